"""Torques with which a joint resists, as C functions that a compiled simulation calls by their address.

Every effect has a function of its own in its own file; the simulation is compiled once and knows none of them.
A call costs a few nanoseconds.
"""

from collections.abc import Callable, Sequence
from typing import Any, cast

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from arm.effects.effect import EffectKind
from arm.model import Floats
from limbcal.compiled import c_function, compiled

#: What a joint torque may depend on, in this order: the run's time [s], the joint's angle, velocity and direction
#: of motion (-1, 0 or 1), the torque that drives it, and its own viscous and Coulomb friction.
T, Q, DQ, DIRECTION, TAU, VISCOUS, COULOMB = range(7)
N_STATE = 7
#: No effect has more numbers a joint than this.
MOST_PARAMETERS = 5

#: A C function's argument; within it only single numbers can be asked for.
Numbers = Sequence[float]
_POINTER: Any = types.CPointer(types.float64)  # type: ignore[no-untyped-call]


def joint_torque(function: Callable[[Numbers, Numbers], float]) -> Callable[..., float]:
    """Compile ``function(x, p)`` to a C function; x holds the state as above, p the effect's parameters."""
    return c_function(function, (_POINTER, _POINTER))


def _call(_context: Any, address: Any, x: Any, p: Any) -> Any:
    """Call the C function at an address with pointers to two arrays of doubles."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        double = ir.DoubleType()
        function = ir.FunctionType(double, [double.as_pointer()] * 2)
        pointers = [
            cast(Any, cgutils).create_struct_proxy(kind)(context, builder, value).data
            for kind, value in zip(signature.args[1:], arguments[1:], strict=True)
        ]
        return builder.call(builder.inttoptr(arguments[0], function.as_pointer()), pointers)

    return types.float64(address, x, p), generate


_called = cast(Callable[[int, Floats, Floats], float], intrinsic(_call))


@compiled
def torque_at(address: int, x: Floats, p: Floats) -> float:
    """Return what the effect at an address makes of a state x (7,) and its parameters p (5,)."""
    return _called(address, x, p)


def torque_along(kind: EffectKind, parameters: Floats, states: Floats) -> Floats:
    """Return an effect's torque along a motion.

    Parameters
    ----------
    kind : EffectKind
        One that acts at a joint.
    parameters : (n_parameter,)
    states : (n_sample, 7)
        Columns as in `T`, `Q`, `DQ`, `DIRECTION`, `TAU`, `VISCOUS`, `COULOMB`.

    Returns
    -------
    (n_sample,) [N m or N]
        Counted as friction is: what the drive must supply on top of the rigid arm's torque.
    """
    return torques_along(kind, parameters[None], states)[:, 0]


def torques_along(kind: EffectKind, parameters: Floats, states: Floats) -> Floats:
    """Return the same for several sets of parameters (n_set, n_parameter), (n_sample, n_set)."""
    p, out = np.zeros((len(parameters), MOST_PARAMETERS)), np.empty((len(states), len(parameters)))
    p[:, : parameters.shape[1]] = parameters
    assert kind.torque is not None
    _along(kind.torque.address, np.ascontiguousarray(states), p, out)  # type: ignore[attr-defined]
    return out


@compiled
def _along(address: int, states: Floats, p: Floats, out: Floats) -> None:
    for k in range(out.shape[0]):
        for i in range(out.shape[1]):
            out[k, i] = torque_at(address, states[k], p[i])
