"""Unit quaternions (x, y, z, w), as glTF and Foxglove write them."""

import numpy as np

from playback.trajectory import Floats


def quaternions(rotations: Floats) -> Floats:
    """Return the quaternion of every rotation, each with the sign that is nearer to the one before it.

    Parameters
    ----------
    rotations : (n, 3, 3)

    Returns
    -------
    (n, 4)
        x, y, z, w. The first has w >= 0 or, where w is 0, any sign.
    """
    R = rotations
    trace = R[:, 0, 0] + R[:, 1, 1] + R[:, 2, 2]
    # squares of 2x, 2y, 2z, 2w; the largest is at least 1, so dividing by it is safe (Shepperd 1978)
    squares = np.stack([1.0 + 2.0 * R[:, i, i] - trace for i in range(3)] + [1.0 + trace], axis=1)
    products = np.empty((len(R), 4, 4))
    products[:, range(4), range(4)] = squares
    for i, j, sign in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        products[:, i, j] = products[:, j, i] = R[:, i, j] + R[:, j, i]
        products[:, sign, 3] = products[:, 3, sign] = R[:, j, i] - R[:, i, j]
    row = products[np.arange(len(R)), np.argmax(squares, axis=1)]
    q = row / np.linalg.norm(row, axis=1, keepdims=True)
    if q[0, 3] < 0.0:
        q[0] = -q[0]
    turns = np.where(np.sum(q[1:] * q[:-1], axis=1) < 0.0, -1.0, 1.0)
    q[1:] *= np.cumprod(turns)[:, None]
    return np.asarray(q)


def quaternion_between(start: Floats, end: Floats) -> Floats:
    """Return the shortest turn, (4,), that takes one direction (3,) to another."""
    a, b = start / np.linalg.norm(start), end / np.linalg.norm(end)
    if a @ b < -1.0 + 1e-12:  # any axis across will do
        across = np.cross(a, np.eye(3)[np.argmin(np.abs(a))])
        return np.append(across / np.linalg.norm(across), 0.0)
    turn = np.append(np.cross(a, b), 1.0 + a @ b)
    return np.asarray(turn / np.linalg.norm(turn))
