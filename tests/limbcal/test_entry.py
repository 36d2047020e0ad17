"""Ctrl-C is one line, also while modules are loaded."""

from types import ModuleType

import pytest

import limbcal.arguments
from limbcal.entry import enter


def test_an_interrupt_while_modules_are_loaded_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def interrupted(*_: object) -> ModuleType:
        raise KeyboardInterrupt

    monkeypatch.setattr(limbcal.arguments, "parser_of", interrupted)
    assert enter("limbd", "words", "daemon.commands", {}, []) == 0
    assert capfd.readouterr() == ("", "stopped\n")
