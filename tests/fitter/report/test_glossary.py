"""Every symbol of a fitted parameter has a meaning, for arms of any number of joints."""

import re

import pytest

from arm.arm_file import load_arm, preset_names
from arm.structural_parameters import structural_parameters
from fitter.kinematics.tip_basis import geometry_names
from fitter.report.glossary import glossary

KINDS = re.compile(r"I\d+(?:xx|yy|zz|xy|xz|yz)?|m\d+|s[xyz]\d+|L\d+|d\d+|D\d+|fc\d+|F\d+|k[pva]\d+")


@pytest.mark.parametrize("name", preset_names())
def test_every_symbol_of_the_built_in_arms_is_explained(name):
    arm = load_arm(name)
    names = structural_parameters(arm).names
    explained = " ".join(symbol for symbol, _ in glossary(names))
    for symbol in {found for one in names for found in KINDS.findall(one)}:
        kind = re.sub(r"\d+", "_j", symbol) if not re.match(r"I\d+[xyz]", symbol) else f"I{symbol[-2:]}_j"
        assert kind in explained, (symbol, explained)


def test_each_kind_is_explained_once_and_without_numbers_of_joints():
    rows = glossary([*geometry_names(7), "m2*sx2", "m3*sy3", "I2", "D1", "D7", "fc1", "F1", "kp1", "kv2", "ka3"])
    symbols = [symbol for symbol, _ in rows]
    assert len(set(symbols)) == len(symbols)
    for symbol in (
        "alpha_j",
        "a_j",
        "d_j",
        "beta_j",
        "theta_offset_j",
        "m_j*sx_j, …",
        "m_j",
        "I_j",
        "D_j",
        "fc_j",
    ):
        assert symbol in symbols
    assert {"F_j", "kp_j", "kv_j", "ka_j"} <= set(symbols)
    assert all(meaning and not meaning[0].isdigit() for _, meaning in rows)


def test_sums_are_explained_where_there_are_some():
    assert not any("sums" in symbol for symbol, _ in glossary(["I2", "D1"]))
    assert any("sums" in symbol for symbol, _ in glossary(["I1+m2*L1^2"]))
    assert glossary([]) == []


def test_numbers_of_a_sensor_are_explained():
    symbols = [symbol for symbol, _ in glossary(["bias_x", "scale_y", "turn_z", "place_x", "highpass_hz"])]
    assert symbols == ["bias_x, _y, _z", "scale_x, _y, _z", "turn_x, _y, _z", "place_x, _y, _z", "highpass_hz"]
