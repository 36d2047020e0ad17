"""One place that says how kernels are compiled."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import NDArray

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


def _borrow(_context: Any, array: Any) -> Any:
    """Leave out of an array whose memory it is."""

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        parts = cast(Any, cgutils).create_struct_proxy(array)(context, builder, arguments[0])
        for owner in ("meminfo", "parent"):
            kept = getattr(parts, owner)
            setattr(parts, owner, kept.type(None))
        return parts._getvalue()  # noqa: SLF001 - numba's own files call it so too

    return array(array), generate


#: Within a kernel: an array whose references nobody counts, nor those of its views. The counting is atomic, and
#: costs a kernel that looks at many small arrays most of its time. The caller must keep the array meanwhile.
borrowed = cast(Callable[[NDArray[Any]], NDArray[Any]], intrinsic(_borrow))
