"""Factors and psi of a model as numbers of the arm that has its effects."""

import math
from dataclasses import replace

import numpy as np
import pytest

from arm.base_parameters import with_base_values
from arm.drive_state import DriveState
from arm.effects.catalogue import catalogue
from arm.model import Arm, Control, Effect
from arm.simulation import simulate
from arm.structural_parameters import structural_parameters
from fitter.diagnosis.estimates import estimates
from fitter.diagnosis.extended_arm import extended_arm, model_numbers
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.model import Candidate, Model
from fitter.dynamics.shooting_effects import ShootingWithEffects, numbers_of, windows
from fitter.dynamics.shooting_windows import ShootingWindow
from tests.fitter.diagnosis.searched import swinging


class TorqueTransfer(JointHypothesis):
    """Something that is there in some trials only."""

    is_intermittent = True


PASSING = TorqueTransfer(catalogue()["torque_offset"], 0)
DRAG = JointHypothesis(catalogue()["quadratic_drag"], 0)


@pytest.fixture(scope="module")
def found():
    regression = swinging(trials=2)
    model = Model().plus(PASSING, np.zeros(0)).plus(DRAG, np.zeros(0))
    n_base = len(regression.solve(Model(), regression.motions))
    x = np.concatenate([regression.solve(Model(), regression.motions), [0.5, 0.3]])
    candidate = Candidate(model, x, np.zeros(2))
    numbers = estimates(regression, candidate)
    arm = extended_arm(regression, candidate, numbers)
    kept = regression.equations.independent(regression.hypothetical(model, regression.motions[0]).arm)
    return model_numbers(arm, numbers, candidate, kept.tolist(), 0), n_base


def test_the_start_is_what_the_arm_has(found):
    numbers, _ = found
    assert [effect.name for effect in numbers.numbers.arm.effects] == ["torque_offset", "quadratic_drag"]
    np.testing.assert_allclose(numbers.values(numbers.start), numbers.numbers.values)
    np.testing.assert_allclose(numbers.start[-2:], [0.5, 0.3])


def test_what_is_moved_is_moved_in_the_arm_and_what_comes_and_goes_stays(found):
    numbers, n_base = found
    np.testing.assert_array_equal(numbers.lasting, [*[True] * n_base, False, True])
    flat = numbers.start
    flat[0] += 0.1
    flat[-2:] = 9.0, 0.7
    moved = numbers.values(flat) - numbers.numbers.values
    assert moved[numbers.base[0]] == pytest.approx(0.1)
    assert np.count_nonzero(np.abs(moved) > 1e-12) == 2 and moved[-1] == pytest.approx(0.4)
    assert numbers.at(flat).x[-1] == 0.7 and numbers.at(flat).model is not numbers.candidate.model


def test_numbers_stay_within_the_catalogue(found):
    numbers, _ = found
    flat = numbers.start
    assert np.all(numbers.admitted(flat) >= 0.0)
    flat[-1] = -0.1
    assert np.min(numbers.admitted(flat)) == pytest.approx(-0.1)


def test_base_parameters_come_first_and_lists_and_infinities_are_no_numbers(true_arm):
    payload = Effect("payload", {"mass_kg": 0.1, "trials": [2]})
    limit = Effect("torque_saturation", {"limit_N_m": math.inf}, joints=(1,))
    base = structural_parameters(true_arm)
    numbers = numbers_of(replace(true_arm, effects=(*true_arm.effects, payload, limit)), base)
    assert numbers.places == ((0, "inertia_kg_m2"), (1, "mass_kg"))
    assert numbers.place(1, "mass_kg") == len(base.names) + 1
    assert numbers.place(2, "limit_N_m") is None
    low, high = numbers.bounds
    assert low[-2] == 0.0 and math.isinf(high[0])
    np.testing.assert_allclose(numbers.values[-2:], [0.004, 0.1])


def test_an_arm_with_other_effects_numbers_keeps_its_links(true_arm):
    numbers = numbers_of(true_arm, structural_parameters(true_arm))
    arm = numbers.with_effects(1.5 * numbers.values)
    assert arm.effects[0].parameters["inertia_kg_m2"] == 1.5 * 0.004
    assert arm.joints == true_arm.joints


