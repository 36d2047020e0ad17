"""The JSON document of a fit of the geometry."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from fitter.kinematics.geometry_fit import fit_kinematics
from fitter.kinematics.kinematics_fit import document
from fitter.kinematics.tip_basis import GEOMETRY, with_geometry
from fitter.kinematics.tip_error import tip_score

PRIOR = with_geometry(load_arm("dd-arm"), np.array([[0.0, 0.4, 0.0, 0.0, 0.1], [0.0, 0.5, 0.0, 0.0, -0.1]]))


def test_document(bench_trials):
    seen = []
    fit = fit_kinematics(
        PRIOR, bench_trials[:1], generations=150, progress=lambda done, rms: seen.append((done, rms))
    )
    assert seen[-1][0] == 150
    result = document(fit, tip_score(fit.arm, bench_trials[:1]), tip_score(fit.arm, bench_trials[1:]))
    assert list(result) == [
        "parameters",
        "method",
        "generations",
        "samples",
        "seconds",
        "tip_error_mm",
        "angle_noise_deg",
        "angle_noise_source",
        "about",
        "gauge",
        "explained",
        "ci95",
        "notes",
    ]
    assert list(result["parameters"]) == [f"{name}{i}" for i in (1, 2) for name in GEOMETRY]
    assert result["method"] == "ga"
    assert result["parameters"]["a1"]["unit"] == "m"
    assert result["parameters"]["theta_offset2"]["unit"] == "rad"
    assert set(result["tip_error_mm"]["evaluate"]) == {"mean", "max"}
    assert result["angle_noise_deg"] == pytest.approx([0.0, 0.0], abs=0.05)
    assert result["angle_noise_source"] == "spectrum"
    assert result["about"] == "rest"
    assert {"parameters": ["d1"], "why": "the displacement of the tip shows nothing of it"} in result["gauge"]
    assert document(fit, tip_score(fit.arm, bench_trials))["tip_error_mm"]["evaluate"] is None
