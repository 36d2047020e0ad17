"""`fitter track`."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arm.arm_file import load_arm, save_arm
from arm.model import Arm, Joint, Sensor
from fitter.__main__ import main
from fitter.commands.track import _warn
from fitter.data.motion_file import write_motion
from fitter.data.trials import load_trials
from fitter.sensing.verdict import Verdict
from protocol.message import RAW, encode
from protocol.recording import RecordingWriter


@pytest.fixture(scope="module")
def raw(short_run, tmp_path_factory):
    path = tmp_path_factory.mktemp("raw") / "day.npz"
    write_motion(path, short_run.raw_columns())
    return path


def test_accelerations_become_joint_motion(fitter, raw, tmp_path):
    out = tmp_path / "new" / "motion.parquet"
    outcome = fitter("track", raw, "--arm", "dd-arm", "--method", "integrate", "--out", out)
    assert outcome.code == 0
    document = outcome.document
    common = {"method", "out", "frames", "trials", "lost_samples", "seconds", "angle_error_deg", "notes"}
    assert set(document) == common and document["seconds"] > 0.0
    assert (document["method"], document["out"]) == ("integrate", str(out))
    assert (document["trials"], document["lost_samples"]) == (3, 0)
    assert set(document["angle_error_deg"]) == {"mean", "max"}
    assert len(document["angle_error_deg"]["mean"]) == len(document["angle_error_deg"]["max"]) == 2
    assert max(document["angle_error_deg"]["max"]) < 1.0
    trials = load_trials([out], 2)
    assert len(trials) == 3 and sum(len(trial.t) for trial in trials) == document["frames"]
    assert all(trial.tip is not None and trial.ref is not None for trial in trials)
    assert "3 trial(s) ->" in outcome.said


@pytest.fixture(scope="module")
def two_seconds(short_run, tmp_path_factory):
    path = tmp_path_factory.mktemp("raw") / "start.npz"
    write_motion(path, {name: values[:8000] for name, values in short_run.raw_columns().items()})
    return path


@pytest.mark.parametrize(
    ("method", "says"),
    [("filter", {"innovation", "doubted", "wrong"}), ("smooth", {"doubted", "wrong", "passes", "converged"})],
)
def test_what_a_tracker_says_of_itself_is_in_the_document(fitter, two_seconds, tmp_path, method, says):
    out = tmp_path / "motion.csv"
    outcome = fitter("track", two_seconds, "--arm", "dd-arm", "--method", method, "--out", out)
    document = outcome.document
    assert outcome.code == 0 and document["method"] == method
    common = {"method", "out", "frames", "trials", "lost_samples", "seconds", "angle_error_deg", "within_3_std"}
    assert set(document) == common | says | {"notes"}
    assert len(document["within_3_std"]) == 2 and all(0.0 <= share <= 1.0 for share in document["within_3_std"])
    assert document["wrong"] is False and "warning" not in outcome.said
    header = out.read_text().partition("\n")[0]
    assert header == "t,q1,q2,dq1,dq2,ddq1,ddq2,q_std1,q_std2,tipx,tipy,tipz,ref1,ref2,trial"
    assert len(load_trials([out], 2)) == document["trials"]


@pytest.mark.parametrize("method", ["filter", "integrate"])
def test_a_leap_of_a_day_makes_two_runs_and_no_frames_between(fitter, short_run, tmp_path, method):
    raw = {name: values[:8000].copy() for name, values in short_run.raw_columns().items()}
    raw["t"][1500:] += 86400.0
    write_motion(tmp_path / "leap.npz", raw)
    out = tmp_path / "m.npz"
    outcome = fitter("track", tmp_path / "leap.npz", "--arm", "dd-arm", "--method", method, "--out", out)
    assert outcome.code == 0 and outcome.document["lost_samples"] == 0 and outcome.document["frames"] <= 2001
    (note,) = [note for note in outcome.document["notes"] if note["kind"] == "gap"]
    assert note["row"] == 1501 and note["columns"] == ["t"]
    motion = np.load(out)
    assert (np.diff(motion["t"]) > 1.0).sum() == 1
    after = int(np.argmax(np.diff(motion["t"]))) + 1
    assert motion["q1"][after] == pytest.approx(motion["q1"][after - 1], abs=0.01)


def test_unless_told_otherwise_the_whole_recording_is_smoothed(fitter, two_seconds, tmp_path):
    outcome = fitter("track", two_seconds, "--arm", "dd-arm", "--out", tmp_path / "motion.npz")
    assert outcome.document["method"] == "smooth" and outcome.document["converged"] is True


@pytest.fixture
def moved_file(short_run, tmp_path):
    *others, last = short_run.arm.sensors
    moved = replace(short_run.arm, sensors=(*others, replace(last, position_m=(0.20, 0.05, 0.0))))
    save_arm(moved, tmp_path / "moved.toml")
    return tmp_path / "moved.toml"


@pytest.mark.parametrize(
    ("method", "says", "size"),
    [
        ("filter", "the readings differ from arm 'dd-arm' by", "discrepancy_m_s2"),
        ("smooth", "the readings fit arm 'dd-arm' only if its sensors sit otherwise", "place_off_m"),
    ],
)
def test_readings_that_contradict_the_arm_are_warned_of(fitter, two_seconds, moved_file, method, says, size):
    out = moved_file.parent / "motion.npz"
    outcome = fitter("track", two_seconds, "--arm", moved_file, "--method", method, "--out", out)
    assert outcome.code == 0 and outcome.document["wrong"] is True
    assert f"warning: start: {says}" in outcome.said
    assert "let `fitter sensors` find how they" in outcome.said
    assert outcome.document[size] > 0.0


def test_predicted_frames_are_marked_in_every_run_if_in_one(fitter, two_seconds, short_run, tmp_path):
    kept, torn = np.r_[0:6000, 6080:8000], tmp_path / "torn.npz"
    write_motion(torn, {name: values[kept] for name, values in short_run.raw_columns().items()})
    outs = [tmp_path / f"{k}.npz" for k in (1, 2)]
    for raw, out in (((two_seconds,), outs[0]), ((two_seconds, torn), outs[1])):
        assert fitter("track", *raw, "--arm", "dd-arm", "--method", "filter", "--out", out).code == 0
    whole, both = np.load(outs[0]), np.load(outs[1])
    assert "gap" not in whole
    n = len(whole["t"])
    assert not both["gap"][:n].any() and both["gap"][n:].sum() == 20


@pytest.mark.parametrize("suffix", [".npz", ".csv", ".parquet"])
def test_the_same_readings_give_the_same_bytes(fitter, two_seconds, tmp_path, suffix):
    outs = [tmp_path / f"{k}{suffix}" for k in (1, 2)]
    for out in outs:
        assert fitter("track", two_seconds, "--arm", "dd-arm", "--frame-rate-hz", "250", "--out", out).code == 0
    assert outs[0].read_bytes() == outs[1].read_bytes()


def test_without_the_truth_there_is_no_error_to_tell(fitter, short_run, tmp_path):
    columns = {name: values[:8000] for name, values in short_run.raw_columns().items() if name not in ("q", "ref")}
    path = tmp_path / "raw.csv"
    write_motion(path, columns)
    outcome = fitter("track", path, "--arm", "dd-arm", "--out", tmp_path / "motion.csv")
    assert outcome.code == 0 and "angle_error_deg" not in outcome.document
    header = (tmp_path / "motion.csv").read_text().partition("\n")[0]
    assert header == "t,q1,q2,dq1,dq2,ddq1,ddq2,q_std1,q_std2,tipx,tipy,tipz,trial"


def test_options_reach_the_tracker(fitter, two_seconds, tmp_path):
    common = ("track", two_seconds, "--arm", "dd-arm", "--frame-rate-hz", "100", "--method", "integrate")
    fitter(*common, "--out", tmp_path / "a.npz")
    fitter(*common, "--zero", "first-rest", "--initial-q", "0.5,-0.25", "--out", tmp_path / "b.npz")
    a, b = np.load(tmp_path / "a.npz"), np.load(tmp_path / "b.npz")
    assert np.allclose(np.diff(a["t"]), 0.01)
    assert (a["q1"][0], a["q2"][0]) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert (b["q1"][0], b["q2"][0]) == pytest.approx((0.5, -0.25), abs=1e-6)


def test_several_runs_become_one_file_whose_trials_keep_apart(fitter, two_seconds, short_run, tmp_path):
    longer = tmp_path / "longer.npz"
    write_motion(longer, {name: values[:32000] for name, values in short_run.raw_columns().items()})
    out = tmp_path / "motion.npz"
    common = ("--arm", "dd-arm", "--frame-rate-hz", "100", "--method", "integrate")
    outcome = fitter("track", longer, two_seconds, *common, "--out", out)
    assert outcome.code == 0 and outcome.document["trials"] == 3
    assert [trial.name for trial in load_trials([out], 2)] == [f"motion/{k}" for k in ("1.1", "1.2", "2.1")]


def test_labels_of_several_runs_stay_where_they_differ(fitter, short_run, tmp_path):
    columns = {name: values[:2000] for name, values in short_run.raw_columns().items()}
    paths = [tmp_path / f"{label}.npz" for label in ("á", "b")]
    for path in paths:
        write_motion(path, columns | {"trial": np.full(2000, path.stem)})
    again = tmp_path / "again.npz"
    write_motion(again, columns | {"trial": np.full(2000, paths[0].stem)})
    common = ("--arm", "dd-arm", "--frame-rate-hz", "50", "--method", "integrate", "--out", tmp_path / "m.npz")
    for given, labels in ((paths, ["b", "á"]), ([paths[0], again], ["1.á", "2.á"])):
        assert fitter("track", *given, *common).code == 0
        assert np.unique(np.load(tmp_path / "m.npz")["trial"]).tolist() == labels


def test_a_sliding_joint_is_off_by_millimetres(fitter, tmp_path):
    sensors = tuple(Sensor(f"s{k}", min(k, 2), (0.05 * k, 0.0, 0.0)) for k in (1, 2, 3))
    save_arm(Arm("rail", (Joint("prismatic"), Joint(a_m=0.2)), sensors=sensors), tmp_path / "rail.toml")
    rest = {f"s{k}{axis}": np.full(400, 9.80665 * (axis == "z")) for k in (1, 2, 3) for axis in "xyz"}
    true = {"q1": np.full(400, 0.003), "q2": np.full(400, np.deg2rad(2.0))}
    write_motion(tmp_path / "raw.csv", {"t": 0.01 * np.arange(400), **rest, **true})
    common = ("--arm", tmp_path / "rail.toml", "--method", "integrate", "--out", tmp_path / "m.csv")
    assert "mean / max a joint: 3 / 3 mm, 2 / 2 deg" in fitter("track", tmp_path / "raw.csv", *common).said


def test_lost_samples_are_counted_and_said(fitter, short_run, tmp_path):
    kept = np.r_[0:12000, 12080:27000]
    path = tmp_path / "torn.npz"
    write_motion(path, {name: values[kept] for name, values in short_run.raw_columns().items()})
    outcome = fitter("track", path, "--arm", "dd-arm", "--out", tmp_path / "motion.npz")
    assert outcome.document["lost_samples"] == 80
    assert "torn: 80 samples lost in 1 gap(s)" in outcome.said


def test_a_recording_of_the_daemon_needs_no_mapping(fitter, short_run, tmp_path):
    path = tmp_path / "day.mcap"
    with RecordingWriter(path, "", "") as writer:
        for begin in range(0, 27000, 400):
            t0_ns = round(short_run.t[begin] * 1e9)
            a = short_run.a[begin : begin + 400].astype(np.float32)
            fields = {"sample0": begin, "t0_ns": t0_ns, "dt_s": 1 / 4000, "n": len(a), "a": a}
            writer.write(RAW, encode(RAW, fields)[1], t0_ns)
    out = tmp_path / "motion.npz"
    outcome = fitter("track", path, "--arm", "dd-arm", "--out", out)
    assert outcome.code == 0
    q = np.load(out)["q1"]
    assert q[-1] == pytest.approx(short_run.truth["q"][26999, 0], abs=0.02)


def test_words_only_where_no_document_is_asked_for(two_seconds, tmp_path, capfd):
    out = str(tmp_path / "m.npz")
    arguments = ["track", str(two_seconds), "--arm", "dd-arm", "--frame-rate-hz", "50", "--out", out]
    assert main(arguments) == 0
    out, _ = capfd.readouterr()
    assert "frames in 1 trial(s)" in out
    assert main([*arguments, "--json"]) == 0
    out, _ = capfd.readouterr()
    assert json.loads(out)["trials"] == 1


@pytest.mark.parametrize(("lacks", "advised"), [(None, True), (0.3, False)])
def test_a_start_is_advised_only_where_it_would_count(capfd, lacks, advised):
    """The motion of an arm that lacks something begins with what gravity shows."""
    verdict = Verdict(doubted=0.0, wrong=False, passes=30, converged=False, discrepancy_m_s2=lacks)
    run, part = SimpleNamespace(name="day", after_leap=False), SimpleNamespace(verdict=verdict)
    _warn(run, load_arm("dd-arm"), part)
    said = capfd.readouterr().err.replace("\n", " ")
    assert "after 30 passes the motion still changes" in said
    assert ("--initial-q" in said) is advised
