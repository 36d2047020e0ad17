"""A person's arms, where the recordings are: the example's own figures, with a margin."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

EXAMPLE = Path(__file__).parents[2] / "examples" / "human_arm.py"
DATA = Path(os.environ.get("LIMBCAL_DATA", Path(__file__).parents[2] / ".." / "shared" / "data"))
#: Tilt of upper arm and forearm, rms [deg]; measured: filter 4.7 9.0 and 5.3 9.2, smoother 3.7 6.6 and 4.4 9.6.
FILTER_DEG = {"right": (5.7, 10.5), "left": (6.3, 10.7)}
SMOOTHER_DEG = {"right": (4.5, 8.0), "left": (5.2, 11.0)}


@pytest.fixture(scope="module")
def example() -> ModuleType:
    spec = importlib.util.spec_from_file_location("human_arm", EXAMPLE)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(params=["right", "left"])
def side(request: pytest.FixtureRequest) -> str:
    if not (DATA / "hipose").is_dir():
        pytest.skip(f"no measured data in {DATA / 'hipose'}; LIMBCAL_DATA can name another folder")
    return str(request.param)


def test_up_is_what_the_sensors_read_while_the_person_stands(example: ModuleType, side: str) -> None:
    readings, up = example.read_side(DATA, side)
    still = slice(0, 270)
    felt = readings.reshape(-1, 2, 3)[still].mean(axis=0)
    assert np.linalg.norm(felt, axis=1) == pytest.approx([9.81, 9.81], abs=0.1)
    angle = np.degrees(np.arccos((felt * up[still].mean(axis=0)).sum(axis=1) / np.linalg.norm(felt, axis=1)))
    assert angle.max() < 1.5


def test_told_of_the_walk_filter_and_smoother_beat_the_readings(example: ModuleType, side: str) -> None:
    readings, up = example.read_side(DATA, side)
    builder = example.ReadingsBuilder(example.RATE_HZ, 6, example.RATE_HZ)
    builder.push(readings)
    arm = example.load_arm(example.ARM)
    filtered, smoothed = example.of_a_walker(arm, builder.done())

    def rms(track: object) -> np.ndarray:
        return np.sqrt(np.mean(example.Track.misses(track, up)[0] ** 2, axis=0))

    low_pass = example.butter(2, 1.0, fs=example.RATE_HZ, output="sos")
    plain = rms(example.taken_for_gravity(example.sosfiltfilt(low_pass, readings, axis=0)))
    raw = rms(example.taken_for_gravity(readings))
    assert (rms(filtered) < FILTER_DEG[side]).all() and (rms(filtered) < raw).all()
    assert (rms(smoothed) < SMOOTHER_DEG[side]).all() and (rms(smoothed) < plain).all()
    for track in (filtered, smoothed):
        within = np.abs(np.radians(track.misses(up)[0])) < 3.0 * track.std
        assert within.mean(axis=0).min() > 0.97


def test_without_the_recordings_it_says_which_file_it_misses(tmp_path: Path) -> None:
    command = [sys.executable, str(EXAMPLE), "--data", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stdout == ""
    (sentence,) = done.stderr.splitlines()
    assert "hipose" in sentence and "is not there" in sentence
