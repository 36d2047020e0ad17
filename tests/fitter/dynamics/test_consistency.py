"""Fits that warn of what no arm can be, and fits that can be arms."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.model import Control
from arm.physical_links import is_possible
from fitter.dynamics.fit import fit_dynamics

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
