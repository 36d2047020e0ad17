"""A person's arms and legs as chains of eq. (1): their axes, ranges and segments.

A person stands upright with arms and hands hanging, palms to the thighs: there all joint positions are zero. The
base frame points forward (x), to the left (y) and up (z). Positive is, at either side: protraction, elevation,
flexion, abduction, internal rotation, pronation, radial deviation, dorsiflexion, inversion. The girdle carries no
mass: the tables count it to the trunk.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from arm.axis_lines import AxisLines
from arm.body.segments import Segment, Sex, segment, together
from arm.model import Arm, Body, Floats, Joint

Girdle = Literal["thorax", "scapula"]

FORWARD, LEFT, UP = np.eye(3)
DOWN = -UP
#: Half the breadth of the shoulders, and height of the ankle above the sole, as shares of stature (Drillis and
#: Contini 1966, after Winter, Biomechanics and Motor Control of Human Movement, 2009, fig. 4.1).
HALF_SHOULDERS, _ANKLE = 0.129, 0.039
#: Distance from heel to ankle as a ratio to the foot's length: assumed; a calibration replaces it.
_BEFORE_HEEL = 0.25
#: Sine of the angle between two axes from which on their common normal is where it is meant to be.
_MEETS = 0.5


@dataclass(frozen=True)
class Axis:
    """One joint: its direction at the right side, whether the left side mirrors it, and its range [deg]."""

    direction: Floats
    turns_with_the_side: bool
    range_deg: tuple[float, float] | None
    slides: bool = False


#: Ranges: Neumann, Kinesiology of the Musculoskeletal System (2010), for the girdle; American Academy of
#: Orthopaedic Surgeons, Joint Motion (1965), for all others.
_GIRDLE = (
    Axis(UP, True, (-30.0, 30.0)),  # protraction
    Axis(-FORWARD, True, (-10.0, 45.0)),  # elevation
)
_SHOULDER_TO_HAND = (
    Axis(-LEFT, False, (-60.0, 180.0)),  # flexion of the shoulder
    Axis(-FORWARD, True, (-75.0, 180.0)),  # abduction
    Axis(UP, True, (-90.0, 70.0)),  # internal rotation
    Axis(-LEFT, False, (0.0, 150.0)),  # flexion of the elbow
    Axis(UP, True, (-80.0, 80.0)),  # pronation
    Axis(FORWARD, True, (-70.0, 80.0)),  # flexion of the wrist
    Axis(-LEFT, False, (-30.0, 20.0)),  # radial deviation
)
_HIP_TO_KNEE = (
    Axis(-LEFT, False, (-30.0, 120.0)),  # flexion of the hip
    Axis(-FORWARD, True, (-30.0, 45.0)),  # abduction
    Axis(UP, True, (-45.0, 45.0)),  # internal rotation
    Axis(LEFT, False, (0.0, 135.0)),  # flexion of the knee
)
#: Of the shank about its long axis: 40° with the knee bent by 90°, two thirds of them outwards (Mossberg and
#: Smith, J. Orthop. Sports Phys. Ther. 4, 1983).
_SHANK_ROTATION = Axis(UP, True, (-27.0, 13.0))  # internal rotation of the shank
_ANKLE_TO_FOOT = (
    Axis(-LEFT, False, (-50.0, 20.0)),  # dorsiflexion
    Axis(FORWARD, True, (-15.0, 35.0)),  # inversion
)
#: Presets, and whose limb each is.
BODY = "human-body"
LIMBS = ("human-arm-right", "human-arm-left", "human-leg-right", "human-leg-left")
#: The mean man of the tables: what a preset is unless a person is given.
MEAN_PERSON = Body("human-arm-right", 73.0, 1.741, "m")


def limb(body: Body, girdle: Girdle = "thorax", shank_turns: bool = False) -> Arm:
    """Return a person's arm or leg.

    Parameters
    ----------
    body : Body
        Whose; its preset is one of `LIMBS`.
    girdle : {"thorax", "scapula"}
        From where on an arm begins: two joints of the shoulder girdle, or none. A leg begins at the hip.
    shank_turns : bool
        Whether a leg's shank turns about its long axis under the knee, as a whole person's do.
    """
    side = 1.0 if body.preset.endswith("right") else -1.0
    plan = arm_plan(body, side, girdle) if "arm" in body.preset else leg_plan(body, side, shank_turns)
    return Arm(name=body.preset, joints=tuple(plan.joints(np.zeros(3), np.eye(3))), body=body)


@dataclass(frozen=True)
class Plan:
    """Joints one after the other, as anatomy has them, with all positions at zero.

    Attributes
    ----------
    axes : tuple of Axis
    side : float
        1 at the right, -1 at the left.
    points : (n + 1, 3) [m]
        A point on every axis from the first on, then the far end; forward, to the left, up.
    segments : mapping of int to (segments, begin, axes)
        By link, from 0: what it is made of, where those begin, and their axes as `Segment.link` takes them.
    """

    axes: tuple[Axis, ...]
    side: float
    points: Floats
    segments: Mapping[int, Sequence[tuple[Segment, Floats, Floats]]]

    def lines(self, start: Floats) -> AxisLines:
        """Return the axes as lines, the first point being at ``start``."""
        turns = [self.side if axis.turns_with_the_side else 1.0 for axis in self.axes]
        directions = np.array([axis.direction * turn for axis, turn in zip(self.axes, turns, strict=True)])
        return AxisLines(self.points + start, directions, _common_normals(directions))

    def joints(self, start: Floats, before: Floats) -> list[Joint]:
        """Return the joints, with ranges and masses.

        Parameters
        ----------
        start : (3,) [m]
            Where the first axis passes.
        before : (3, 3)
            The axes, as columns, of the link that the first joint hangs on.
        """
        lines = self.lines(start)
        joints, frames = lines.joints(before), lines.frames()
        for k, axis in enumerate(self.axes):
            limits = None if axis.range_deg is None else tuple(np.deg2rad(axis.range_deg).tolist())
            joints[k] = replace(joints[k], type="prismatic" if axis.slides else "revolute", limits=limits)
        for k, made_of in self.segments.items():
            links = [one.link(start + begin, axes, frames[k]) for one, begin, axes in made_of]
            joints[k] = replace(joints[k], link=links[0] if len(links) == 1 else together(links))
        return joints


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


def arm_plan(body: Body, side: float, girdle: Girdle) -> Plan:
    """Return a person's arm from the girdle, or the shoulder, on."""
    upper, fore, hand = (_segment(body, name) for name in ("upper_arm", "forearm", "hand"))
    reach = HALF_SHOULDERS * body.height_m if girdle == "thorax" else 0.0
    shoulder = -side * reach * LEFT
    elbow = shoulder + upper.length_m * DOWN
    wrist = elbow + fore.length_m * DOWN
    before = [np.zeros(3)] * 2 if girdle == "thorax" else []
    points = [*before, shoulder, shoulder, shoulder, elbow, elbow, wrist, wrist, wrist + hand.length_m * DOWN]
    along = np.column_stack([FORWARD, -LEFT, DOWN])
    n = len(before)
    segments = {n + 2: [(upper, shoulder, along)], n + 4: [(fore, elbow, along)], n + 6: [(hand, wrist, along)]}
    return Plan((*(_GIRDLE if before else ()), *_SHOULDER_TO_HAND), side, np.array(points), segments)


