"""Initial estimate of a whole person: the preset with the lengths that landmarks have, on pelvis and thorax.

Each limb begins as it does by itself (`fitter.limb.initial_geometry`). Pelvis and thorax stand in their markers as
the upright frames show them; hips and shoulders are then where centres and landmarks have them there.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from arm.body.limbs import MEAN_PERSON
from arm.body.whole_body import PELVIS_LINK, SIDES, body_landmarks, body_map
from arm.kinematics import axis_frames
from arm.marker_kinematics import HANG_X, A, D
from arm.model import Arm, Floats
from fitter.body.body_map import BodyLimbs, LimbOfBody
from fitter.body.stance import Stance
from fitter.functional.functional_centre import FunctionalCentre
from fitter.limb.base_orientation import seen_or_posed
from fitter.limb.centres import Centre, joint_centres
from fitter.limb.floating_base import FLOATING
from fitter.limb.free_geometry import CENTRE_M, FreeGeometry, Geometry, geometry_of, limb_rows, of_rows
from fitter.limb.initial_geometry import joint_prior, virtual_markers, with_lengths
from fitter.limb.limb_trials import LimbTrials
from fitter.limb.marker_observations import AnglePrior, MarkerModel
from fitter.limb.nan_statistics import nan_median
from limbcal.note import Note

#: How well a table has the joint between pelvis and thorax, and the acromion tells of the shoulder [m], assumed.
_TRUNK_M, _BELOW_ACROMION_M = 0.03, 0.02
#: How well a marker of pelvis or thorax is known in its segment once the stance is [m].
_CARRIED_M = 0.01
#: How far the acromion is above the shoulder's centre [m] of the mean person (`arm.body.landmarks`).
_ACROMION_M = 0.045
#: How far the sternoclavicular joint is beside the notch [m] (`fitter.limb.initial_geometry`).
_NOTCH_M = 0.025
#: A shoulder by motion is taken where its standard error is below this [m].
_SHOULDER_M = 0.015


@dataclass(frozen=True)
class BodyStart:
    """Where the fit of a whole person begins.

    Attributes
    ----------
    world : (3, 3)
        Forward, left and up of the person as columns, in the laboratory.
    geometry : Geometry
        Frame 0 is the laboratory's.
    free : FreeGeometry
    angles : AnglePrior
    virtual : MarkerModel
        Centres, landmarks, and the markers of pelvis and thorax, on their links.
    points : (n_frame, m, 3) [m]
        Where those were, in all frames.
    limbs : mapping of str to Arm
        Each limb's preset with the lengths that were found.
    functional : tuple of FunctionalCentre
    notes : tuple of Note
    """

    world: Floats
    geometry: Geometry
    free: FreeGeometry
    angles: AnglePrior
    virtual: MarkerModel
    points: Floats
    limbs: dict[str, Arm]
    functional: tuple[FunctionalCentre, ...]
    notes: tuple[Note, ...]


def initial_body(arm: Arm, where: BodyLimbs, trials: LimbTrials, stand: Stance, height_m: float) -> BodyStart:
    """Return the start.

    Parameters
    ----------
    arm : Arm
        The preset.
    where : BodyMap
    trials : LimbTrials
    stand : Stance
    height_m : float
    """
    zero = axis_frames(arm, np.zeros(arm.n_joint))[0]
    geometry = _in_laboratory(geometry_of(arm), zero, stand.world)
    numbers, hang = geometry.numbers, geometry.hang
    centres, functional, notes = dict[str, dict[str, Centre]](), list[FunctionalCentre](), list[Note]()
    for limb in where.limbs:
        found, by_motion, said = joint_centres(trials, limb.where)
        centres[limb.name] = found
        functional += by_motion
        notes += said
    trunk = _trunk(arm, where, trials, stand, zero, centres)
    rows: list[tuple[int, int, float]] = [(HANG_X + axis, where.lumbar, _TRUNK_M) for axis in range(3)]
    rows += [(D, where.lumbar + 2, _TRUNK_M), (A, where.lumbar + 2, _TRUNK_M)]  # the joint above it
    limbs = dict[str, Arm]()
    for limb in where.limbs:
        k, own = limb.first, limb.arm
        link, begins, std = where.links[limb.segment], zero[k, :3, 3], CENTRE_M
        found_at = (
            _hip(limb, centres) if limb.is_leg else _shoulder(limb, trials, stand, trunk, functional, height_m)
        )
        if found_at is not None:
            begins, std = trunk[limb.segment].to_body(found_at[0]), found_at[1]
        if found_at is not None and not limb.is_leg:
            own, begins = _on_the_girdle(own, begins, limb.where.outward)
        own, length_std = with_lengths(own, limb.where, centres[limb.name])
        limbs[limb.name] = own
        for i, joint in enumerate(own.joints):
            numbers[k + i, 1:3] = joint.a_m, joint.d_m
        hang[k] = [0.0, *(zero[link, :3, :3].T @ (begins - zero[link, :3, 3]))]
        rows += [(HANG_X + axis, k, std) for axis in range(3)]
        rows += limb_rows(limb.is_leg, k + limb.where.balls[0], length_std, lower_turns=True)
    virtual, points = _virtual(where, trials, zero, trunk, limbs, centres, height_m)
    angles = joint_prior(arm, body_map().balls, FLOATING)
    return BodyStart(
        stand.world, geometry, of_rows(rows), angles, virtual, points, limbs, tuple(functional), tuple(notes)
    )


@dataclass(frozen=True)
class _Carried:
    """Where a segment's frame stands in the preset with all joints at zero."""

    axes: Floats
    origin: Floats
    body_origin: Floats

    def to_body(self, x: Floats) -> Floats:
        return np.asarray((x - self.origin) @ self.axes + self.body_origin)

    def to_segment(self, x: Floats) -> Floats:
        return np.asarray(self.axes @ (x - self.body_origin) + self.origin)


