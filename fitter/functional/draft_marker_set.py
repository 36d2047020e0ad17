"""A draft of a marker set from a recording: clusters of markers that keep their distances."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.spatial.distance import squareform

from arm.body.tracked_segments import TRACKED_SEGMENTS
from arm.model import Floats
from fitter.functional.marker_set import load_marker_set, marker_set_names
from limbcal.errors import DataError

#: Scatter of a distance up to which two markers ride on one segment [m]. Skin moves markers by 3 to 9 mm rms over
#: thigh and shank (Leardini et al. 2005, Peters et al. 2010), and most of it together.
RIGID_M = 0.008
#: Scatter that a distance between segments of somebody who moves exceeds [m].
_MOVES_M = 0.02
#: From the median absolute deviation to the standard deviation of normal noise.
_MAD_TO_STD = 1.4826
#: Frames, evenly spread, that scatter is taken from.
_MOST_FRAMES = 1000
#: Frames in which two markers must be seen together for their distance to say anything, and their share: in
#: fewer the person may just not have moved.
_LEAST_TOGETHER, _LEAST_SHARE_TOGETHER = 20, 0.05


@dataclass(frozen=True)
class Draft:
    """Clusters of markers that keep their distances.

    Attributes
    ----------
    clusters : tuple of tuple of str
        The largest first; markers in the order of the recording.
    scatter_m : tuple of float
        Mean scatter of the distances within each cluster; NaN for a single marker.
    perhaps : tuple of str or None
        The segment that the markers ride on in a built-in set, or the segments where they are of several.
    """

    clusters: tuple[tuple[str, ...], ...]
    scatter_m: tuple[float, ...]
    perhaps: tuple[str | None, ...]

    def toml(self, name: str) -> str:
        """Return the text of a marker-set file whose segments the user has still to name."""
        lines = [
            "# A draft: markers that keep their distances ride on one segment. Give every line its name,",
            "# join what belongs together, and take out what rides on nothing. The names are",
            *(f"#   {', '.join(TRACKED_SEGMENTS[i : i + 4])}" for i in range(0, len(TRACKED_SEGMENTS), 4)),
            "schema = 1",
            f"name = {_quoted(name)}",
            "",
            "[segments]",
        ]
        for i, (markers, scatter, segment) in enumerate(
            zip(self.clusters, self.scatter_m, self.perhaps, strict=True)
        ):
            said = [] if np.isnan(scatter) else [f"distances keep to {1e3 * scatter:.1f} mm"]
            said += [f"perhaps {segment}"] if segment else []
            comment = f"  # {', '.join(said)}" if said else ""
            lines.append(f"cluster_{i + 1} = [{', '.join(map(_quoted, markers))}]{comment}")
        lines += ["", "[landmarks]", '# acromion_right = "the marker on it"', ""]
        return "\n".join(lines)


def draft_marker_set(markers: Sequence[str], trials_m: Sequence[Floats], rigid_m: float = RIGID_M) -> Draft:
    """Cluster the markers of a recording by the scatter of their distances.

    Parameters
    ----------
    markers : sequence of str
    trials_m : sequence of (n_frame, n_marker, 3)
        NaN where a marker was not seen.
    rigid_m : float
        Mean scatter up to which clusters are joined [m].

    Raises
    ------
    DataError
        If fewer than three markers are seen together, or nothing moves relative to anything.
    """
    frames = np.concatenate([np.asarray(trial, dtype=np.float64) for trial in trials_m])
    frames = frames[np.linspace(0, len(frames) - 1, min(len(frames), _MOST_FRAMES)).round().astype(int)]
    scatter = distance_scatter(frames)
    known = np.isfinite(scatter) & ~np.eye(len(markers), dtype=bool)
    if not known.any():
        raise DataError("no two markers are seen together, expected a recording with clusters of markers")
    if np.max(scatter[known]) < _MOVES_M:
        raise DataError(
            f"all distances between markers keep to {1e3 * np.max(scatter[known]):.0f} mm, expected a recording "
            "in which the person moves every joint"
        )
    filled = np.where(np.isfinite(scatter), scatter, max(_MOVES_M, 2.0 * rigid_m))  # never seen together: apart
    np.fill_diagonal(filled, 0.0)
    label = fcluster(linkage(squareform(filled, checks=False), "average"), rigid_m, "distance")
    groups = sorted((np.flatnonzero(label == one) for one in np.unique(label)), key=lambda g: (-len(g), g[0]))
    clusters = tuple(tuple(markers[int(i)] for i in group) for group in groups)
    return Draft(clusters, tuple(_within(scatter, g) for g in groups), tuple(map(_perhaps, clusters)))


def distance_scatter(frames: Floats) -> Floats:
    """Return the standard deviation of each distance, (n_marker, n_marker) [m], by its median absolute deviation.

    NaN where two markers are hardly ever seen together. A label that is swapped for some frames does not count.
    """
    n = frames.shape[1]
    scatter = np.full((n, n), np.nan)
    for i in range(n):
        distance = np.linalg.norm(frames - frames[:, i : i + 1], axis=2)
        enough = np.isfinite(distance).sum(axis=0) >= max(_LEAST_TOGETHER, _LEAST_SHARE_TOGETHER * len(frames))
        some = distance[:, enough]
        scatter[i, enough] = _MAD_TO_STD * np.nanmedian(np.abs(some - np.nanmedian(some, axis=0)), axis=0)
    return scatter


def _within(scatter: Floats, group: np.ndarray) -> float:
    if len(group) < 2:
        return np.nan
    first, second = np.triu_indices(len(group), 1)
    return float(np.nanmean(scatter[group[first], group[second]]))


def _perhaps(cluster: Sequence[str]) -> str | None:
    """Return the segments that a cluster's markers ride on in the built-in set that knows most of them."""
    best: dict[str, int] = {}
    for name in marker_set_names():
        segments = load_marker_set(name).segments.items()
        counts = {segment: len(set(listed) & set(cluster)) for segment, listed in segments}
        if sum(counts.values()) > sum(best.values()):
            best = {segment: count for segment, count in counts.items() if count}
    if 2 * sum(best.values()) <= len(cluster):
        return None
    first = max(best, key=lambda segment: best[segment])
    if 3 * best[first] > 2 * sum(best.values()):
        return first
    return f"{', '.join(best)}, which hardly moved relative to each other"


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
