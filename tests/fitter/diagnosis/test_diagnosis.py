"""From trials to a verdict, on a pendulum small enough to be diagnosed in a second."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Body, Effect
from fitter.diagnosis.diagnosis import _UNSEEN, diagnose
from fitter.diagnosis.hypotheses import hypotheses
from limbcal.errors import DataError
from tests.fitter.pendulum import pendulum, stop_that_no_learning_trial_reaches, swings

DRAG = Effect("quadratic_drag", {"drag_N_m_s2": 0.6}, joints=(1,))


@pytest.fixture(scope="module")
def dragged():
    motions = swings((DRAG,), trials=4)
    return diagnose(pendulum(), motions[:2], motions[2:])


def test_the_cause_is_named_with_its_size(dragged):
    finding = dragged.finding
    assert finding.verdict == "named"
    (cause,) = finding.causes
    assert (cause.effect, cause.joints) == ("quadratic_drag", (1,))
    found = cause.parameters["drag_N_m_s2"]
    assert abs(found.value - 0.6) < 3.0 * found.std < 0.3


def test_the_extended_arm_moves_like_the_real_one(dragged):
    finding = dragged.finding
    assert [effect.name for effect in finding.arm.effects] == ["quadratic_drag"]
    assert finding.after.angle_deg["mean"] < 0.5 * finding.before.angle_deg["mean"]
    assert finding.gain.ci95[0] < finding.gain.torque < finding.gain.ci95[1]


def test_the_extended_arm_lacks_nothing(dragged):
    motions = swings((DRAG,), trials=4)
    again = diagnose(dragged.finding.arm, motions[:2], motions[2:]).finding
    assert again.verdict == "none"
    assert again.arm.effects == dragged.finding.arm.effects
    before, after = again.before.angle_deg, dragged.finding.after.angle_deg
    assert before is not None and after is not None
    assert before["mean"] == pytest.approx(after["mean"], rel=0.05)


def test_a_delay_found_replaces_the_one_in_the_file():
    delays = [Effect("actuator_delay", {"delay_s": size}, joints=(1,)) for size in (0.03, 0.012)]
    motions = swings((delays[0],), trials=4)
    finding = diagnose(replace(pendulum(), effects=(delays[1],)), motions[:2], motions[2:]).finding
    (late,) = finding.arm.effects
    assert late.name == "actuator_delay" and late.parameters["delay_s"] == pytest.approx(0.03, rel=0.03)
    before, after = finding.before.angle_deg, finding.after.angle_deg
    assert before is not None and after is not None and after["mean"] < 0.5 * before["mean"]


def test_rivals_are_ranked_behind_the_cause(dragged):
    candidates = dragged.finding.candidates
    assert candidates[0].effect == "quadratic_drag"
    assert all(0.0 <= one.gain <= 1.0 and 0.0 <= one.support <= 1.0 for one in candidates)
    assert [one.gain for one in candidates] == sorted((one.gain for one in candidates), reverse=True)


def test_every_effect_that_was_tried_is_a_candidate(dragged):
    named = {(one.effect, one.joints) for one in dragged.finding.candidates}
    tried = {(one.kind.name, tuple(j + 1 for j in one.joints)) for one in hypotheses(1)}
    assert tried - named == set()


def test_the_document_has_the_contracts_fields(dragged):
    document = dragged.finding.document()
    assert {
        "verdict",
        "causes",
        "candidates",
        "confusable",
        "next_experiment",
        "before",
        "after",
        "gain",
        "residual",
    } <= set(document)
    assert {"torque_rms_N_m", "share", "times_noise"} == set(document["left"])
    assert document["complete"] is True and document["left"]["share"] < 0.5
    (cause,) = document["causes"]
    assert all(0.0 < cause["takes_away"][role] <= 1.0 for role in ("learn", "evaluate"))
    assert {"explained", "white", "depends_on"} <= set(document["residual"])
    assert {"torque", "angle", "position", "ci95"} == set(document["gain"])


def test_nothing_is_named_where_nothing_is_wrong():
    motions = swings((), trials=8, seed=3)
    finding = diagnose(pendulum(), motions[:4], motions[4:]).finding
    assert finding.verdict == "none"
    assert not finding.causes and not finding.warnings
    assert finding.before is finding.after


def test_what_only_the_judging_trials_show_is_learnt_from_them_and_said():
    motions = stop_that_no_learning_trial_reaches()
    finding = diagnose(pendulum(), motions[:3], motions[3:]).finding
    assert [cause.effect for cause in finding.causes] == ["end_stop"]
    assert _UNSEEN in [note.text for note in finding.warnings]


def test_beside_another_cause_one_is_found_that_only_the_judging_trials_show():
    motions = stop_that_no_learning_trial_reaches(DRAG, learning=2)
    finding = diagnose(pendulum(), motions[:2], motions[2:]).finding
    assert {cause.effect for cause in finding.causes} == {"quadratic_drag", "end_stop"}
    assert _UNSEEN in [note.text for note in finding.warnings]


def test_tissue_at_the_end_of_a_persons_range_is_named():
    numbers = {"angle_rad": 0.9, "moment_N_m": 2.0, "rate_1_rad": 6.0, "damping_s": 0.05, "side": 1.0}
    motions = swings((Effect("passive_tissue", numbers, joints=(1,)),), trials=4)
    person = replace(pendulum(), body=Body("human-leg-right", 70.0, 1.75, "f"))
    finding = diagnose(person, motions[:2], motions[2:]).finding
    (cause,) = finding.causes
    assert (finding.verdict, cause.effect) == ("named", "passive_tissue")
    found = {name: cause.parameters[name] for name in ("moment_N_m", "rate_1_rad", "damping_s")}
    at = cause.parameters["angle_rad"].value  # the end that was reached
    truth = {**numbers, "moment_N_m": 2.0 * np.exp(6.0 * (at - 0.9))}
    # Noise of 3e-4 rad in the angle at which the moment is stated is 0.2 % of it.
    assert all(abs(one.value - truth[name]) < 3.5 * one.std + 2e-3 * truth[name] for name, one in found.items())
    assert found["rate_1_rad"].std < 0.1


def test_noise_in_the_regressors_does_not_pass_for_physics():
    rng = np.random.default_rng(8)
    motions = swings((), trials=8, seed=5)
    for motion in motions:
        motion.columns["q"][:] += 1e-3 * rng.normal(size=motion.columns["q"].shape)  # three times the noise
    assert diagnose(pendulum(), motions[:4], motions[4:]).finding.verdict == "none"


def test_a_torque_that_is_mostly_noise_is_said_to_be():
    rng, motions = np.random.default_rng(1), swings((), trials=6, seed=3)
    for motion in motions:
        torque = 20.0 * (motion.columns["ref"] - motion.columns["q"])
        chatter = 5.0 * np.std(torque) * rng.choice([-1.0, 1.0], torque.shape)  # a drive that overdoes it
        motion.columns["tau"] = torque + chatter
    finding = diagnose(pendulum(), motions[:3], motions[3:]).finding
    (warning,) = finding.warnings
    assert warning.text.startswith("the torque at joint 1 changes from sample to sample like noise")
    assert finding.document()["notes"][0] == warning.document()


def test_an_empty_set_is_refused():
    with pytest.raises(DataError, match="no evaluating trial"):
        diagnose(pendulum(), swings((), trials=1), [])
