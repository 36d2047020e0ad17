"""A walking figure of rigid segments with markers, as a file would hold it."""

import numpy as np

from protocol.markers.recording import RawRecording

RATE_HZ = 100.0
#: Where each segment is [m], and how its markers sit on it.
SEGMENTS = {"head": (0.0, 1.7), "trunk": (0.0, 1.2), "thigh": (0.1, 0.7), "shank": (0.1, 0.3), "arm": (-0.3, 1.1)}
SITS = np.array([[0.12, 0.0, 0.0], [-0.07, 0.02, 0.01], [0.01, 0.05, 0.11], [0.0, -0.08, -0.04]])


def walking(seconds: float = 6.0, seed: int = 0) -> RawRecording:
    """Return markers of five segments that swing about their places, in metres, z up, without any damage."""
    rng = np.random.default_rng(seed)
    t = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    labels, paths = [], []
    for k, (name, (y, z)) in enumerate(SEGMENTS.items()):
        angle = 0.5 * np.sin(2.0 * np.pi * 0.9 * t + k)
        c, s = np.cos(angle), np.sin(angle)
        turn = np.stack([np.stack([c, 0 * c, s]), np.stack([0 * c, 0 * c + 1, 0 * c]), np.stack([-s, 0 * c, c])])
        place = np.stack([0.4 * t + 0.1 * s, 0 * t + y, 0 * t + z])
        for i, at in enumerate(SITS):
            labels.append(f"{name}{i + 1}")
            paths.append(np.einsum("abt,b->ta", turn, at) + place.T)
    points = np.stack(paths, axis=1) + 5e-4 * rng.normal(size=(len(t), len(labels), 3))
    return RawRecording("walking.trc", RATE_HZ, "m", tuple(labels), points, t, "+z")
