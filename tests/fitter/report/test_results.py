"""What a calibration leaves behind."""

import json
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Control
from fitter.data.trials import load_trials
from fitter.live.calibration import Calibration
from fitter.report import published
from fitter.report.compared import load_compared
from fitter.report.parameter_listing import parameter_rows
from fitter.report.results import write_results
from limbcal.arguments import version
from limbcal.digits import plain
from limbcal.errors import DeviceError

FILES = ["calibrated.toml", "dynamics.json", "kinematics.json", "motions.npz", "report.html"]


@pytest.fixture(scope="module")
def written(calibration, tmp_path_factory):
    out = tmp_path_factory.mktemp("results") / "new" / "folder"
    compared = load_compared(["dd-arm"], calibration.arm)
    return out, write_results(calibration, compared, {"frames": 1000, "motions": 3}, out)


class Page(HTMLParser):
    """The text of every cell, and every address that a browser would follow."""

    def __init__(self, html):
        super().__init__()
        self.rows, self.addresses, self._cell = [], [], False
        self.feed(html)

    def handle_starttag(self, tag, attributes):
        self.addresses += [value for name, value in attributes if name in ("src", "href", "action", "data")]
        if tag == "tr":
            self.rows.append([])
        self._cell = tag in ("td", "th")

    def handle_data(self, data):
        if self._cell:
            self.rows[-1].append(data)

    def handle_endtag(self, tag):
        self._cell = False


def test_everything_is_written(written):
    out, document = written
    assert sorted(path.name for path in out.iterdir()) == FILES
    assert set(document) == {"stream", "kinematics", "dynamics"}
    assert document["stream"] == {"frames": 1000, "motions": 3}


def test_the_files_say_what_the_document_says(written):
    out, document = written
    for part in ("kinematics", "dynamics"):
        said = json.loads((out / f"{part}.json").read_text())
        for name, parameter in said["parameters"].items():
            assert parameter["value"] == document[part]["parameters"][name]["value"]
        assert (out / f"{part}.json").read_text().endswith("}\n")


def test_the_arm_is_the_calibrated_one(written, calibration):
    arm = load_arm(written[0] / "calibrated.toml")
    assert arm == calibration.calibrated()
    learnt = {name: estimate.value for name, estimate in arm.base_parameters.items()}
    document = written[1]["dynamics"]["parameters"]
    assert learnt == {name: document[name]["value"] for name in learnt}


def test_the_motions_can_be_read_back_and_simulated(written, calibration):
    out, _ = written
    trials = load_trials([out / "motions.npz"], 2)
    assert [trial.name for trial in trials] == ["motions/1", "motions/2", "motions/3"]
    for trial, measured in zip(trials, [*calibration.learn, *calibration.evaluate], strict=True):
        assert np.array_equal(trial.q, measured.q) and trial.ref.shape == measured.q.shape
        assert trial.notes == ()
    columns = np.load(out / "motions.npz")
    simulated = np.column_stack([columns["simulated1"], columns["simulated2"]])
    q = np.column_stack([columns["q1"], columns["q2"]])
    assert np.rad2deg(np.abs(simulated - q)).mean() < 0.5


def test_the_report_opens_offline(written):
    html = (written[0] / "report.html").read_text(encoding="utf-8")
    page = Page(html)
    assert page.addresses and all(address.startswith("data:image/png;base64,") for address in page.addresses)
    assert not any(word in html for word in ("http:", "https:", "//cdn", "@import", "url(", "<script", "<link"))


