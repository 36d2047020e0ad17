"""Labels that two markers have exchanged, found by the distances between markers alone.

On one segment distances stay as they are. A marker whose distances to its own segment are wrong where another
one's would be right, and the other way round, has that one's label.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from limbcal.note import Note
from protocol.markers.recording import MarkerRecording, runs

#: A marker is compared with this number of others whose distances change least, by at most this [m] (skin).
_PARTNERS, _RIGID_M = 6, 0.02
#: Others of the same segment differ by less than this factor in how they keep their distance, or keep it within
#: this [m], the noise of cameras.
_ALIKE, _GLUED_M = 3.0, 0.002
#: Fewer others are not enough: two distances leave a circle of places.
_ENOUGH = 2
#: Distances are wrong beyond this [m], and beyond this multiple of their usual deviation.
_WRONG_M, _TIMES = 0.015, 5.0
#: Exchanged, they must be righter by this factor.
_RIGHTER = 2.0
#: Most frames of a reference; least frames of an exchange.
_FRAMES, _SHORTEST = 400, 3
#: … and this long [s]: a glimpse is not enough.
SHORTEST_S = 0.05
#: … which must be this fraction of the time from its first to its last one.
_MOSTLY = 0.5
#: So many recordings of one person overrule one of them.
_MAJORITY = 3


@dataclass(frozen=True)
class Reference:
    """Distances between markers: their median and its absolute deviation, (n, n) [m]; NaN where not seen."""

    distance: np.ndarray
    deviation: np.ndarray


def reference_of(positions: np.ndarray) -> Reference:
    """Return the distances between the markers of a recording (n_frame, n, 3)."""
    some = positions[:: max(1, len(positions) // _FRAMES)]
    apart = np.linalg.norm(some[:, :, None] - some[:, None], axis=3)
    with np.errstate(all="ignore"):
        distance = _nanmedian(apart)
        deviation = _nanmedian(np.abs(apart - distance))
    return Reference(distance, deviation)


def _nanmedian(values: np.ndarray) -> np.ndarray:
    """Return the median over frames, NaN where less than a tenth of them is known."""
    known = np.isfinite(values).sum(axis=0)
    in_order = np.sort(values, axis=0)  # NaN last; numpy's own nanmedian takes ten times as long
    below, above = (np.take_along_axis(in_order, k[None], axis=0)[0] for k in ((known - 1) // 2, known // 2))
    return np.where(10 * known >= len(values), 0.5 * (below + above), np.nan)


#: Distances that recordings of one person agree on, and how far they change within one, [m], by markers' names.
Agreed = dict[tuple[str, str], tuple[float, float]]


def agreed(recordings: Sequence[MarkerRecording]) -> Agreed:
    """Return distances between markers that most of several recordings agree on, and their deviation [m]."""
    if len(recordings) < _MAJORITY:
        return {}
    known: dict[tuple[str, str], list[tuple[float, float]]] = defaultdict(list)
    for recording in recordings:
        own = reference_of(recording.positions)
        for i, j in np.argwhere(np.triu(np.isfinite(own.distance), 1)):
            one, other = sorted((recording.names[i], recording.names[j]))
            known[one, other].append((float(own.distance[i, j]), float(own.deviation[i, j])))
    found: Agreed = {}
    for names, values in known.items():
        distance, deviation = np.median(values, axis=0)
        alike = sum(abs(one - distance) < _WRONG_M for one, _ in values)
        if len(values) >= _MAJORITY and 2 * alike > len(values) and deviation < _RIGID_M:
            found[names] = float(distance), float(deviation)
    return found


class _Distances:
    """Distances of markers to those of their own segments, and by how much they are wrong.

    Parameters
    ----------
    positions : (n_frame, n_marker, 3) [m]
    partners : list of (n_partner,) int
        To which markers the distances of each are compared.
    distance : (n_marker, n_marker) [m]
        What they should be.
    """

    def __init__(self, positions: np.ndarray, partners: list[np.ndarray], distance: np.ndarray) -> None:
        self._partners, self._distance = partners, distance
        miss = [_miss(positions, k, partners[k], distance[k]) for k in range(len(partners))]
        self._miss = np.stack(miss, axis=1)
        with np.errstate(all="ignore"):
            usual = np.array([np.nanmedian(one) if np.isfinite(one).any() else np.inf for one in miss])
        self._limit = np.maximum(_WRONG_M, _TIMES * np.where(usual > _WRONG_M, 0.0, usual))
        wrong = self._miss > self._limit
        #: The frames in which a marker's distances are wrong, of those with enough of them.
        self.wrong = {k: np.flatnonzero(wrong[:, k]) for k in range(len(miss)) if wrong[:, k].sum() >= _SHORTEST}

    def righter(self, some: np.ndarray, i: int, j: int) -> np.ndarray:
        """Say in which of some frames two markers are wrong, and exchanged right."""
        straight, crossed = self._misses(some, i, j)
        is_wrong = (straight[0] > self._limit[i]) & (straight[1] > self._limit[j])
        is_right = (crossed[0] < self._limit[i]) & (crossed[1] < self._limit[j])
        right: np.ndarray = is_wrong & is_right & (sum(straight) > _RIGHTER * sum(crossed))
        return right

    def with_ends(self, some: np.ndarray, i: int, j: int, first: int, last: int) -> tuple[int, int]:
        """Return a run with the frames beside it in which two markers are righter, exchanged, if only a little."""
        straight, crossed = self._misses(some, i, j)
        others = np.flatnonzero(~(sum(straight) > sum(crossed)))
        before, after = others[others < first], others[others >= last]
        return int(before.max(initial=-1)) + 1, int(after.min(initial=len(some)))

    def gained(self, positions: np.ndarray, i: int, j: int, first: int, last: int) -> float:
        """Return by how much the distances of all markers are righter if two are exchanged [m frames].

        Of four on a segment the other two, exchanged, are its mirror image: nearly as right for themselves.
        """
        some = positions[first:last].copy()
        some[:, [i, j]] = some[:, [j, i]]
        after = [np.nansum(_miss(some, k, self._partners[k], self._distance[k])) for k in self.wrong]
        return float(np.nansum(self._miss[first:last, list(self.wrong)]) - sum(after))

    def _misses(self, some: np.ndarray, i: int, j: int) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Return by how much the distances of two markers are wrong, as they are and exchanged [m]."""
        partners, distance = self._partners, self._distance
        straight = [_miss(some, k, partners[k], distance[k]) for k in (i, j)]
        crossed = [_miss(some, b, partners[a], distance[a], without=b) for a, b in ((i, j), (j, i))]
        return straight, crossed


