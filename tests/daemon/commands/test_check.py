"""`limbd check`: every mistake of a config, or of an arm file."""

import json
from pathlib import Path

import pytest

from daemon.__main__ import main

WRONG = '[device]\nport = "/dev/ttyX"\nbaud = -1\n[arm]\nfile = "dd-arm"\n[trials]\nlearning = -5\n[colour]\n'
MILLIMETRES = """schema = 1
name = "mine"
[[joint]]
a_m = 300.0
alpha_rad = 90.0
[[sensor]]
name = "s1"
joint = 1
"""


def test_check_finds_nothing_wrong(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    good = tmp_path / "limbd.toml"
    good.write_text('[device]\nport = "/dev/ttyX"\n[arm]\nfile = "dd-arm"\n')
    assert main(["check", str(good), "--json"]) == 0
    out, _ = capsys.readouterr()
    assert json.loads(out) == {
        "file": str(good),
        "ok": True,
        "kind": "config",
        "mistakes": [],
        "arm": "dd-arm",
        "notes": [],
    }


def test_check_names_three_mistakes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wrong = tmp_path / "limbd.toml"
    wrong.write_text(WRONG)
    assert main(["check", str(wrong), "--json"]) == 2
    out, err = capsys.readouterr()
    mistakes = json.loads(out)["mistakes"]
    assert len(mistakes) == 3
    for field, sentence in zip(("device.baud", "trials.learning", "colour"), mistakes, strict=True):
        assert sentence.startswith(f"{wrong}: {field} ")
        assert sentence in " ".join(err.split())


def test_an_arm_file_is_checked_by_itself(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arm = tmp_path / "arm.toml"
    arm.write_text(MILLIMETRES)
    assert main(["check", str(arm), "--json"]) == 0
    said = capsys.readouterr()
    document = json.loads(said.out)
    assert (document["ok"], document["kind"], document["arm"]) == (True, "arm", "mine")
    texts = [note["text"] for note in document["notes"]]
    assert texts == [
        "joint[0].alpha_rad is 90: degrees? expected radians",
        "joint[0].a_m is 300: millimetres? expected metres",
    ]
    assert all(text in " ".join(said.err.split()) for text in texts)


def test_every_mistake_of_an_arm_file_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arm = tmp_path / "arm.toml"
    arm.write_text(MILLIMETRES.replace("joint = 1", "joint = 2").replace("300.0", '"long"') + "colour = 3\n")
    assert main(["check", str(arm), "--json"]) == 2
    found = json.loads(capsys.readouterr().out)
    assert not found["ok"] and len(found["mistakes"]) == 3


def test_the_arm_of_a_config_is_questioned(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "arm.toml").write_text(MILLIMETRES)
    config = tmp_path / "limbd.toml"
    config.write_text(f'[device]\nport = "/dev/ttyX"\n[arm]\nfile = "{tmp_path}/arm.toml"\n')
    assert main(["check", str(config), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["kind"], len(document["notes"])) == ("config", 2)
    assert document["notes"][0]["source"] == f"{tmp_path}/arm.toml"