def _trunk(
    arm: Arm,
    where: BodyLimbs,
    trials: LimbTrials,
    stand: Stance,
    zero: Floats,
    centres: dict[str, dict[str, Centre]],
) -> dict[str, _Carried]:
    """Return where pelvis and thorax stand in the preset: by the hips, and by the joint between them."""
    legs = [limb for limb in where.limbs if limb.is_leg]
    found = [
        centres[limb.name]["hip"].in_segment_m.get("pelvis") if "hip" in centres[limb.name] else None
        for limb in legs
    ]
    in_body = np.array([zero[limb.first, :3, 3] for limb in legs])
    hips = [x for x in found if x is not None]
    if len(hips) == len(legs):
        pelvis = _Carried(stand.axes["pelvis"], np.mean(hips, axis=0), in_body.mean(axis=0))
    else:
        pelvis = _Carried(stand.axes["pelvis"], *_middle_of_spines(arm, trials, zero))
    lumbar = zero[where.lumbar, :3, 3]
    world = trials.motions["pelvis"].whole.to_world(pelvis.to_segment(lumbar))
    local = trials.motions["thorax"].whole.to_segment(world)[stand.rows]
    return {"pelvis": pelvis, "thorax": _Carried(stand.axes["thorax"], nan_median(local), lumbar)}


def _middle_of_spines(arm: Arm, trials: LimbTrials, zero: Floats) -> tuple[Floats, Floats]:
    """Return the middle of two spines of the pelvis in its markers' frame, and in the preset's zero posture."""
    template, about = trials.motions["pelvis"].template, body_landmarks(arm)
    for name in ("asis", "psis"):
        both = [f"{name}_{side}" for side in SIDES]
        marks = [trials.landmarks.get(one) for one in both]
        if all(mark in template.markers for mark in marks):
            there = template.points_m[[template.markers.index(str(mark)) for mark in marks]]
            frames = [zero[about[one][0]] for one in both]
            places = [T[:3, :3] @ about[one][1] + T[:3, 3] for T, one in zip(frames, both, strict=True)]
            if np.isfinite(there).all():
                return there.mean(axis=0), np.mean(places, axis=0)
    return np.zeros(3), zero[PELVIS_LINK, :3, 3]


