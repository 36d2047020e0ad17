"""Markers that leap onto each other's places from one frame to the next: their labels were exchanged there.

Such leaps part a recording into runs. Which of them have the labels right, distances to other markers show: as the
pair's are in the longest run, or in other recordings of the person. Unlike distances over a whole recording, which
an exchange of half of it changes as much as it is changed by them, those of a run have no exchange in them.
"""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from limbcal.note import Note
from protocol.markers.marker_jumps import leaps_of
from protocol.markers.recording import MarkerRecording, runs
from protocol.markers.swaps import SHORTEST_S

#: A marker is on the other's place if that is nearer than this part of its leap.
_NEARER = 0.5
#: Distances of two markers from a third are distinct if they differ by this much [m], what skin changes them by,
#: and by this multiple of what they change within a run; a single third marker is not enough: it leaves a sphere.
_DISTINCT_M, _TIMES, _ENOUGH = 0.015, 3.0, 2
#: A distance is a reference's if it differs from it by no more than this many times as much.
_FITS = 2.0
#: Frames of a run that its distances are taken from.
_FRAMES = 400

#: Distances of two markers to all others, (2, n) [m], and by how much they change.
Pair = tuple[np.ndarray, np.ndarray]


def uncrossed(
    recording: MarkerRecording, others: Sequence[MarkerRecording]
) -> tuple[list[Note], np.ndarray, np.ndarray]:
    """Say which markers leapt onto each other's places, and return positions with their labels exchanged again.

    Parameters
    ----------
    recording : MarkerRecording
    others : sequence of MarkerRecording
        Of the same person. They decide which part has the labels right; without them it is the longer one.

    Returns
    -------
    list of Note, (n_frame, n_marker, 3) [m], (n_frame, n_marker) of bool
        The last is true where labels were exchanged.
    """
    positions, notes = recording.positions.copy(), list[Note]()
    exchanged = np.zeros(positions.shape[:2], dtype=np.bool_)
    for (i, j), frames in _crossings(recording).items():
        mask, is_decided = _exchanged(recording, others, (i, j), frames)
        for first, last in runs(mask):
            # a glimpse is not enough, but between two leaps
            is_long = last - first >= SHORTEST_S * recording.rate_hz
            mask[first:last] &= is_long or (first in frames and last in frames)
        frame = np.flatnonzero(mask)[:, None]
        positions[frame, [i, j]] = positions[frame, [j, i]]
        exchanged[frame, [i, j]] = True
        one, other = recording.names[i], recording.names[j]
        for first, last in runs(mask):
            begin, end = first / recording.rate_hz, last / recording.rate_hz
            text = (
                f"{one} and {other} have each other's labels for {end - begin:.2f} s, at an end of which they "
                "leap onto each other's places: exchanged again"
            )
            text += (
                ""
                if is_decided
                else "; no other recording shows which part is right, the longer one is taken for it"
            )
            notes.append(Note("swapped", text, "", (one, other), None, begin, end))
    return notes, positions, exchanged


def _crossings(recording: MarkerRecording) -> dict[tuple[int, int], dict[int, bool]]:
    """Return the frames in which two markers are on each other's places of the frame before, by pair.

    Where one of them is not seen before or after, the other's leap onto its place or off its own is enough; the
    value says whether both were seen.
    """
    at, x = defaultdict[int, list[int]](list), recording.positions
    for k in range(x.shape[1]):
        for frame in leaps_of(x[:, k], recording.rate_hz):
            at[frame].append(k)
    found = defaultdict[tuple[int, int], dict[int, bool]](dict)
    for frame, leaping in sorted(at.items()):
        before, after = x[frame - 1], x[frame]
        for i in leaping:
            leap = np.linalg.norm(after[i] - before[i])
            onto = np.linalg.norm(after[i] - before, axis=1) < _NEARER * leap
            off = np.linalg.norm(after - before[i], axis=1) < _NEARER * leap
            is_half = np.isnan(before[:, 0]) != np.isnan(after[:, 0])
            for j in np.flatnonzero((onto & off) | ((onto | off) & is_half)).tolist():
                found[min(i, j), max(i, j)][frame] = not is_half[j]
    return found


