"""Orientation of frame 0 in the segment that carries it: forward, left and up of the person, from markers.

A ball joint takes up whatever orientation frame 0 has, so this only says from where its angles count. Where the
motion comes near the posture in which two of its three axes fall together (gimbal lock), frame 0 is turned
away from it.
"""

from collections.abc import Sequence

import numpy as np

from arm.model import Floats
from fitter.limb.base_motion import BaseMotion
from fitter.limb.limb_trials import LimbTrials
from fitter.limb.nan_statistics import nan_mean, nan_median
from limbcal.note import Note

#: Landmarks in front and behind, and whose line points to the left, by segment.
_FRONT_AND_BACK = {
    "thorax": (("suprasternal_notch", "xiphoid"), ("c7", "t8", "t10")),
    "pelvis": (("asis_right", "asis_left"), ("psis_right", "psis_left")),
}
_ACROSS = {"thorax": ("acromion",), "pelvis": ("asis", "psis")}
#: Landmarks at the upper and the lower end of the thorax.
_TOP_AND_BOTTOM = (("suprasternal_notch", "c7"), ("xiphoid", "t8", "t10"))
#: Three directions that lie within 30° of one plane do not tell a person from a mirrored one: their unit vectors
#: span less than this volume.
_FLAT = 0.5
#: Who stands, squats or sits has pelvis and thorax inclined by less in the median frame [deg]; squats: 13.
_LIES_DEG = 60.0
#: A ball joint's middle axis is locked within this of a right angle [rad], in more than this fraction of frames.
_LOCK_RAD, _LOCKED_SHARE = np.radians(20.0), 0.01


def base_orientation(trials: LimbTrials, base: BaseMotion, side: str) -> tuple[Floats, tuple[Note, ...]]:
    """Return forward, left and up as columns, in the base segment's frame, (3, 3)."""
    up = _upright(trials, base)
    leftward = _leftward(trials, base)
    if leftward is None:
        leftward = _from_limb(trials, base, side)
    notes = []
    if up is None or leftward is None:
        what = " and ".join(name for name, found in (("up", up), ("left", leftward)) if found is None)
        notes.append(
            Note("base_axes", f"no landmark tells {what} of the base: its angles' zero is arbitrary there")
        )
    up = np.array([0.0, 0.0, 1.0]) if up is None else up
    leftward = np.eye(3)[int(np.argmin(np.abs(up)))] if leftward is None else leftward
    leftward = leftward - (leftward @ up) * up
    if np.linalg.norm(leftward) < 1e-6:
        leftward = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
    leftward = leftward / np.linalg.norm(leftward)
    return np.column_stack([np.cross(leftward, up), leftward, up]), (*notes, *against_landmarks(trials))


def against_landmarks(trials: LimbTrials) -> tuple[Note, ...]:
    """Say where a person's own directions contradict the recordings' axes: what points up, and right and left."""
    return (*upside_down(trials), *mirrored(trials))


def upside_down(trials: LimbTrials) -> tuple[Note, ...]:
    """Say where thorax or pelvis have up, by their own markers and the legs, far from the axis called up."""
    notes = []
    for segment in _FRONT_AND_BACK if trials.up else ():
        own = _own_up(trials, segment)
        if own is None:
            continue
        cosine = nan_median(own @ world_up(trials.up) / np.linalg.norm(own, axis=1))
        inclined = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))  # rounding takes it beyond 1
        if inclined > _LIES_DEG:
            text = (
                f"landmarks have up of the {segment} {inclined:.0f}° away from {trials.up} in the median frame: "
                f"the person lies, or {trials.up} does not point up; --up says which axis does"
            )
            notes.append(Note("up", text))
    return tuple(notes)


