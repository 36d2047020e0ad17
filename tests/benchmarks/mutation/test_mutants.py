"""A sample is the same for a seed, can be loaded, and is none of what Python takes for the same."""

import ast
from pathlib import Path

import pytest

pytest.importorskip("cosmic_ray", reason="the extra 'mutate' is not installed")

from benchmarks.mutation.mutants import change, mutated, sample  # noqa: E402 - after the extra is looked for

CODE = '''"""Sums."""


def total(values):
    """Return their sum."""
    found = 0
    for one in values:
        if one > 0:
            found = found + one
    return found
'''


@pytest.fixture
def root(tmp_path: Path) -> Path:
    (tmp_path / "sums.py").write_text(CODE)
    (tmp_path / "more.py").write_text(CODE.replace("> 0", "< 10"))
    return tmp_path


def test_a_seed_draws_the_same_places_once_each(root: Path) -> None:
    some = sample(root, ["sums.py", "more.py"], 4, 7)
    assert some == sample(root, ["sums.py", "more.py"], 4, 7)
    assert some != sample(root, ["sums.py", "more.py"], 4, 8)
    every = sample(root, ["sums.py", "more.py"], 100, 7)
    assert every[:4] == some
    assert (
        len({(one.path, one.line, one.column) for one in every}) == len({one.key for one in every}) == len(every)
    )


def test_each_fault_changes_what_python_runs(root: Path) -> None:
    for mutant in sample(root, ["sums.py"], 100, 0):
        changed = mutated(CODE, mutant)
        assert ast.dump(ast.parse(changed)) != ast.dump(ast.parse(CODE))
        before, after = change(CODE, changed).split(" → ")
        assert before == CODE.splitlines()[mutant.line - 1].strip() != after
