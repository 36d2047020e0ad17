"""Errors on trials that had no say, by set and by trial."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.data.trials import to_trials
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.held_out import aimed, likeness, novelty, torque_residual
from fitter.diagnosis.held_out_error import Errors, Judged
from fitter.diagnosis.model import Model
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.run import run_of
from tests.fitter.pendulum import pendulum, swings


def errors(*rms: float) -> Errors:
    one = np.array(rms)[:, None] ** 2
    count, still, trials = np.ones_like(one), np.zeros_like(one), np.arange(len(rms))
    motion = still, still, still, count, np.array([True]), [np.zeros((1, 1))] * len(rms)
    return Errors(one, count, trials, None, *motion)


def test_sets_and_trials_have_errors_of_their_own():
    found = Judged(("monday", "monday", "tuesday"), ("a", "b", "a"), errors(1.0, 2.0, 3.0), errors(0.1, 0.2, 0.3))
    document = found.document()
    assert document["after"]["torque_rms_N_m"] == pytest.approx([np.sqrt(0.14 / 3.0)])
    assert set(document["before"]["sets"]) == {"monday", "tuesday"}
    assert document["before"]["sets"]["monday"]["torque_rms_N_m"] == pytest.approx([np.sqrt(2.5)])
    trials = {name: one["torque_rms_N_m"][0] for name, one in document["after"]["trials"].items()}
    assert trials == pytest.approx({"monday/a": 0.1, "b": 0.2, "tuesday/a": 0.3})


def test_trials_of_one_set_and_name_are_counted():
    found = Judged(("day", "day"), ("a", "a"), errors(1.0, 2.0), errors(1.0, 2.0))
    assert list(found.by_trial()) == ["day/a", "day/a (2)"]


def test_what_is_new_is_no_matter_of_units_or_of_which_combinations_are_sought():
    rng = np.random.default_rng(0)
    some, others = rng.normal(size=(200, 4)), rng.normal(size=(300, 4)) * [1.0, 2.0, 3.0, 0.5]
    mixed = rng.normal(size=(4, 4))
    assert novelty([some @ mixed], [others @ mixed]) == pytest.approx(novelty([some], [others]), rel=1e-3)
    assert novelty([some], [some]) < 1e-9
    assert novelty([others], [some]) == pytest.approx(np.sqrt((np.log(4.0) ** 2 + np.log(9.0) ** 2) / 4), rel=0.15)


def test_what_a_motion_lacks_is_nothing_new_and_what_others_do_not_tell_is_finite():
    rows = np.random.default_rng(1).normal(size=(200, 2))
    assert novelty([rows * [1.0, 0.0]], [rows]) < 0.05
    assert 1.0 < novelty([rows], [rows * [1.0, 0.0]]) < np.inf


@pytest.fixture(scope="module")
def trials():
    return to_trials(swings((), trials=5, seed=3), cutoff_hz=25.0)


def test_motions_drawn_alike_are_said_to_be_alike(trials):
    note = likeness(regression_of(pendulum(), run_of(pendulum(), trials[:4], [*trials[4:], *trials[:4]])))
    assert note is not None and note.kind == "alike" and "like the learning ones" in note.text


def test_a_motion_that_goes_farther_is_another_kind_and_one_that_hardly_moves_is_none(trials):
    (swing,) = swings((), trials=1, seed=9)
    noted = []
    for factor in (0.01, 4.0):
        other = replace(swing, columns={name: factor * values for name, values in swing.columns.items()})
        motions = run_of(pendulum(), trials, to_trials([other], cutoff_hz=25.0))
        noted.append(likeness(regression_of(pendulum(), motions)) is not None)
    assert noted == [True, False]


def test_without_motions_held_back_there_is_nothing_to_say(trials):
    assert likeness(regression_of(pendulum(), run_of(pendulum(), trials, []))) is None


@pytest.fixture(scope="module")
def swung(trials):
    regression = regression_of(pendulum(), run_of(pendulum(), trials[:4], trials[4:]))
    return regression, fitted(regression, Model()), regression.motions[-1]


def off_by(motion, rad):
    """Return a motion whose target was found and is off by so much."""
    trial = replace(motion.trial, ref=motion.trial.ref + rad, target_std=np.array([0.1]))
    return replace(motion, trial=trial, u=motion.u + rad * pendulum().control.kp[0])


def test_a_found_target_is_that_of_each_model(swung):
    """By eq. (5) a target that is off by some angle is a torque that is off by kp times as much."""
    regression, model, motion = swung
    right, wrong = off_by(motion, 0.0), off_by(motion, 0.3)
    both = [torque_residual(regression, model, one) for one in (right, wrong)]
    np.testing.assert_allclose(both[1], both[0], atol=1e-9)
    targets = [aimed(regression, model, one).trial.ref[-1] for one in (right, wrong)]
    np.testing.assert_allclose(targets[1], targets[0], atol=1e-9)


def test_a_recorded_target_stays(swung):
    regression, model, motion = swung
    assert aimed(regression, model, motion) is motion


def test_what_the_data_contradicts_has_no_residual(swung):
    regression, model, motion = swung
    contradicted = np.zeros_like(motion.stuck)
    contradicted[10:20] = True
    residual = torque_residual(regression, model, replace(motion, contradicted=contradicted))
    assert np.isnan(residual[10:20]).all()
