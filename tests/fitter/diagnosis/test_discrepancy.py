"""What is in no catalogue: its variables are found, and causes that only imitate it are distinguished from it."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.data.motions import Measured
from fitter.diagnosis.diagnosis import diagnose
from fitter.diagnosis.discrepancy import describe, surpassed
from fitter.diagnosis.evidence import Floor
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.refinement import fitted
from tests.fitter.diagnosis.searched import regression_of, searched
from tests.fitter.pendulum import pendulum, swings


def resisted(motions: list[Measured], torque: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> list[Measured]:
    """Return motions for which the drive had to supply a torque more: its target led by so much."""
    kp = pendulum().control.kp[0]
    found = []
    for motion in motions:
        q, t = motion.columns["q"], motion.t
        ref = motion.columns["ref"] + torque(q, np.gradient(q, t, axis=0)) / kp
        found.append(replace(motion, columns={"q": q, "ref": ref}))
    return found


PLAIN = swings((), trials=12, seed=4)
#: Much more than noise is left, and no more.
MORE, NOTHING = (Floor(np.full(1, ratio), np.zeros(1), np.ones(1)) for ratio in (9.0, 1.0))


@pytest.mark.parametrize(
    ("torque", "variables", "formula"),
    [
        (lambda q, dq: 0.5 * np.tanh(q / 0.1), {"q1"}, ""),
        (lambda q, dq: 0.8 * q**3, {"q1"}, "q1^3"),
        (lambda q, dq: 0.5 * np.sin(q) * dq, {"q1", "dq1"}, "sin(q1) dq1"),
    ],
)
def test_its_variables_are_found(torque, variables, formula):
    regression = regression_of(resisted(PLAIN, torque), 5)
    discrepancy = describe(regression, fitted(regression, Model()), MORE)
    assert set(discrepancy.depends_on) == variables
    assert discrepancy.joint == 1
    assert discrepancy.formula.endswith(formula)


def test_a_diagnosis_leaves_it_unexplained_and_says_what_it_depends_on():
    motions = resisted(PLAIN, lambda q, dq: 0.5 * np.sin(q) * dq)
    finding = diagnose(pendulum(), motions[:6], motions[6:]).finding
    assert finding.verdict == "unexplained" and not finding.causes
    assert set(finding.document()["residual"]["depends_on"]) == {"q1", "dq1"}


def test_nothing_depends_on_nothing():
    regression = regression_of(PLAIN, 5)
    discrepancy = describe(regression, fitted(regression, Model()), MORE)
    assert (discrepancy.depends_on, discrepancy.joint, discrepancy.formula) == ((), 0, "")


def test_noise_is_no_function_of_anything():
    regression = regression_of(resisted(PLAIN, lambda q, dq: 0.8 * q**3), 5)
    assert describe(regression, fitted(regression, Model()), NOTHING).depends_on == ()


def test_a_soft_wall_outdoes_what_imitates_it():
    plain = regression_of(resisted(PLAIN, lambda q, dq: 0.8 * np.tanh(q / 0.15)), 5)
    regression, search = searched(plain, [JointHypothesis(catalogue()["cogging"], 0)])
    assert "cogging" in {one.kind.name for one in search.final.model.hypotheses}
    assert surpassed(regression, search.final)


@pytest.mark.parametrize(
    ("name", "numbers"),
    [
        ("cogging", {"amplitude_N_m": 0.5, "phase_rad": 0.3, "periods_per_turn": 7.0}),
        ("joint_spring", {"stiffness_N_m_rad": 1.0, "rest_angle_rad": 0.2}),
    ],
)
def test_a_true_cause_is_outdone_by_no_function(name, numbers):
    plain = regression_of(swings((Effect(name, numbers, joints=(1,)),), trials=12, seed=4), 5)
    regression, search = searched(plain, [JointHypothesis(catalogue()[name], 0)])
    assert [one.kind.name for one in search.final.model.hypotheses] == [name]
    assert not surpassed(regression, search.final)


def test_a_true_cause_of_which_calm_motions_know_little_is_outdone_by_no_function():
    drag = Effect("quadratic_drag", {"drag_N_m_s2": 0.6}, joints=(1,))
    motions = sorted(swings((drag,), trials=16), key=lambda one: float(np.ptp(one.columns["q"])))
    regression = regression_of(motions, 2)
    cause = JointHypothesis(catalogue()["quadratic_drag"], 0)
    final = fitted(regression, Model((cause,), (np.zeros(0),)))
    assert np.mean((final.squares / regression.n_effective)[2:]) > 2.0
    assert not surpassed(regression, final)
