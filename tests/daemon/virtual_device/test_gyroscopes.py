"""A virtual device whose arm has gyroscopes."""

from itertools import islice

import numpy as np

from arm.arm_file import load_arm
from arm.bench import Bench, motions
from arm.counts import COUNT_RAD_S
from arm.gyroscope import angular_velocity
from daemon.acquisition.handshake import check_channels
from daemon.virtual_device.bench_plan import BenchPlan
from daemon.virtual_device.gyroscopes import BIAS_RAD_S, NOISE_RAD_S
from daemon.virtual_device.virtual_device import device_info
from daemon.virtual_device.virtual_motion import stretches

RATE_HZ = 2000.0
ARM = load_arm("dd-arm")
TURNING = ARM.with_gyroscopes(["s2", "s4"])


def test_it_sends_what_they_read_after_what_accelerometers_do() -> None:
    (motion,) = islice(motions(ARM, Bench(rate_hz=RATE_HZ), 4), 1)
    (plain,) = islice(stretches(BenchPlan(ARM, 4, RATE_HZ, 1, 0.0)), 1)
    (found,) = islice(stretches(BenchPlan(TURNING, 4, RATE_HZ, 1, 0.0)), 1)
    np.testing.assert_array_equal(found.counts[:, :12], plain.counts)
    expected = angular_velocity(TURNING, motion.q, motion.dq).reshape(len(motion.q), 6)
    assert np.abs(COUNT_RAD_S * found.counts[:, 12:] - expected).max() <= 0.5 * COUNT_RAD_S * (1.0 + 1e-9)


def test_their_noise_leaves_the_accelerometers_as_they_were() -> None:
    plain, found = (next(stretches(BenchPlan(arm, 4, RATE_HZ, 0))) for arm in (ARM, TURNING))
    np.testing.assert_array_equal(found.counts[:, :12], plain.counts)
    read = COUNT_RAD_S * found.counts[:, 12:]
    assert abs(read.std(axis=0).mean() / NOISE_RAD_S - 1.0) < 0.05
    assert 0.0 < np.abs(read.mean(axis=0)).max() < 4.0 * BIAS_RAD_S


def test_its_channels_are_the_arms() -> None:
    info = device_info(TURNING, RATE_HZ, 4)
    check_channels(info, TURNING, "here")
    assert [channel.name for channel in info.channels[12:]] == ["s2gx", "s2gy", "s2gz", "s4gx", "s4gy", "s4gz"]
    assert info.channels[12].scale == COUNT_RAD_S
