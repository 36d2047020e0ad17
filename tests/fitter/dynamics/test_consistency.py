"""Fits that warn of what no arm can be, and fits that can be arms."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.model import Control, Friction
from arm.physical_links import is_possible
from fitter.dynamics.fit import fit_dynamics
from tests.fitter.dynamics.test_torque_wiring import driven

ARM = load_arm("dd-arm")
BASE = base_parameters(ARM)


def columns_of(fit):
    return [
        np.array([*j.link.inertia_kg_m2, *(j.link.mass_kg * s for s in j.link.com_m), j.link.mass_kg])
        for j in fit.arm.joints
    ]


def test_the_papers_own_arm_pushes_and_it_is_said(bench_trials):
    fit = fit_dynamics(ARM, bench_trials[:4], method="least-squares")
    said = [note for note in fit.notes if "pushes instead of braking" in note.text]
    assert [note.text.split(" ")[0] for note in said] == ["D1", "fc2"]


@pytest.mark.parametrize("objective", ["torque", "motion"])
def test_the_possible_fit_brakes_and_has_masses(bench_trials, objective):
    rng = np.random.default_rng(0)
    trials = [replace(t, q=t.q + 1e-4 * rng.normal(size=t.q.shape)) for t in bench_trials[:3]]
    fit = fit_dynamics(ARM, trials, objective=objective, method="least-squares", physical=True)
    assert fit.objective == objective
    values = {name: fit.parameters[name].value for name in BASE.names}
    assert values["D1"] == pytest.approx(0.0, abs=1e-9) and values["fc2"] == pytest.approx(0.0, abs=1e-9)
    assert all(is_possible(p) for p in columns_of(fit))
    assert all(joint.friction.viscous_N_m_s >= 0.0 for joint in fit.arm.joints)
    assert values["I2"] == pytest.approx(0.471209, rel=0.05)
    assert any("D1" in note.text and note.text.startswith("moved to what masses") for note in fit.notes)


def test_an_arm_that_is_possible_already_is_left_alone(bench_trials):
    arm = replace(ARM, control=Control())
    free, bound = (
        fit_dynamics(
            arm,
            [replace(t, tau=t.tau + 0.5 * t.dq + 0.3 * np.sign(t.dq)) for t in bench_trials[:2]],
            method="least-squares",
            physical=physical,
        )
        for physical in (False, True)
    )
    assert not any("moved to" in note.text for note in bound.notes)
    assert [free.parameters[n].value for n in BASE.names] == [bound.parameters[n].value for n in BASE.names]


def test_what_the_error_explains_is_not_called_impossible():
    """A joint without friction comes out below zero as often as above."""
    arm = replace(
        load_arm("dd-arm-vertical"),
        control=Control(),
        joints=tuple(replace(joint, friction=Friction()) for joint in ARM.joints),
    )
    seen = 0
    for seed in range(6):
        trial = driven(arm, seed)
        free, bound = (
            fit_dynamics(
                arm, [trial], method="least-squares", objective="torque", physical=physical, examine=False
            )
            for physical in (False, True)
        )
        frictions = [free.parameters[name] for name in ("D1", "D2", "fc1", "fc2")]
        below = [p for p in frictions if p.value < 0.0]
        within = [p for p in below if -p.value < 2.0 * p.std]
        seen += len(within)
        impossible = [note for note in free.notes if note.kind == "impossible" and "pushes" in note.text]
        assert len(impossible) == len(below) - len(within)
        if within:
            (moved,) = [note for note in bound.notes if note.kind == "moved"]
            assert "within their errors" in moved.text
    assert seen
