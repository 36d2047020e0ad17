"""The rotations nearest to 3 × 3 matrices, by quaternions.

A rotation's quaternion q makes ``tr R^T D`` the quadratic form ``q^T N q`` of a symmetric 4 × 4 matrix that is
linear in D, so the nearest rotation is N's eigenvector with the largest eigenvalue, and never a mirror (B. K. P.
Horn, *Closed-form solution of absolute orientation using unit quaternions*, 1987).
"""

import numpy as np
from scipy.spatial.transform import Rotation

from arm.model import Floats


def nearest_rotations(D: Floats) -> Floats:
    """Return the rotations R that maximise ``tr R^T D`` for some matrices D, (n, 3, 3).

    Parameters
    ----------
    D : (n, 3, 3)
        Of a rank below two, several rotations are as near; one of them is returned.
    """
    trace = np.trace(D, axis1=1, axis2=2)
    axis = np.stack([D[:, 2, 1] - D[:, 1, 2], D[:, 0, 2] - D[:, 2, 0], D[:, 1, 0] - D[:, 0, 1]], axis=1)
    N = np.empty((len(D), 4, 4))
    N[:, :3, :3] = D + D.mT - trace[:, None, None] * np.eye(3)
    N[:, 3, :3] = N[:, :3, 3] = axis
    N[:, 3, 3] = trace
    _, vectors = np.linalg.eigh(N)
    return np.asarray(Rotation.from_quat(vectors[:, :, -1]).as_matrix(), dtype=np.float64)
