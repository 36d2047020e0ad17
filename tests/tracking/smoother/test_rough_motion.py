"""A rough motion is near whatever a sensor gets wrong."""

import numpy as np
import pytest

from arm.model import Arm
from tests.tracking.model.test_clocks import RATE_HZ, felt, read
from tracking.model.initial_state import MountingPrior
from tracking.smoother import rough_motion as module
from tracking.smoother.coarsening import every
from tracking.smoother.rough_motion import rough_motion


def test_one_sensors_fault_bends_it_little(vertical_arm: Arm) -> None:
    readings, q = felt(vertical_arm, 0.0, 5.0)
    wrong = readings.copy()
    wrong[:, 9:12] *= 1.3
    found = rough_motion(vertical_arm, read(wrong), q[0], True)
    assert found is not None and found.is_near
    assert found.stride == round(RATE_HZ / 30.0)
    off = found.states[:, :6:3] - every(q, found.stride)[: len(found.states)]
    assert np.abs(off).max() < 0.3 and np.sqrt(np.mean(off**2)) < 0.1


def test_a_sound_arm_is_likelier_than_one_with_a_fault(vertical_arm: Arm) -> None:
    readings, q = felt(vertical_arm, 0.0, 5.0)
    sound = rough_motion(vertical_arm, read(readings), q[0], True)
    readings[:, 9:12] *= 1.3
    wrong = rough_motion(vertical_arm, read(readings), q[0], True)
    assert sound is not None and wrong is not None
    assert sound.log_likelihood > wrong.log_likelihood + 100.0


def test_mountings_that_are_right_are_near_wherever_sensors_sit(vertical_arm: Arm) -> None:
    readings, q = felt(vertical_arm, 0.0, 5.0)
    found = rough_motion(vertical_arm, read(readings), q[0], True, MountingPrior())
    assert found is not None and found.is_near


def passed(monkeypatch: pytest.MonkeyPatch, costs: list[float], state: float = 0.0, left: float = 0.01) -> list:
    """Let passes have these costs, and leave so much of every reading; return the noise that each one held."""
    noise = []

    def once(of, room, course, at, x, P, found, with_variance):
        assert not with_variance
        noise.append(course.noise.copy())
        found.states[:], found.error[:] = state, left / course.noise.mean()
        return costs[len(noise) - 1]

    monkeypatch.setattr(module, "smooth_once", once)
    return noise


@pytest.mark.parametrize(("prior", "steps"), [(None, 2), (MountingPrior(), 15)])
def test_steps_that_gain_are_gone_on_with(monkeypatch, vertical_arm: Arm, prior, steps: int) -> None:
    readings, q = felt(vertical_arm, 0.0, 2.0)
    noise = passed(monkeypatch, [-100.0 * k for k in range(20)])
    found = rough_motion(vertical_arm, read(readings), q[0], True, prior)
    assert len(noise) == steps and found is not None
    assert found.log_likelihood == pytest.approx(50.0 * (steps - 1))


@pytest.mark.parametrize(("gain", "steps"), [(9.3, 3), (9.1, 2)])
def test_a_step_that_gains_less_than_a_hundred_to_one_is_the_last(
    monkeypatch, vertical_arm: Arm, gain: float, steps: int
) -> None:
    """Costs are twice a logarithm of odds: 2 ln 100 = 9.21."""
    readings, q = felt(vertical_arm, 0.0, 2.0)
    noise = passed(monkeypatch, [0.0, -gain, -gain, -gain])
    assert rough_motion(vertical_arm, read(readings), q[0], True, MountingPrior()) is not None
    assert len(noise) == steps


def test_noise_is_as_large_as_what_is_left_and_no_less_than_its_own(monkeypatch, vertical_arm: Arm) -> None:
    readings, q = felt(vertical_arm, 0.0, 2.0)
    first = passed(monkeypatch, [0.0, -50.0], left=0.7)
    rough_motion(vertical_arm, read(readings), q[0], True)
    spread = np.var(readings, axis=0).mean()
    np.testing.assert_allclose(first[0], spread, rtol=0.05)
    np.testing.assert_allclose(first[1], 0.49, rtol=1e-6)
    second = passed(monkeypatch, [0.0, -50.0], left=0.0)
    rough_motion(vertical_arm, read(readings), q[0], True)
    assert (0.0 < second[1]).all() and second[1].max() < 1e-3


@pytest.mark.parametrize(("cost", "state"), [(np.nan, 0.0), (np.inf, 0.0), (0.0, np.nan)])
def test_without_a_number_there_is_no_motion(monkeypatch, vertical_arm: Arm, cost: float, state: float) -> None:
    readings, q = felt(vertical_arm, 0.0, 2.0)
    passed(monkeypatch, [cost] * 20, state)
    assert rough_motion(vertical_arm, read(readings), q[0], True) is None


def test_a_covariance_without_sense_is_no_motion(monkeypatch, vertical_arm: Arm) -> None:
    def fail(*_: object) -> None:
        raise np.linalg.LinAlgError

    readings, q = felt(vertical_arm, 0.0, 2.0)
    monkeypatch.setattr(module, "smooth_once", fail)
    assert rough_motion(vertical_arm, read(readings), q[0], True) is None
