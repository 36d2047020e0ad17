"""The cache of compiled kernels: what a kernel calls, and the constants that it has, count as its source.

The compiler's own cache looks at the file of a kernel alone. What it calls is compiled into it, so a change of
another file would leave machine code of the old one, and nobody would know. And two processes that compile the
same kernel for different types at the same time could give one the other's code.
"""

import fcntl
import hashlib
import types
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from numba.core import event
from numba.core.caching import FunctionCache
from numba.core.dispatcher import Dispatcher
from numba.core.runtime.nrt import rtsys

from limbcal.uninterrupted import SignalsLater

event.register("numba:compiler_lock", SignalsLater())  # type: ignore[no-untyped-call]

_PLAIN = (int, float, complex, str, bytes, bool, type(None))
_LOCK = ".limbcal.lock"


class KernelCache(FunctionCache):
    """Caches one kernel on disk, as long as it and all that is compiled into it stay the same.

    Parameters
    ----------
    kernel : callable
        The Python function.
    """

    def __init__(self, kernel: Callable[..., object]) -> None:
        super().__init__(kernel)  # type: ignore[no-untyped-call]
        self._stamped = False

    def load_overload(self, sig: object, target_context: object) -> object:
        """Return what was compiled for some types, or None.

        Machine code asks for the compiler's runtime alone. Its own cache fetches all that the compiler knows to
        compile as well, which takes a process longer than all else at its start.
        """
        self._stamp()
        rtsys.initialize(target_context)
        found: object = None
        with self._guard_against_spurious_io_errors():
            found = self._load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        return found

    def _save_overload(self, sig: object, data: object) -> None:
        self._stamp()
        self._impl.locator.ensure_cache_path()
        with (Path(self.cache_path) / _LOCK).open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            super()._save_overload(sig, data)  # type: ignore[no-untyped-call]

    def _stamp(self) -> None:
        """Make what the kernel refers to a part of its version; not before its module has been loaded.

        Of another version nothing is unpickled: that may name modules that are no longer there.
        """
        if not self._stamped:
            self._stamped = True
            file = self._cache_file
            file._version = (file._version, digest_of(self._py_func))  # noqa: SLF001 - numba's


def digest_of(kernel: Callable[..., object]) -> str:
    """Return a digest of a kernel, of all kernels that it calls and of the constants that they name."""
    digest = hashlib.sha256(Path(__file__).with_name("compiled.py").read_bytes())  # how all of them are compiled
    for part in _parts(kernel, set()):
        digest.update(part.encode())
        digest.update(b"\0")
    return digest.hexdigest()


def _parts(function: Callable[..., object], seen: set[int]) -> Iterator[str]:
    """Yield what a function is made of, then what it refers to, each function once."""
    code = getattr(function, "__code__", None)
    if code is None or id(code) in seen:
        return
    seen.add(id(code))
    yield function.__module__  # machine code names the modules that it was made of, and imports them
    yield from _of_code(code, getattr(function, "__doc__", None))
    for kind in getattr(function, "__annotations__", {}).values():  # what is handed to it has a module, too
        if isinstance(kind, type):
            yield from _of_value(kind, seen)
    known = {**function.__globals__}
    for name, cell in zip(code.co_freevars, getattr(function, "__closure__", None) or (), strict=False):
        known[name] = cell.cell_contents
    for name in sorted(_names(code)):
        if name in known:
            yield name
            yield from _of_value(known[name], seen)


def _of_value(value: Any, seen: set[int]) -> Iterator[str]:
    if isinstance(value, Dispatcher):
        yield from _parts(value.py_func, seen)
    elif isinstance(value, types.FunctionType):
        yield from _parts(value, seen)
    elif isinstance(value, _PLAIN):
        yield repr(value)
    elif isinstance(value, tuple | list | frozenset):
        for item in value:
            yield from _of_value(item, seen)
    elif isinstance(value, type):
        yield f"{value.__module__}.{value.__qualname__}{getattr(value, '_fields', '')}"
    elif hasattr(value, "tobytes") and hasattr(value, "dtype"):
        yield f"{value.dtype}{getattr(value, 'shape', ())}{hashlib.sha256(value.tobytes()).hexdigest()}"


def _of_code(code: types.CodeType, words: str | None = None) -> Iterator[str]:
    """Yield what code does; its words, the docstring, are no part of that."""
    yield code.co_code.hex()
    yield repr((code.co_names, code.co_varnames, code.co_freevars))
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _of_code(constant)
        else:
            yield repr(None if constant == words else constant)


def _names(code: types.CodeType) -> set[str]:
    """Return the names that a function or one within it looks up outside."""
    nested = (constant for constant in code.co_consts if isinstance(constant, types.CodeType))
    return {*code.co_names, *code.co_freevars}.union(*(_names(inner) for inner in nested))
