"""Arms to hold beside a calibrated one."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm, save_arm
from arm.model import Control
from fitter.report.compared import geometry_by_name, load_compared
from limbcal.command import to_json
from limbcal.errors import ConfigError

ARM = load_arm("dd-arm")
#: The paper's Table 3.
TRUE = {
    "I1+m2*L1^2": 1.986076,
    "m2*sx2": 1.718632,
    "m2*sy2": 0.181763,
    "I2": 0.471209,
    "D1": -0.002409,
    "D2": 0.000311,
    "fc1": 0.010918,
    "fc2": -0.002271,
    "F1": 0.0,
    "F2": 0.0,
}


def test_the_built_in_arm_has_the_papers_parameters():
    (compared,) = load_compared(["dd-arm"], ARM)
    assert compared.name == "dd-arm"
    assert compared.parameters == pytest.approx(TRUE, abs=1e-9)


def test_a_file_goes_by_its_stem_and_takes_over_the_law(tmp_path):
    other = replace(ARM, name="somebody else's", control=Control("p", (1.0, 1.0)))
    save_arm(other, tmp_path / "last month.toml")
    (compared,) = load_compared([str(tmp_path / "last month.toml")], ARM)
    assert compared.name == "last month"
    assert compared.arm == replace(other, control=ARM.control)


def test_several_keep_their_order_and_none_is_none(tmp_path):
    save_arm(ARM, tmp_path / "a.toml")
    assert [c.name for c in load_compared([str(tmp_path / "a.toml"), "dd-arm"], ARM)] == ["a", "dd-arm"]
    assert load_compared([], ARM) == []


def test_another_number_of_joints_cannot_be_compared(tmp_path):
    save_arm(replace(ARM, joints=ARM.joints[:1], sensors=(), tip=None, control=Control()), tmp_path / "one.toml")
    with pytest.raises(ConfigError, match="one.toml' has 1 joints, expected 2 as dd-arm has"):
        load_compared([str(tmp_path / "one.toml")], ARM)


def test_its_scores_are_on_the_same_trials(bench_trials):
    (compared,) = load_compared(["dd-arm"], ARM)
    document = compared.document(bench_trials[:2], bench_trials[4:5], 0.5)
    assert set(document) == {"parameters", "torque_rms_N_m", "angle_error_deg", "explained"}
    assert np.allclose(document["torque_rms_N_m"]["learn"], 0.0, atol=1e-6)
    assert document["angle_error_deg"]["evaluate"]["max"] < 1e-3
    without = compared.document(bench_trials[:2], [], 0.5)
    assert without["torque_rms_N_m"]["evaluate"] is None and without["angle_error_deg"]["evaluate"] is None
    to_json(without)


def test_geometry_goes_by_the_names_of_the_tables():
    names = ("alpha", "a", "d", "beta", "theta_offset")
    found = geometry_by_name(ARM)
    assert list(found) == [f"{name}{joint}" for joint in (1, 2) for name in names]
    assert found["a1"] == 0.25 and found["a2"] == 0.3 and found["beta2"] == 0.0
