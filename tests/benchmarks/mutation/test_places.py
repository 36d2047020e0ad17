"""Faults are put where Python decides something, and nowhere else."""

import pytest

pytest.importorskip("cosmic_ray", reason="the extra 'mutate' is not installed")

from benchmarks.mutation.mutants import mutants_of, mutated  # noqa: E402 - after the extra is looked for

LEFT_ALONE = [
    "def f(a: int | None = None) -> list[int] | None: return a",
    "x: Literal[1, 2]",
    "Number = int | float",
    "Both = Path | Other",
    "@dataclass(frozen=True)\nclass A: pass",
    "@lru_cache(maxsize=8)\ndef f(a): return a",
    "assert a > 1 and b is not None",
    "if TYPE_CHECKING:\n    pass",
    'if __name__ == "__main__":\n    main()',
    'say(f"took {1000 * t:.1f} ms")',
    "LIMIT = 3\n@compiled\ndef f(a): return a < LIMIT + 1",
    "@njit(nogil=True)\ndef f(a): return a + 1",
    "def f(a, *, b): return a",
    "f(*a, **b)",
    "zip(a, b, strict=True)",
    '__all__ = ["one"]',
    '"""One of 2 + 2."""',
]


@pytest.mark.parametrize("code", LEFT_ALONE)
def test_what_decides_nothing_is_left_alone(code: str) -> None:
    assert list(mutants_of("some.py", code + "\n")) == []


CHANGED = [
    ("x = 1", {"x = 2", "x = 0"}),
    ("x: int = 4", {"x: int = 5", "x: int = 3"}),
    ("x = a < b", {"x = a <= b", "x = a >= b"}),
    ("x = a == b", {"x = a != b"}),
    ("x = a + b", {"x = a - b"}),
    ("x = a * b", {"x = a / b"}),
    ("x = a | b", {"x = a & b"}),
    ("x = -a", {"x = a"}),
    ("x = not a", {"x = a"}),
    ("x = a and b", {"x = a or b"}),
    ("x = True", {"x = False"}),
    ("if a:\n    pass", {"if not a:\n    pass"}),
    ("for a in b:\n    break", {"for a in []:\n    break", "for a in b:\n    continue"}),
    ('x = f"q{j+k}"', {'x = f"q{j-k}"'}),
    ("@compiled\ndef f(a): return -a\nx = -a", {"@compiled\ndef f(a): return -a\nx = a"}),
]


@pytest.mark.parametrize(("code", "wanted"), CHANGED)
def test_what_decides_is_changed_in_each_way(code: str, wanted: set[str]) -> None:
    found = [mutated(code + "\n", mutant) for mutant in mutants_of("some.py", code + "\n")]
    assert sorted(map(_plain, found)) == sorted(map(_plain, wanted))


def test_an_exception_is_not_caught_any_more() -> None:
    code = "try:\n    f()\nexcept OSError:\n    pass\n"
    (mutant,) = mutants_of("some.py", code)
    assert (mutant.line, mutant.column) == (3, 7)
    assert "except OSError" not in mutated(code, mutant)
    two = "try:\n    f()\nexcept (zmq.Again, OSError):\n    pass\n"
    (plain,) = mutants_of("some.py", two)  # one of a module's cannot be replaced
    assert "zmq.Again" in mutated(two, plain) and "OSError" not in mutated(two, plain)


def _plain(code: str) -> str:
    """Return code without blanks, which faults may leave more of."""
    return code.replace(" ", "").strip()
