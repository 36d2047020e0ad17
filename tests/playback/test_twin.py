"""The virtual arm beside the real one."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from arm.arm_file import load_arm, save_arm
from arm.kinematics import tip_position
from arm.model import Arm
from arm.simulation import simulate
from limbcal.errors import ConfigError, DataError
from playback.file_source import file_source
from playback.player import Player
from playback.source import Source
from playback.twin import with_twin

DT_S = 1e-3


def heavier(arm: Arm) -> Arm:
    last = arm.joints[-1]
    link = replace(last.link, mass_kg=1.3 * last.link.mass_kg)
    return replace(arm, name="heavier", joints=(*arm.joints[:-1], replace(last, link=link)))


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write two trials of the built-in arm with their targets."""
    arm = load_arm("dd-arm")
    rows = []
    for trial, target in ((1, (0.4, -0.2)), (2, (-0.3, 0.5))):
        motion = simulate(arm, np.tile(target, (800, 1)), DT_S, np.array([0.1, 0.05 * trial]))
        number = np.full(len(motion.t), trial)
        rows.append(np.column_stack([motion.t, motion.q, motion.dq, motion.ddq, motion.ref, number]))
    names = ["t", "q1", "q2", "dq1", "dq2", "ddq1", "ddq2", "ref1", "ref2", "trial"]
    path = tmp_path_factory.mktemp("twin") / "measured.npz"
    np.savez(path, **dict(zip(names, np.concatenate(rows).T, strict=True)))
    return path


@pytest.fixture(scope="module")
def real(measured: Path) -> Source:
    return file_source(measured, load_arm("dd-arm"))


def test_the_arm_itself_moves_as_it_was_measured(real: Source, measured: Path) -> None:
    both = with_twin(real, "dd-arm", measured, print)
    t = np.linspace(0.0, 0.7, 50)
    for trial in (1, 2):
        np.testing.assert_allclose(both.twin.load(trial).at(t)[0], real.load(trial).at(t)[0], atol=1e-9)


def test_another_arm_starts_there_and_goes_its_own_way(
    real: Source, measured: Path, tmp_path: Path, fake_time
) -> None:
    arm = heavier(load_arm("dd-arm"))
    save_arm(arm, tmp_path / "heavier.toml")
    both = with_twin(real, str(tmp_path / "heavier.toml"), measured, print)
    player = Player(both, 100.0, fake_time.clocks, 2)
    player.play()
    fake_time.now_s += 0.6
    frames = []
    while (frame := player.take_due()) is not None:
        frames.append(frame)
    assert player.state()["twin"] is True
    np.testing.assert_array_equal(frames[0]["twin"]["q"], frames[0]["q"])
    assert np.abs(frames[-1]["twin"]["q"] - frames[-1]["q"]).max() > 1e-3
    for frame in frames:
        np.testing.assert_array_equal(frame["twin"]["tip"], tip_position(arm, frame["twin"]["q"]))


def test_a_motion_may_be_the_twin(real: Source, measured: Path) -> None:
    said: list[str] = []
    both = with_twin(real, str(measured), None, said.append)
    assert both.twin.name == "measured.npz"
    assert not said


def test_trials_that_only_one_has_are_left_out_and_said(real: Source, tmp_path: Path) -> None:
    t = np.arange(10) * 0.1
    np.savez(tmp_path / "second.npz", t=t, q1=t, q2=t, trial=np.full(10, 2))
    said: list[str] = []
    both = with_twin(real, str(tmp_path / "second.npz"), None, said.append)
    assert both.trials == (2,)
    assert any("it has no trial 1; left out" in sentence for sentence in said)
    np.savez(tmp_path / "other.npz", t=t, q1=t, q2=t, trial=np.full(10, 7))
    with pytest.raises(DataError, match=r"none of the trials of measured.npz"):
        with_twin(real, str(tmp_path / "other.npz"), None, print)


def test_what_cannot_be_a_twin_is_refused(real: Source, measured: Path) -> None:
    with pytest.raises(ConfigError, match="has no targets; expected --reference FILE with ref1"):
        with_twin(real, "dd-arm", None, print)
    with pytest.raises(ConfigError, match=r"it has \d+ joint\(s\), but what moves in measured.npz has 2"):
        with_twin(real, "spatial-arm", measured, print)
