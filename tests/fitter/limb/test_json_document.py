"""The document of a limb: numbers of the fit, in their units, and errors in closed form."""

import numpy as np
import pytest

from fitter.functional.disjoint import coverage_factor
from fitter.limb.json_document import derived_document, document, length_label, of_markers, rms_mm
from fitter.limb.marker_errors import scores_of
from fitter.limb.uncertainty import Derived, Errors


@pytest.fixture(scope="module")
def found(leg):
    return document(leg.fit, scores_of(leg.fit, leg.truth.recordings[:1], leg.truth.recordings[1:], 0))


def test_lengths_are_the_persons_in_metres(leg, found):
    thigh = found["lengths_m"]["thigh"]
    assert thigh["value"] == pytest.approx(abs(leg.truth.arm.joints[2].d_m), abs=5e-3)
    low, high = thigh["ci95"]
    assert low < abs(leg.truth.arm.joints[2].d_m) < high
    assert found["lengths_m"]["shank"]["value"] == pytest.approx(leg.truth.arm.joints[3].a_m, abs=5e-3)


def test_every_number_of_eq_1_has_a_unit_and_gauge_no_error(leg, found):
    rows = found["parameters"]
    assert len(rows) == 5 * 6 + 3
    assert rows["d3"]["value"] == leg.fit.bundle.geometry.numbers[2, 2] and rows["d3"]["unit"] == "m"
    assert rows["theta_offset2"]["unit"] == "rad" and rows["theta_offset2"]["std"] is None
    assert rows["d3"]["identifiable"] and not rows["theta_offset2"]["identifiable"]
    assert rows["base_y"]["value"] == leg.fit.bundle.geometry.base_p[1] and rows["base_y"]["std"] > 0.0


def test_markers_are_told_trial_set_by_set(leg, found):
    rms = found["marker_rms_mm"]
    assert rms["learn"]["frames"] == rms["evaluate"]["frames"] == 200
    names = [*leg.fit.bundle.markers.names, *leg.fit.base.markers]
    assert list(rms["per_marker"]) == names
    mean = np.sqrt(np.mean(np.square(list(rms["per_marker"].values()))))
    assert mean == pytest.approx(rms["evaluate"]["rms"], rel=1e-6)
    assert found["samples"] == 120 and found["method"] == "bundle" and found["converged"]
    alone = document(leg.fit, scores_of(leg.fit, leg.truth.recordings[:1], [], 0))
    assert "evaluate" not in alone["marker_rms_mm"] and alone["explained"]["evaluate"] is None


def test_a_centre_stands_among_its_segments_markers(leg, found):
    hip = found["centres"]["hip_right"]
    assert hip["segment"] == "pelvis" and set(hip["markers_m"]) == set(leg.fit.base.markers)
    assert hip["score_apart_mm"] < 30.0 and hip["score_std_mm"] > 0.0
    markers = np.array([hip["markers_m"][f"B{k + 1}"] for k in range(4)])
    true = leg.truth.recordings[0].positions[0, -4:]
    joint = leg.truth.R[0][0] @ leg.truth.base_p + leg.truth.p[0][0]
    distances = np.linalg.norm(markers - hip["position_m"], axis=1)
    np.testing.assert_allclose(distances, np.linalg.norm(true - joint, axis=1), atol=0.01)


def test_errors_are_those_of_three_directions_together():
    own = Derived({"thigh": 0.4}, {"hip": ("pelvis", np.zeros(3))}, {"knee": ("thigh", np.array([0.0, 1.0, 0.0]))})
    variance = np.array([0.01, 0.02, 0.01, 0.02, 0.03, 0.0, 0.04]) ** 2
    errors = Errors(np.zeros(1), np.ones(1, dtype=bool), np.diag(variance), (own, own), 5)
    found = derived_document(
        own, errors, lambda _: 0.002, lambda s: dict.fromkeys("abc" if s == "thigh" else "a", [0.0])
    )
    factor = coverage_factor(5)
    assert found["lengths_m"]["thigh"]["ci95"] == pytest.approx([0.4 - 0.01 * factor, 0.4 + 0.01 * factor])
    assert found["centres"]["hip"]["std_mm"] == pytest.approx(30.0) and found["centres"]["hip"]["apart_mm"] == 0.0
    assert found["axes"]["knee"]["std_deg"] == pytest.approx(np.degrees(0.05))
    wide = derived_document(own, errors, lambda _: 0.05, lambda _: {})
    assert wide["lengths_m"]["thigh"]["std"] == 0.05
    assert wide["axes"]["knee"]["std_deg"] is None and wide["axes"]["knee"]["apart_deg"] is None


@pytest.mark.parametrize(
    ("length", "ball", "label"),
    [("thigh", 0, "d3"), ("shank", 0, "a4"), ("upper_arm", 2, "d5"), ("forearm", 2, "d7"), ("girdle", 2, "a2")],
)
def test_a_length_is_a_number_of_eq_1(length, ball, label):
    assert length_label(length, ball) == label


def test_distances_are_in_millimetres_and_gaps_left_out():
    distances = np.array([[0.003, np.nan], [0.004, 0.012]])
    assert rms_mm(distances[:, :1]) == pytest.approx(np.sqrt(12.5))
    assert rms_mm(np.full((2, 1), np.nan)) is None
    assert of_markers(distances, 1) == {
        "rms": pytest.approx(13.0 / np.sqrt(3.0)), "median": pytest.approx(4.0), "max": pytest.approx(12.0),
        "limb": pytest.approx(np.sqrt(12.5)), "frames": 2,
    }  # fmt: skip
