"""An arm in other units is questioned where it is loaded."""

from pathlib import Path

import pytest

from fitter.commands.arm_option import questioned_arm


def test_lengths_in_millimetres_are_questioned(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "arm.toml"
    file.write_text('schema = 1\nname = "mine"\n[[joint]]\na_m = 300.0\n')
    assert questioned_arm(file).joints[0].a_m == 300.0
    assert "joint[0].a_m is 300: millimetres? expected metres" in " ".join(capsys.readouterr().err.split())
    questioned_arm("dd-arm")
    assert capsys.readouterr().err == ""
