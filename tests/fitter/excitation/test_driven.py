"""What a reference makes of an arm."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Control, Link
from arm.newton_euler import inverse_dynamics
from arm.simulation import simulate
from fitter.excitation.driven import Limits, driven, finely_driven, furthest, reached, rest_at, search_step_s
from fitter.excitation.shapes import Fourier
from limbcal.errors import ConfigError

ARM = load_arm("dd-arm-vertical")
MEASURED = replace(ARM, control=Control())
SHAPE = Fourier(4.0, 0.5, np.full(2, 0.8))
GENES = np.random.default_rng(0).uniform(-1, 1, SHAPE.n_gene)


def reference(rate_hz):
    return SHAPE.trial(GENES, np.arange(round(4.0 * rate_hz)) / rate_hz, np.zeros(2))


def test_the_closed_loop_or_the_reference_itself():
    ref, start = reference(200.0), rest_at(ARM, np.zeros(2))
    loop = driven(ARM, ref, 0.005, start)
    assert np.array_equal(loop.q, simulate(ARM, ref[0], 0.005, start).q)
    exact = driven(MEASURED, ref, 0.005, np.zeros(2))
    assert np.array_equal(exact.q, ref[0])
    assert np.array_equal(exact.tau, inverse_dynamics(ARM, *ref))
    assert np.array_equal(rest_at(MEASURED, np.array([0.3, 0.1])), [0.3, 0.1])


def test_rest_is_rest():
    start = rest_at(ARM, np.zeros(2))
    assert np.abs(driven(ARM, np.zeros((3, 400, 2)), 0.005, start).q - start).max() < 1e-3
    assert np.abs(start).max() > 0.1  # gravity pulls it off its target


def test_a_searching_step_is_near_the_fine_motion():
    step = search_step_s(ARM)
    assert 1e-4 < step <= 5e-3
    start = rest_at(ARM, np.zeros(2))
    coarse = driven(ARM, reference(1 / step), step, start)
    fine = finely_driven(ARM, reference(1 / step), step, start)
    assert len(coarse.t) == len(fine.t)
    assert np.abs(coarse.q - fine.q).max() < 1e-3
    stiff = replace(ARM, control=Control("pd", (1e4, 1e4), (-300.0, -300.0)))
    assert search_step_s(stiff) < step / 5


def test_limits():
    low, high = Limits(*np.array([[1.0, 2.0]] * 3)), Limits(*np.array([[1.5, 2.0]] * 3))
    assert low.excess(high) == pytest.approx(0.5)
    assert high.excess(low) <= 0.0
    assert np.array_equal(furthest([low, high]).angle, [1.5, 2.0])
    motion = driven(MEASURED, reference(200.0), 0.005, np.zeros(2))
    most = reached(motion)
    assert np.allclose(most.angle, np.abs(motion.q).max(axis=0))
    assert np.allclose(most.torque, np.abs(motion.tau).max(axis=0))


def test_an_arm_without_masses_cannot_be_simulated():
    light = replace(ARM, joints=tuple(replace(joint, link=Link()) for joint in ARM.joints))
    with pytest.raises(ConfigError, match="no mass"):
        search_step_s(light)