EFFECTS = (
    Effect("air_drag", {"drag_N_m_s2": 0.01}, joints=(2,)),
    Effect("periodic_disturbance", {"amplitude_N_m": 0.1, "frequency_hz": 2.0, "phase_rad": 0.3}, joints=(1,)),
    Effect("actuator_lag", {"time_constant_s": 0.02}, joints=(1,)),
    Effect("backlash", {"gap_rad": 0.01}, joints=(2,)),
    Effect("payload", {"mass_kg": 0.2, "trials": [5]}),
)


def shot(arm: Arm, window: ShootingWindow, first: int = 1):
    numbers = numbers_of(arm, structural_parameters(arm))
    shooting = ShootingWithEffects(numbers, 1, first)
    return shooting.angles(shooting.machine(numbers.values), window, window.start)


@pytest.mark.parametrize("law", ["measured", "pd"])
def test_a_shot_is_what_simulate_says(true_arm, law):
    control = Control("pd", (3.0, 2.0), (-0.3, -0.2)) if law == "pd" else Control()
    arm = replace(true_arm, effects=(*true_arm.effects, *EFFECTS), control=control)
    drive = 0.3 * np.sin(np.linspace(0.0, 6.0, 400))[:, None] * np.ones(2)
    window = ShootingWindow(0, 2e-3, drive, np.zeros_like(drive), np.array([0.2, -0.1, 0.5, 0.0]), None, 3.1)
    given = drive if law == "measured" else None
    said = simulate(arm, drive, 2e-3, window.start[:2], window.start[2:], torque=given, t0_s=3.1, trial=5)
    assert np.abs(shot(arm, window, first=5) - said.q).max() < 1e-9
    assert np.abs(shot(arm, window, first=1) - said.q).max() > 1e-3  # without the load of trial 5


def test_a_trial_says_its_own_gains_and_where_its_drives_are_let_go(true_arm):
    arm = replace(true_arm, control=Control("p"))
    drive = np.full((300, 2), 0.4)
    on = np.ones((300, 2), dtype=bool)
    on[150:] = False
    state = DriveState(on, np.full((300, 2), 5.0))
    window = ShootingWindow(0, 2e-3, drive, np.zeros_like(drive), np.zeros(4), state)
    numbers = numbers_of(arm, structural_parameters(arm))
    shooting = ShootingWithEffects(numbers, 1)
    machine = shooting.machine(numbers.values)
    said = simulate(arm, drive, 2e-3, np.zeros(2), drives=state).q
    for _ in range(2):  # the machine is as it was after a shot
        assert np.abs(shooting.angles(machine, window, window.start) - said).max() < 1e-9


def test_base_parameters_and_what_effects_change_add_up(true_arm):
    drag = Effect("air_drag", {"drag_N_m_s2": 0.01}, joints=(2,))
    tilt = Effect("gravity_tilt", {"gx_m_s2": -1.0, "gy_m_s2": 0.5})
    arm = replace(true_arm, effects=(drag, tilt))
    numbers = numbers_of(arm, structural_parameters(arm))
    values = numbers.values * 1.2
    drive = np.zeros((300, 2))
    window = ShootingWindow(0, 2e-3, drive, drive, np.array([0.7, 0.3, 0.0, 0.0]))
    shooting = ShootingWithEffects(numbers, 1)
    moved = with_base_values(numbers.with_effects(values), numbers.base, values[: len(numbers.base.names)])
    said = simulate(moved, drive, 2e-3, window.start[:2], torque=drive)
    assert np.abs(shooting.angles(shooting.machine(values), window, window.start) - said.q).max() < 1e-9


def test_windows_are_as_long_as_asked_and_whole_under_a_law(true_arm, trials):
    assert len(windows(true_arm, trials, 2e-3, 0.5)) == 12
    ruled = replace(true_arm, control=Control("pd", (3.0, 2.0), (-0.3, -0.2)))
    aimed = [replace(t, ref=t.q, whole=t.whole | {"ref": t.whole["q"]} if t.whole else {}) for t in trials]
    assert len(windows(ruled, aimed, 2e-3, 0.5)) == 2
