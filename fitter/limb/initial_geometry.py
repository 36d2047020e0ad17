"""Initial estimate for the bundle fit: lengths, frame 0, marker places and angles, from centres and landmarks.

The preset's chain gets the lengths that centres and landmarks have, follows them as if they were markers, and
takes along every marker where it then is, in the median of the frames.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.body.landmarks import LANDMARK_STD_M, LimbMap, centre_points, landmark_places, middle_of
from arm.kinematics import axis_frames
from arm.marker_kinematics import Integers
from arm.model import Arm, Floats
from fitter.functional.anatomy import LANDMARKS
from fitter.functional.pose_error import pose_covariance
from fitter.functional.rigid_fit import Poses
from fitter.limb.base_motion import BaseMotion
from fitter.limb.base_orientation import seen_or_posed
from fitter.limb.centres import Centre
from fitter.limb.free_geometry import CENTRE_M, LENGTH_SHARE, Geometry, geometry_of
from fitter.limb.inverse_kinematics import follow, link_poses
from fitter.limb.limb_trials import LimbTrials
from fitter.limb.marker_observations import SWAY, AnglePrior, Frames, MarkerModel, base_sways
from fitter.limb.nan_statistics import nan_mean, nan_median

#: How near to its centres the first angles bring the chain [m]; how well a length between two is known before the
#: bundle fit [m].
_NEAR_M, _LENGTH_M = 0.02, 0.015
#: How far a marker may be from where the start has it [m].
PLACE_STD_M = 0.05
#: How far skin lets a marker wander along an axis [m] (Leardini et al. 2005); what stands may sway by hardly
#: anything, and a small cluster far from the joint by no more than this [m].
_SKIN_M, _STANDS_M, _MOST_SWAY_M = 0.008, 1e-5, 0.02
#: Of a ball joint, and at the least of others [rad].
_BALL_STD_RAD, _LEAST_STD_RAD = 2.0, 0.5
#: Of where a floating base is in the laboratory [m].
_ANYWHERE_M = 10.0


@dataclass(frozen=True)
class Start:
    """Where the bundle fit begins.

    Attributes
    ----------
    geometry : Geometry
    centre_std_m : float
        How well frame 0's place is known.
    length_std_m : tuple of float
    angles : AnglePrior
    virtual : MarkerModel
        Centres and landmarks on the links.
    points : (n_frame, m, 3) [m]
        Where those were, in all frames.
    """

    geometry: Geometry
    centre_std_m: float
    length_std_m: tuple[float, ...]
    angles: AnglePrior
    virtual: MarkerModel
    points: Floats


def initial_geometry(
    arm: Arm,
    where: LimbMap,
    trials: LimbTrials,
    base: BaseMotion,
    axes: Floats,
    centres: dict[str, Centre],
    height_m: float,
) -> Start:
    """Return the start.

    Parameters
    ----------
    arm : Arm
        The preset.
    where : LimbMap
    trials : LimbTrials
    base : BaseMotion
    axes : (3, 3)
        Forward, left and up in the base segment.
    centres : mapping of str to Centre
    height_m : float
        Of the person, or of the mean one.
    """
    arm, length_std = with_lengths(arm, where, centres)
    origin, centre_std = _origin(where, trials, base, axes, centres, height_m)
    geometry = replace(geometry_of(arm), base_R=axes, base_p=origin)
    virtual, points = virtual_markers(arm, where, trials, centres, height_m)
    return Start(
        geometry, centre_std, length_std, angle_prior(arm, where, sway_std(base, origin)), virtual, points
    )


def sway_std(base: BaseMotion, at_m: Floats) -> float:
    """Return how far skin lets the base miss a joint at some place in its segment, along an axis [m]."""
    n = len(base.points_m)
    if n == 0:
        return _STANDS_M
    if n < 3:
        return _SKIN_M
    still = Poses(np.eye(3)[None], np.zeros((1, 3)), np.zeros((1, n, 3)))
    covariance = pose_covariance(base.points_m, still, at_m, _SKIN_M**2)[0]
    return min(float(np.sqrt(np.trace(covariance) / 3.0)), _MOST_SWAY_M)


def angle_prior(arm: Arm, where: LimbMap, sway_std_m: float) -> AnglePrior:
    """Return the prior of sway and angles: within the range of each joint, of a ball joint hardly any."""
    own = joint_prior(arm, where.balls)
    sway = np.zeros(SWAY)
    plain = AnglePrior(np.concatenate([sway, own.mean]), np.concatenate([sway + 1.0, own.information]))
    return base_sways(plain, sway_std_m)


def joint_prior(arm: Arm, balls: Sequence[int], n_floating: int = 0) -> AnglePrior:
    """Return the prior of angles without sway.

    Parameters
    ----------
    arm : Arm
    balls : sequence of int
        First joints, from 0, of ball joints.
    n_floating : int
        How many joints float: they may be anywhere.
    """
    mean, std = np.zeros(arm.n_joint), np.empty(arm.n_joint)
    for i, joint in enumerate(arm.joints):
        low, high = joint.limits or (-np.pi, np.pi)
        ball = any(first <= i < first + 3 for first in balls)
        mean[i] = 0.0 if ball else 0.5 * (low + high)
        std[i] = _BALL_STD_RAD if ball else max(0.5 * (high - low), _LEAST_STD_RAD)
        if i < n_floating:
            mean[i], std[i] = 0.0, _ANYWHERE_M if joint.type == "prismatic" else _BALL_STD_RAD
    return AnglePrior(mean, std**-2)


def first_angles(begin: Start, frames: Frames, rows: Integers, seed: int) -> Floats:
    """Return the angles that bring centres and landmarks nearest, (n_frame, n_joint); ``rows`` are the frames'."""
    virtual = frames._replace(y=np.ascontiguousarray(begin.points[rows]))
    return follow(begin.virtual.chain(begin.geometry), virtual, begin.virtual.std, begin.angles, seed)


