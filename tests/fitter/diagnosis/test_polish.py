"""A model's numbers moved by its simulated motion."""

from dataclasses import replace

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.diagnosis.arm_hypotheses import RotorInertia
from fitter.diagnosis.basis_functions import Discrepancy
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.estimates import estimates, information_of
from fitter.diagnosis.evidence import Floor
from fitter.diagnosis.finding import Conclusion
from fitter.diagnosis.held_out_error import Errors
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.model import Candidate, Model
from fitter.diagnosis.polish import comes_nearer, is_measured, loses, polished
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.run import run_of
from fitter.diagnosis.search import Search
from tests.fitter.diagnosis.searched import swinging

DRAG = JointHypothesis(catalogue()["quadratic_drag"], 0)
ROTOR = RotorInertia(catalogue()["rotor_inertia"], (1,))


def whole(regression):
    """Return all trials, not thinned."""
    learn, others = ([one.trial for one in regression.motions if one.learn is learn] for learn in (True, False))
    return run_of(regression.arm, learn, others, thin=False)


def come_to(regression, final, scatter=1.0, ratio=9.0) -> Conclusion:
    """Return a conclusion whose final model leaves something, and whose numbers are known so well."""
    one = np.ones(regression.arm.n_joint)
    floor, base = Floor(ratio * one, one, one), fitted(regression, Model())
    search = Search(base, final, [], base, [], [], floor, floor)
    numbers = estimates(regression, final)
    numbers = replace(numbers, covariance=scatter**2 * numbers.covariance)
    return Conclusion(search, "named", final, numbers, Discrepancy(0.0, 0.0, True, (), 0, "", [], (0.0,)), [], {})


@pytest.fixture(scope="module")
def dragged():
    """Return a run with a drag, and a model of it whose drag is off."""
    regression = swinging(Effect("quadratic_drag", {"drag_N_m_s2": 0.3}, joints=(1,)), trials=4)
    right = fitted(regression, Model().plus(DRAG, np.zeros(0)))
    return regression, right, replace(right, x=right.x + np.r_[np.zeros(len(right.x) - 1), 0.2])


def test_numbers_that_are_off_come_back_and_are_kept_under_a_law(dragged):
    regression, right, wrong = dragged
    found = polished(regression, come_to(regression, wrong, scatter=20.0), whole(regression), 0.5)
    assert found is not None and found.said.kept
    drag = found.numbers.effects[0]["drag_N_m_s2"]
    assert abs(drag.value - 0.3) < 4.0 * drag.std + 0.01
    assert found.candidate.x[-1] == drag.value != wrong.x[-1]
    assert found.said.after.angle_deg["rms"] < 0.5 * found.said.before.angle_deg["rms"]
    assert set(found.said.document()) == {"before", "after"} and "are kept" in found.said.sentence


def test_numbers_stand_where_a_causes_size_would_vanish():
    """Motion without any drag comes nearer without the drag, but then no drag is named."""
    regression = swinging(trials=4)
    right = fitted(regression, Model().plus(DRAG, np.zeros(0)))
    wrong = replace(right, x=right.x + np.r_[np.zeros(len(right.x) - 1), 0.2])
    found = polished(regression, come_to(regression, wrong, scatter=20.0), whole(regression), 0.5)
    assert found is not None and not found.said.kept
    assert found.said.after.angle_deg["rms"] < 0.5 * found.said.before.angle_deg["rms"]
    assert "no longer differ from none, so the numbers of the torque's equations stand" in found.said.sentence


def test_nothing_is_moved_where_noise_is_all_that_is_left_or_no_cause_is_there(dragged):
    regression, right, _ = dragged
    exact = come_to(regression, right, ratio=1.0)
    assert polished(regression, exact, whole(regression), 0.5) is None
    bare = come_to(regression, right)
    assert polished(regression, replace(bare, final=bare.search.base), whole(regression), 0.5) is None


def test_with_measured_torque_both_are_evidence(true_arm, trials):
    bare = replace(true_arm, effects=())
    regression = regression_of(bare, run_of(bare, trials[:1], trials[1:]))
    assert is_measured(regression.motions) and not is_measured(swinging(trials=2).motions)
    right = fitted(regression, Model().plus(ROTOR, np.zeros(0)))
    off = right.x + 3.0 / np.sqrt(np.diag(information_of(regression, right)))
    wrong = Candidate(right.model, off, right.squares)
    found = polished(regression, come_to(regression, wrong), whole(regression), 0.5)
    assert found is not None and found.said.kept
    assert found.said.after.unfiltered_rms is not None
    assert found.said.after.angle_deg["mean"] < found.said.before.angle_deg["mean"]
    rotor = found.numbers.effects[0]["inertia_kg_m2"]
    torque = estimates(regression, wrong).effects[0]["inertia_kg_m2"]
    assert 0.0 < rotor.std < 1.5 * torque.std


def test_torque_that_grows_beyond_the_scatter_of_blocks_is_a_loss(dragged):
    regression, right, wrong = dragged
    motions = [one for one in whole(regression) if not one.learn]
    assert loses(regression, right, replace(wrong, x=1.5 * wrong.x), motions)
    assert not loses(regression, right, right, motions)
    assert not loses(regression, wrong, right, motions)


def off_by(*means):
    """Return errors of simulated motion with these means, the first joint turning and the others sliding."""
    one, turns = np.array([means]), np.arange(len(means)) == 0
    return Errors(one, one, np.zeros(1, dtype=np.intp), None, one**2, one, one, np.ones_like(one), turns, [])


def test_joints_count_in_units_of_their_errors_before():
    """A millimetre of a slide counts as much as what an angle is off by, though it is the smaller number."""
    assert comes_nearer(off_by(0.1, 1e-3), off_by(0.11, 0.5e-3))
    assert not comes_nearer(off_by(0.1, 1e-3), off_by(0.09, 1.5e-3))
    assert not comes_nearer(off_by(0.1), off_by(0.1))


def test_what_runs_away_comes_no_nearer():
    assert not comes_nearer(off_by(0.1, 0.1), off_by(0.01, np.inf))
    assert comes_nearer(off_by(0.1, np.inf), off_by(0.1, 0.1))
