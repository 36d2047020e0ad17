"""Centres of joints from bony landmarks alone, by published regressions: rivals of the functional ones.

Each says how far off others found it, against images of the bones. All are of people on the average: none knows
this one.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from arm.body.tracked_segments import SIDES
from arm.model import Floats

_Landmarks = Mapping[str, Floats]


@dataclass(frozen=True)
class RegressionCentre:
    """A joint's centre from landmarks.

    Attributes
    ----------
    joint : str
        Such as ``hip_left``.
    method : str
        Such as ``harrington``.
    position_m : (n_frame, 3)
        In the world; NaN where a landmark was not seen.
    error_m : float
        Root mean square distance from the centre in images, as published; NaN where nothing is known.
    source : str
    """

    joint: str
    method: str
    position_m: Floats
    error_m: float
    source: str


#: Harrington et al. 2007, the equations of one variable each (abstract: "for single-variable regression, the
#: exclusion of leg length and pelvic depth from the latter two"): factor and constant [m] forward (of pelvic
#: depth), up and lateral (of pelvic width). Digits as in two independent programs that cite the paper, whose
#: table we have not seen.
_HARRINGTON_FORWARD = (-0.24, -9.9e-3)
_HARRINGTON_UP = (-0.30, -10.9e-3)
_HARRINGTON_LATERAL = (0.33, 7.3e-3)
#: Mantovani et al. 2016 (abstract): 12.3 ± 5.9 mm from the centre in CT, 67 people; sqrt(12.3² + 5.9²).
_HARRINGTON_ERROR_M = 13.6e-3
#: Bell, Pedersen, Brand 1990: forward, up and lateral from the middle of the ASIS, of the distance between them;
#: digits as in the manual of Visual3D. Up and lateral are those of Bell et al. 1989 (abstract: 30 % distal, 14 %
#: medial of the ASIS, hence 36 % lateral of the middle), whose 22 % posterior the later paper made 19 %.
_BELL = (-0.19, -0.30, 0.36)
#: Bell et al. 1990, mean distance from the centre in X-rays, as programs that cite it hand it on.
_BELL_ERROR_M = 19.0e-3


def regression_centres(landmarks_m: Mapping[str, Floats]) -> list[RegressionCentre]:
    """Return every centre that the landmarks allow.

    Parameters
    ----------
    landmarks_m : mapping of str to (n_frame, 3)
        Positions in the world by the names of `fitter.functional.anatomy`, NaN where a landmark was not seen.
    """
    found: list[RegressionCentre] = []
    for side in SIDES:
        for joint, method, needed, centre, error_m, source in _RIVALS:
            if all(name.format(side=side) in landmarks_m for name in needed):
                at = centre(landmarks_m, side)
                found.append(RegressionCentre(f"{joint}_{side}", method, at, error_m, source))
    return found


def pelvis_axes(landmarks_m: Mapping[str, Floats]) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the pelvis by its four spines (Wu et al. 2002).

    Returns
    -------
    R : (n_frame, 3, 3)
        Forward, up and right as columns.
    origin : (n_frame, 3)
        The middle of the anterior spines.
    width, depth : (n_frame,)
        Between the anterior spines; from their middle to that of the posterior ones.
    """
    right, left = landmarks_m["asis_right"], landmarks_m["asis_left"]
    front, back = 0.5 * (right + left), 0.5 * (landmarks_m["psis_right"] + landmarks_m["psis_left"])
    z = _unit(right - left)
    y = _unit(np.cross(z, front - back))
    x = np.cross(y, z)
    width, depth = np.linalg.norm(right - left, axis=1), np.linalg.norm(front - back, axis=1)
    return np.stack([x, y, z], axis=2), front, width, depth


def _harrington(landmarks: _Landmarks, side: str) -> Floats:
    R, origin, width, depth = pelvis_axes(landmarks)
    forward, up, lateral = (
        factor * size + constant
        for size, (factor, constant) in (
            (depth, _HARRINGTON_FORWARD),
            (width, _HARRINGTON_UP),
            (width, _HARRINGTON_LATERAL),
        )
    )
    at = np.column_stack([forward, up, _to_side(lateral, side)])
    return np.asarray(origin + np.einsum("nij,nj->ni", R, at))


def _bell(landmarks: _Landmarks, side: str) -> Floats:
    R, origin, width, _ = pelvis_axes(landmarks)
    forward, up, lateral = _BELL
    at = np.column_stack([forward * width, up * width, _to_side(lateral * width, side)])
    return np.asarray(origin + np.einsum("nij,nj->ni", R, at))


def _middle(first: str, second: str) -> Callable[[_Landmarks, str], Floats]:
    return lambda landmarks, side: 0.5 * (landmarks[f"{first}_{side}"] + landmarks[f"{second}_{side}"])


_PELVIS = ("asis_right", "asis_left", "psis_right", "psis_left")
_ISB = "Wu et al. 2002, 2005 (ISB)"

#: Joint, method, the landmarks it needs, how it is computed, its published error [m], its source.
_RIVALS: tuple[tuple[str, str, tuple[str, ...], Callable[[_Landmarks, str], Floats], float, str], ...] = (
    ("hip", "harrington", _PELVIS, _harrington, _HARRINGTON_ERROR_M, "Harrington et al. 2007"),
    ("hip", "bell", _PELVIS, _bell, _BELL_ERROR_M, "Bell et al. 1990"),
    *(
        (joint, "middle", (f"{first}_{{side}}", f"{second}_{{side}}"), _middle(first, second), np.nan, _ISB)
        for joint, first, second in (
            ("knee", "lateral_femoral_epicondyle", "medial_femoral_epicondyle"),
            ("ankle", "lateral_malleolus", "medial_malleolus"),
            ("elbow", "lateral_epicondyle", "medial_epicondyle"),
            ("wrist", "radial_styloid", "ulnar_styloid"),
        )
    ),
)


def _to_side(lateral: Floats, side: str) -> Floats:
    return lateral if side == "right" else -lateral


def _unit(x: Floats) -> Floats:
    return np.asarray(x / np.linalg.norm(x, axis=1, keepdims=True))
