"""A whole person as a tree: pelvis, trunk with head, both legs and both arms.

The pelvis floats: three joints slide it along frame 0's axes (forward, left, up) and three turn it, and nothing
drives them. With all positions at zero a person stands upright, the middle between the hips' centres in frame 0's
origin. The pelvis turns about the vertical, then to a side (obliquity, positive with its left side up), then
forward (tilt): in this order (Baker 2001) gimbal lock is a pelvis that lies on its side, and standing, squatting
and sitting are far from it. The abdomen hangs on the pelvis at the lumbar joint: flexion, bending to the right,
turn to the left. Thorax and head flex on it a second time, where lumbar and thoracic spine meet. Legs and arms are
those of `arm.body.limbs`: a shank that turns under the knee, and arms from the thorax on: two joints of the girdle
carry the shoulder, for an arm that is raised takes its shoulder along by centimetres.

References
----------
Baker, Pelvic angles: a mathematically rigorous definition which is consistent with a conventional clinical
understanding of the terms. Gait & Posture 13 (2001).
Delp, Loan, Hoy, Zajac, Topp and Rosen, An interactive graphics-based model of the lower extremity. IEEE Trans.
Biomed. Eng. 37 (1990).
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from arm.body.landmarks import LimbMap, Part, landmark_places, limb_map
from arm.body.limbs import (
    BODY,
    DOWN,
    FORWARD,
    LEFT,
    MEAN_PERSON,
    UP,
    Axis,
    Plan,
    arm_plan,
    leg_plan,
    limb,
)
from arm.body.segments import Sex, above_hips_m, segment
from arm.kinematics import axis_frames
from arm.model import Arm, Body, Floats

SIDES = ("right", "left")
#: Half the distance of the hips' centres, and how far the lumbar joint is behind them, as shares of stature: those
#: of the model of Delp et al. (1990), a man of 1.80 m. A calibration replaces them.
_HALF_HIPS, _LUMBAR_BEHIND = 0.0835 / 1.80, 0.0300 / 1.80

#: Joints of the pelvis and of the trunk; ranges of the spine: American Academy of Orthopaedic Surgeons, Joint
#: Motion (1965), its flexion and extension divided as those of the lumbar spine are to the whole's, 60 of 105° and
#: 35 of 60° (Kapandji, The Physiology of the Joints 3, 1974).
_PELVIS = (
    Axis(FORWARD, False, None, slides=True),
    Axis(LEFT, False, None, slides=True),
    Axis(UP, False, None, slides=True),
    Axis(UP, False, None),
    Axis(FORWARD, False, None),
    Axis(LEFT, False, None),
)
_TRUNK = (
    Axis(LEFT, False, (-17.5, 45.7)),
    Axis(FORWARD, False, (-35.0, 35.0)),
    Axis(UP, False, (-45.0, 45.0)),
    Axis(LEFT, False, (-12.5, 34.3)),
)
#: Where the lumbar spine ends on the way from its lower end to the seventh cervical vertebra: 18 of 46 cm (Gray,
#: Anatomy of the Human Body, 1918).
_LUMBAR_SHARE = 18.0 / 46.0
_PELVIS_NAMES = ("forward", "left", "up", "rotation", "obliquity", "tilt")
_TRUNK_NAMES = ("lumbar_flexion", "lumbar_bending", "lumbar_rotation", "thoracic_flexion")
_LEG_NAMES = ("hip_flexion", "hip_abduction", "hip_rotation", "knee", "shank", "ankle", "subtalar")
_ARM_NAMES = (
    "girdle_protraction", "girdle_elevation", "shoulder_flexion", "shoulder_abduction", "shoulder_rotation",
    "elbow", "forearm", "wrist", "radial",
)  # fmt: skip


@dataclass(frozen=True)
class Branch:
    """Joints of the body that follow one another.

    Attributes
    ----------
    first : int
        The first joint, from 0.
    names : tuple of str
        Of its joints.
    where : LimbMap or None
        What `arm.body.landmarks` knows of the limb, its links counted from ``first``; None for pelvis and trunk.
    """

    first: int
    names: tuple[str, ...]
    where: LimbMap | None = None


#: Branches in the order of their joints.
BRANCHES: Mapping[str, Branch] = {
    "pelvis": Branch(0, tuple(f"pelvis_{name}" for name in _PELVIS_NAMES)),
    "trunk": Branch(6, _TRUNK_NAMES),
    **{
        f"{kind}_{side}": Branch(
            first + len(names) * k,
            tuple(f"{name}_{side}" for name in names),
            limb_map(f"human-{kind}-{side}", len(names)),
        )
        for kind, first, names in (("leg", 10, _LEG_NAMES), ("arm", 24, _ARM_NAMES))
        for k, side in enumerate(SIDES)
    },
}
PELVIS_LINK, ABDOMEN_LINK, THORAX_LINK = 5, 8, 9

#: Landmarks of thorax and pelvis: how far forward, outward (those at either side) and up they are of the middle
#: between the hips' centres [m], of a person of 1.741 m, about. Heights of the thorax: de Leva (1996); the front
#: of the pelvis: Delp et al. (1990); depths and breadths as grown-ups have them, assumed.
_MIDDLE_LANDMARKS = {
    "suprasternal_notch": (0.06, 0.532),
    "xiphoid": (0.10, 0.361),
    "c7": (-0.06, 0.603),
    "t8": (-0.11, 0.42),
    "t10": (-0.11, 0.36),
}
_PELVIS_LANDMARKS = {"asis": (0.071, 0.12, 0.066), "psis": (-0.09, 0.045, 0.08)}


@dataclass(frozen=True)
class BodyMap:
    """Which links of the body are which segments, and where its joints are; links and joints count from 0.

    Attributes
    ----------
    parts : mapping of str to Part
        By segment, named as marker sets do, and the abdomen, which none follows; ``begins`` and ``ends`` are keys
        of ``centres`` or ends.
    centres : mapping of str to int
        By joint, such as ``hip_right``: the joint whose joint-axis frame begins there with all positions at zero.
    balls : tuple of int
        First joints of those of three whose axes meet in one point.
    axes : mapping of str to int
        Joints whose axis anatomy names, such as ``knee_right``.
    joints : tuple of str
        The anatomical name of every joint.
    """

    parts: Mapping[str, Part]
    centres: Mapping[str, int]
    balls: tuple[int, ...]
    axes: Mapping[str, int]
    joints: tuple[str, ...]


def body_map() -> BodyMap:
    """Return the map of `human_body`."""
    parts = {
        "pelvis": Part(PELVIS_LINK, "pelvis", "lumbar"),
        "abdomen": Part(ABDOMEN_LINK, "lumbar", "thoracic"),
        "thorax": Part(THORAX_LINK, "thoracic", "vertex"),
    }
    centres, balls, axes = {"pelvis": 5, "lumbar": 6, "thoracic": 9}, [6], dict[str, int]()
    for branch in BRANCHES.values():
        where, k = branch.where, branch.first
        if where is not None:
            parts |= {
                name: Part(k + part.link, f"{part.begins}_{where.side}", f"{part.ends}_{where.side}")
                for name, part in where.parts.items()
            }
            centres |= {f"{name}_{where.side}": k + joint for name, joint in where.centres.items()}
            axes |= {f"{name}_{where.side}": k + joint for name, joint in where.axes.items()}
            balls += [k + ball for ball in where.balls]
    names = tuple(name for branch in BRANCHES.values() for name in branch.names)
    return BodyMap(parts, centres, tuple(balls), axes, names)


def human_body(body: Body) -> Arm:
    """Return a person: 42 joints, of which the first six carry the pelvis.

    Frame 0 is the world's; the segments' masses add up to the person's.

    Parameters
    ----------
    body : Body
        Whose; its preset is `BODY`.
    """
    sex: Sex = body.sex
    height = body.height_m
    lower, middle, upper, head = (
        segment(name, body.mass_kg, height, sex) for name in ("lower_trunk", "middle_trunk", "upper_trunk", "head")
    )
    down = np.column_stack([FORWARD, -LEFT, DOWN])
    waist = lower.length_m * UP
    notch = waist + (middle.length_m + upper.length_m) * UP
    vertex = (above_hips_m("c7", height, sex) + head.length_m) * UP
    lumbar = waist - _LUMBAR_BEHIND * height * FORWARD
    x, z = _MIDDLE_LANDMARKS["c7"]
    thoracic = _LUMBAR_SHARE * (height / MEAN_PERSON.height_m * (x * FORWARD + z * UP) - lumbar)
    pelvis = Plan(_PELVIS, 1.0, np.zeros((7, 3)), {5: [(lower, waist, down)]})
    trunk = Plan(
        _TRUNK,
        1.0,
        np.array([np.zeros(3), np.zeros(3), np.zeros(3), thoracic, thoracic]),
        {
            2: [(middle, waist + middle.length_m * UP - lumbar, down)],
            3: [(upper, notch - lumbar, down), (head, vertex - lumbar, down)],
        },
    )
    shoulders = above_hips_m("shoulders", height, sex) * UP
    joints = pelvis.joints(np.zeros(3), np.eye(3))
    frames = [*pelvis.lines(np.zeros(3)).frames(), *trunk.lines(lumbar).frames()]
    plans = {"trunk": (trunk, PELVIS_LINK, lumbar)}
    for side, sign in (("right", 1.0), ("left", -1.0)):
        hip = -sign * _HALF_HIPS * height * LEFT
        plans[f"leg_{side}"] = leg_plan(body, sign, shank_turns=True), PELVIS_LINK, hip
        plans[f"arm_{side}"] = arm_plan(body, sign, "thorax"), THORAX_LINK, shoulders
    for name in [*BRANCHES][1:]:
        plan, parent, start = plans[name]
        frame = frames[parent]
        x, y, z = _in_frame(frame, start).tolist()
        first, *others = plan.joints(start, frame[:3, :3])
        joints += [replace(first, parent=parent + 1, parent_position_m=(x, y, z)), *others]
    return Arm(name=body.preset, joints=tuple(joints), body=body)


def is_whole_body(arm: Arm) -> bool:
    """Return whether an arm has the joints of `human_body`; a file may have those of an earlier version."""
    return arm.name == BODY and arm.n_joint == len(body_map().joints)


def limb_of_body(person: Body, name: str) -> Arm:
    """Return a leg or an arm of the body by itself, such as that of the branch ``leg_right``."""
    return limb(replace(person, preset=f"human-{name.replace('_', '-')}"), "thorax", shank_turns=True)


def body_landmarks(arm: Arm) -> dict[str, tuple[int, Floats]]:
    """Return where bony landmarks are, about: starting values for a calibration and nothing more.

    Parameters
    ----------
    arm : Arm
        Of `human_body`.

    Returns
    -------
    mapping of str to (link, (3,) [m])
        The link, from 0, and the place in its joint-axis frame; off by about `arm.body.landmarks.LANDMARK_STD_M`
        at the limbs, and by twice that at the trunk.

    Raises
    ------
    ValueError
        If the arm does not say whose body it is.
    """
    if arm.body is None:
        raise ValueError(f"arm {arm.name!r} does not say whose body it is")
    scale, frames = arm.body.height_m / MEAN_PERSON.height_m, axis_frames(arm, np.zeros(arm.n_joint))[0]
    points = {name: (THORAX_LINK, x * FORWARD + z * UP) for name, (x, z) in _MIDDLE_LANDMARKS.items()}
    for name, (x, y, z) in _PELVIS_LANDMARKS.items():
        for side, sign in (("right", 1.0), ("left", -1.0)):
            points[f"{name}_{side}"] = PELVIS_LINK, x * FORWARD - sign * y * LEFT + z * UP
    places = {name: (link, _in_frame(frames[link], scale * at)) for name, (link, at) in points.items()}
    for name, branch in BRANCHES.items():
        if branch.where is None:
            continue
        own = limb_of_body(arm.body, name)
        for landmark, (link, at) in landmark_places(own, branch.where, arm.body.height_m).items():
            places[landmark] = branch.first + link, at
    return places


def _in_frame(frame: Floats, at: Floats) -> Floats:
    return np.asarray(frame[:3, :3].T @ (at - frame[:3, 3]))
