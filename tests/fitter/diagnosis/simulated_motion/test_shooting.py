"""Simulations of an arm with its effects through windows."""

from dataclasses import replace

import numpy as np
import pytest

from arm.base_parameters import with_base_values
from arm.drive_state import DriveState
from arm.model import Arm, Control, Effect
from arm.simulation import simulate
from fitter.diagnosis.simulated_motion.numbers import numbers_of
from fitter.diagnosis.simulated_motion.shooting import ShootingWithEffects, windows
from fitter.dynamics.stretches import Stretch
from fitter.dynamics.structure import structural_parameters

EFFECTS = (
    Effect("air_drag", {"drag_N_m_s2": 0.01}, joints=(2,)),
    Effect("periodic_disturbance", {"amplitude_N_m": 0.1, "frequency_hz": 2.0, "phase_rad": 0.3}, joints=(1,)),
    Effect("actuator_lag", {"time_constant_s": 0.02}, joints=(1,)),
    Effect("backlash", {"gap_rad": 0.01}, joints=(2,)),
    Effect("payload", {"mass_kg": 0.2, "trials": [5]}),
)


def shot(arm: Arm, stretch: Stretch, first: int = 1):
    numbers = numbers_of(arm, structural_parameters(arm))
    shooting = ShootingWithEffects(numbers, 1, first)
    return shooting.angles(shooting.machine(numbers.values), stretch, stretch.start)


@pytest.mark.parametrize("law", ["measured", "pd"])
def test_a_shot_is_what_simulate_says(true_arm, law):
    control = Control("pd", (3.0, 2.0), (-0.3, -0.2)) if law == "pd" else Control()
    arm = replace(true_arm, effects=(*true_arm.effects, *EFFECTS), control=control)
    drive = 0.3 * np.sin(np.linspace(0.0, 6.0, 400))[:, None] * np.ones(2)
    stretch = Stretch(0, 2e-3, drive, np.zeros_like(drive), np.array([0.2, -0.1, 0.5, 0.0]), None, 3.1)
    given = drive if law == "measured" else None
    said = simulate(arm, drive, 2e-3, stretch.start[:2], stretch.start[2:], torque=given, t0_s=3.1, trial=5)
    assert np.abs(shot(arm, stretch, first=5) - said.q).max() < 1e-9
    assert np.abs(shot(arm, stretch, first=1) - said.q).max() > 1e-3  # without the load of trial 5


def test_a_trial_says_its_own_gains_and_where_its_drives_are_let_go(true_arm):
    arm = replace(true_arm, control=Control("p"))
    drive = np.full((300, 2), 0.4)
    on = np.ones((300, 2), dtype=bool)
    on[150:] = False
    state = DriveState(on, np.full((300, 2), 5.0))
    stretch = Stretch(0, 2e-3, drive, np.zeros_like(drive), np.zeros(4), state)
    numbers = numbers_of(arm, structural_parameters(arm))
    shooting = ShootingWithEffects(numbers, 1)
    machine = shooting.machine(numbers.values)
    said = simulate(arm, drive, 2e-3, np.zeros(2), drives=state).q
    for _ in range(2):  # the machine is as it was after a shot
        assert np.abs(shooting.angles(machine, stretch, stretch.start) - said).max() < 1e-9


def test_base_parameters_and_what_effects_change_add_up(true_arm):
    drag = Effect("air_drag", {"drag_N_m_s2": 0.01}, joints=(2,))
    tilt = Effect("gravity_tilt", {"gx_m_s2": -1.0, "gy_m_s2": 0.5})
    arm = replace(true_arm, effects=(drag, tilt))
    numbers = numbers_of(arm, structural_parameters(arm))
    values = numbers.values * 1.2
    drive = np.zeros((300, 2))
    stretch = Stretch(0, 2e-3, drive, drive, np.array([0.7, 0.3, 0.0, 0.0]))
    shooting = ShootingWithEffects(numbers, 1)
    moved = with_base_values(numbers.with_effects(values), numbers.base, values[: len(numbers.base.names)])
    said = simulate(moved, drive, 2e-3, stretch.start[:2], torque=drive)
    assert np.abs(shooting.angles(shooting.machine(values), stretch, stretch.start) - said.q).max() < 1e-9


def test_windows_are_as_long_as_asked_and_whole_under_a_law(true_arm, trials):
    assert len(windows(true_arm, trials, 2e-3, 0.5)) == 12
    ruled = replace(true_arm, control=Control("pd", (3.0, 2.0), (-0.3, -0.2)))
    aimed = [replace(t, ref=t.q, whole=t.whole | {"ref": t.whole["q"]} if t.whole else {}) for t in trials]
    assert len(windows(ruled, aimed, 2e-3, 0.5)) == 2
