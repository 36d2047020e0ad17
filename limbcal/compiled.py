"""One place that says how kernels are compiled."""

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar, cast

import numba
from numba import carray, types  # type: ignore[attr-defined]
from numba.core import cgutils
from numba.core.ccallback import CFunc
from numba.extending import intrinsic, overload
from numpy.typing import NDArray

from limbcal.kernel_cache import KernelCache

Kernel = TypeVar("Kernel", bound=Callable[..., object])
Parts = TypeVar("Parts")


def compiled(kernel: Kernel) -> Kernel:
    """Compile a function of plain floats and arrays to machine code, cached on disk.

    Division by zero follows IEEE 754 (``error_model="numpy"``) and the order of additions is kept, so that
    the same input gives the same bytes. Other threads go on while a kernel runs.
    """
    return _kept(numba.njit(nogil=True, error_model="numpy")(kernel), kernel)


def inlined(kernel: Kernel) -> Kernel:
    """Compile as `compiled` does, into each of its callers: kernels that hand many arrays on cost them no time."""
    return _kept(numba.njit(nogil=True, error_model="numpy", forceinline=True)(kernel), kernel)


def c_function(function: Callable[..., float], kinds: Sequence[types.Type]) -> Callable[..., float]:
    """Compile a function of the types ``kinds`` that returns a float to a C function, cached as kernels are.

    Its ``address`` is what compiled code calls it by.
    """
    callback: Any = CFunc(function, (tuple(kinds), types.float64), {}, {})
    callback._cache = KernelCache(function)  # noqa: SLF001 - as its own `enable_caching` does
    callback.compile()
    return cast(Callable[..., float], callback)


def _kept(dispatcher: Any, kernel: Kernel) -> Kernel:
    """Return a dispatcher that keeps on disk what it compiles, and compiles no kernel for one value alone.

    A number that stands in a caller's source has a type of its own: for each of them the kernel, and all that it
    calls, would be compiled again.
    """
    dispatcher._cache = KernelCache(kernel)  # noqa: SLF001 - as its own `enable_caching` does
    resolve, widened = dispatcher.get_call_template, cast(Any, types).unliteral

    def of_any_value(arguments: tuple[Any, ...], by_name: dict[str, Any]) -> Any:
        return resolve(tuple(map(widened, arguments)), {name: widened(kind) for name, kind in by_name.items()})

    dispatcher.get_call_template = of_any_value
    return cast(Kernel, dispatcher)


def cut(array: NDArray[Any], start: int, shape: tuple[int, ...]) -> tuple[NDArray[Any], int]:
    """Return a part of a 1-D array from ``start`` on, as a view of some shape, and where the next part begins.

    In a kernel nobody counts references to it and to its views, nor looks whether it fits. Counting is atomic, and
    takes most of the time of a kernel that looks at many small arrays. The caller must keep the array meanwhile.
    """
    end = start + math.prod(shape)
    return array[start:end].reshape(shape), end


def _pointer(_context: Any, array: Any, start: Any) -> Any:
    """Point into an array."""

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        data = cast(Any, cgutils).create_struct_proxy(array)(context, builder, arguments[0]).data
        return builder.gep(data, [arguments[1]])

    return cast(Any, types).CPointer(array.dtype)(array, start), generate


_pointer_into = cast(Callable[[NDArray[Any], int], Any], intrinsic(_pointer))


@overload(cut)
def _cut(array: Any, start: Any, shape: Any) -> Any:
    def compiled_cut(array: Any, start: Any, shape: Any) -> Any:
        view = carray(_pointer_into(array, start), shape)
        return view, start + view.size

    return compiled_cut


def _without_owners(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    """Leave out of an array, or of all arrays in a tuple, whose memory it is."""
    if isinstance(kind, types.Array):
        array = cast(Any, cgutils).create_struct_proxy(kind)(context, builder, value)
        array.meminfo, array.parent = array.meminfo.type(None), array.parent.type(None)
        return array._getvalue()  # noqa: SLF001 - that is how numba's own files ask for it
    if isinstance(kind, types.BaseTuple):
        for k, each in enumerate(cast(Any, kind)):
            part = _without_owners(context, builder, each, builder.extract_value(value, k))
            value = builder.insert_value(value, part, k)
    return value


def _borrow(_context: Any, parts: Any) -> Any:
    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return _without_owners(context, builder, parts, arguments[0])

    return parts(parts), generate


#: For kernels: an array, or a tuple of such, to which nobody counts references. Its owner must keep it meanwhile.
borrowed = cast(Callable[[Parts], Parts], intrinsic(_borrow))