def leg_plan(body: Body, side: float, shank_turns: bool) -> Plan:
    """Return a person's leg from the hip on; `limb` says what the shank does."""
    thigh, shank, foot = (_segment(body, name) for name in ("thigh", "shank", "foot"))
    hip = np.zeros(3)
    knee = hip + thigh.length_m * DOWN
    ankle = knee + shank.length_m * DOWN
    heel = ankle + _ANKLE * body.height_m * DOWN - _BEFORE_HEEL * foot.length_m * FORWARD
    turning = [knee] if shank_turns else []
    points = [hip, hip, hip, knee, *turning, ankle, ankle, heel + foot.length_m * FORWARD]
    along, forward = np.column_stack([FORWARD, -LEFT, DOWN]), np.column_stack([UP, -LEFT, FORWARD])
    # The foot's mass lies between ankle and sole.
    middle = heel + 0.5 * _ANKLE * body.height_m * UP
    n = 3 + len(turning)
    segments = {2: [(thigh, hip, along)], n: [(shank, knee, along)], n + 2: [(foot, middle, forward)]}
    axes = (*_HIP_TO_KNEE, *([_SHANK_ROTATION] if turning else []), *_ANKLE_TO_FOOT)
    return Plan(axes, side, np.array(points), segments)


def _segment(body: Body, name: str) -> Segment:
    sex: Sex = body.sex
    return segment(name, body.mass_kg, body.height_m, sex)
