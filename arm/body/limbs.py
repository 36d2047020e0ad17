"""A person's arms and legs as chains of eq. (1): their axes, ranges and segments.

A person stands upright with arms and hands hanging, palms to the thighs: there all joint positions are zero. The
base frame points forward (x), to the left (y) and up (z). Positive is, at either side: protraction, elevation,
flexion, abduction, internal rotation, pronation, radial deviation, dorsiflexion, inversion. The girdle carries no
mass: the tables count it to the trunk.
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from arm.axis_lines import AxisLines
from arm.body.segments import Segment, Sex, segment
from arm.model import Arm, Body, Floats

Girdle = Literal["thorax", "scapula"]

FORWARD, LEFT, UP = np.eye(3)
DOWN = -UP
#: Half the breadth of the shoulders, and height of the ankle above the sole, as shares of stature (Drillis and
#: Contini 1966, after Winter, Biomechanics and Motor Control of Human Movement, 2009, fig. 4.1).
_HALF_SHOULDERS, _ANKLE = 0.129, 0.039
#: Distance from heel to ankle as a ratio to the foot's length: assumed; a calibration replaces it.
_BEFORE_HEEL = 0.25
#: Sine of the angle between two axes from which on their common normal is where it is meant to be.
_MEETS = 0.5


@dataclass(frozen=True)
class _Axis:
    """One joint: its direction at the right side, what of it the left side mirrors, and its range [deg]."""

    direction: Floats
    turns_with_the_side: bool
    range_deg: tuple[float, float]


#: Ranges: Neumann, Kinesiology of the Musculoskeletal System (2010), for the girdle; American Academy of
#: Orthopaedic Surgeons, Joint Motion (1965), for all others.
_GIRDLE = (
    _Axis(UP, True, (-30.0, 30.0)),  # protraction
    _Axis(-FORWARD, True, (-10.0, 45.0)),  # elevation
)
_SHOULDER_TO_HAND = (
    _Axis(-LEFT, False, (-60.0, 180.0)),  # flexion of the shoulder
    _Axis(-FORWARD, True, (-75.0, 180.0)),  # abduction
    _Axis(UP, True, (-90.0, 70.0)),  # internal rotation
    _Axis(-LEFT, False, (0.0, 150.0)),  # flexion of the elbow
    _Axis(UP, True, (-80.0, 80.0)),  # pronation
    _Axis(FORWARD, True, (-70.0, 80.0)),  # flexion of the wrist
    _Axis(-LEFT, False, (-30.0, 20.0)),  # radial deviation
)
_HIP_TO_FOOT = (
    _Axis(-LEFT, False, (-30.0, 120.0)),  # flexion of the hip
    _Axis(-FORWARD, True, (-30.0, 45.0)),  # abduction
    _Axis(UP, True, (-45.0, 45.0)),  # internal rotation
    _Axis(LEFT, False, (0.0, 135.0)),  # flexion of the knee
    _Axis(-LEFT, False, (-50.0, 20.0)),  # dorsiflexion
    _Axis(FORWARD, True, (-15.0, 35.0)),  # inversion
)
#: Presets, and whose limb each is.
LIMBS = ("human-arm-right", "human-arm-left", "human-leg-right", "human-leg-left")
#: The mean man of the tables: what a preset is unless a person is given.
MEAN_PERSON = Body("human-arm-right", 73.0, 1.741, "m")


def limb(body: Body, girdle: Girdle = "thorax") -> Arm:
    """Return a person's arm or leg.

    Parameters
    ----------
    body : Body
        Whose; its preset is one of `LIMBS`.
    girdle : {"thorax", "scapula"}
        From where on an arm begins: two joints of the shoulder girdle, or none. A leg begins at the hip.
    """
    side = 1.0 if body.preset.endswith("right") else -1.0
    build = _arm if "arm" in body.preset else _leg
    axes, points, segments = build(body, side, girdle)
    directions = np.array([axis.direction * (side if axis.turns_with_the_side else 1.0) for axis in axes])
    lines = AxisLines(points, directions, _common_normals(directions))
    joints = [
        replace(joint, limits=tuple(np.deg2rad(axis.range_deg).tolist()))
        for joint, axis in zip(lines.joints(), axes, strict=True)
    ]
    frames = lines.frames()
    for k, (one, begin, along) in segments.items():
        joints[k] = replace(joints[k], link=one.link(begin, along, frames[k]))
    return Arm(name=body.preset, joints=tuple(joints), body=body)


def _common_normals(directions: Floats) -> Floats:
    """Return where the links' frames point that have no length, (n, 3): across to the next axis too.

    Then ``a`` is the distance of two axes that nearly meet, and can be learnt.
    """
    normals = np.tile(FORWARD, (len(directions), 1))
    for i, (z, after) in enumerate(pairwise(directions)):
        normal = np.cross(z, after)
        if np.linalg.norm(normal) > _MEETS:
            way = normal @ (FORWARD - 0.5 * UP + 0.25 * LEFT)  # of two, the one ahead, or down, or to the left
            normals[i] = normal / np.linalg.norm(normal) * np.sign(way)
    return normals


_Built = tuple[tuple[_Axis, ...], Floats, dict[int, tuple[Segment, Floats, Floats]]]


def _arm(body: Body, side: float, girdle: Girdle) -> _Built:
    upper, fore, hand = (_segment(body, name) for name in ("upper_arm", "forearm", "hand"))
    reach = _HALF_SHOULDERS * body.height_m if girdle == "thorax" else 0.0
    shoulder = -side * reach * LEFT
    elbow = shoulder + upper.length_m * DOWN
    wrist = elbow + fore.length_m * DOWN
    before = [np.zeros(3)] * 2 if girdle == "thorax" else []
    points = [*before, shoulder, shoulder, shoulder, elbow, elbow, wrist, wrist, wrist + hand.length_m * DOWN]
    along = np.column_stack([FORWARD, -LEFT, DOWN])
    n = len(before)
    segments = {n + 2: (upper, shoulder, along), n + 4: (fore, elbow, along), n + 6: (hand, wrist, along)}
    axes = (*(_GIRDLE if before else ()), *_SHOULDER_TO_HAND)
    return axes, np.array(points), segments


def _leg(body: Body, side: float, girdle: Girdle) -> _Built:
    thigh, shank, foot = (_segment(body, name) for name in ("thigh", "shank", "foot"))
    hip = np.zeros(3)
    knee = hip + thigh.length_m * DOWN
    ankle = knee + shank.length_m * DOWN
    heel = ankle + _ANKLE * body.height_m * DOWN - _BEFORE_HEEL * foot.length_m * FORWARD
    points = [hip, hip, hip, knee, ankle, ankle, heel + foot.length_m * FORWARD]
    along, forward = np.column_stack([FORWARD, -LEFT, DOWN]), np.column_stack([UP, -LEFT, FORWARD])
    # The foot's mass lies between ankle and sole.
    middle = heel + 0.5 * _ANKLE * body.height_m * UP
    segments = {2: (thigh, hip, along), 3: (shank, knee, along), 5: (foot, middle, forward)}
    return _HIP_TO_FOOT, np.array(points), segments


def _segment(body: Body, name: str) -> Segment:
    sex: Sex = body.sex
    return segment(name, body.mass_kg, body.height_m, sex)
