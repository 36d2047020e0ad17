"""Vectors as triples of numbers, which stay in registers where arrays would have to be made."""

from arm.model import Floats
from limbcal.compiled import compiled

Triple = tuple[float, float, float]


@compiled
def cross(a: Triple, b: Triple) -> Triple:
    """Return ``a x b``."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@compiled
def turned(R: Floats, a: Triple) -> Triple:
    """Return ``R a``."""
    return (
        R[0, 0] * a[0] + R[0, 1] * a[1] + R[0, 2] * a[2],
        R[1, 0] * a[0] + R[1, 1] * a[1] + R[1, 2] * a[2],
        R[2, 0] * a[0] + R[2, 1] * a[1] + R[2, 2] * a[2],
    )


@compiled
def turned_back(R: Floats, a: Triple) -> Triple:
    """Return ``R^T a``."""
    return (
        R[0, 0] * a[0] + R[1, 0] * a[1] + R[2, 0] * a[2],
        R[0, 1] * a[0] + R[1, 1] * a[1] + R[2, 1] * a[2],
        R[0, 2] * a[0] + R[1, 2] * a[1] + R[2, 2] * a[2],
    )
