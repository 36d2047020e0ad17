"""A fit that nobody can act on is named as such."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.dynamics.evaluation import Score
from fitter.dynamics.fit import fit_dynamics
from fitter.dynamics.usability import explained_of, joint_notes, next_to_nothing, percent, unusable
from tests.fitter.dynamics.test_torque_wiring import ARM, driven


def scored(*explained: float) -> dict[str, Score | None]:
    return {"learn": Score((1.0,) * len(explained), 1.0, 2.0, 1.0, explained), "evaluate": None}


def fitted(trial):
    return fit_dynamics(ARM, [trial], method="least-squares", examine=False)


def test_a_good_fit_can_be_used():
    trial = driven(ARM, 1)
    assert unusable(fitted(trial), ARM, [trial], scored(0.99, 0.98)) == []


def test_a_torque_of_the_other_sign_cannot():
    trial = driven(ARM, 1)
    trial = replace(trial, tau=-trial.tau)
    (reason,) = unusable(fitted(trial), ARM, [trial], scored(0.99, 0.98))
    assert "negative" in reason and "the load's?" in reason


def test_a_law_whose_gain_drives_is_named():
    law = replace(ARM, control=replace(ARM.control, law="pd", kp=(9.5, 9.5), kv=(-9.5, 9.5)))
    trial = driven(ARM, 1)
    reasons = unusable(fitted(trial), law, [replace(trial, ref=trial.q)], scored(0.9, 0.9))
    assert any("kv2 = 9.5" in reason and "D2" in reason for reason in reasons)


@pytest.mark.parametrize(("shares", "reasons"), [((0.1, -3.0), 1), ((0.1, 0.9), 0), ((np.nan, 0.9), 0)])
def test_next_to_nothing_is_explained_where_no_joint_is(shares, reasons):
    assert len(next_to_nothing(explained_of(scored(*shares)), ARM)) == reasons


def test_a_single_joint_that_is_hardly_explained_is_noted():
    (note,) = joint_notes(scored(0.1, 0.9))
    assert note.columns == ("tau1",) and "only 10 %" in note.text
    assert percent(-0.2) == "nothing" and percent(np.nan) == "–"


@pytest.mark.parametrize("seed", range(4))
def test_what_noise_would_explain_as_well_is_no_answer(seed):
    trial = driven(ARM, seed)
    noise = np.random.default_rng(seed).normal(size=trial.tau.shape)
    filtered = replace(trial, tau=noise, cutoff_hz=3.0, band_hz=1.5)
    assert any(
        any(word in reason for word in ("noise", "next to nothing", "impossible", "too few"))
        for reason in unusable(fitted(filtered), ARM, [filtered], scored(0.3, 0.3))
    )


def test_samples_at_rest_say_nothing_of_the_arm():
    """One short movement in a long trial holds few independent samples, however long the trial is."""
    trial = driven(ARM, 3)
    moves = np.arange(len(trial.q)) < 0.2 * len(trial.q)
    short = replace(trial, dq=trial.dq * moves[:, None], band_hz=5.0)
    (reason,) = unusable(fitted(short), ARM, [short], scored(0.9, 0.9))
    assert "holds about 9 independent samples of moving joints" in reason
    assert unusable(fitted(replace(trial, band_hz=5.0)), ARM, [trial], scored(0.9, 0.9)) == []