def placed(begin: Start, names: tuple[str, ...], links: Integers, frames: Frames, q: Floats) -> Floats:
    """Return where markers are in their links in the median of the frames, (m, 3) [m]."""
    R, o = link_poses(begin.virtual.chain(begin.geometry), frames, q)
    places = np.empty((len(names), 3))
    for m, link in enumerate(links):
        local = np.einsum("nji,nj->ni", R[:, SWAY + link], frames.y[:, m] - o[:, SWAY + link])
        places[m] = nan_median(local)
    return places


def with_lengths(arm: Arm, where: LimbMap, centres: dict[str, Centre]) -> tuple[Arm, tuple[float, ...]]:
    """Give the preset the lengths that two centres in one segment have; return how well they are known [m]."""
    a, d = (np.array([getattr(j, name) for j in arm.joints]) for name in ("a_m", "d_m"))
    k = where.balls[0]
    stds = [LENGTH_SHARE * a[1]] if where.base == "thorax" else []
    long = [(s, p) for s, p in where.parts.items() if not s.startswith(("scapula", "hand", "foot"))]
    for segment, part in long:
        ends = [centres[c].in_segment_m.get(segment) if c in centres else None for c in (part.begins, part.ends)]
        near = part.begins in ("shoulder", "hip")
        hinged = segment.startswith("shank") and part.link == k + 3
        column, i = (a, k + 3) if hinged else (d, k + 2 if near else k + 4)
        if ends[0] is None or ends[1] is None:
            stds.append(LENGTH_SHARE * abs(column[i]))
            continue
        column[i] = np.sign(column[i]) * np.linalg.norm(ends[0] - ends[1])
        stds.append(_LENGTH_M)
    return arm.with_joints(a_m=a, d_m=d), tuple(stds)


