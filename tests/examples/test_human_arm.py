"""A person's arms, where the recordings are: the example's own figures, with a margin."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from tests.soak import Long

EXAMPLE = Path(__file__).parents[2] / "examples" / "human_arm.py"
DATA = Path(os.environ.get("LIMBCAL_DATA", Path(__file__).parents[2] / ".." / "shared" / "data"))
#: Tilt of upper arm and forearm, rms [deg]; measured: 2.9 5.1 and 4.2 4.7.
SMOOTHER_DEG = {"right": (4.0, 7.5), "left": (5.2, 6.5)}


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


def test_the_smoother_beats_the_readings_and_claims_what_it_holds(
    example: ModuleType, side: str, long: Long
) -> None:
    """Nothing is given of the walk: that the shoulder moves, and how much, is found in the readings."""
    if side == "left" and not long.at_length:
        pytest.skip("both arms are tracked with --long")
    readings, up = example.read_side(DATA, side)
    tracks = example.tracks_of(example.load_arm(example.ARM), readings)

    def rms(name: str) -> np.ndarray:
        return np.sqrt(np.mean(tracks[name].misses(up)[0] ** 2, axis=0))

    assert (rms("smoother") < SMOOTHER_DEG[side]).all()
    assert (rms("smoother") < rms("low-passed twice")).all()
    within = np.abs(np.radians(tracks["smoother"].misses(up)[0])) < 3.0 * tracks["smoother"].std
    assert within.mean(axis=0).min() > 0.95


def test_without_the_recordings_it_says_which_file_it_misses(tmp_path: Path) -> None:
    command = [sys.executable, str(EXAMPLE), "--data", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stdout == ""
    (sentence,) = done.stderr.splitlines()
    assert "hipose" in sentence and "is not there" in sentence
