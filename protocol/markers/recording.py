"""A recording of optical markers, in metres, with the forces."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from protocol.tables.table import Floats


@dataclass(frozen=True)
class ForceRecord:
    """What one force platform or instrumented rim measured.

    Attributes
    ----------
    name : str
    rate_hz : float
    channels : (n_sample, n_channel)
        Forces first, in the file's units; NaN where nothing was stored.
    """

    name: str
    rate_hz: float
    channels: Floats


@dataclass(frozen=True)
class RawRecording:
    """A file as it says itself.

    Attributes
    ----------
    path : str
    rate_hz : float
    unit : str
        As the header has it.
    labels : tuple of str
    points : (n_frame, n_marker, 3)
        In that unit; NaN where nothing was stored.
    t : (n_frame,) [s], or None
        A column of time, where the file has one.
    up : str
        Such as ``+z``, by the header; empty if it says nothing.
    computed : frozenset of str
        Labels that the header calls angles, forces, moments, powers or scalars.
    other_rates : mapping of str to float [Hz]
        What else in the file gives the rate of its frames.
    forces : tuple of ForceRecord
    stated_frames : int, optional
        How many frames there are by the header.
    unnamed : int
        Points without a name in a frame, at the most, that the file holds beside its markers.
    """

    path: str
    rate_hz: float
    unit: str
    labels: tuple[str, ...]
    points: Floats
    t: Floats | None = None
    up: str = ""
    computed: frozenset[str] = frozenset()
    other_rates: dict[str, float] = field(default_factory=dict)
    forces: tuple[ForceRecord, ...] = ()
    stated_frames: int | None = None
    unnamed: int = 0

    @property
    def t0_s(self) -> float:
        """Time of the first frame by the column of time [s]; zero where there is none."""
        known = np.flatnonzero(np.isfinite(self.t)) if self.t is not None else np.empty(0, dtype=np.intp)
        if self.t is None or not len(known):
            return 0.0
        return float(self.t[known[0]] - known[0] / self.rate_hz)


@dataclass(frozen=True)
class MarkerRecording:
    """A recording of markers.

    Attributes
    ----------
    path : str
    rate_hz : float
    names : tuple of str
        Without prefix.
    positions : (n_frame, n_marker, 3) [m]
        NaN where a marker was not seen.
    unit, up : str
        Of the file; the axis that points up, such as ``+z``, empty if it is unknown.
    forces : tuple of ForceRecord
    t0_s : float
        Time of the first frame on the recording's own clock.
    """

    path: str
    rate_hz: float
    names: tuple[str, ...]
    positions: Floats
    unit: str
    up: str
    forces: tuple[ForceRecord, ...] = ()
    t0_s: float = 0.0

    @property
    def t(self) -> Floats:
        """Time on the recording's own clock [s], (n_frame,)."""
        return self.t0_s + np.arange(len(self.positions)) / self.rate_hz

    def of(self, names: Sequence[str]) -> Floats:
        """Return markers in some order, (n_frame, n_marker, 3) [m], NaN for those that it has not."""
        out = np.full((len(self.positions), len(names), 3), np.nan)
        for k, name in enumerate(names):
            if name in self.names:
                out[:, k] = self.positions[:, self.names.index(name)]
        return out

    def with_marker(self, name: str, position_m: Floats) -> "MarkerRecording":
        """Return the recording with a marker, (n_frame, 3) [m], in the place of one of that name."""
        kept = [k for k, one in enumerate(self.names) if one != name]
        positions = np.concatenate([self.positions[:, kept], position_m[:, None]], axis=1)
        return replace(self, names=(*(self.names[k] for k in kept), name), positions=positions)

    @property
    def missing(self) -> np.ndarray:
        """Where a marker was not seen, (n_frame, n_marker) of bool."""
        return np.isnan(self.positions[:, :, 0])


def runs(mask: np.ndarray) -> list[tuple[int, int]]:
    """Return first and one past the last frame of each run of true values in a mask (n_frame,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    return [(int(first), int(last)) for first, last in zip(edges[::2], edges[1::2], strict=True)]
