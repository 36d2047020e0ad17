"""One place that says how kernels are compiled."""

from collections.abc import Callable
from typing import TypeVar, cast

import numba

Kernel = TypeVar("Kernel", bound=Callable[..., object])


def compiled(kernel: Kernel) -> Kernel:
    """Compile a function of plain floats and arrays to machine code, cached on disk.

    Division by zero follows IEEE 754 (``error_model="numpy"``) and the order of additions is kept, so that
    the same input gives the same bytes. Other threads go on while a kernel runs.
    """
    return cast(Kernel, numba.njit(cache=True, nogil=True, error_model="numpy")(kernel))


def inlined(kernel: Kernel) -> Kernel:
    """Compile as `compiled` does, into each of its callers: kernels that hand many arrays on cost them no time."""
    return cast(Kernel, numba.njit(cache=True, nogil=True, error_model="numpy", forceinline=True)(kernel))
