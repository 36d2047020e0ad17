"""How well a geometry is known, by what its motions were made of."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import tip_position
from fitter.data.first_rest import displacement
from fitter.kinematics.found_geometry import fit_of
from fitter.kinematics.incremental import IncrementalKinematics
from fitter.kinematics.tip_basis import geometry_of
from limbcal.errors import NotIdentifiable

ARM = load_arm("dd-arm")


def searched(trials):
    search = IncrementalKinematics(ARM, 0)
    for number, trial in enumerate(trials):
        moved, rest = displacement(ARM, trial)
        search.add(trial.q, moved, rest, number)
    for _ in range(60):
        search.generation()
    search.polish()
    return search


def drifting(trials, seed):
    """Return tracked motions with angles that drift by what each has of its own."""
    rng, points = np.random.default_rng(seed), np.zeros((1, len(ARM.sensors), 3))
    return [
        replace(
            trial,
            q=trial.q + (trial.t - trial.t[0])[:, None] * rng.normal(0.0, 2e-3, 2),
            tip=tip_position(ARM, trial.q) + 1e-4 * rng.normal(size=(len(trial.t), 3)),
            points=np.repeat(points, len(trial.t), axis=0),
        )
        for trial in trials
    ]


def test_intervals_of_tracked_motions_hold_their_drift(bench_trials):
    truth, held, by_samples = geometry_of(ARM).ravel(), [], []
    for seed in range(4):
        trials = drifting(bench_trials[:4], seed)
        search = searched(trials)
        found = [p for p in fit_of(search, trials).parameters.values() if p.identifiable]
        off = np.abs([p.value for p in found] - truth[search.sought])
        held.append(off < [p.half_width for p in found])
        by_samples.append(off < 1.96 * np.sqrt(np.diag(search.scattered())))
        assert {p.freedom for p in found} == {3.0}
    assert np.mean(held) > 0.9 > np.mean(by_samples) + 0.1


def test_one_tracked_motion_alone_claims_nothing(bench_trials):
    trials = drifting(bench_trials[:1], 0)
    fit = fit_of(searched(trials), trials)
    assert all(p.ci95 is None and not p.identifiable for p in fit.parameters.values())
    assert "one tracked motion" in fit.notes[0].text


def test_one_measured_motion_is_known_by_its_samples(bench_trials):
    trial = replace(drifting(bench_trials[:1], 0)[0], q=bench_trials[0].q, points=None)
    fit = fit_of(searched([trial]), [trial])
    low, high = fit.parameters["a1"].ci95
    assert low < 0.25 < high < low + 1e-3 and not fit.notes


def test_without_motion_nothing_is_found():
    with pytest.raises(NotIdentifiable, match="don't move"):
        fit_of(IncrementalKinematics(ARM, 0), [])