def mirrored(trials: LimbTrials) -> tuple[Note, ...]:
    """Say where thorax or pelvis have left opposite to up x forward, as no turn of a person brings about.

    Up is from the thorax' lower end to its upper, from the legs to the pelvis, else the world's.
    """
    notes = []
    for segment, (front, back) in _FRONT_AND_BACK.items():
        up, leftward = _up_in_world(trials, segment), _left_in_world(trials, segment)
        ahead = _between(_middle(trials, front), _middle(trials, back))
        if up is None or leftward is None or ahead is None:
            continue
        directions = np.stack(np.broadcast_arrays(up, ahead, leftward), axis=1)
        directions = directions / np.linalg.norm(directions, axis=2, keepdims=True)
        turned = np.einsum("ni,ni->n", np.cross(directions[:, 0], directions[:, 1]), directions[:, 2])
        if nan_median(turned) < -_FLAT:
            doubt = f", or {trials.up} does not point up" if len(up) == 1 else ""
            text = (
                f"landmarks have left of the {segment} to the right of up and forward: the recordings are "
                f"mirrored{doubt}. Most likely their axes were exported left-handed, or the labels or the marker "
                "set exchange right and left: export them with right-handed axes, or exchange the names in the "
                "marker set"
            )
            notes.append(Note("mirrored", text))
    return tuple(notes)


def _up_in_world(trials: LimbTrials, segment: str) -> Floats | None:
    """Return up by a segment's own landmarks, (n_frame, 3), else the world's, (1, 3)."""
    own = _own_up(trials, segment)
    return world_up(trials.up)[None] if own is None and trials.up else own


def _own_up(trials: LimbTrials, segment: str) -> Floats | None:
    """Return the way from the thorax' lower end to its upper, or from the legs to the pelvis, (n_frame, 3)."""
    if segment == "thorax":
        top, bottom = (_middle(trials, names) for names in _TOP_AND_BOTTOM)
    else:
        legs = [
            m for name, on in trials.segments.items() if name.startswith(("thigh", "shank", "foot")) for m in on
        ]
        top = _middle(trials, [name for group in _FRONT_AND_BACK[segment] for name in group])
        bottom = nan_mean(np.array([trials.of(m) for m in legs])) if legs else None
    return _between(top, bottom)


def _left_in_world(trials: LimbTrials, segment: str) -> Floats | None:
    """Return the way to the left, (n_frame, 3): between both sides, else from the spine to one acromion."""
    for name in _ACROSS[segment]:
        leftmost, rightmost = _middle(trials, [f"{name}_left"]), _middle(trials, [f"{name}_right"])
        across = _between(leftmost, rightmost)
        if across is not None:
            return across
        if segment == "thorax":
            spine = _middle(trials, [name for group in _FRONT_AND_BACK[segment] for name in group])
            return _between(spine, rightmost) if leftmost is None else _between(leftmost, spine)
    return None


def _middle(trials: LimbTrials, names: Sequence[str]) -> Floats | None:
    """Return the middle of those landmarks that there are, (n_frame, 3)."""
    marks = [trials.landmarks[name] for name in names if name in trials.landmarks]
    return nan_mean(np.array([seen_or_posed(trials, m) for m in marks])) if marks else None


def _between(end: Floats | None, begin: Floats | None) -> Floats | None:
    """Return the way from one point to another, (n_frame, 3); None where no frame has it."""
    if end is None or begin is None or not np.isfinite(end - begin).any():
        return None
    return np.asarray(end - begin)


def away_from_lock(long_axis: Floats, lateral: Floats) -> Floats | None:
    """Return another direction for a ball joint's first axis, where the limb's long axis comes near it; else None.

    Parameters
    ----------
    long_axis : (n_frame, 3)
        Of the segment after the joint, in the base segment's frame.
    lateral : (3,)
        The joint's first axis there.
    """
    limit = np.cos(_LOCK_RAD)
    if np.mean(np.abs(long_axis @ lateral) > limit) <= _LOCKED_SHARE:
        return None
    rng = np.random.default_rng(0)
    candidates = rng.normal(size=(800, 3))
    candidates /= np.linalg.norm(candidates, axis=1, keepdims=True)
    nearest = np.quantile(np.abs(candidates @ long_axis.T), 0.995, axis=1)
    free = nearest < max(np.cos(np.radians(35.0)), nearest.min() + 0.02)  # of those that stay clear
    best = np.flatnonzero(free)[int(np.argmax(np.abs(candidates[free] @ lateral)))]  # the one nearest to anatomy
    return np.asarray(candidates[best] * np.sign(candidates[best] @ lateral))


