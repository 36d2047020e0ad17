"""`fitter dynamics --unknown-gains` where nothing says which law holds the arm."""

import argparse

import pytest

from arm.arm_file import load_arm
from fitter.commands.equilibrium import up_to_scale
from limbcal.errors import ConfigError
from tests.fitter.held_limb import KV_LOOSE, limb, unknown_limb, write_motions


@pytest.fixture
def call(tmp_path):
    write_motions(tmp_path / "let-go", limb(KV_LOOSE), slow_hz=0.3, released_rad=0.4, seed=0)
    arm, out = unknown_limb(tmp_path / "arm.toml"), tmp_path / "out.toml"
    return ["dynamics", tmp_path / "let-go", "--arm", arm, "--unknown-gains", "--out", out]


def test_ratios_are_labelled_up_to_scale(fitter, call, tmp_path):
    outcome = fitter(*call, "--report", tmp_path / "page.html")
    assert outcome.code == 0 and outcome.document["up_to_scale"] is True
    assert {one["name"] for one in outcome.document["ratios"]} >= {"(kp1)/I1", "(D1-kv1)/I1"}
    assert "kilograms stay unknown" in outcome.said
    page = (tmp_path / "page.html").read_text()
    assert "Up to scale" in page and "(kp1 and gravity)/I1" in page
    assert load_arm(tmp_path / "out.toml").joints == load_arm(tmp_path / "arm.toml").joints  # no scale, no masses


def test_a_scale_cannot_be_given(fitter, call):
    outcome = fitter(*call, "--fix", "I1=0.05")
    assert outcome.code == 2 and "no [control]" in outcome.said


def test_a_floating_base_is_held_by_no_law():
    arguments = argparse.Namespace(fix=None, evaluate=[])
    with pytest.raises(ConfigError, match="expected --ground"):
        up_to_scale(arguments, load_arm("human-body"), [])
