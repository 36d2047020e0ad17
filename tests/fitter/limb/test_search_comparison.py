"""How far two answers are apart."""

from dataclasses import replace

import numpy as np
import pytest

from arm.body.landmarks import limb_map
from fitter.limb.bundle import cost_of, fit_bundle
from fitter.limb.limb_search import Found
from fitter.limb.search_comparison import Comparison, compared, comparison
from tests.fitter.limb.simulated_task import simulated_task


@pytest.fixture(scope="module")
def fitted():
    known = simulated_task()
    return known, limb_map(known.arm.name, known.arm.n_joint), fit_bundle(
        known.task, known.geometry, known.markers, known.q
    )  # fmt: skip


def test_an_answer_is_nowhere_from_itself(fitted):
    known, where, bundle = fitted
    one = compared(where, known.task, bundle, bundle)
    assert (one.cost, one.apart_m, one.centres_apart_m) == (0.0, 0.0, 0.0)
    assert one.marker_rms_m == pytest.approx(
        1e-3 * np.sqrt(3.0), rel=0.35
    )  # noise of 1 mm an axis, less what fits it


def test_a_hip_that_is_moved_moves_all_markers_and_one_centre(fitted):
    known, where, bundle = fitted
    away = np.array([0.0, 3e-3, 4e-3])
    moved = replace(bundle, geometry=replace(bundle.geometry, base_p=bundle.geometry.base_p + away))
    one = compared(where, known.task, bundle, moved)
    assert one.apart_m == pytest.approx(5e-3)  # frame 0 and base segment are parallel
    assert one.centres_apart_m == pytest.approx(5e-3 / np.sqrt(3.0))  # hip; knee and ankle stay in their segments
    own = cost_of(known.task, moved.geometry, moved.markers, moved.q)
    expected = own - cost_of(known.task, bundle.geometry, bundle.markers, bundle.q)
    assert one.cost == pytest.approx(expected) and one.cost > 0.0


def test_the_document_is_in_millimetres(fitted):
    known, where, bundle = fitted
    found = {"bundle": Found(bundle, 2.0, 10), "ga": Found(bundle, 30.0, 8, 100)}
    document = comparison(where, known.task, found).document()
    one = compared(where, known.task, bundle, bundle)
    assert document["bundle"]["marker_rms_mm"] == 1e3 * one.marker_rms_m
    assert document["ga"]["population"] == 100 and document["ga"]["cpu_s"] == 30.0


@pytest.mark.parametrize(
    ("above", "after", "converged", "kinds"),
    [
        (0.5, 0.0, True, []),
        (0.5, 0.0, False, ["not_converged"]),
        (20.0, 0.0, True, ["above_bundle"]),
        (20.0, 15.0, True, ["other_minimum"]),
        (-11.0, -12.0, True, ["other_minimum"]),
        (20.0, -12.0, False, ["not_converged", "other_minimum"]),
    ],
)
def test_a_worse_minimum_is_said_of_whichever_is_in_it(fitted, above, after, converged, kinds):
    known, where, bundle = fitted
    one = compared(where, known.task, bundle, bundle)
    found = {name: Found(replace(bundle, converged=converged), 1.0, 10) for name in ("bundle", "ga", "ga+bundle")}
    costs = {"bundle": 0.0, "ga": above, "ga+bundle": after}
    rivals = Comparison(found, {name: replace(one, cost=cost) for name, cost in costs.items()})
    notes = rivals.notes()
    assert [note.kind for note in notes] == kinds
    if kinds[-1:] == ["other_minimum"]:
        assert ("lower by 12" in notes[-1].text) == (after < 0.0)