def _upright(trials: LimbTrials, base: BaseMotion) -> Floats | None:
    """Return up in the base segment: by the spine's landmarks, else by the world, in the mean of all frames."""
    marks = [[trials.landmarks[name] for name in names if name in trials.landmarks] for names in _TOP_AND_BOTTOM]
    if base.segment == "thorax" and all(marks):
        top, bottom = (nan_mean(np.array([_in_base(trials, base, m) for m in group])) for group in marks)
        if np.isfinite(top - bottom).all():
            return _unit(top - bottom)
    if not trials.up:
        return None
    return _unit(nan_mean(np.einsum("nji,j->ni", base.R, world_up(trials.up))))


def world_up(up: str) -> Floats:
    """Return the axis that points up, such as ``+y``, (3,); +z where it is unknown."""
    away = np.zeros(3)
    name = up or "+z"
    away["xyz".index(name[1])] = 1.0 if name[0] == "+" else -1.0
    return away


def _leftward(trials: LimbTrials, base: BaseMotion) -> Floats | None:
    pairs = ("asis", "psis", "acromion") if base.segment == "pelvis" else ("acromion", "asis", "psis")
    for name in pairs:
        right, leftward = (trials.landmarks.get(f"{name}_{side}") for side in ("right", "left"))
        if right and leftward:
            across = nan_median(_relative(trials, base, leftward) - _relative(trials, base, right))
            if np.isfinite(across).all():
                return _unit(across)
    front, back = (
        [trials.landmarks[name] for name in names if name in trials.landmarks]
        for names in _FRONT_AND_BACK["thorax"]
    )
    up = _upright(trials, base)
    if front and back and up is not None:
        ahead = nan_mean(np.array([_in_base(trials, base, m) for m in front]))
        ahead = ahead - nan_mean(np.array([_in_base(trials, base, m) for m in back]))
        if np.isfinite(ahead).all():
            return _unit(np.cross(up, ahead))
    return None


def _from_limb(trials: LimbTrials, base: BaseMotion, side: str) -> Floats | None:
    """Return left by the line of the elbow's or the knee's epicondyles, in the mean of the frames."""
    for lateral, medial in (
        ("lateral_epicondyle", "medial_epicondyle"),
        ("lateral_femoral_epicondyle", "medial_femoral_epicondyle"),
    ):
        marks = [trials.landmarks.get(f"{name}_{side}") for name in (lateral, medial)]
        if all(marks):
            out, inside = (_relative(trials, base, str(m)) for m in marks)
            across = nan_mean(inside - out if side == "right" else out - inside)
            if np.isfinite(across).all():
                return _unit(across)
    return None


def _relative(trials: LimbTrials, base: BaseMotion, marker: str) -> Floats:
    """Return a marker in the base segment's frame, (n_frame, 3), by its segment's pose where it has one."""
    return np.asarray(np.einsum("nji,nj->ni", base.R, seen_or_posed(trials, marker) - base.p))


def _in_base(trials: LimbTrials, base: BaseMotion, marker: str) -> Floats:
    """Return the median place of a marker in the base segment, (3,)."""
    return np.asarray(nan_median(_relative(trials, base, marker)))


def seen_or_posed(trials: LimbTrials, marker: str) -> Floats:
    """Return where a marker is in all frames, (n_frame, 3) [m]: by the pose of its segment where that is known."""
    y = trials.of(marker)
    for motion in trials.motions.values():
        if marker in motion.template.markers:
            place = motion.template.points_m[motion.template.markers.index(marker)]
            if np.isfinite(place).all():
                whole = motion.whole
                posed = np.einsum("nij,j->ni", whole.R, place) + whole.p
                return np.where(np.isfinite(posed), posed, y)
    return y


def _unit(x: Floats) -> Floats:
    return np.asarray(x / np.linalg.norm(x))
