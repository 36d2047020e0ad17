"""What is compiled into a kernel counts as its source, wherever it stands."""

import os
import subprocess
import sys
from types import SimpleNamespace

import numba
import numpy as np
import pytest

from limbcal.kernel_cache import digest_of

CALLED = """
from typing import NamedTuple
from limbcal.compiled import compiled

FACTOR = {factor}

class Pair(NamedTuple):
    x: float
    y: float

@compiled
def inner(pair):
    return pair.x + {term}
"""
BETWEEN = """
from limbcal.compiled import compiled
from {module} import FACTOR, Pair, inner

@compiled
def middle(pair):
    return inner(pair)
"""
CALLER = """
import sys
from numba import types
from numba.core import event
from limbcal.compiled import c_function, compiled
from between import FACTOR, Pair, middle

@compiled
def outer(pair):
    return FACTOR * middle(pair)

def resists(x):
    return FACTOR * x

class Compiled(event.Listener):
    n = 0
    def on_start(self, event):
        self.n += 1
    def on_end(self, event):
        pass

listener = Compiled()
with event.install_listener("numba:compile", listener):
    value = outer(Pair(1.0, 0.0))
    assert c_function(resists, (types.float64,)).ctypes(1.0) == FACTOR
print(value, listener.n > 0, "numba.typed.typeddict" in sys.modules)
"""


@pytest.fixture
def run(tmp_path):
    (tmp_path / "caller.py").write_text(CALLER)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}

    def run(factor, term, module="called"):
        """Return what the kernel gives, and whether anything had to be compiled; else no compiler is fetched."""
        for known in ("called", "moved"):
            (tmp_path / f"{known}.py").unlink(missing_ok=True)
        (tmp_path / f"{module}.py").write_text(CALLED.format(factor=factor, term=term))
        (tmp_path / "between.py").write_text(BETWEEN.format(module=module))
        command = [sys.executable, str(tmp_path / "caller.py")]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        value, fresh, whole = done.stdout.split()
        assert whole == fresh
        return float(value), fresh == "True"

    return run


def test_a_change_in_another_file_is_compiled_anew(run):
    assert run(2.0, 1.0) == (4.0, True)
    assert run(2.0, 1.0) == (4.0, False)
    assert run(2.0, 3.0) == (8.0, True)  # what it calls
    assert run(5.0, 3.0) == (20.0, True)  # a constant that it names


def test_what_moves_to_another_module_is_compiled_anew(run):
    """Machine code and the types that it takes name the module that they were made of, which is there no more."""
    assert run(2.0, 1.0) == (4.0, True)
    assert run(2.0, 1.0, module="moved") == (4.0, True)


def made(text, **known):
    space = {"__name__": "made", **known}
    exec(text, space)
    return space["f"]


def test_a_digest_is_of_what_a_kernel_does():
    def digest(text, **known):
        return digest_of(made(text, **known))

    plain = digest("def f(x):\n    return x + k", k=1)
    assert digest("def f(x):\n    'A docstring.'\n    return x + k", k=1) == plain
    assert digest("\n\ndef f(x):\n    return x + k  # elsewhere", k=1) == plain
    for other in (
        digest("def f(x):\n    return x + k", k=2),
        digest("def f(x):\n    return x - k", k=1),
        digest("def f(x):\n    return x + k + 1", k=1),
        digest("def f(x):\n    return x + k", k=1.0),
        digest("def f(x):\n    return x + k", k=np.array([1])),
        digest("def f(x):\n    return x + k", k=(1, (2,))),
    ):
        assert other != plain
    arrays = [digest("def f(x):\n    return x + k", k=np.array(values)) for values in ([1, 2], [1, 3], [1.0, 2.0])]
    assert len(set(arrays)) == 3


def test_kernels_that_call_each_other_have_a_digest():
    space = SimpleNamespace()
    space.f = made("def f(x):\n    return g(x)", g=None)
    space.f.__globals__["g"] = numba.njit(made("def f(x):\n    return h(x)", h=space.f))
    assert len(digest_of(space.f)) == 64


def test_a_digest_names_the_types_that_are_handed_over():
    text = "def f(x: Kind, y: list[int]):\n    return x"
    whole, array, number = (digest_of(made(text, Kind=kind)) for kind in (int, np.ndarray, float))
    assert len({whole, array, number}) == 3