def _origin(
    where: LimbMap, trials: LimbTrials, base: BaseMotion, axes: Floats, centres: dict[str, Centre], height_m: float
) -> tuple[Floats, float]:
    """Return frame 0's origin in the base segment, and how well it is known [m]."""
    first = next(iter(where.centres))
    world = centres[first].world_m if first in centres else {}
    if base.segment in world or (base.segment is None and world):
        local = np.einsum("nji,nj->ni", base.R, world.get(str(base.segment), next(iter(world.values()))) - base.p)
        return nan_median(local), centres[first].std_m
    scale = height_m / 1.741
    near = (
        ("acromion_" + where.side, np.array([0.0, 0.0, -0.045]), CENTRE_M),
        # the sternoclavicular joint beside the notch (Gray's Anatomy: the clavicle's end makes its side)
        ("suprasternal_notch", 0.025 * where.outward, CENTRE_M),
    )
    for landmark, away, std in near if first == "shoulder" else near[1:]:
        if landmark in trials.landmarks:
            at = seen_or_posed(trials, trials.landmarks[landmark])
            local = nan_median(np.einsum("nji,nj->ni", base.R, at - base.p))
            if np.isfinite(local).all():
                return local + scale * (axes @ away), std
    return _middle_of_child(where, trials, base), 4.0 * CENTRE_M


def _middle_of_child(where: LimbMap, trials: LimbTrials, base: BaseMotion) -> Floats:
    """Return the base's middle, drawn towards the first segment's markers, where nothing else is known."""
    first = next(s for s in where.parts if s.startswith(("upper_arm", "thigh")))
    y = nan_mean(np.stack([trials.of(m) for m in trials.segments[first]], axis=1), axis=1)
    local = nan_median(np.einsum("nji,nj->ni", base.R, y - base.p))
    return np.asarray(local if base.segment is None else 0.5 * local)


def virtual_markers(
    arm: Arm, where: LimbMap, trials: LimbTrials, centres: dict[str, Centre], height_m: float
) -> tuple[MarkerModel, Floats]:
    """Return centres and landmarks on their links, and where they were in all frames, (n_frame, m, 3).

    A body's limb of which nothing was recorded has none.
    """
    frames, points = axis_frames(arm, np.zeros(arm.n_joint))[0], centre_points(arm, where)
    names, links, places, stds, world = list[str](), list[int](), list[Floats](), list[float](), list[Floats]()

    def add(name: str, link: int, place: Floats, std: float, at: Floats) -> None:
        names.append(name)
        links.append(link)
        places.append(place)
        stds.append(std)
        world.append(at)

    for segment, part in where.parts.items():
        T = frames[part.link]
        for name, centre in centres.items():
            if segment in centre.world_m and name in (part.begins, part.ends):
                add(name, part.link, T[:3, :3].T @ (points[name] - T[:3, 3]), _NEAR_M, centre.world_m[segment])
    for landmark, (link, place) in landmark_places(arm, where, height_m).items():
        if link >= 0 and landmark in trials.landmarks:
            add(landmark, link, place, LANDMARK_STD_M, seen_or_posed(trials, trials.landmarks[landmark]))
    for segment, part in where.parts.items():
        marked = [name for name in names if LANDMARKS.get(name) == segment]
        if segment in trials.segments and not marked and segment.startswith(("hand", "foot", "forearm", "shank")):
            y = nan_mean(np.stack([seen_or_posed(trials, m) for m in trials.segments[segment]], axis=1), axis=1)
            add(segment, part.link, middle_of(arm, where, segment), 0.04, y)
    first = next(s for s in where.parts if s.startswith(("upper_arm", "thigh")))
    if not names and first in trials.segments:
        y = nan_mean(np.stack([trials.of(m) for m in trials.segments[first]], axis=1), axis=1)
        add(first, where.parts[first].link, middle_of(arm, where, first), 0.04, y)
    model = MarkerModel(
        tuple(names), np.array(links, dtype=np.int64), np.array(places).reshape(-1, 3), np.array(stds)
    )
    return model, np.stack(world, axis=1) if world else np.empty((len(trials.whole), 0, 3))
