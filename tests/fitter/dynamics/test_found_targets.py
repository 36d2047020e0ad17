"""Motions whose targets nobody recorded get those that a calibrated arm explains them with."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Control
from fitter.data.motions import Measured
from fitter.data.plausibility.saturated import CONTRADICTED
from fitter.dynamics.found_targets import HINT, lacks_torque, with_found_targets

ARM = load_arm("dd-arm")


@pytest.fixture(scope="module")
def motions(bench_trials):
    """Two motions to learn from and one to judge on, of which only angles and their derivatives were recorded."""
    found = []
    for k, trial in enumerate(bench_trials[:3]):
        columns = {"q": trial.q, "dq": trial.dq, "ddq": trial.ddq}
        found.append(Measured(trial.name, "run.mcap", 0, 10.0 * k + trial.t, columns))
    return found[:2], found[2:]


def test_targets_are_found_and_everything_else_stays(motions, bench_trials):
    learn, evaluate = with_found_targets(ARM, *motions)
    assert [len(learn), len(evaluate)] == [2, 1]
    for motion, before, trial in zip([*learn, *evaluate], [*motions[0], *motions[1]], bench_trials, strict=False):
        assert (motion.name, motion.where, motion.t[0]) == (before.name, "run.mcap", before.t[0])
        assert np.allclose(motion.columns["q"], before.columns["q"])
        assert np.abs(motion.columns["ref"][-1] - trial.ref[-1]).max() < 2e-3
        assert motion.notes[-1].text == HINT
        assert not lacks_torque(ARM, motion) and motion.target_std.max() < 0.1


def test_instants_that_do_not_count_have_no_say_in_a_target(motions):
    """Nor do they count later: an angle that is a guess for a while leaves the target where it was."""
    learn, evaluate = motions
    guessed = np.zeros_like(evaluate[0].columns["q"])
    middle = slice(len(guessed) // 2, len(guessed) // 2 + 200)
    guessed[middle] = 1.0
    columns = {**evaluate[0].columns, CONTRADICTED: guessed}
    columns["q"] = columns["q"] + guessed
    (found,) = with_found_targets(ARM, learn, [replace(evaluate[0], columns=columns)])[1]
    (plain,) = with_found_targets(ARM, learn, evaluate)[1]
    assert np.abs(found.columns["ref"][-1] - plain.columns["ref"][-1]).max() < 1e-3
    np.testing.assert_array_equal(found.columns[CONTRADICTED], guessed)


def test_motions_that_tell_their_torque_stay_as_they_are(motions):
    with_targets = [
        replace(motion, columns={**motion.columns, "ref": motion.columns["q"]}) for motion in motions[0]
    ]
    learn, evaluate = with_found_targets(ARM, with_targets, with_targets)
    assert all(
        one is other for one, other in zip([*learn, *evaluate], [*with_targets, *with_targets], strict=True)
    )
    measured = replace(ARM, control=Control())
    assert with_found_targets(measured, *motions) == (list(motions[0]), list(motions[1]))
