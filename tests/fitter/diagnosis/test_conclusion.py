"""A finding says what was searched and what was left, in numbers that follow from the rows."""

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.diagnosis.conclusion import concluded, finding_of
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.run import run_of
from tests.fitter.diagnosis.searched import searched, swinging
from tests.fitter.pendulum import pendulum

DRAG, SPRING = (JointHypothesis(catalogue()[name], 0) for name in ("quadratic_drag", "joint_spring"))


@pytest.fixture(scope="module")
def concluded_run():
    regression, search = searched(
        swinging(Effect("quadratic_drag", {"drag_N_m_s2": 0.3}, joints=(1,))), [DRAG, SPRING]
    )
    come_to = concluded(regression, search)
    trials = [one.trial for one in regression.motions]
    motions = run_of(pendulum(), trials[:4], trials[4:], thin=False)
    return regression, come_to, finding_of(regression, come_to, motions)


def test_the_cause_has_its_numbers_and_what_it_took_away(concluded_run):
    regression, come_to, finding = concluded_run
    (cause,) = finding.causes
    assert (cause.effect, cause.joints, finding.verdict) == ("quadratic_drag", (1,), "named")
    assert cause.parameters == come_to.numbers.effects[0]
    judging = np.array([not one.learn for one in regression.motions])
    was, left = (
        one.squares[judging].sum() for one in (come_to.search.causes[0].before, come_to.search.causes[0].itself)
    )
    assert cause.takes_away["evaluate"] == pytest.approx(1.0 - left / was)
    assert finding.complete and finding.suspected == []


def test_all_that_was_tried_is_ranked_by_its_gain(concluded_run):
    regression, come_to, finding = concluded_run
    assert finding.candidates[0].effect == "quadratic_drag"
    judging = np.array([not one.learn for one in regression.motions])
    was, left = (one.squares[judging].sum() for one in (come_to.search.screening_base, come_to.search.first[0]))
    assert finding.candidates[0].gain == pytest.approx(1.0 - left / was)
    assert sum(one.support for one in finding.candidates) == pytest.approx(1.0)


def test_what_is_explained_of_the_torque_is_one_less_the_ratio_of_powers(concluded_run):
    regression, come_to, finding = concluded_run
    motions = [one for one in regression.motions if not one.learn]
    left = [
        regression.equations.residual_torque(come_to.final.model, come_to.final.x, one)[~one.stuck]
        for one in motions
    ]
    power = [one.u[~one.stuck] for one in motions]
    expected = 1.0 - np.mean(np.concatenate(left) ** 2) / np.mean(np.concatenate(power) ** 2)
    assert finding.torque_explained["evaluate"] == [pytest.approx(expected, abs=1e-3)]


def test_its_errors_fell_and_its_arm_has_the_effect(concluded_run):
    finding = concluded_run[2]
    assert finding.after.torque_rms[0] < 0.7 * finding.before.torque_rms[0]
    assert finding.residual_size.share == pytest.approx(
        float(finding.after.torque_rms[0] / finding.before.torque_rms[0])
    )
    assert finding.base_arm.effects == () and [one.name for one in finding.arm.effects] == ["quadratic_drag"]
