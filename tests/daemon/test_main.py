"""The command line: exit codes and one JSON document."""

import pytest

from daemon.__main__ import main


def test_run_needs_a_port_and_an_arm(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run"]) == 2
    err = " ".join(capsys.readouterr().err.split())
    assert "device.port is missing; expected in the config file or as --port" in err
    assert "arm.file is missing; expected in the config file or as --arm" in err


def test_an_unknown_method_is_a_mistake(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "--port", "/dev/ttyX", "--arm", "dd-arm", "--method", "magic"]) == 2
    assert "tracking.method is 'magic'" in " ".join(capsys.readouterr().err.split())
