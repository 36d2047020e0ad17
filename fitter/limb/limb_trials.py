"""Recordings of one person, sorted into the segments of one limb."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.body.landmarks import LimbMap
from arm.model import Floats
from fitter.functional.anatomy import LANDMARKS
from fitter.functional.draft_marker_set import distance_scatter
from fitter.functional.marker_set import MarkerSet
from fitter.functional.marker_set_fit import built_in_advice, fit_marker_set
from fitter.functional.segment_motion import SegmentMotion, segment_motion
from limbcal.errors import DataError
from limbcal.note import Note
from protocol.markers.recording import MarkerRecording

#: Frames that a marker must be seen in to be placed.
_LEAST_FRAMES = 5
#: A marker is left out that keeps its distances to another segment's to less than the first and to its own to more
#: than the second [m]: skin alone makes 3 to 9 mm (Leardini et al. 2005).
_KEEPS_M, _LEAVES_M = 1e-3, 8e-3
_SCATTER_FRAMES = 1000
#: A landmark is computed that keeps its distances better than optical noise lets a marker [m].
_COMPUTED_M = 2e-4


@dataclass(frozen=True)
class LimbTrials:
    """What was recorded of a limb and of the trunk's landmarks, in metres.

    Attributes
    ----------
    names : tuple of str
        All markers that are used.
    trials : tuple of (n_frame, n_marker, 3) [m]
        NaN where a marker was not seen.
    t : tuple of (n_frame,) [s]
    up : str
        Such as ``+z``; empty where it is unknown.
    segments : mapping of str to tuple of str
        The markers of the base and of each part of the limb, landmarks among them.
    landmarks : mapping of str to str
        The marker of each landmark.
    computed : frozenset of str
        Landmarks that the recordings have computed from a segment's markers: they say where a bony point is, and
        are no measurement of their own.
    motions : mapping of str to SegmentMotion
        Of the segments that have a pose of their own.
    notes : tuple of Note
    """

    names: tuple[str, ...]
    trials: tuple[Floats, ...]
    t: tuple[Floats, ...]
    up: str
    segments: Mapping[str, tuple[str, ...]]
    landmarks: Mapping[str, str]
    computed: frozenset[str]
    motions: Mapping[str, SegmentMotion]
    notes: tuple[Note, ...]

    @property
    def whole(self) -> Floats:
        """All trials, one after the other, (n_frame, n_marker, 3) [m]."""
        return np.concatenate(self.trials)

    def of(self, marker: str) -> Floats:
        """Return where a marker was in all trials, (n_frame, 3) [m]."""
        return np.asarray(self.whole[:, self.names.index(marker)])


def limb_trials(recordings: Sequence[MarkerRecording], marker_set: MarkerSet, where: LimbMap) -> LimbTrials:
    """Sort recordings into the segments of a limb.

    Raises
    ------
    DataError
        If the marker set or the recordings have no marker on a part that the limb needs.
    """
    wanted = (where.base, *where.parts)
    first = next(iter(s for s in where.parts if s.startswith(("upper_arm", "thigh"))))

    def of_the_limb(landmark: str) -> bool:
        return not landmark.endswith(_other(where)) or landmark in _BOTH_SIDES

    return sorted_trials(recordings, _limb_set(marker_set, wanted), wanted, (first,), of_the_limb)


def sorted_trials(
    recordings: Sequence[MarkerRecording],
    own: MarkerSet,
    wanted: Sequence[str],
    needed: Sequence[str],
    keeps: Callable[[str], bool] = lambda _: True,
) -> LimbTrials:
    """Sort recordings into segments.

    Parameters
    ----------
    recordings : sequence of MarkerRecording
    own : MarkerSet
        What there is to do with of a marker set.
    wanted, needed : sequence of str
        Segments, and those without which it does not do.
    keeps : callable
        Whether a landmark is kept.

    Raises
    ------
    DataError
        If no marker of a segment that is needed is in the recordings.
    """
    frames = sum(len(one.positions) for one in recordings)
    if frames < _LEAST_FRAMES:
        raise DataError(f"{recordings[0].path}: {frames} frames in all, expected {_LEAST_FRAMES} at least")
    seen = _seen(recordings)
    fit = fit_marker_set(own, seen)
    segments: dict[str, tuple[str, ...]] = {}
    for segment in wanted:
        on_it = [*fit.segments.get(segment, ())]
        on_it += [m for landmark, m in fit.landmarks.items() if LANDMARKS[landmark] == segment and m not in on_it]
        if on_it:
            segments[segment] = tuple(on_it)
    segments, elsewhere, computed = _sorted_by_distances(own, segments, recordings)
    computed |= own.computed & {m for on_it in segments.values() for m in on_it}
    for segment in needed:
        if segment not in segments:
            raise DataError(
                f"marker set {own.name}: no marker of {segment} is in the recordings, expected some: "
                f"{', '.join(own.segments.get(segment, ())) or 'the set names none'}; "
                f"{built_in_advice(seen)}"
            )
    others = [m for landmark, m in fit.landmarks.items() if keeps(landmark)]
    names = tuple(dict.fromkeys([*(m for on_it in segments.values() for m in on_it), *others]))
    trials = tuple(recording.of(names) for recording in recordings)
    motions, notes = _motions(segments, names, trials)
    ups = {recording.up for recording in recordings}
    if len(ups) > 1:
        several = ", ".join(sorted(up or "unknown" for up in ups))
        text = f"recordings differ in which axis points up ({several}): none is taken for up; expected --up"
        notes.append(Note("up", text))
    elif ups == {""}:
        text = "nothing tells which axis points up: gravity is taken along -z; expected --up, such as --up +y"
        notes.append(Note("up", text))
    kept = [note for note in fit.notes if note.kind not in ("unused_marker", "too_few_markers")]
    return LimbTrials(
        names,
        trials,
        tuple(recording.t for recording in recordings),
        ups.pop() if len(ups) == 1 else "",
        segments,
        {name: m for name, m in fit.landmarks.items() if m in names and m not in _columns(elsewhere)},
        computed,
        motions,
        (*kept, *elsewhere, *notes),
    )


#: Landmarks of either side that determine the trunk's orientation.
_BOTH_SIDES = tuple(f"{name}_{side}" for name in ("asis", "psis", "acromion") for side in ("right", "left"))


def _other(where: LimbMap) -> str:
    return "_left" if where.side == "right" else "_right"


def _limb_set(marker_set: MarkerSet, wanted: Sequence[str]) -> MarkerSet:
    """Return the part of a marker set that a limb has to do with."""
    trunk = ("thorax",) if wanted[0] != "pelvis" else ("pelvis",)
    landmarks = {
        name: marker
        for name, marker in marker_set.landmarks.items()
        if LANDMARKS[name] in (*wanted, *trunk)
        or (name in _BOTH_SIDES and "acromion" in name and "thorax" in trunk)
    }
    segments = {name: markers for name, markers in marker_set.segments.items() if name in wanted}
    return replace(marker_set, segments=segments, landmarks=landmarks)


def _seen(recordings: Sequence[MarkerRecording]) -> list[str]:
    counts: dict[str, int] = {}
    for recording in recordings:
        for name, count in zip(recording.names, (~recording.missing).sum(axis=0), strict=True):
            counts[name] = counts.get(name, 0) + int(count)
    return [name for name, count in counts.items() if count >= _LEAST_FRAMES]


def _motions(
    segments: Mapping[str, tuple[str, ...]], names: Sequence[str], trials: Sequence[Floats]
) -> tuple[dict[str, SegmentMotion], list[Note]]:
    motions, notes = dict[str, SegmentMotion](), list[Note]()
    for segment, markers in segments.items():
        if len(markers) < 3:
            continue
        own = [trial[:, [names.index(m) for m in markers]] for trial in trials]
        try:
            motions[segment] = segment_motion(segment, markers, own)
            notes += motions[segment].notes
        except DataError as error:
            notes.append(Note("no_pose", f"{segment} has no pose of its own: {error}", columns=markers))
    return motions, notes


def _columns(notes: Sequence[Note]) -> set[str]:
    return {name for note in notes if note.kind == "marker_elsewhere" for name in note.columns}


def _sorted_by_distances(
    own_set: MarkerSet, segments: Mapping[str, tuple[str, ...]], recordings: Sequence[MarkerRecording]
) -> tuple[dict[str, tuple[str, ...]], list[Note], frozenset[str]]:
    """Leave out markers that go with another segment; separate computed landmarks from measured ones."""
    names = tuple(m for on_it in segments.values() for m in on_it)
    frames = np.concatenate([recording.of(names) for recording in recordings])
    scatter = distance_scatter(frames[:: max(1, len(frames) // _SCATTER_FRAMES)])
    of = {name: segment for segment, on_it in segments.items() for name in on_it}
    kept, notes, computed = {segment: list(on_it) for segment, on_it in segments.items()}, list[Note](), set[str]()
    listed = {m for on_it in own_set.segments.values() for m in on_it}
    for k, name in enumerate(names):
        apart = {
            segment: _median(scatter[k, [names.index(m) for m in on_it if m != name and m in listed]])
            for segment, on_it in segments.items()
        }
        own = apart.pop(of[name])
        if name not in listed and own < _COMPUTED_M:
            computed.add(name)
        nearest = min(apart, key=lambda segment: apart[segment]) if apart else ""
        if nearest and apart[nearest] < _KEEPS_M and _LEAVES_M < own < np.inf:
            kept[of[name]].remove(name)
            text = (
                f"{name} is on {of[name]} by the marker set, but keeps its distances to {nearest} to "
                f"{1e3 * apart[nearest]:.1f} mm and to {of[name]} to {1e3 * own:.0f} mm only, as if it were "
                f"computed from {nearest}: left out"
            )
            notes.append(Note("marker_elsewhere", text, columns=(name,)))
    if computed:
        text = (
            f"{', '.join(sorted(computed))} keep their distances to their segment's other markers to less than "
            f"{1e3 * _COMPUTED_M:g} mm, as if computed from them: taken for bony points, not for measured ones"
        )
        notes.append(Note("computed", text, columns=tuple(sorted(computed))))
    return {segment: tuple(on_it) for segment, on_it in kept.items() if on_it}, notes, frozenset(computed)


def _median(scatter: Floats) -> float:
    known = scatter[np.isfinite(scatter)]
    return float(np.median(known)) if len(known) >= 2 else np.inf