def _hip(limb: LimbOfBody, centres: dict[str, dict[str, Centre]]) -> tuple[Floats, float] | None:
    """Return a hip's centre in the pelvis' frame, and how well it is known along an axis [m]."""
    found = centres[limb.name].get("hip")
    at = None if found is None else found.in_segment_m.get("pelvis")
    return None if found is None or at is None else (at, found.std_m)


def _shoulder(
    limb: LimbOfBody,
    trials: LimbTrials,
    stand: Stance,
    trunk: dict[str, _Carried],
    functional: list[FunctionalCentre],
    height_m: float,
) -> tuple[Floats, float] | None:
    """Return a shoulder's centre in the thorax' frame, below the acromion or by motion, and its error.

    The acromion is first: a girdle that rises as the arm does takes the centre along, and what the arm then turns
    about in the thorax is centimetres beside it, the same in every part of the motion.
    """
    side, thorax = limb.where.side, trunk["thorax"]
    marker = trials.landmarks.get(f"acromion_{side}")
    if marker is not None:
        local = trials.motions["thorax"].whole.to_segment(seen_or_posed(trials, marker))[stand.rows]
        at = nan_median(local) - thorax.axes[:, 2] * _ACROMION_M * height_m / MEAN_PERSON.height_m
        if np.isfinite(at).all():
            return at, _BELOW_ACROMION_M
    for found in functional:
        if found.joint == f"shoulder_{side}" and not found.unobservable.any() and found.std_m < _SHOULDER_M:
            return found.in_parent_m, _SHOULDER_M
    return None


def _on_the_girdle(arm: Arm, shoulder: Floats, outward: Floats) -> tuple[Arm, Floats]:
    """Return an arm whose girdle reaches to a shoulder, and where its girdle begins: beside the notch."""
    aside = _NOTCH_M * outward
    begins = shoulder + aside - (shoulder @ outward) * outward
    a = np.array([joint.a_m for joint in arm.joints])
    a[1] = (shoulder - begins) @ outward
    return arm.with_joints(a_m=a), begins


def _in_laboratory(geometry: Geometry, zero: Floats, world: Floats) -> Geometry:
    """Return the preset turned so that frame 0 is the laboratory's: its first axis takes the turn up."""
    beta, alpha, theta = Rotation.from_matrix(world @ zero[0, :3, :3]).as_euler("YXZ")
    numbers = geometry.numbers.copy()
    numbers[0, [0, 3, 4]] = alpha, beta, theta
    return replace(geometry, numbers=numbers, hang=geometry.hang.copy())


def _virtual(
    where: BodyLimbs,
    trials: LimbTrials,
    zero: Floats,
    trunk: dict[str, _Carried],
    limbs: dict[str, Arm],
    centres: dict[str, dict[str, Centre]],
    height_m: float,
) -> tuple[MarkerModel, Floats]:
    names, links, places, stds, world = list[str](), list[int](), list[Floats](), list[float](), list[Floats]()
    for segment, link in ((name, where.links[name]) for name in ("pelvis", "thorax")):
        template = trials.motions[segment].template
        for name, x in zip(template.markers, template.points_m, strict=True):
            if np.isfinite(x).all():
                names.append(name)
                links.append(link)
                places.append(zero[link, :3, :3].T @ (trunk[segment].to_body(x) - zero[link, :3, 3]))
                stds.append(_CARRIED_M)
                world.append(trials.of(name))
    for limb in where.limbs:
        own, points = virtual_markers(limbs[limb.name], limb.where, trials, centres[limb.name], height_m)
        names += [f"{name}, {limb.name}" for name in own.names]
        links += [int(link) + limb.first for link in own.link]
        places += list(own.place)
        stds += own.std.tolist()
        world += list(np.moveaxis(points, 1, 0))
    model = MarkerModel(tuple(names), np.array(links, dtype=np.int64), np.array(places), np.array(stds), 0)
    return model, np.stack(world, axis=1)
