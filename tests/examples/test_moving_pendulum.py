"""The pendulum's example: how it reads recordings, and what it says where they are not there."""

import importlib.util
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

EXAMPLE = Path(__file__).parents[2] / "examples" / "moving_pendulum.py"


@pytest.fixture(scope="module")
def example() -> ModuleType:
    spec = importlib.util.spec_from_file_location("moving_pendulum", EXAMPLE)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_an_angle_is_that_about_the_main_axis(example: ModuleType) -> None:
    """Whatever the cameras' frame is, and beyond half a turn."""
    true = np.concatenate([np.zeros(20), np.linspace(0.0, 4.0, 200)])
    axis, frame = np.array([0.6, 0.0, 0.8]), Rotation.from_rotvec([0.3, -0.5, 0.2])
    turned = (Rotation.from_rotvec(true[:, None] * axis) * frame).as_quat()[:, [3, 0, 1, 2]]
    found = example.angle_of(turned)
    np.testing.assert_allclose(found * np.sign(found[-1]), true, atol=1e-9)


def test_held_readings_are_lines_between_their_changes(example: ModuleType) -> None:
    time = np.arange(6.0)
    held = np.array([[0.0], [0.0], [2.0], [2.0], [6.0], [6.0]])
    found = example.at_changes(np.array([0.0, 1.0, 2.0, 3.0, 4.0]), time, held)
    np.testing.assert_allclose(found[:, 0], [0.0, 1.0, 2.0, 4.0, 6.0])


def test_a_clock_that_is_late_is_found(example: ModuleType) -> None:
    t = np.arange(0.0, 10.0, 1.0 / 90.0)
    q = np.column_stack([np.sin(3.0 * t), np.cos(2.0 * t)])
    early = np.column_stack([np.sin(3.0 * (t + 0.03)), np.cos(2.0 * (t + 0.03))])
    trial = example.Trial("one", t, *np.zeros((2, len(t), 6)), early)
    assert np.abs(example.misses(trial, trial.q, q)).max() < 1e-3


def test_the_reference_is_the_gyros_at_the_level_of_cameras_that_may_stand_still(example: ModuleType) -> None:
    """Gyros that drift, whose zero is off and who count the other way round; cameras that stick."""
    t = np.arange(0.0, 20.0, 1.0 / example.RATE_HZ)
    links = np.column_stack([0.3 * np.sin(3.0 * t), 0.5 * np.sin(2.0 * t)]) * np.clip(t - 1.0, 0.0, 1.0)[:, None]
    rates = np.zeros((len(t), 6))
    rates[:, [2, 5]] = np.gradient(links, t, axis=0) * [1.0, -1.0] + 1e-4 * t[:, None] + 0.01
    links[(t > 8.0) & (t < 10.0)] = links[t > 8.0][0]
    q = np.column_stack([links[:, 0], links[:, 1] - links[:, 0]])
    trial = example.Trial("one", t, np.zeros((len(t), 6)), rates, q)
    moving = (example.inside_of(trial)) & ((t < 8.0) | (t > 10.0))
    off = example.misses(trial, example.at_level(trial), q)[moving[example.inside_of(trial)]]
    assert np.abs(off).mean() < 0.005
    assert np.abs(example.misses(trial, q, example.at_level(trial))).max() > 0.2


def test_gyros_are_read_where_the_arm_has_them(example: ModuleType) -> None:
    arm, t = example.load_arm(example.ARM), np.arange(90) / 90.0
    trial = example.Trial("one", t, np.ones((90, 6)), 2.0 * np.ones((90, 6)), np.zeros((90, 2)))
    assert trial.decimated(arm).values.shape == (90, 6)
    assert trial.decimated(arm.with_gyroscopes(["s1", "s2"])).values[0].tolist() == [1.0] * 6 + [2.0] * 6


def test_without_the_recordings_it_says_which_file_it_misses(tmp_path: Path) -> None:
    command = [sys.executable, str(EXAMPLE), "--data", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    (sentence,) = done.stderr.splitlines()
    assert "Segment_1.csv is not there" in sentence
