"""An arm as other programs have it: each joint placed on the link it hangs on, turning about its own z axis."""

from dataclasses import dataclass

import numpy as np

from arm.effects.effect_table import changed
from arm.kinematics import axis_frames, rotation_from_rpy
from arm.model import Arm, Floats

#: A standing arm's ground, a carried arm's segment, and its links, by name.
BASE = "base"


@dataclass(frozen=True)
class Placements:
    """Where an arm's joints are on the links that they hang on, and what its links weigh.

    Attributes
    ----------
    frame_0 : (4, 4)
        Frame 0 in the world, or in the segment that carries it.
    joints : (n_joint, 4, 4)
        Each joint-axis frame at position zero in that of its parent, in frame 0 where it hangs on the base.
    mass_kg : (n_joint,)
    centre_m : (n_joint, 3)
        In the link's joint-axis frame.
    inertia_kg_m2 : (n_joint, 3, 3)
        About the centre of mass.
    gravity_m_s2 : (3,)
        In the world.
    """

    frame_0: Floats
    joints: Floats
    mass_kg: Floats
    centre_m: Floats
    inertia_kg_m2: Floats
    gravity_m_s2: Floats


def placements(arm: Arm) -> Placements:
    """Return an arm's placements; effects that are other numbers of it are put in."""
    arm = changed(arm)
    frames = np.concatenate([np.eye(4)[None], axis_frames(arm, np.zeros(arm.n_joint))[0]])
    frame_0 = np.eye(4)
    if arm.base is not None:
        frame_0[:3, :3] = rotation_from_rpy(*arm.base.rotation_rad)
        frame_0[:3, 3] = arm.base.position_m
    mass = np.array([joint.link.mass_kg for joint in arm.joints])
    centre = np.array([joint.link.com_m for joint in arm.joints])
    inertia = np.array([_tensor(joint.link.inertia_kg_m2) for joint in arm.joints])
    square = np.einsum("ni,ni->n", centre, centre)[:, None, None] * np.eye(3)
    inertia = inertia - mass[:, None, None] * (square - np.einsum("ni,nj->nij", centre, centre))
    gravity = np.array(arm.gravity_m_s2)
    if arm.base is None or arm.base.segment is None:  # of a base that stands it is given in frame 0
        gravity = frame_0[:3, :3] @ gravity
    before = frames[[parent + 1 for parent in arm.parents]]
    return Placements(frame_0, np.linalg.inv(before) @ frames[1:], mass, centre, inertia, gravity)


def link_name(joint: int) -> str:
    """Return the name of a link by its joint, counted from 1; 0 is what carries the arm."""
    return f"link{joint}" if joint else BASE


def is_carried(arm: Arm) -> bool:
    """Whether a tracked segment carries the arm, so that its base has six coordinates of its own."""
    return arm.base is not None and arm.base.segment is not None


def _tensor(six: tuple[float, ...]) -> Floats:
    xx, yy, zz, xy, xz, yz = six
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
