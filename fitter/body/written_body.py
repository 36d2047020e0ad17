"""The calibrated person as an arm: a tree in the laboratory, its markers, and the table's masses."""

from dataclasses import replace

from arm.model import STANDARD_GRAVITY_M_S2, Arm, Body, Joint, Marker
from fitter.body.body_fit import BodyFit
from fitter.body.body_map import body_with_limbs
from fitter.body.derived_body import limb_geometry
from fitter.limb.base_orientation import world_up
from fitter.limb.bundle import wander
from fitter.limb.written_arm import joints_found, vector, with_masses


def calibrated_body(fit: BodyFit, body: Body | None) -> Arm:
    """Return the arm that a fit found: frame 0 is the laboratory's, the base floats by six joints.

    Parameters
    ----------
    fit : BodyFit
    body : Body, optional
        Without it the links have no masses.
    """
    bundle = fit.bundle
    joints = joints_found(fit.arm, bundle.geometry, fit.task.free, fit.errors)
    if body is not None:
        joints = _with_masses(fit, joints, body)
    std = wander(bundle, fit.task.frames)
    rows = zip(bundle.markers.names, bundle.markers.link, bundle.markers.place, std, strict=True)
    return Arm(
        name=fit.arm.name,
        joints=joints,
        body=body,
        gravity_m_s2=vector(-STANDARD_GRAVITY_M_S2 * world_up(fit.trials.up)),
        markers=tuple(Marker(name, int(link) + 1, vector(x), float(s)) for name, link, x, s in rows),
    )


def _with_masses(fit: BodyFit, joints: tuple[Joint, ...], body: Body) -> tuple[Joint, ...]:
    """Give the limbs the table's masses by the lengths that were found, pelvis and trunk those of the preset."""
    table, where = body_with_limbs(body)
    found = [replace(joint, link=own.link) for joint, own in zip(joints, table.joints, strict=True)]
    for limb in where.limbs:
        at = slice(limb.first, limb.first + limb.arm.n_joint)
        own = limb_geometry(fit.bundle.geometry, limb.first, limb.arm.n_joint)
        # its first axis as the limb by itself has it, from a frame that points forward, left and up
        own.numbers[0, [0, 3, 4]] = _first_axis(limb.arm)
        alone = replace(limb.arm, joints=own.joints(limb.arm))
        links = [joint.link for joint in with_masses(alone, limb.where, body)]
        found[at] = [replace(joint, link=link) for joint, link in zip(found[at], links, strict=True)]
    return tuple(found)


def _first_axis(arm: Arm) -> tuple[float, float, float]:
    joint = arm.joints[0]
    return joint.alpha_rad, joint.beta_rad, joint.theta_offset_rad
