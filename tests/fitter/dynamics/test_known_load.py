"""A known load leaves the bare arm's torque, and tells by which factor torque was measured too large."""

from dataclasses import replace

import numpy as np
import pytest

from arm.effects.payload import with_load
from arm.model import Link
from fitter.data.motions import Measured
from fitter.data.trial import Trial
from fitter.data.trials import to_trials
from fitter.dynamics.known_load import (
    KnownLoad,
    by_factors,
    factor_notes,
    load_torque,
    torque_factors,
    without_load,
)
from fitter.search.fitted_parameter import FittedParameter
from limbcal.errors import DataError
from tests.fitter.dynamics.test_torque_wiring import ARM, BASE, driven

LOAD = KnownLoad(0.8, frozenset({2, 4}))


def motion_of(trial):
    return trial.q, trial.dq, trial.ddq


def run(factors: tuple[float, float] = (1.0, 1.0), seed: int = 0) -> list[Trial]:
    """Return four motions, the second and the fourth with a load."""
    arms = [ARM, with_load(ARM, LOAD.mass_kg)] * 2
    trials = [driven(arm, 10 * seed + k) for k, arm in enumerate(arms)]
    return [replace(trial, tau=trial.tau * np.array(factors)) for trial in trials]


def test_the_torque_of_a_load_is_linear_in_its_mass_and_of_no_link():
    motion = motion_of(driven(ARM, 0))
    one = load_torque(ARM, motion, 1.0)
    other = replace(ARM, joints=tuple(replace(joint, link=Link()) for joint in ARM.joints))
    assert np.allclose(load_torque(ARM, motion, 2.5), 2.5 * one)
    assert np.allclose(load_torque(other, motion, 1.0), one)


def test_loaded_trials_become_those_of_the_bare_arm():
    bare = without_load(ARM, run(), LOAD)
    loaded = driven(with_load(ARM, LOAD.mass_kg), 1)
    assert np.allclose(bare[1].tau, loaded.tau - load_torque(ARM, motion_of(loaded), LOAD.mass_kg))
    assert bare[0].tau is not None and np.array_equal(bare[0].tau, run()[0].tau)


def test_a_filtered_trial_keeps_its_columns_as_they_were_measured():
    trial = driven(with_load(ARM, LOAD.mass_kg), 1)
    measured = Measured("m", "m", 0, trial.t, {"q": trial.q, "tau": trial.tau})
    (filtered,) = to_trials([measured], cutoff_hz=10.0)
    factors = [FittedParameter(2.0, 0.01, "1", True), FittedParameter(1.0, 0.01, "1", True)]
    (bare,) = without_load(ARM, by_factors([filtered], factors), KnownLoad(LOAD.mass_kg, frozenset({1})))
    assert np.array_equal(bare.whole["q"], filtered.whole["q"])
    inner = slice(bare.trimmed, len(trial.q) - bare.trimmed)
    wanted = trial.tau / [2.0, 1.0] - load_torque(ARM, motion_of(trial), LOAD.mass_kg)
    size = np.abs(wanted).max()
    assert np.abs(bare.whole["tau"][inner] - wanted[inner]).max() < 0.02 * size


@pytest.mark.parametrize("factors", [(1.0, 1.0), (1.1, 0.9), (0.5, 2.0)])
def test_factors_are_inside_their_intervals(factors):
    found = [torque_factors(ARM, BASE, run(factors, seed), LOAD) for seed in range(5)]
    off = np.array([[(one.value - c) / one.std for one, c in zip(some, factors, strict=True)] for some in found])
    assert np.sqrt(np.mean(off**2)) < 2.0
    assert all(one.std < 0.03 * c for some in found for one, c in zip(some, factors, strict=True))
    said = [note.text for note in factor_notes(found[0])]
    assert len(said) == (0 if factors == (1.0, 1.0) else 2)
    assert all(note.startswith("by the known load the torque of joint") for note in said)


def test_without_a_bare_trial_no_factor_is_known():
    assert torque_factors(ARM, BASE, run(), KnownLoad(0.8, frozenset({1, 2, 3, 4}))) == []
    assert torque_factors(ARM, BASE, run()[:1], LOAD) == []


def test_a_trial_that_is_not_there_or_has_no_torque_is_said():
    with pytest.raises(DataError, match="names trial 9 of 4"):
        without_load(ARM, run(), KnownLoad(0.8, frozenset({9})))
    with pytest.raises(DataError, match="no torque was measured"):
        torque_factors(ARM, BASE, [replace(trial, tau=None) for trial in run()], LOAD)
    with pytest.raises(DataError, match="no torque was measured"):
        without_load(ARM, [replace(trial, tau=None) for trial in run()], LOAD)


def test_of_a_joint_that_never_moves_no_factor_is_known():
    def held(trial: Trial) -> Trial:
        moves = np.array([1.0, 0.0])
        return replace(trial, q=trial.q * moves, dq=trial.dq * moves, ddq=trial.ddq * moves)

    first, second = torque_factors(ARM, BASE, [held(trial) for trial in run()], LOAD)
    assert not second.identifiable and np.isnan(second.std)
    assert np.isfinite(first.value)
