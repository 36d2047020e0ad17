"""Segments of simulated and of real recordings, and the joints' equations written out, for tests."""

import os
from pathlib import Path

import numpy as np
import pytest

from fitter.functional.segment_motion import SegmentMotion, segment_motion
from tests.fitter.functional.simulated_limb import Limb, ball_angles, hinge_angles, limb

KINDS = {"ball": ball_angles, "hinge": hinge_angles}
PARENT, CHILD = ("P1", "P2", "P3", "P4"), ("C1", "C2", "C3", "C4")


def simulated(kind: str, seed: int, n: int = 1500, trials: int = 1, **noise: float):
    """Return the limbs of some trials and both segments."""
    rng = np.random.default_rng(seed)
    limbs = [limb(KINDS[kind](rng, n), rng, **noise) for _ in range(trials)]
    return limbs, *segments(limbs)


def segments(limbs: list[Limb]) -> tuple[SegmentMotion, SegmentMotion]:
    return (
        segment_motion("thigh_right", PARENT, [x.parent_m for x in limbs]),
        segment_motion("shank_right", CHILD, [x.child_m for x in limbs]),
    )


def written_out(parent: SegmentMotion, child: SegmentMotion):
    """Return the matrix and right-hand side of SCoRE, frame under frame (Ehrig et al. 2006)."""
    rows, right = [], []
    for a, b in zip(parent.trials, child.trials, strict=True):
        for i in np.flatnonzero(a.valid & b.valid):
            rows.append(np.hstack([a.R[i], -b.R[i]]))
            right.append(b.p[i] - a.p[i])
    return np.vstack(rows), np.concatenate(right)


def recorded(path: str, markers: dict[str, list[str]]) -> dict[str, SegmentMotion]:
    """Return segments of a real recording; skips where there is none or nothing that reads it."""
    ezc3d = pytest.importorskip("ezc3d")
    folder = Path(os.environ.get("LIMBCAL_DATA", Path(__file__).parents[3] / ".." / "shared" / "data"))
    if not (folder / path).is_file():
        pytest.skip(f"no {path} in {folder}; LIMBCAL_DATA can name another folder")
    names, positions = read(ezc3d.c3d(str(folder / path)))
    return {
        segment: segment_motion(segment, listed, [positions[:, [names.index(m) for m in listed]]])
        for segment, listed in markers.items()
    }


def read(file) -> tuple[list[str], np.ndarray]:
    point = file["parameters"]["POINT"]
    positions = file["data"]["points"][:3].transpose(2, 1, 0).copy()
    positions[(positions == 0.0).all(axis=2)] = np.nan
    unit = {"mm": 1e-3, "m": 1.0}[point["UNITS"]["value"][0]]
    return point["LABELS"]["value"], positions * unit
