"""Running the real command."""

import json
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest

from fitter.__main__ import main


@dataclass(frozen=True)
class Outcome:
    """What a command left: exit code, JSON document, and all that it said in one line."""

    code: int
    document: Any
    said: str
    errors: list[str]


@pytest.fixture
def fitter(capfd: pytest.CaptureFixture[str]) -> Callable[..., Outcome]:
    """Run ``fitter … --json``; stdout must be one JSON document or nothing."""

    def run(*arguments: object) -> Outcome:
        code = main([*map(str, arguments), "--json"])
        out, err = capfd.readouterr()
        errors = [line for line in err.splitlines() if line.startswith("error: ")]
        assert "Traceback" not in err
        assert bool(errors) == bool(code)
        return Outcome(code, json.loads(out) if out else None, " ".join(err.split()), errors)

    return run


@pytest.fixture
def place():
    """Make a folder whose name is short enough for sockets in it."""
    with tempfile.TemporaryDirectory() as folder:
        yield folder
