"""A module's tests are those of its name, and then those that use it."""

from pathlib import Path

import pytest

from benchmarks.mutation.mirror import mirrored
from benchmarks.mutation.mirror import tests_of as nearest_tests

FILES = {
    "room/__init__.py": "",
    "room/__main__.py": "",
    "room/base.py": "",
    "room/lonely.py": "from room.base import thing",
    "room/commands/go.py": "import_module('room.lonely')",
    "room/hidden.py": "",
    "other/user.py": "",
    "tests/room/test_base.py": "from room import base",
    "tests/room/test_once.py": "from room.base import thing",
    "tests/room/test_often.py": "from room.base import thing\nthing(thing, thing)",
    "tests/room/test_main.py": "run('go')",
    "tests/room/go/test_go_command.py": "",
    "tests/other/test_user.py": "import room.hidden",
    "tests/room/test_nothing.py": "nothing = ''",
}


@pytest.fixture
def root(tmp_path: Path) -> Path:
    for name, code in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(code)
    return tmp_path


def test_its_own_first_then_those_that_name_it_most(root: Path) -> None:
    nearest = ["tests/room/test_base.py", "tests/room/test_often.py", "tests/room/test_once.py"]
    assert nearest_tests(root, "room/base.py", 3) == nearest
    assert nearest_tests(root, "room/base.py", 2) == nearest[:2]


def test_without_any_those_of_what_uses_it(root: Path) -> None:
    assert nearest_tests(root, "room/lonely.py", 5) == [
        "tests/room/go/test_go_command.py",
        "tests/room/test_main.py",
    ]


def test_without_any_in_its_package_those_of_others(root: Path) -> None:
    assert nearest_tests(root, "room/hidden.py", 5) == ["tests/other/test_user.py"]


def test_a_command_is_tested_by_its_name(root: Path) -> None:
    assert mirrored(root, "room/commands/go.py") == "tests/room/go/test_go_command.py"
    assert mirrored(root, "room/__main__.py") == "tests/room/test_main.py"
    assert mirrored(root, "room/lonely.py") is None
