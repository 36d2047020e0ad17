"""What follows from a search: its causes are named, ambiguous, outdone by what is in no catalogue, or none."""

from dataclasses import replace

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.diagnosis.conclusion import concluded
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.search import Cause
from tests.fitter.diagnosis.searched import regression_of, searched, swinging
from tests.fitter.diagnosis.test_discrepancy import PLAIN, resisted

OFFSET, ASYMMETRY, DRAG, SPRING = (
    JointHypothesis(catalogue()[name], 0)
    for name in ("torque_offset", "coulomb_asymmetry", "quadratic_drag", "joint_spring")
)


def test_a_cause_that_explains_all_is_named():
    drag = Effect("quadratic_drag", {"drag_N_m_s2": 0.3}, joints=(1,))
    found = concluded(*searched(swinging(drag), [DRAG, SPRING]))
    assert found.verdict == "named"
    assert found.final is found.search.final
    (number,) = found.numbers.effects[0].values()
    assert abs(number.value - 0.3) < 3.0 * number.std
    assert found.discrepancy.depends_on == ()


def test_one_with_an_equal_is_ambiguous():
    offset = Effect("torque_offset", {"torque_N_m": 0.3}, joints=(1,))
    found = concluded(*searched(swinging(offset), [OFFSET, ASYMMETRY, DRAG]))
    assert found.verdict == "ambiguous"
    (cause,) = found.search.causes
    named = {one.hypothesis.kind.name for one in (cause.itself, *cause.rivals)}
    assert named == {"torque_offset", "coulomb_asymmetry"}
    assert sum(cause.support) == pytest.approx(1.0)


def test_where_nothing_is_wrong_there_is_none():
    found = concluded(*searched(swinging(), [DRAG, SPRING]))
    assert found.verdict == "none"
    assert not found.search.causes and not found.held and not found.equals


@pytest.fixture(scope="module")
def coupled():
    """Return a run with a drag that depends on angle and velocity together, which stands in no catalogue."""
    return regression_of(resisted(PLAIN, lambda q, dq: 0.5 * np.sin(q) * dq), 5)


def test_much_that_no_cause_explains_is_unexplained_and_described(coupled):
    found = concluded(*searched(coupled, [DRAG, SPRING]))
    assert found.verdict == "unexplained"
    assert set(found.discrepancy.depends_on) == {"q1", "dq1"}
    assert found.final.model.hypotheses == ()


def test_a_cause_that_a_function_outdoes_is_not_believed_and_all_that_the_base_leaves_is_described(coupled):
    regression, search = searched(coupled, [])
    final = fitted(regression, Model().plus(OFFSET, np.zeros(0)))
    imitated = replace(search, final=final, causes=[Cause(0, search.base, final)])
    found = concluded(regression, imitated)
    assert found.verdict == "unexplained"
    assert found.final is search.base and found.search is imitated
    assert len(found.numbers.effects) == 1
    assert set(found.discrepancy.depends_on) == {"q1", "dq1"}
