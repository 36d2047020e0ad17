"""`--export`: which files are taken, and that of several trials each has its own motion."""

import argparse
from pathlib import Path

import numpy as np
import pytest

from arm.model import Arm
from benchmarks.simulated_people.person import person, with_markers
from fitter.commands.limb_export import add_export, check_export, export
from fitter.export.motion_tables import marker_places
from fitter.limb.tracking import TrackedLimb
from limbcal.errors import ConfigError, DeviceError
from protocol.markers.trc_file import read_trc


@pytest.fixture(scope="module")
def arm() -> Arm:
    return with_markers(person(n=2))


def motion(arm: Arm, n: int = 5, first_s: float = 1.0) -> TrackedLimb:
    q = np.tile(np.linspace(0.1, 0.2, arm.n_joint), (n, 1))
    base = np.tile([0.1, 0.2, 0.3, 1.0, 0.0, 0.0, 0.0], (n, 1))
    return TrackedLimb(first_s + 0.02 * np.arange(n), q, 0.0 * q, base, np.zeros((n, len(arm.markers))), ())


def columns(path: Path) -> list[list[str]]:
    return [line.split() for line in path.read_text().splitlines()]


@pytest.mark.parametrize("motions", [True, False])
def test_the_option_takes_files_and_says_which(motions: bool) -> None:
    parser = argparse.ArgumentParser()
    add_export(parser, motions)
    assert parser.parse_args([]).export == []
    assert parser.parse_args(["--export", "a.osim", "b.mot"]).export == [Path("a.osim"), Path("b.mot")]
    assert ("(.mot)" in parser.format_help()) == motions


@pytest.mark.parametrize(
    ("name", "motions", "fits"),
    [
        ("a.osim", False, True),
        ("a.BIOMOD", False, True),
        ("a.mot", True, True),
        ("a.trc", True, True),
        ("a.mot", False, False),
        ("a.fbx", True, False),
        ("a", True, False),
    ],
)
def test_endings_that_are_none_are_refused(tmp_path: Path, name: str, motions: bool, fits: bool) -> None:
    if fits:
        check_export([tmp_path / name], motions)
        return
    found = Path(name).suffix or "nothing"
    known = ".osim, .bioMod, .mot, .trc" if motions else ".osim, .bioMod"
    with pytest.raises(ConfigError, match=f"its name ends with {found}, expected {known}$"):
        check_export([tmp_path / "a.osim", tmp_path / name], motions)


def test_models_and_one_motion_have_the_names_that_were_given(
    arm: Arm, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    paths = [tmp_path / name for name in ("a.OSIM", "a.bioMod", "a.mot", "a.trc")]
    one = motion(arm)
    assert export(paths, arm, [one], ["walk"]) == [str(path) for path in paths]
    assert "<OpenSimDocument" in paths[0].read_text() and "segment" in paths[1].read_text()
    assert float(columns(paths[2])[-1][0]) == pytest.approx(1.08)
    written = read_trc(paths[3])
    assert written.rate_hz == pytest.approx(50.0)
    assert list(written.labels) == [marker.name for marker in arm.markers]
    np.testing.assert_allclose(written.points, marker_places(arm, one.q, one.base), atol=1e-6)
    assert f"exported: {paths[0]}, {paths[1]}" in capsys.readouterr().out.replace("\n", "")


def test_each_of_several_trials_has_its_own_file(arm: Arm, tmp_path: Path) -> None:
    tracked = [motion(arm, first_s=1.0), motion(arm, first_s=3.0)]
    written = export([tmp_path / "a.mot"], arm, tracked, ["walk", "run"])
    assert written == [str(tmp_path / "a_walk.mot"), str(tmp_path / "a_run.mot")]
    assert [float(columns(Path(path))[-1][0]) for path in written] == pytest.approx([1.08, 3.08])


def test_a_single_frame_has_a_rate_too(arm: Arm, tmp_path: Path) -> None:
    export([tmp_path / "a.trc"], arm, [motion(arm, n=1)], ["walk"])
    assert columns(tmp_path / "a.trc")[2][0] == "1"


def test_nothing_asked_for_says_nothing(arm: Arm, capsys: pytest.CaptureFixture[str]) -> None:
    assert export([], arm) == []
    assert capsys.readouterr().out == ""


def test_what_cannot_be_written_is_said(arm: Arm, tmp_path: Path) -> None:
    with pytest.raises(DeviceError, match="cannot be written: Is a directory"):
        (tmp_path / "a.osim").mkdir()
        export([tmp_path / "a.osim"], arm)
