"""Commands run in this process, what they said, and data to spoil."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import pytest

import fitter.__main__
from arm.arm_file import save_arm
from arm.model import Control
from fitter.data.motion_file import write_motion


@dataclass(frozen=True)
class Outcome:
    """Exit code, stdout, and the sentences of an error."""

    code: int
    out: str
    errors: list[str]


@pytest.fixture
def run(capfd: pytest.CaptureFixture[str]) -> Callable[..., Outcome]:
    """Run a command: ``run(fitter.__main__.main, "track", …)``; whatever happens, no traceback."""

    def outcome(main: Callable[[list[str]], int], *arguments: object) -> Outcome:
        code = main([str(argument) for argument in arguments])
        out, err = capfd.readouterr()
        assert "Traceback" not in err
        return Outcome(code, out, [line for line in err.splitlines() if line.startswith("error: ")])

    return outcome


@pytest.fixture
def said(run: Callable[..., Outcome]) -> Callable[..., str]:
    """Run ``fitter``; return the one sentence of an error with this exit code, and no word of it on stdout."""

    def sentence(code: int, *arguments: object) -> str:
        outcome = run(fitter.__main__.main, *arguments, "--json")
        assert (outcome.code, outcome.out, len(outcome.errors)) == (code, "", 1), outcome
        return outcome.errors[0].removeprefix("error: ")

    return sentence


@pytest.fixture
def columns(short_run):
    """Return two seconds of motion at 100 Hz, with targets."""
    rows = slice(2000, 10000, 40)
    return {"t": short_run.t[rows], "q": short_run.truth["q"][rows], "ref": short_run.truth["ref"][rows]}


@pytest.fixture
def motion(columns, tmp_path):
    """Write them."""
    write_motion(tmp_path / "motion.csv", columns)
    return tmp_path / "motion.csv"


@pytest.fixture
def measuring(short_run, tmp_path):
    """Write an arm whose torque comes with the data."""
    save_arm(replace(short_run.arm, control=Control("measured")), tmp_path / "measuring.toml")
    return tmp_path / "measuring.toml"


@pytest.fixture
def a_second(short_run, tmp_path):
    """Write a second of readings, in which the arm begins to move."""
    path = tmp_path / "raw.npz"
    write_motion(path, {name: values[:4000] for name, values in short_run.raw_columns().items()})
    return path
