"""The JSON document of a person's calibration."""

import numpy as np


def test_it_has_what_that_of_a_limb_has_side_by_side(found):
    assert {"parameters", "marker_rms_mm", "lengths_m", "centres", "axes", "samples", "converged"} <= found.keys()
    assert {
        f"{name}_{side}" for name in ("thigh", "shank", "upper_arm", "forearm") for side in ("right", "left")
    } <= set(found["lengths_m"])
    assert found["centres"]["hip_left"]["segment"] == "pelvis"
    assert found["parameters"]["parent_position11_x"]["std"] > 0.0
    for one in found["lengths_m"].values():
        low, high = one["ci95"]
        assert low < one["value"] < high and np.isfinite([low, high]).all()


def test_a_centre_is_told_among_the_markers_of_its_segment(person, fit, found):
    """As many disjoint ways: the hip in the pelvis' markers, against the truth there."""
    hip = found["centres"]["hip_right"]
    names = list(hip["markers_m"])
    here = np.array([hip["markers_m"][name] for name in names])
    world = person.recording.of(names)[10]
    R = np.linalg.svd((world - world.mean(0)).T @ (here - here.mean(0)))
    turn = R[0] @ np.diag([1.0, 1.0, np.linalg.det(R[0] @ R[2])]) @ R[2]
    at = turn @ (np.array(hip["position_m"]) - here.mean(0)) + world.mean(0)
    assert np.linalg.norm(at - person.centres_m["hip_right"][10]) < 0.015
