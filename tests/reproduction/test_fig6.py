"""Fig. 6."""

import numpy as np

from arm.kinematics import tip_position
from fitter.kinematics.tip_basis import geometry_of, with_geometry
from reproduction.bench_data import true_arm
from reproduction.experiment import Settings
from reproduction.fig6 import GENES, landscape, run
from reproduction.table1 import drawn_trials


def test_costs_differ_as_the_mean_square_of_the_tips_error_does():
    arm = true_arm()
    cost = landscape(arm, 500, seed=2)
    trial, rng = drawn_trials(arm, 500, 2)[0], np.random.default_rng([2, 6])
    q = trial.q + np.deg2rad(1.0) * rng.standard_normal(trial.q.shape)
    tip = trial.tip + 1e-3 * rng.standard_normal(trial.tip.shape)

    def error(genes):
        geometry = geometry_of(arm).copy()
        for place, value in zip(GENES, genes, strict=True):
            geometry[place] = value
        left = tip - tip_position(with_geometry(arm, geometry), q)
        return np.mean(np.sum((left - left.mean(axis=0)) ** 2, axis=1))

    genes = np.random.default_rng(0).uniform(-0.5, 0.9, (4, len(GENES)))
    ours = np.sum(cost.residuals(genes) ** 2, axis=1)
    theirs = np.array([error(individual) for individual in genes])
    np.testing.assert_allclose(ours - ours[0], theirs - theirs[0], atol=1e-12)


def test_every_search_is_scored_in_every_box():
    found = run(Settings(quick=True))
    boxes = found.document["boxes"]
    assert len(found.grids) == len(boxes) == 2
    for rows in boxes.values():
        assert all(0.0 <= row["share"] <= 1.0 for row in rows.values())
        reached = [row for row in rows.values() if row["share"] == 1.0]
        assert all(row["median_error_mm"] <= 0.1 for row in reached)
    assert boxes["angles within ±30°"]["GA (ours)"]["share"] == 1.0
