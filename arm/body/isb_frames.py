"""Anatomical frames of segments, from bony landmarks and joints' centres: x forward, y up, z to the right.

As the International Society of Biomechanics recommends them (Wu et al., J. Biomech. 35 (2002) for leg and spine;
38 (2005) for the arm). The left side has the same frames; its angles are mirrored. Three differ, for want of
landmarks: the shank's torsional plane goes through the knee's centre, the hand stands for its third metacarpal,
and the foot's plane goes through heel and metatarsal heads (Leardini et al., Gait & Posture 25 (2007)).
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from arm.model import Floats

Points = Mapping[str, Floats]


def isb_frame(segment: str, points: Points) -> Floats:
    """Return a segment's anatomical frame, its axes as columns.

    Parameters
    ----------
    segment : str
        Such as ``thigh_right``.
    points : mapping of str to (3,)
        Landmarks and centres (``hip_right``, ``knee_right``, …) in one frame.

    Returns
    -------
    (3, 3)

    Raises
    ------
    KeyError
        If a landmark or centre is missing; it names it. Also for a segment that has no such frame.
    """
    kind, _, side = segment.rpartition("_") if segment.endswith(("_right", "_left")) else (segment, "", "")
    return _FRAMES[kind](points, side)


def _unit(x: Floats) -> Floats:
    return np.asarray(x / np.linalg.norm(x))


def _middle(points: Points, *names: str) -> Floats:
    return np.asarray(np.mean([points[name] for name in names], axis=0))


def _axes(x: Floats, y: Floats, z: Floats) -> Floats:
    return np.column_stack([x, y, z])


def _along(y: Floats, right: Floats) -> Floats:
    """Return the frame with this y whose z points as far to the right as that allows."""
    y = _unit(y)
    x = _unit(np.cross(y, right))
    return _axes(x, y, np.cross(x, y))


def _to_the_right(points: Points, side: str, lateral: str, medial: str) -> Floats:
    way = points[f"{lateral}_{side}"] - points[f"{medial}_{side}"]
    return way if side == "right" else -way


def _pelvis(points: Points, _side: str) -> Floats:
    z = _unit(points["asis_right"] - points["asis_left"])
    ahead = _middle(points, "asis_right", "asis_left") - _middle(points, "psis_right", "psis_left")
    x = _unit(ahead - (ahead @ z) * z)
    return _axes(x, np.cross(z, x), z)


def _thorax(points: Points, _side: str) -> Floats:
    y = _unit(_middle(points, "suprasternal_notch", "c7") - _middle(points, "xiphoid", "t8"))
    ahead = points["suprasternal_notch"] - points["c7"]
    z = _unit(np.cross(ahead, y))
    return _axes(np.cross(y, z), y, z)


def _upper_arm(points: Points, side: str) -> Floats:
    elbow = _middle(points, f"lateral_epicondyle_{side}", f"medial_epicondyle_{side}")
    right = _to_the_right(points, side, "lateral_epicondyle", "medial_epicondyle")
    return _along(points[f"shoulder_{side}"] - elbow, right)


def _forearm(points: Points, side: str) -> Floats:
    elbow = _middle(points, f"lateral_epicondyle_{side}", f"medial_epicondyle_{side}")
    right = _to_the_right(points, side, "radial_styloid", "ulnar_styloid")
    return _along(elbow - points[f"ulnar_styloid_{side}"], right)


def _hand(points: Points, side: str) -> Floats:
    wrist = _middle(points, f"radial_styloid_{side}", f"ulnar_styloid_{side}")
    heads = _middle(points, f"second_metacarpal_{side}", f"fifth_metacarpal_{side}")
    return _along(wrist - heads, _to_the_right(points, side, "second_metacarpal", "fifth_metacarpal"))


def _thigh(points: Points, side: str) -> Floats:
    knee = _middle(points, f"lateral_femoral_epicondyle_{side}", f"medial_femoral_epicondyle_{side}")
    right = _to_the_right(points, side, "lateral_femoral_epicondyle", "medial_femoral_epicondyle")
    return _along(points[f"hip_{side}"] - knee, right)


def _shank(points: Points, side: str) -> Floats:
    ankle = _middle(points, f"lateral_malleolus_{side}", f"medial_malleolus_{side}")
    z = _unit(_to_the_right(points, side, "lateral_malleolus", "medial_malleolus"))
    x = _unit(np.cross(points[f"knee_{side}"] - ankle, z))
    return _axes(x, np.cross(z, x), z)


def _foot(points: Points, side: str) -> Floats:
    heel = points[f"calcaneus_{side}"]
    x = _unit(_middle(points, f"first_metatarsal_{side}", f"fifth_metatarsal_{side}") - heel)
    right = _to_the_right(points, side, "fifth_metatarsal", "first_metatarsal")
    y = _unit(np.cross(right, x))
    return _axes(x, y, np.cross(x, y))


_FRAMES: Mapping[str, Callable[[Points, str], Floats]] = {
    "pelvis": _pelvis,
    "thorax": _thorax,
    "upper_arm": _upper_arm,
    "forearm": _forearm,
    "hand": _hand,
    "thigh": _thigh,
    "shank": _shank,
    "foot": _foot,
}
#: Segments that have an anatomical frame, without their side.
SEGMENTS: Sequence[str] = tuple(_FRAMES)
