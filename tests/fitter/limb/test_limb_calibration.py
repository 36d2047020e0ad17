"""The bundle fit on a person whose limb is known."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.simulated_people.person import person
from fitter.limb.limb_calibration import calibrate
from fitter.limb.uncertainty import derived
from limbcal.errors import DataError


@pytest.fixture(scope="module")
def right_arm():
    truth = person(trials=2, n=500)
    return truth, calibrate(truth.recordings, truth.marker_set, "human-arm-right")


def test_lengths_and_twists_are_those_of_the_person(right_arm):
    truth, fit = right_arm
    found = fit.bundle.geometry.numbers
    assert fit.bundle.converged
    for i, name in ((2, "d_m"), (4, "d_m")):
        assert found[i, 2] == pytest.approx(getattr(truth.arm.joints[i], name), abs=2e-3)
    for i in range(3, 6):
        assert found[i, 0] == pytest.approx(truth.arm.joints[i].alpha_rad, abs=0.03)
    learnt = dict(zip(fit.free.names, fit.errors.learnt, strict=True))
    assert learnt["d3"] and learnt["alpha4"] and learnt["d5"]


def test_the_shoulder_is_where_it_is_among_the_bases_markers(right_arm):
    truth, fit = right_arm
    template = dict(zip(fit.base.markers, fit.base.points_m, strict=True))
    true_points = truth.recordings[0].positions[0, -4:]
    shoulder = truth.R[0][0] @ truth.base_p + truth.p[0][0]
    distances = [np.linalg.norm(shoulder - x) for x in true_points]
    found = [np.linalg.norm(fit.bundle.geometry.base_p - template[f"B{k + 1}"]) for k in range(4)]
    np.testing.assert_allclose(found, distances, atol=2.5e-3)


def test_markers_are_hardly_off(right_arm):
    truth, fit = right_arm
    distances = fit.marker_errors(truth.recordings[1:], seed=0).distance_m
    assert np.sqrt(np.nanmean(distances**2)) < 2e-3


def test_disjoint_trials_agree_as_far_as_errors_say(right_arm):
    truth, fit = right_arm
    assert len(fit.errors.apart) == 2
    own = derived(
        fit.where, fit.bundle.geometry, fit.bundle.markers.link, fit.bundle.markers.place, fit.bundle.markers.place
    )
    assert own.lengths["upper_arm"] == pytest.approx(abs(truth.arm.joints[2].d_m), abs=2e-3)
    assert fit.errors.apart_m("centres", "shoulder_right") < 3e-3
    assert np.degrees(fit.errors.apart_m("axes", "elbow_right")) < 2.0


def test_a_leg_is_found_too():
    truth = person("human-leg-right", seed=3)
    fit = calibrate(truth.recordings, truth.marker_set, "human-leg-right")
    found = fit.bundle.geometry.numbers
    assert abs(found[2, 2]) == pytest.approx(abs(truth.arm.joints[2].d_m), abs=4e-3)
    assert found[3, 1] == pytest.approx(truth.arm.joints[3].a_m, abs=4e-3)
    twist = fit.free.names.index("alpha6")  # a foot hardly turns about that axis: what is left open is said
    assert abs(found[5, 0] - truth.arm.joints[5].alpha_rad) < 3.0 * fit.errors.free_std[twist]


def test_no_marker_of_the_limb_is_an_error():
    truth = person(n=60)
    none = truth.recordings[0].positions.copy()
    none[:] = np.nan
    with pytest.raises(DataError, match="no marker of upper_arm_right"):
        calibrate([replace(truth.recordings[0], positions=none)], truth.marker_set, "human-arm-right")
