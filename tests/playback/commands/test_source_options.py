"""Which motion is meant by what was typed."""

import argparse
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from limbcal.errors import ConfigError
from playback.commands.source_options import add_source_arguments, open_source
from playback.source import Source

Opened = Callable[..., Source]


def opened(*arguments: object) -> Source:
    parser = argparse.ArgumentParser()
    add_source_arguments(parser)
    return open_source(parser.parse_args([str(argument) for argument in arguments]))


@pytest.fixture
def reference(tmp_path: Path) -> Path:
    """Write targets for the arm of two joints."""
    path, t = tmp_path / "targets.csv", np.arange(0.0, 0.1, 0.001)
    table = np.column_stack([t, 0.0 * t, 0.1 * (t > 0.02)])
    np.savetxt(path, table, delimiter=",", header="t,ref1,ref2", comments="")
    return path


def test_a_file_moves_the_arm_that_was_named(motion_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = opened(motion_file, "--arm", "dd-arm-vertical")
    assert (source.arm.name, source.twin) == ("dd-arm-vertical", None)
    assert source.durations_s == pytest.approx({1: 0.5, 2: 1.0, 3: 1.5})
    assert "no --arm" not in capsys.readouterr().err


def test_without_an_arm_it_is_said_whose_tip_it_is(motion_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert opened(motion_file).arm.name == "dd-arm"
    assert "no --arm given: tip and points are those of dd-arm" in capsys.readouterr().err


def test_a_file_s_suffix_may_be_in_capitals(motion_file: Path, tmp_path: Path) -> None:
    loud = tmp_path / "MOTION.NPZ"
    loud.write_bytes(motion_file.read_bytes())
    assert opened(loud).trials == opened(motion_file).trials


def test_a_recording_has_an_arm_unless_another_is_named(recording: Path) -> None:
    assert opened(recording).arm.name == "dd-arm"
    assert opened(recording, "--arm", "dd-arm-vertical").arm.name == "dd-arm-vertical"


def test_targets_alone_are_simulated(reference: Path) -> None:
    source = opened("--reference", reference, "--arm", "dd-arm")
    assert source.twin is None and len(source.trials) == 1
    assert source.load(next(iter(source.trials))).q[-1, 1] > 0.0


def test_a_twin_follows_the_targets_beside_the_motion(motion_file: Path, reference: Path) -> None:
    source = opened(motion_file, "--twin", "dd-arm", "--reference", reference)
    assert source.twin is not None
    twin = opened(motion_file, "--twin", motion_file)
    assert twin.twin is not None and twin.twin.arm.name == "dd-arm"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([], "a motion is missing: expected SOURCE or --reference"),
        (["a.csv", "--reference", "b.csv"], "SOURCE and --reference are both given"),
        (["--reference", "b.csv", "--twin", "dd-arm", "--arm", "dd-arm"], "--twin is given without SOURCE"),
        (["--reference", "b.csv"], "--arm is missing"),
        (["a.txt"], "a.txt: the suffix is '.txt', expected one of .mcap, .csv"),
    ],
)
def test_what_contradicts_itself_is_refused(arguments: list[str], said: str) -> None:
    with pytest.raises(ConfigError, match=said.replace(".", r"\.")):
        opened(*arguments)
