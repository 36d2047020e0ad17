"""Products of simple functions of some variables: formulas that one factor makes a torque of.

They know what to expect where no trial was, if they are right, so they need the least data.
"""

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np

from arm.model import Floats
from fitter.diagnosis.functions import variable
from fitter.diagnosis.motion import Motion

_SHAPES: dict[str, Callable[[Floats], Floats]] = {
    "{}": lambda x: x,
    "sin({})": np.sin,
    "cos({})": np.cos,
    "{}^2": np.square,
    "{}^3": lambda x: x**3,
    "|{}|": np.abs,
    "{0}|{0}|": lambda x: x * np.abs(x),
}


def products(motion: Motion, some: Sequence[str]) -> Floats:
    """Return all products along a motion, (n_sample, n_product)."""
    columns = np.ones((len(motion.t), 1))
    for name in some:
        values = variable(motion, name)
        one = np.stack([_SHAPES[shape](values) for shape in _shapes(name)], axis=1)
        columns = (columns[:, :, None] * one[:, None, :]).reshape(len(columns), -1)
    return columns


def spelled(some: Sequence[str]) -> list[str]:
    """Return how they are written, in the same order."""
    choices = product(*([shape.format(name) for shape in _shapes(name)] for name in some))
    return [" ".join(parts) for parts in choices]


def _shapes(name: str) -> list[str]:
    return ["{}"] if name.startswith("sign(") else list(_SHAPES)