def put_right(recording: MarkerRecording, others: Agreed) -> tuple[list[Note], np.ndarray, np.ndarray]:
    """Say which markers have each other's labels, and return positions with them exchanged.

    Parameters
    ----------
    recording : MarkerRecording
    others : mapping
        What most recordings of the person agree on, see `agreed`.

    Returns
    -------
    list of Note, (n_frame, n_marker, 3), (n_frame, n_marker) of bool
        The last is true where labels were exchanged.
    """
    names, positions = recording.names, recording.positions.copy()
    n_frame, n, _ = positions.shape
    exchanged, notes = np.zeros((n_frame, n), dtype=np.bool_), list[Note]()
    if n < 4:
        return notes, positions, exchanged
    distance, deviation = _by_majority(reference_of(positions), names, others)
    distances = _Distances(positions, _partners(distance, deviation), distance)
    shortest = max(_SHORTEST, round(SHORTEST_S * recording.rate_hz))
    found: list[tuple[float, int, int, int, int]] = []
    for i, j in combinations(distances.wrong, 2):
        frames = np.intersect1d(distances.wrong[i], distances.wrong[j], assume_unique=True)
        if len(frames) < _SHORTEST:
            continue
        right = distances.righter(positions[frames], i, j)
        mask = np.zeros(n_frame, dtype=np.bool_)
        mask[frames[right]] = True
        is_missing = np.any(recording.missing[:, [i, j]], axis=1)
        for begin, end in runs(_bridged(mask, is_missing)):
            wrong_there, seen = mask[begin:end].sum(), (~is_missing[begin:end]).sum()
            if wrong_there >= max(shortest, _MOSTLY * seen):
                first, last = distances.with_ends(positions, i, j, begin, end)
                found.append((distances.gained(positions, i, j, first, last), i, j, first, last))
    for _, i, j, first, last in sorted(found, reverse=True):
        # Distances to two that have been exchanged since are right again, and may have been all that was wrong.
        right = distances.righter(positions[first:last], i, j)
        seen = (~recording.missing[first:last, [i, j]].any(axis=1)).sum()
        if exchanged[first:last, [i, j]].any() or right.sum() < _MOSTLY * seen:
            continue
        positions[first:last, [i, j]] = positions[first:last, [j, i]]
        exchanged[first:last, [i, j]] = True
        whole = last - first >= n_frame - _SHORTEST
        times = (None, None) if whole else (first / recording.rate_hz, last / recording.rate_hz)
        when = "throughout" if whole else f"for {(last - first) / recording.rate_hz:.2f} s"
        text = f"{names[i]} and {names[j]} have each other's labels {when}, by their distances: exchanged again"
        notes.append(Note("swapped", text, "", (names[i], names[j]), None, *times))
    return notes, positions, exchanged


