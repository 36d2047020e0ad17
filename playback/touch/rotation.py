"""Rotation matrices and rotation vectors (axis times angle), compiled."""

import math

from arm.model import Floats
from arm.triple import Triple
from limbcal.compiled import compiled


@compiled
def rotation_of(x: float, y: float, z: float, R: Floats) -> None:
    """Fill in the rotation about a vector by its length (Rodrigues)."""
    angle = math.sqrt(x * x + y * y + z * z)
    s = math.sin(angle) / angle if angle > 0.0 else 1.0
    half = math.sin(angle / 2.0) / (angle / 2.0) if angle > 0.0 else 1.0
    c = half * half / 2.0  # (1 - cos) / angle^2 without a difference of near numbers
    R[0, 0], R[0, 1], R[0, 2] = 1.0 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y
    R[1, 0], R[1, 1], R[1, 2] = c * x * y + s * z, 1.0 - c * (x * x + z * z), c * y * z - s * x
    R[2, 0], R[2, 1], R[2, 2] = c * x * z - s * y, c * y * z + s * x, 1.0 - c * (x * x + y * y)


@compiled
def rotation_vector(R: Floats) -> Triple:
    """Return axis times angle of a rotation, the angle from 0 to pi.

    By way of the quaternion, whose largest part is found first: no angle is a bad one.
    """
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    if trace > 0.0:
        w, x, y, z = 1.0 + trace, R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    elif R[0, 0] >= R[1, 1] and R[0, 0] >= R[2, 2]:
        w, x = R[2, 1] - R[1, 2], 1.0 + R[0, 0] - R[1, 1] - R[2, 2]
        y, z = R[0, 1] + R[1, 0], R[0, 2] + R[2, 0]
    elif R[1, 1] >= R[2, 2]:
        w, y = R[0, 2] - R[2, 0], 1.0 - R[0, 0] + R[1, 1] - R[2, 2]
        x, z = R[0, 1] + R[1, 0], R[1, 2] + R[2, 1]
    else:
        w, z = R[1, 0] - R[0, 1], 1.0 - R[0, 0] - R[1, 1] + R[2, 2]
        x, y = R[0, 2] + R[2, 0], R[1, 2] + R[2, 1]
    sine = math.sqrt(x * x + y * y + z * z)
    if sine == 0.0:
        return 0.0, 0.0, 0.0
    if w < 0.0:
        w, sine = -w, -sine
    scale = 2.0 * math.atan2(abs(sine), w) / sine
    return scale * x, scale * y, scale * z


@compiled
def turned_on(R: Floats, d: Floats, part: float, turn: Floats, out: Floats) -> None:
    """Fill in ``out`` with R turned by a part of the rotation vector ``d``; ``turn`` (3, 3) is room to work in."""
    rotation_of(part * d[0], part * d[1], part * d[2], turn)
    for row in range(3):
        for col in range(3):
            out[row, col] = turn[row, 0] * R[0, col] + turn[row, 1] * R[1, col] + turn[row, 2] * R[2, col]


@compiled
def turned_between(A: Floats, B: Floats, out: Floats) -> Triple:
    """Return the rotation vector of ``A B^T``, which is left in ``out``."""
    for row in range(3):
        for col in range(3):
            out[row, col] = A[row, 0] * B[col, 0] + A[row, 1] * B[col, 1] + A[row, 2] * B[col, 2]
    return rotation_vector(out)
