"""Two segments and a joint between them, with skin that moves coherently, for tests and for nothing else."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

Floats = NDArray[np.float64]

#: Where markers sit on the parent (a pelvis, or a thigh) and on the child, in their own frames, the joint at the
#: origin.
PARENT_M = np.array([[0.05, 0.09, 0.12], [0.04, 0.10, -0.13], [-0.14, 0.09, 0.05], [-0.15, 0.10, -0.05]])
CHILD_M = np.array([[0.05, -0.15, 0.06], [-0.03, -0.20, 0.08], [0.06, -0.26, 0.03], [0.02, -0.33, 0.07]])
RATE_HZ = 100.0


@dataclass(frozen=True)
class Limb:
    """Markers of both segments in the world, (n_frame, 4, 3) [m]; the parent's turn and the joint's centre."""

    parent_m: Floats
    child_m: Floats
    R: Floats
    p: Floats


def ball_angles(rng: np.random.Generator, n: int) -> Floats:
    """Star and circle: flexion, abduction and some turn, (n, 3) [rad]."""
    t = np.arange(n) / RATE_HZ
    phase = rng.uniform(0.0, 2.0 * np.pi, 3)
    slow = rng.uniform(0.05, 0.12, 2)
    heading = 2.0 * np.pi * slow[0] * t + phase[0]
    swing = np.radians(rng.uniform(25.0, 35.0)) * np.sin(2.0 * np.pi * 0.5 * t + phase[1])
    turn = np.radians(rng.uniform(3.0, 8.0)) * np.sin(2.0 * np.pi * slow[1] * t + phase[2])
    return np.column_stack([0.7 * swing * np.sin(heading), turn, swing * np.cos(heading)])


def hinge_angles(rng: np.random.Generator, n: int) -> Floats:
    """Bend and stretch, (n, 3) [rad]."""
    t = np.arange(n) / RATE_HZ
    bend = np.radians(rng.uniform(30.0, 45.0)) * (1.0 - np.cos(2.0 * np.pi * rng.uniform(0.3, 0.5) * t))
    return np.column_stack([np.zeros(n), np.zeros(n), bend])


def limb(
    angles: Floats,
    rng: np.random.Generator,
    *,
    skin_m: float = 0.004,
    skin_rad: float = 0.02,
    noise_m: float = 3e-4,
) -> Limb:
    """Simulate markers; skin shifts and turns each cluster as a whole, and each marker besides, over 0.3 s."""
    n = len(angles)
    sway = np.radians(8.0) * _wander(rng, n, 1.0, 3)
    R = Rotation.from_rotvec(sway) * Rotation.from_rotvec(rng.normal(size=3))
    p = 0.05 * _wander(rng, n, 1.5, 3) + rng.normal(size=3)
    child = R * Rotation.from_euler("ZXY", angles[:, [2, 0, 1]])
    return Limb(
        _markers(PARENT_M, R, p, rng, 0.5 * skin_m, 0.5 * skin_rad, noise_m),
        _markers(CHILD_M, child, p, rng, skin_m, skin_rad, noise_m),
        R.as_matrix(),
        p,
    )


def _markers(
    points: Floats,
    R: Rotation,
    p: Floats,
    rng: np.random.Generator,
    skin_m: float,
    skin_rad: float,
    noise_m: float,
) -> Floats:
    n = len(p)
    mean = points.mean(axis=0)
    shift = skin_m * _wander(rng, n, 0.3, 3)
    turned = Rotation.from_rotvec(skin_rad * _wander(rng, n, 0.3, 3)).as_matrix()
    own = 0.5 * skin_m * _wander(rng, n, 0.3, 3 * len(points)).reshape(n, len(points), 3)
    local = np.einsum("nij,mj->nmi", turned, points - mean) + mean + shift[:, None] + own
    return (
        np.einsum("nij,nmj->nmi", R.as_matrix(), local)
        + p[:, None]
        + noise_m * rng.normal(size=(n, len(points), 3))
    )


def _wander(rng: np.random.Generator, n: int, seconds: float, columns: int) -> Floats:
    """Return smooth noise of rms one, (n, columns)."""
    width = seconds * RATE_HZ
    smooth = gaussian_filter1d(rng.normal(size=(n + int(8 * width), columns)), width, axis=0)[int(4 * width) :][:n]
    return smooth * np.sqrt(2.0 * width * np.sqrt(np.pi))