def _by_majority(own: Reference, names: tuple[str, ...], others: Agreed) -> tuple[np.ndarray, np.ndarray]:
    """Return distances and deviations (n, n) [m], of a marker with enough measured distances alone."""
    distance, deviation = own.distance.copy(), own.deviation.copy()
    index = {name: k for k, name in enumerate(names)}
    is_measured = np.zeros(distance.shape, dtype=np.bool_)
    for (one, other), (value, spread) in others.items():
        if one in index and other in index:
            i, j = index[one], index[other]
            distance[i, j] = distance[j, i] = value
            deviation[i, j] = deviation[j, i] = spread
            is_measured[i, j] = is_measured[j, i] = True
    enough = is_measured.sum(axis=1) >= _ENOUGH
    deviation[enough[:, None] & ~is_measured] = np.inf
    return distance, deviation


def _partners(distance: np.ndarray, deviation: np.ndarray) -> list[np.ndarray]:
    """Return for each marker those that keep their distances to it best: of its own segment, where it has some."""
    steady = np.where(np.isfinite(distance) & (deviation < _RIGID_M), deviation, np.inf)
    np.fill_diagonal(steady, np.inf)
    found = []
    for row in steady:
        order = np.argsort(row)[:_PARTNERS]
        limit = max(_ALIKE * row[order[min(_ENOUGH, len(order)) - 1]], _GLUED_M)
        found.append(order[np.isfinite(row[order]) & (row[order] <= limit)])
    return found


def _miss(
    positions: np.ndarray, k: int, partners: np.ndarray, distance: np.ndarray, without: int = -1
) -> np.ndarray:
    """Return by how much the distances of marker k to some others differ from a reference, (n_frame,) [m]."""
    some = partners[(partners != k) & (partners != without)]
    if len(some) < _ENOUGH:
        return np.full(len(positions), np.nan)
    apart = np.linalg.norm(positions[:, some] - positions[:, [k]], axis=2) - distance[some]
    with np.errstate(all="ignore"):
        known = np.isfinite(apart).sum(axis=1) >= _ENOUGH
        median = np.nanmedian(np.where(known[:, None], np.abs(apart), 0.0), axis=1)
    return np.where(known, median, np.nan)


def _bridged(mask: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """Return a mask that goes on where markers were not seen between two of its frames."""
    filled = mask.copy()
    for first, last in runs(~mask):
        if first > 0 and last < len(mask) and missing[first:last].mean() > 0.5:
            filled[first:last] = True
    return filled
