"""Faultless data are asked nothing."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from fitter.data.motions import Measured
from fitter.data.plausibility.questions import questioned


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(("size", "rate_hz"), [(1.0, 250.0), (0.1, 1000.0), (4.0, 100.0), (1.0, 40.0)])
def test_clean_motions_pass_unchanged(arm, clean, seed, size, rate_hz):
    motion = clean(seed, size, rate_hz)
    assert questioned([motion], arm) == [motion]


def test_a_wheel_that_turns_many_times_is_legal():
    t = np.arange(0.0, 30.0, 0.01)
    for speed in (2.0, 15.0):
        wheel = Measured("wheel", "wheel.csv", 0, t, {"q": np.column_stack([speed * t, np.sin(t)])})
        assert questioned([wheel], load_arm("dd-arm")) == [wheel]


def test_a_bench_motion_of_the_virtual_arm_passes(short_run):
    columns = short_run.motion_columns([1], 8)
    motion = Measured("bench", "bench.csv", 0, columns["t"], {"q": columns["q"], "ref": columns["ref"]})
    assert questioned([motion], short_run.arm) == [motion]


def test_poses_that_were_measured_one_by_one_are_asked_nothing(arm):
    rng = np.random.default_rng(3)
    for span in (0.5, np.pi, 200.0):
        poses = Measured("poses", "poses.csv", 0, np.arange(400.0), {"q": rng.uniform(-span, span, (400, 2))})
        assert questioned([poses], arm) == [poses]
