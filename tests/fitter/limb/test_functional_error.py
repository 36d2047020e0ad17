"""What repeated trials cannot tell of a functional centre."""

import numpy as np
import pytest

from benchmarks.simulated_people.person import person
from fitter.limb.functional_error import beyond_the_acromion, systematic_std_m
from fitter.limb.limb_calibration import calibrate


def test_the_error_along_an_axis_is_that_against_images():
    assert systematic_std_m("shoulder") == pytest.approx(0.0214 / np.sqrt(3.0), abs=1e-4)
    assert systematic_std_m("elbow") == 0.0


def test_an_upper_arm_is_no_longer_than_from_acromion_to_elbow():
    truth = person(n=150)
    fit = calibrate(truth.recordings, truth.marker_set, "human-arm-right", fit_frames=100)
    chain, (frames, rows) = fit.bundle.markers.chain(fit.bundle.geometry), fit.frames_of_fit()
    shoulder = np.einsum("nij,j->ni", frames.R, fit.bundle.geometry.base_p) + frames.p
    length = abs(fit.bundle.geometry.numbers[2, 2])
    said = beyond_the_acromion(fit.where, frames, chain, fit.bundle.q, shoulder, length + 0.05)
    assert said is not None and "its acromion is" in said.text
    assert beyond_the_acromion(fit.where, frames, chain, fit.bundle.q, shoulder, length - 0.05) is None
    seldom = np.full_like(shoulder, np.nan)
    assert beyond_the_acromion(fit.where, frames, chain, fit.bundle.q, seldom, length) is None
    assert fit.errors.free_std[fit.free.names.index("d3")] >= systematic_std_m("shoulder")
    assert len(rows) == len(frames.t)