def test_the_report_shows_the_papers_numbers_beside_ours(written, calibration):
    out, document = written
    rows = {row[0]: row for row in Page((out / "report.html").read_text(encoding="utf-8")).rows if row}
    ours = document["dynamics"]["angle_error_deg"]
    for kind, paper in (("mean", ["0.7300", "1.910"]), ("max", ["3.510", "12.70"])):
        found = [plain(ours[role][kind]) for role in ("learn", "evaluate")]
        assert rows[f"simulated angle, {kind} [deg]"][1:] == [*found, *paper]
    for section, paper in (
        (calibration.dynamics, published.DYNAMICS),
        (calibration.kinematics(), published.KINEMATICS),
    ):
        for row in parameter_rows(section.parameters, {}):
            name, value, half_width, *others, unit = rows[row.name]
            assert (name, value, half_width, unit) == row.cells
            assert len(others) == 2 and (others[1] != "–") == (name in paper)
    assert rows["parameter"] == ["parameter", "value", "± (95 %)", "dd-arm", "the paper", "unit"]


def test_the_report_can_be_handed_on(written, calibration):
    html = (written[0] / "report.html").read_text(encoding="utf-8")
    for words in (
        "What the symbols mean",
        "What was assumed",
        "Where this comes from",
        version(),
        "eq. (5)",
        "9.5",
    ):
        assert words in html
    rows = {row[0]: row for row in Page(html).rows if row}
    assert "only these sums move the arm" in rows["sums such as I1+m2*L1^2"][1]
    assert rows["date"][1].startswith("20") and rows["limbcal"] == ["limbcal", version()]
    assert all(note.text in unescape(html) for note in calibration.dynamics.notes)


def test_nothing_of_the_papers_is_on_the_page_of_another_arm(calibration, tmp_path):
    others = Calibration(replace(calibration.arm, name="ours"))
    others.learn, others.evaluate = calibration.learn, calibration.evaluate
    others.geometry, others.dynamics = calibration.geometry, calibration.dynamics
    write_results(others, [], {}, tmp_path)
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Calibration of ours" in html and "paper" not in html.lower()


def test_the_terminal_ends_with_the_reports_tables(calibration, capsys):
    write_results(calibration, [], {}, None)
    out, err = capsys.readouterr()
    assert err == ""
    for fit in (calibration.kinematics(), calibration.dynamics):
        for row in parameter_rows(fit.parameters, {}):
            assert any(all(cell in line for cell in row.cells) for line in out.splitlines()), row
    assert max(map(len, out.splitlines())) <= 80
    assert "simulated angle, mean [deg]: learn" in out


def test_without_a_folder_nothing_is_written(calibration, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    document = write_results(calibration, [], {"frames": 1}, None)
    assert set(document) == {"stream", "kinematics", "dynamics"}
    assert list(tmp_path.iterdir()) == []


def test_what_is_not_known_is_not_written(measured, short_run, tmp_path):
    geometry_only = Calibration(replace(short_run.arm, control=Control("measured")))
    for motion in measured[:2]:
        geometry_only.add(motion)
    geometry_only.conclude()
    document = write_results(geometry_only, [], {}, tmp_path)
    assert set(document) == {"stream", "kinematics"}
    assert document["kinematics"]["tip_error_mm"]["evaluate"] is None
    assert sorted(path.name for path in tmp_path.iterdir()) == ["calibrated.toml", "kinematics.json"]


def test_the_same_calibration_gives_the_same_bytes(calibration, written, tmp_path):
    compared = load_compared(["dd-arm"], calibration.arm)
    write_results(calibration, compared, {"frames": 1000, "motions": 3}, tmp_path)
    for name in FILES:
        again, before = ((folder / name).read_bytes() for folder in (tmp_path, written[0]))
        if name == "report.html":  # tells the day and the command
            again, before = (page.partition(b"Where this comes from")[0] for page in (again, before))
        assert again == before, name


def test_a_place_that_cannot_be_written_to(calibration, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(DeviceError, match="file/below: cannot be written: Not a directory"):
        write_results(calibration, [], {}, tmp_path / "file" / "below")
    (tmp_path / "motions.npz").mkdir()
    with pytest.raises(DeviceError, match="motions.npz: cannot be written"):
        write_results(calibration, [], {}, tmp_path)
