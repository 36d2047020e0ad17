"""`fitter` as it is typed."""

import importlib
import json
import os
import pkgutil
import subprocess
import sys

import pytest

import fitter.commands
from fitter.__main__ import COMMANDS, main


def test_every_command_is_a_module_and_every_such_module_a_command() -> None:
    found = set()
    for module in pkgutil.iter_modules(fitter.commands.__path__):
        source = importlib.import_module(f"fitter.commands.{module.name}")
        if hasattr(source, "EXAMPLE"):
            assert source.EXAMPLE.startswith(f"fitter {module.name.replace('_', '-')}")
            assert callable(source.add_arguments)
            found.add(module.name.replace("_", "-"))
    assert found == set(COMMANDS)


def test_a_command_runs_and_says_one_document(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["effects", "--json"]) == 0
    assert "payload" in json.dumps(json.loads(capsys.readouterr().out))


def test_what_is_no_command_is_a_mistake(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 2
    assert main(["dance"]) == 2
    said = capsys.readouterr()
    assert "dance" in said.err and said.out == ""


def test_help_says_what_each_command_is_for(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--help"])
    assert not ended.value.code
    said = " ".join(capsys.readouterr().out.split())
    assert "Learn an arm's kinematics and dynamics from its motion." in said
    for name, words in COMMANDS.items():
        assert name in said and " ".join(words.split()) in said


def test_blas_is_told_before_numpy_is_loaded() -> None:
    code = "import fitter.__main__, os, sys; print(os.environ['OMP_NUM_THREADS'], 'numpy' in sys.modules)"
    given = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    said = subprocess.run([sys.executable, "-c", code], env=given, capture_output=True, text=True, check=True)
    assert said.stdout.split() == ["1", "False"]


def test_what_is_slow_to_load_waits_for_its_use() -> None:
    commands = [name.replace("-", "_") for name in COMMANDS if name != "reproduce"]  # which draws in any case
    code = f"import importlib, sys; [importlib.import_module('fitter.commands.' + c) for c in {commands}]"
    code += "; print([m for m in ('matplotlib', 'scipy.signal', 'scipy.stats') if m in sys.modules])"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "[]"
