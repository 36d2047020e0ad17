"""`limbd zero`: what it refuses before it measures."""

import pytest

from daemon.__main__ import main


def test_a_built_in_arm_cannot_be_zeroed_in_place(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["zero", "--port", "/dev/ttyX", "--arm", "dd-arm"]) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert "arm 'dd-arm' is built in and cannot be written, expected --out FILE" in said


@pytest.mark.parametrize("seconds", ["0.1", "100"])
def test_zeroing_takes_a_few_seconds(capsys: pytest.CaptureFixture[str], seconds: str) -> None:
    assert main(["zero", "--port", "/dev/ttyX", "--arm", "dd-arm", "--seconds", seconds]) == 2
    assert f"'{seconds}' is not a number from 0.5 to 60" in " ".join(capsys.readouterr().err.split())
