"""Axes of joints with their errors, and what a motion leaves open."""

import numpy as np

from fitter.functional.functional_axis import functional_axis
from tests.fitter.functional.poses import simulated
from tests.fitter.functional.test_functional_centre import DRAWS, LEAST_HELD


def test_intervals_of_axes_hold_them_although_skin_moves_coherently():
    held = []
    for seed in range(DRAWS):
        limbs, parent, child = simulated("hinge", seed, 700, trials=2)
        axis = functional_axis("knee_right", parent, child)
        true = [np.einsum("nji,nj->ni", t.R, x.R[:, :, 2]) for t, x in zip(parent.trials, limbs, strict=True)]
        mean = np.mean(np.concatenate(true), axis=0)
        mean *= np.sign(mean @ axis.in_parent) / np.linalg.norm(mean)
        held.append(np.arccos(min(1.0, mean @ axis.in_parent)) <= axis.half_width_rad)
    assert np.mean(held) >= LEAST_HELD


def test_a_ball_has_no_single_axis_and_it_is_told():
    _, parent, child = simulated("ball", 6)
    note = functional_axis("wrist_left", parent, child).notes[0]
    assert note.kind == "no_single_axis"
    assert "without moving it sideways" in note.text


def test_the_document_has_what_the_design_promises():
    _, parent, child = simulated("hinge", 10, 1500)
    document = functional_axis("knee_right", parent, child).document()
    assert 0.0 < document["std_deg"] < 10.0 and 0.0 < document["apart_deg"] < 20.0
