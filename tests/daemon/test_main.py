"""The command line: exit codes and one JSON document."""

import json
from pathlib import Path

import pytest

from daemon.__main__ import main

WRONG = '[device]\nport = "/dev/ttyX"\nbaud = -1\n[arm]\nfile = "dd-arm"\n[trials]\nlearning = -5\n[colour]\n'


def test_check_finds_nothing_wrong(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    good = tmp_path / "limbd.toml"
    good.write_text('[device]\nport = "/dev/ttyX"\n[arm]\nfile = "dd-arm"\n')
    assert main(["check", str(good), "--json"]) == 0
    out, _ = capsys.readouterr()
    assert json.loads(out) == {"file": str(good), "ok": True, "mistakes": [], "arm": "dd-arm"}


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


def test_run_needs_a_port_and_an_arm(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run"]) == 2
    err = " ".join(capsys.readouterr().err.split())
    assert "device.port is missing; expected in the config file or as --port" in err
    assert "arm.file is missing; expected in the config file or as --arm" in err


def test_an_unknown_method_is_a_mistake(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "--port", "/dev/ttyX", "--arm", "dd-arm", "--method", "magic"]) == 2
    assert "tracking.method is 'magic'" in " ".join(capsys.readouterr().err.split())


def test_a_built_in_arm_cannot_be_zeroed_in_place(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["zero", "--port", "/dev/ttyX", "--arm", "dd-arm"]) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert "arm 'dd-arm' is built in and cannot be written, expected --out FILE" in said


@pytest.mark.parametrize("seconds", ["0.1", "100"])
def test_zeroing_takes_a_few_seconds(capsys: pytest.CaptureFixture[str], seconds: str) -> None:
    assert main(["zero", "--port", "/dev/ttyX", "--arm", "dd-arm", "--seconds", seconds]) == 2
    assert f"'{seconds}' is not a number from 0.5 to 60" in " ".join(capsys.readouterr().err.split())
