"""An arm as other programs have it: each joint placed in its parent, turning about its own z axis."""

from dataclasses import dataclass

import numpy as np

from arm.base_pose import base_in_segment, gravity_in_world
from arm.effects.effect_table import changed
from arm.kinematics import axis_frames
from arm.model import Arm, Floats

#: A standing arm's ground, a carried arm's segment, and its links, by name.
BASE = "base"


@dataclass(frozen=True)
class Placements:
    """Where an arm's joints are in the links before them, and what its links weigh.

    Attributes
    ----------
    frame_0 : (4, 4)
        Frame 0 in the world, or in the segment that carries it.
    joints : (n_joint, 4, 4)
        Each joint-axis frame at position zero in its parent's, or in frame 0.
    parents : tuple of int
        The link that each joint hangs on, counted from 1; 0 is what carries the arm.
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
    parents: tuple[int, ...]
    mass_kg: Floats
    centre_m: Floats
    inertia_kg_m2: Floats
    gravity_m_s2: Floats


def placements(arm: Arm) -> Placements:
    """Return an arm's placements; effects that are other numbers of it are put in."""
    arm = changed(arm)
    frames = np.concatenate([np.eye(4)[None], axis_frames(arm, np.zeros(arm.n_joint))[0]])
    frame_0 = np.eye(4)
    frame_0[:3, :3], frame_0[:3, 3] = base_in_segment(arm)
    mass = np.array([joint.link.mass_kg for joint in arm.joints])
    centre = np.array([joint.link.com_m for joint in arm.joints])
    inertia = np.array([_tensor(joint.link.inertia_kg_m2) for joint in arm.joints])
    square = np.einsum("ni,ni->n", centre, centre)[:, None, None] * np.eye(3)
    inertia = inertia - mass[:, None, None] * (square - np.einsum("ni,nj->nij", centre, centre))
    parents = tuple(parent + 1 for parent in arm.parents)
    local = np.linalg.inv(frames[list(parents)]) @ frames[1:]
    return Placements(frame_0, local, parents, mass, centre, inertia, gravity_in_world(arm))


def placed_on(placed: Placements, i: int) -> tuple[str, Floats]:
    """Return on what joint ``i`` (from 0) is placed and how, (4, 4); frame 0 is no body of its own."""
    parent = placed.parents[i]
    return link_name(parent), placed.joints[i] if parent else placed.frame_0 @ placed.joints[i]


def link_name(joint: int) -> str:
    """Return the name of a link by its joint, counted from 1; 0 is what carries the arm."""
    return f"link{joint}" if joint else BASE


def _tensor(six: tuple[float, ...]) -> Floats:
    xx, yy, zz, xy, xz, yz = six
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