def _exchanged(
    recording: MarkerRecording, others: Sequence[MarkerRecording], pair: tuple[int, int], frames: dict[int, bool]
) -> tuple[np.ndarray, bool]:
    """Return in which frames two markers have each other's labels, and whether other recordings decide it."""
    seen: np.ndarray = ~np.any(recording.missing[:, list(pair)], axis=1)
    starts = np.zeros(len(seen), dtype=np.bool_)
    starts[list(frames)] = True
    parts = [part for run in runs(seen) for part in _cut(run, starts)]
    reference = max(parts, key=lambda part: part[1] - part[0])
    own = _distances(recording.positions[slice(*reference)], pair)
    mask, is_judged = np.zeros((2, len(seen)), dtype=np.bool_)
    for part in parts:
        # after another motion distances alone mislead: where one marker leapt, only the runs that end there count
        if any(frames.values()) or frames.keys() & set(part):
            is_judged[slice(*part)] = True
            mask[slice(*part)] = _crossed(own, _distances(recording.positions[slice(*part)], pair)) > 0.0
    names = [recording.names[k] for k in pair]
    votes = [_crossed(own, _like(other, recording, pair)) for other in others if set(names) <= set(other.names)]
    by_others = float(np.sum(np.sign(votes)))
    is_decided = by_others != 0.0
    is_other_way = by_others > 0.0 if is_decided else 2 * mask.sum() > seen.sum()
    return ~mask & is_judged if is_other_way else mask, is_decided


def _cut(run: tuple[int, int], starts: np.ndarray) -> list[tuple[int, int]]:
    first, last = run
    ends = [first, *(first + 1 + np.flatnonzero(starts[first + 1 : last])), last]
    return [(int(a), int(b)) for a, b in zip(ends[:-1], ends[1:], strict=True)]


def _distances(positions: np.ndarray, pair: tuple[int, int]) -> Pair:
    """Return the distances of two markers to all others."""
    some = positions[:: max(1, len(positions) // _FRAMES)]
    with np.errstate(all="ignore"):
        apart = np.linalg.norm(some[:, list(pair), None] - some[:, None], axis=3)
        known = np.isfinite(apart).any(axis=0)
        middle = np.nanmedian(np.where(known, apart, 0.0), axis=0)
        change = np.nanmedian(np.where(known, np.abs(apart - middle), 0.0), axis=0)
    middle[~known] = np.nan
    middle[:, list(pair)] = np.nan
    return middle, change


def _like(other: MarkerRecording, recording: MarkerRecording, pair: tuple[int, int]) -> Pair:
    """Return another recording's distances of two markers, in this one's order of markers."""
    index = {name: k for k, name in enumerate(other.names)}
    one, two = (index[recording.names[k]] for k in pair)
    middle, change = _distances(other.positions, (one, two))
    found = np.full((2, 2, len(recording.names)), np.nan)
    for k, name in enumerate(recording.names):
        if name in index:
            found[:, :, k] = middle[:, index[name]], change[:, index[name]]
    return found[0], found[1]


def _crossed(reference: Pair, pair: Pair) -> float:
    """Return by how much two markers' distances are like each other's in a reference rather than their own [m].

    The median over the markers at distinct distances that fit one way or the other, as those of other segments do
    not after another motion; zero where they are too few.
    """
    (middle, change), (here, change_here) = reference, pair
    apart = np.abs(middle[0] - middle[1])
    unsteady = np.maximum(change.max(axis=0), change_here.max(axis=0))
    distinct = (apart > _DISTINCT_M) & (apart > _TIMES * unsteady) & np.isfinite(here).all(axis=0)
    if distinct.sum() < _ENOUGH:
        return 0.0
    straight, across = (np.abs(here - one)[:, distinct].sum(axis=0) for one in (middle, middle[::-1]))
    fit = np.minimum(straight, across) < _FITS * _DISTINCT_M
    if fit.sum() < _ENOUGH:
        return 0.0
    return float(np.median((straight - across)[fit]))
