"""The calibrated limb as an arm: its geometry, base, markers, and the table's masses where the person is known."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from arm.body.landmarks import LimbMap, centre_points
from arm.body.limbs import FORWARD, leg_plan
from arm.body.segments import SEGMENTS, segment
from arm.kinematics import axis_frames, rpy_from_rotation
from arm.model import STANDARD_GRAVITY_M_S2, Arm, Base, Body, Floats, Joint, Link, Marker, Vector3
from fitter.limb.base_motion import markers_in
from fitter.limb.base_orientation import world_up
from fitter.limb.bundle import wander
from fitter.limb.free_geometry import FreeGeometry, Geometry
from fitter.limb.inverse_kinematics import link_poses
from fitter.limb.limb_fit import LimbFit
from fitter.limb.marker_observations import SWAY
from fitter.limb.nan_statistics import nan_median
from fitter.limb.uncertainty import Errors


def calibrated_arm(fit: LimbFit, body: Body | None) -> Arm:
    """Return the arm that a fit found.

    Parameters
    ----------
    fit : LimbFit
    body : Body, optional
        Without it the links have no masses.
    """
    geometry, bundle = fit.bundle.geometry, fit.bundle
    joints = joints_found(fit.arm, geometry, fit.free, fit.errors)
    arm = Arm(name=fit.arm.name, joints=joints, body=body, gravity_m_s2=_gravity(fit))
    if body is not None:
        arm = replace(arm, joints=with_masses(arm, fit.where, body))
    base_rpy = rpy_from_rotation(geometry.base_R)
    base = Base(vector(geometry.base_p), vector(base_rpy), fit.base.segment)
    std = wander(bundle, fit.task.frames)
    carried = markers_in(fit.base.points_m, geometry.base_R, geometry.base_p)
    markers = [
        Marker(name, 0, vector(x), fit.base_std_m) for name, x in zip(fit.base.markers, carried, strict=True)
    ]
    markers += [
        Marker(name, int(link) + 1, vector(x), float(s))
        for name, link, x, s in zip(
            bundle.markers.names, bundle.markers.link, bundle.markers.place, std, strict=True
        )
    ]
    markers += _computed(fit)
    return replace(arm, base=base, markers=with_landmarks(markers, fit.trials.landmarks))


def with_landmarks(markers: Sequence[Marker], landmarks: Mapping[str, str]) -> tuple[Marker, ...]:
    """Return markers that say which landmark they are on; ``landmarks`` are markers' names by theirs."""
    is_on = {marker: landmark for landmark, marker in landmarks.items()}
    return tuple(replace(marker, landmark=is_on.get(marker.name)) for marker in markers)


def joints_found(arm: Arm, geometry: Geometry, free: FreeGeometry, errors: Errors) -> tuple[Joint, ...]:
    """Return a preset's joints with the numbers that were found, lengths with their errors, without masses."""
    joints = [replace(joint, link=Link()) for joint in geometry.joints(arm)]
    for name, k in (("d", 2), ("a", 1)):
        for i, joint in enumerate(joints):
            label = f"{name}{i + 1}"
            if label in free.names and abs(geometry.numbers[i, k]) > 0.1:
                joints[i] = replace(joint, length_std_m=float(errors.free_std[free.names.index(label)]))
    return tuple(joints)


def _gravity(fit: LimbFit) -> Vector3:
    """Return gravity by the axis that points up in the recordings: in the world, or in a frame 0 that stands."""
    if not fit.trials.up:
        return (0.0, 0.0, -STANDARD_GRAVITY_M_S2)
    world = -STANDARD_GRAVITY_M_S2 * world_up(fit.trials.up)
    return vector(world if fit.base.segment else fit.bundle.geometry.base_R.T @ world)


def _computed(fit: LimbFit) -> list[Marker]:
    """Return bony points that recordings compute, where the links have them in the median of the fit's frames."""
    found = []
    chain = fit.bundle.markers.chain(fit.bundle.geometry)
    frames, usable = fit.frames_of_fit()
    R, o = link_poses(chain, frames, fit.bundle.q)
    for segment_name, part in fit.where.parts.items():
        for name in fit.trials.segments.get(segment_name, ()):
            if name not in fit.trials.computed:
                continue
            y = fit.trials.of(name)[usable]
            i = SWAY + part.link
            place = nan_median(np.einsum("nji,nj->ni", R[:, i], y - o[:, i]))
            scatter = np.einsum("nji,nj->ni", R[:, i], y - o[:, i]) - place
            if np.isfinite(place).all():
                std = float(np.sqrt(np.nanmean(scatter**2)))
                found.append(Marker(name, part.link + 1, vector(place), std))
    return found


def with_masses(arm: Arm, where: LimbMap, body: Body) -> tuple[Joint, ...]:
    """Return the joints with the table's masses, in the frames and lengths that were found."""
    frames, centres = axis_frames(arm, np.zeros(arm.n_joint))[0], centre_points(arm, where)
    joints = list(arm.joints)
    for name, part in where.parts.items():
        kind = name.rpartition("_")[0]
        if kind not in SEGMENTS:
            continue
        own = segment(kind, body.mass_kg, body.height_m, body.sex)
        begin, end = centres[part.begins], centres[part.ends]
        length = float(np.linalg.norm(end - begin))
        if kind not in ("hand", "foot"):  # the ends of those are the table's, not found
            scale = length / own.length_m
            inertia = own.inertia_kg_m2
            own = replace(
                own,
                length_m=length,
                centre_m=own.centre_m * scale,
                inertia_kg_m2=(inertia[0] * scale**2, inertia[1] * scale**2, inertia[2]),
            )
        axes = _axes_along(end - begin)
        if kind == "foot":  # the table's begins at the heel
            plan = leg_plan(body, 1.0, shank_turns=False)
            ((_, heel, along_sole),) = plan.segments[max(plan.segments)]
            ankle, toes = plan.points[-2:]
            turn = axes @ _axes_along(toes - ankle).T
            begin, axes = begin + turn @ (heel - ankle), turn @ along_sole
        joints[part.link] = replace(joints[part.link], link=own.link(begin, axes, frames[part.link]))
    return tuple(joints)


def _axes_along(way: Floats) -> Floats:
    """Return sagittal, transverse and longitudinal axis as columns of what reaches along a way, (3, 3)."""
    along = way / np.linalg.norm(way)
    forward = FORWARD if abs(along @ FORWARD) < 0.7 else np.array([0.0, 0.0, 1.0])
    sagittal = forward - (forward @ along) * along
    sagittal /= np.linalg.norm(sagittal)
    return np.column_stack([sagittal, np.cross(along, sagittal), along])


def vector(x: Floats) -> Vector3:
    """Return three numbers as an arm has them."""
    return (float(x[0]) + 0.0, float(x[1]) + 0.0, float(x[2]) + 0.0)  # never a zero with a sign
