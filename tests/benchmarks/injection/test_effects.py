"""What an injected effect adds to the torque, on a motion made here."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.effects.catalogue import catalogue
from arm.model import Effect, Friction
from benchmarks.injection import effects
from benchmarks.injection.effects import AT_JOINT, MORE, PAIRS, added_torque, drawn, sized
from benchmarks.injection.runs import ARM, Run, motion_of, rms


def run_of(number: int, learning: bool) -> Run:
    rng = np.random.default_rng(number)
    t = np.cumsum(rng.uniform(0.002, 0.0025, 1500)) + 10.0 * number
    q = np.stack([np.sin(2.0 * t) + 0.5 * np.sin(5.1 * t), 0.8 * np.cos(3.3 * t)], axis=1)
    tau = np.stack([0.8 * np.sin(3.0 * t), 0.4 * np.cos(2.0 * t)], axis=1)
    return Run(f"run{number}", number, learning, t, q, tau, motion_of(t, q))


RUNS = (run_of(1, True), run_of(2, True), run_of(3, False))
RUBBING = replace(
    load_arm(ARM), joints=tuple(replace(joint, friction=Friction(0.02, 0.2)) for joint in load_arm(ARM).joints)
)


def test_every_effect_of_a_machines_joint_but_plain_friction_is_injected() -> None:
    of_joint = {name for name, kind in catalogue().items() if kind.torque is not None and not kind.is_living}
    assert of_joint - set(AT_JOINT) == {"viscous", "coulomb"}
    assert len(PAIRS) == 22


@pytest.mark.parametrize(("name", "joint"), [*PAIRS, *MORE])
def test_it_has_the_share_that_was_asked_for(name: str, joint: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(effects, "read_set", lambda _name: RUNS)
    effect = sized(drawn("some", name, joint, 7), 0.2, RUBBING, RUNS)
    i = max(joint, 1) - 1
    added = rms([added_torque(RUBBING, effect, run)[:, i] for run in RUNS if run.learning])
    assert added == pytest.approx(0.2 * rms([run.tau[:, i] for run in RUNS if run.learning]), rel=1e-6)


def test_load_friction_resists_by_the_load_that_has_it_in_it() -> None:
    run, effect = RUNS[0], Effect("load_friction", {"coefficient": 0.3}, (2,))
    more = added_torque(RUBBING, effect, run)
    expected = 0.3 * np.abs(run.tau + more)[:, 1] * run.motion[3][:, 1]
    np.testing.assert_allclose(more[:, 1], expected, atol=1e-8)
    assert not more[:, 0].any()


def test_of_a_wrong_gain_the_joint_gets_what_moved_it() -> None:
    run, effect = RUNS[0], Effect("gain_error", {"factor": 0.8}, (1,))
    asked = run.tau + added_torque(RUBBING, effect, run)
    np.testing.assert_allclose(0.8 * asked[:, 0], run.tau[:, 0], atol=1e-8)


def test_a_rotor_adds_what_accelerates_it() -> None:
    run, effect = RUNS[0], Effect("rotor_inertia", {"inertia_kg_m2": 0.01}, (2,))
    np.testing.assert_allclose(added_torque(RUBBING, effect, run)[:, 1], 0.01 * run.motion[2][:, 1])


def test_at_rest_the_last_direction_of_motion_goes_on() -> None:
    t = np.arange(2000) / 500.0
    q = np.stack([np.clip(t - 1.0, 0.0, 1.0), np.clip(1.0 - t, -1.0, 0.0)], axis=1)
    direction = motion_of(t, q)[3]
    np.testing.assert_array_equal(direction, np.tile([1.0, -1.0], (len(t), 1)))
