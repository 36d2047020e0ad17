"""biorbd's model file of an arm: a segment a link, turning about or sliding along z, with markers and masses."""

import numpy as np

from arm.base_pose import is_carried
from arm.model import Arm, Floats
from fitter.export.placements import BASE, link_name, placed_on, placements


def biomod_model(arm: Arm) -> str:
    """Return the text of a .bioMod file; the base of a carried arm has translations xyz and rotations xyz."""
    placed = placements(arm)
    lines = ["version 4", "", f"gravity {_row(placed.gravity_m_s2)}", "", f"segment {BASE}"]
    if is_carried(arm):
        lines += ["  translations xyz", "  rotations xyz"]
    lines += [*_mass(0.0, np.zeros(3), np.zeros((3, 3))), "endsegment", ""]
    for i, joint in enumerate(arm.joints):
        parent, at = placed_on(placed, i)
        low, high = joint.limits or ((-np.pi, np.pi) if joint.type == "revolute" else (-1.0, 1.0))
        kind = "rotations" if joint.type == "revolute" else "translations"
        lines += [
            f"segment {link_name(i + 1)}",
            f"  parent {parent}",
            "  RTinMatrix 1",
            "  RT",
            *(f"    {_row(row)}" for row in at),
            f"  {kind} z",
            "  rangesQ",
            f"    {low!r} {high!r}",
            *_mass(placed.mass_kg[i], placed.centre_m[i], placed.inertia_kg_m2[i]),
            "endsegment",
            "",
        ]
    for one in arm.markers:
        place = np.array(one.position_m)
        if one.joint == 0:  # frame 0 is no segment of its own
            place = placed.frame_0[:3, :3] @ place + placed.frame_0[:3, 3]
        lines += [
            f"marker {'_'.join(one.name.split())}",
            f"  parent {link_name(one.joint)}",
            f"  position {_row(place)}",
            "endmarker",
            "",
        ]
    return "\n".join(lines)


def _mass(mass_kg: float, centre_m: Floats, inertia: Floats) -> list[str]:
    rows = [f"    {_row(row)}" for row in inertia]
    return [f"  mass {float(mass_kg)!r}", f"  CenterOfMass {_row(centre_m)}", "  inertia", *rows]


def _row(values: Floats) -> str:
    return " ".join(repr(float(x)) for x in values)
