"""Every mistake in an arm file or a config is named, with its place."""

import json

import pytest

import daemon.__main__
import fitter.__main__

BAD_ARM = """\
schema = 1
name = "ours"

[[joint]]
type = "hinge"

[[joint]]
a_m = "0.3"

[[sensor]]
name = "s1"
joint = 1
colour = "red"
"""
ARM_MISTAKES = {
    "joint[0].type is 'hinge'; input should be 'revolute' or 'prismatic'",
    "joint[1].a_m is '0.3'; input should be a valid number",
    "sensor[0].colour is not a known field",
}


@pytest.mark.parametrize(
    "command",
    [
        ("track", "raw.npz", "--out", "motion.npz"),
        ("sensors", "raw.npz", "--out", "arm.toml"),
        ("kinematics", "motion.csv", "--out", "arm.toml"),
        ("dynamics", "motion.csv", "--out", "arm.toml"),
        ("simulate", "--reference", "motion.csv", "--out", "motion.npz"),
        ("subscribe",),
    ],
)
def test_three_mistakes_in_an_arm_file_are_all_named(run, tmp_path, command):
    path = tmp_path / "arm.toml"
    path.write_text(BAD_ARM)
    outcome = run(fitter.__main__.main, *command, "--arm", path)
    assert outcome.code == 2
    assert set(outcome.errors) == {f"error: {path}: {mistake}" for mistake in ARM_MISTAKES}


def test_what_only_follows_from_a_mistake_is_not_one(run, tmp_path):
    path = tmp_path / "arm.toml"
    for text, mistake in (
        ('schema = 1\nname = "x"\n[[joint]]\na = 1\n', "joint[0].a is not a known field"),
        ('schema = 1\nname = "x"\njoint = []\n', "joint is []; tuple should have at least 1 item"),
        ('schema = 1\nname = "x"\n[[joint]]\nlink = { com_m = [0.0, 0.0] }\n', "joint[0].link.com_m"),
    ):
        path.write_text(text)
        outcome = run(fitter.__main__.main, "subscribe", "--arm", path)
        assert outcome.code == 2 and len(outcome.errors) == 1
        assert f"{path}: {mistake}" in outcome.errors[0]


BAD_CONFIG = """\
[device]
port = 5
[arm]
file = "dd-arm"
[tracking]
method = "guess"
[record]
folder = "recordings"
directory = "recordings"
"""
CONFIG_MISTAKES = {
    "device.port is 5; input should be a valid string",
    "tracking.method is 'guess'; input should be 'filter' or 'integrate'",
    "record.folder is not a known field",
}


def test_three_mistakes_in_a_config_are_all_named(run, tmp_path):
    path = tmp_path / "limbd.toml"
    path.write_text(BAD_CONFIG)
    expected = {f"{path}: {mistake}" for mistake in CONFIG_MISTAKES}
    for arguments in (("check", path), ("run", "--config", path)):
        outcome = run(daemon.__main__.main, *arguments)
        assert outcome.code == 2 and outcome.out == ""
        assert set(outcome.errors) == {f"error: {mistake}" for mistake in expected}
    outcome = run(daemon.__main__.main, "check", path, "--json")
    assert outcome.code == 2
    assert set(json.loads(outcome.out)["mistakes"]) == expected


def test_files_that_are_not_toml(run, said, tmp_path):
    path = tmp_path / "broken.toml"
    path.write_text("schema = = 1\n")
    assert said(2, "subscribe", "--arm", path).startswith(f"{path}: not TOML: ")
    outcome = run(daemon.__main__.main, "check", path)
    assert outcome.code == 2 and f"{path}: not TOML: " in outcome.errors[0]
