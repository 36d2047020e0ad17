"""Readings that were taken at an uneven rate, put on an even one: what follows them in time counts samples."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy

from fitter.data.derivatives import lowpass
from fitter.data.gaps import WITNESSES, Gap, find_gaps
from fitter.data.motions import Measured
from fitter.data.resample import CROWDED, Floats, curve_through
from limbcal.note import Note
from protocol.tables.columns import JOINT_ROLES

#: Relative error of a rate that is tolerated: a tenth of the error of accelerometers' scales.
_RATE = 1e-3
#: Standard deviations of a rate by which jitter makes it seem to be off.
_SIGMAS = 5.0
#: Steps over which a rate is seen, and twice, four times … as many.
_WINDOW = 64
#: Share of the samples' rate up to which readings are moved in time; motions are slower, noise is not.
_COURSE = 0.1
#: Steps up to which readings are drawn through: half a period of the quickest course.
_BRIDGED = 4.0


def evened(motion: Measured) -> tuple[Measured, float, tuple[Gap, ...]]:
    """Return readings at an even rate, their step [s] and the gaps in them.

    Stamps that jitter about an even rate are taken to be late, not the samples; nothing is done to these. Where
    the rate itself wanders, readings are moved to the instants of a grid of the mean step.

    Parameters
    ----------
    motion : Measured
        Readings, and what came with them, at rising stamps.
    """
    dt_s, gaps = find_gaps(motion.t)
    late = motion.t - motion.t[0] - dt_s * _index(len(motion.t), gaps)
    smooth = _smoothed(late)
    if not _wanders(smooth, late - smooth, dt_s):
        return motion, dt_s, gaps
    return _resampled(motion, motion.t + smooth - late)


def _index(n: int, gaps: Sequence[Gap]) -> Floats:
    """Return the number of each sample, those that were lost counted, (n,)."""
    lost = np.zeros(n)
    for gap in gaps:
        lost[gap.row] = gap.samples
    return np.arange(n, dtype=np.float64) + np.cumsum(lost)


def _smoothed(late: Floats) -> Floats:
    """Return how late samples were taken, (n,), by how late their stamps are: what jitters is the stamps' own.

    Jitter turns successive steps against each other, a rate that changes does not: the lag-one covariance of the
    steps is minus the jitter's variance. Their smoother is that of a random walk seen through white noise (local
    level model), no wider than the witnesses of a gap.
    """
    steps = np.diff(late)
    steps -= scipy.ndimage.uniform_filter1d(steps, WITNESSES)
    jitter = -float(np.mean(steps[1:] * steps[:-1]))
    if not jitter > 0.0:
        return late
    walk = max(0.0, float(np.mean(steps**2)) - 2.0 * jitter) / jitter
    gain = max((np.sqrt(walk**2 + 4.0 * walk) - walk) / 2.0, 2.0 / WITNESSES)
    forth, back = (
        scipy.signal.lfilter([gain], [1.0, gain - 1.0], values, zi=[(1.0 - gain) * values[0]])[0]
        for values in (late, late[::-1])
    )
    return np.asarray((forth + back[::-1] - gain * late) / (2.0 - gain), dtype=np.float64)


def _wanders(late: Floats, jitter: Floats, dt_s: float) -> bool:
    """Say whether the rate over some window, short or long, is off by more than jitter lets it seem."""
    width = _WINDOW
    while width < len(late):
        off = np.abs(late[width:] - late[:-width]).max()
        if off > _RATE * width * dt_s + _SIGMAS * np.sqrt(2.0) * jitter.std():
            return True
        width *= 2
    return False


def _resampled(motion: Measured, t: Floats) -> tuple[Measured, float, tuple[Gap, ...]]:
    """Return readings that were taken at some times (n,) on an even grid, without what lies in holes."""
    steps = np.diff(t)
    holes = np.flatnonzero(steps > _BRIDGED * np.median(steps)) + 1
    dt_s = float(np.delete(steps, holes - 1).mean())
    bounds = [0, *holes.tolist(), len(t)]
    parts: list[tuple[Floats, dict[str, Floats]]] = []
    for begin, end in zip(bounds[:-1], bounds[1:], strict=True):
        own = t[begin:end]
        first, last = np.ceil((own[0] - t[0]) / dt_s - 1e-6), np.floor((own[-1] - t[0]) / dt_s + 1e-6)
        index = np.arange(first, last + 1.0)
        if len(own) < 2 or not len(index):
            continue
        at = np.clip(t[0] + dt_s * index, own[0], own[-1])
        drawn = {role: _moved(role, own, values[begin:end], at, dt_s) for role, values in motion.columns.items()}
        parts.append((index, drawn))
    index = np.concatenate([part for part, _ in parts])
    at = t[0] + dt_s * index
    rows = np.clip(np.searchsorted((t[1:] + t[:-1]) / 2.0, at), 0, len(t) - 1)
    missing = np.diff(index).round().astype(int) - 1
    gaps = tuple(Gap(int(row) + 1, int(missing[row])) for row in np.flatnonzero(missing))
    steps = 1e3 * np.diff(motion.t)
    text = f"irregular steps of {steps.min():.4g} to {steps.max():.4g} ms resampled to {1e3 * dt_s:.6g} ms"
    even = replace(
        motion,
        t=at,
        columns={role: np.concatenate([drawn[role] for _, drawn in parts]) for role in motion.columns},
        labels=None if motion.labels is None else motion.labels[rows],
        notes=(*motion.notes, Note("resampled", text, columns=("t",))),
    )
    return even, dt_s, gaps


def _moved(role: str, t: Floats, values: Floats, at: Floats, dt_s: float) -> Floats:
    """Return a column at some instants (n,): of readings the nearest sample, moved along their smooth course.

    A curve through the samples would take noise out of what lies midway, and a tracker would believe it.
    """
    course = curve_through(role, t, values, bool(np.diff(t).min() < CROWDED * dt_s))
    if role in JOINT_ROLES:
        return course(at)
    nearest = np.searchsorted((t[1:] + t[:-1]) / 2.0, at)
    grid = t[0] + dt_s * np.arange(int((t[-1] - t[0]) / dt_s) + 2)
    smooth = lowpass(course(np.minimum(grid, t[-1])), dt_s, _COURSE / dt_s)
    along = scipy.interpolate.make_interp_spline(grid, smooth, k=1, axis=0)
    return np.asarray(values[nearest] + along(at) - along(t[nearest]), dtype=np.float64)
