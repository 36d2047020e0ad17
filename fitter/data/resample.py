"""From the time stamps that a file came with to a uniform grid."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import count

import numpy as np
import scipy
from numpy.typing import NDArray

from fitter.data.derivatives import lowpass
from fitter.data.leaps import MINIMUM_SAMPLES, split_at_leaps
from fitter.data.motions import Measured
from limbcal.errors import ConfigError, DataError
from limbcal.note import Note
from protocol.tables.columns import DRIVE_ROLES
from protocol.tables.stamps import holes

Floats = NDArray[np.float64]
Curve = Callable[[Floats], Floats]

#: A stamp may lie this share of a step off the grid before the grid is doubted.
TOLERANCE = 0.005
#: Stamps may have been rounded to this many decimals at most, and then lie off the grid by that.
MOST_DECIMALS = 7
#: A cubic spline through samples closer than this share of the usual step swings out.
CROWDED = 0.2
#: Factor over the samples' own rate beyond which a rate adds nothing but memory.
MOST_FINER = 100
#: A lower rate is reached after everything above this share of it has been taken out.
ANTI_ALIAS = 0.4


@dataclass(frozen=True)
class Uniform:
    """A motion on a uniform grid.

    Attributes
    ----------
    measured : Measured
        Columns on the grid; ``t`` starts at 0.
    dt_s : float
        Step of the grid [s].
    began_s : float
        The first stamp as the file had it: trials may follow one another on one clock.
    """

    measured: Measured
    dt_s: float
    began_s: float = 0.0


def split_at_holes(motion: Measured) -> list[Measured]:
    """Part a motion at holes, see `protocol.tables.stamps`; what was not measured is not made up.

    Pieces with fewer than `MINIMUM_SAMPLES` samples are left out, unless there is no other; the notes say so.
    """
    rows = holes(motion.t)
    if not rows.size:
        return [motion]
    bounds = [0, *rows.tolist(), len(motion.t)]
    spans = [span for span in zip(bounds[:-1], bounds[1:], strict=True) if span[1] - span[0] >= MINIMUM_SAMPLES]
    if not spans:
        return split_at_leaps(motion)
    before, after = float(motion.t[rows[0] - 1]), float(motion.t[rows[0]])
    row = motion.first_row + int(rows[0]) + 1
    text = (
        f"in row {row} t goes from {before:.9g} to {after:.9g} s: "
        f"parted at {rows.size} hole(s) of up to {np.diff(motion.t)[rows - 1].max():.4g} s, "
        f"{len(spans)} piece(s) kept"
    )
    note = Note("gap", text, source=motion.where, columns=("t",), row=row, from_s=before, to_s=after)
    return [motion.piece(begin, end, k + 1, note) for k, (begin, end) in enumerate(spans)]


def time_step(t: Floats) -> tuple[float, bool]:
    """Return the step of some rising time stamps, and whether they already are a uniform grid.

    Parameters
    ----------
    t : ndarray of shape (n,)
        Time stamps [s].

    Returns
    -------
    dt_s : float
        The mean step of a uniform grid, the median step of anything else, rounded to the fewest digits that
        make no difference (0.1 % of a median).
    uniform : bool
        True if no stamp is off the grid by more than `TOLERANCE` of a step, or than its decimals can say.
    """
    mean = float(t[-1] - t[0]) / (len(t) - 1)
    off = np.abs(t - t[0] - mean * np.arange(len(t))).max()
    if off <= max(TOLERANCE * mean, _resolution(t, mean)):
        return _rounded(mean, within=TOLERANCE / len(t)), True  # less than a fiftieth of a step in all
    return _rounded(float(np.median(np.diff(t))), within=1e-3), False


def resample(motion: Measured, rate_hz: float | None = None) -> Uniform:
    """Put a motion on a uniform grid.

    Angles, velocities and positions are drawn through by a cubic spline (a shape-preserving one where samples
    crowd), torques by a shape-preserving cubic that never overshoots, references, which may jump, by straight
    lines; switches and gains of the drives are those of the nearest sample. Before the rate is lowered everything
    that it could not carry is taken out without a phase shift.

    Parameters
    ----------
    motion : Measured
        A motion without holes.
    rate_hz : float, optional
        Rate of the grid. Default: the stamps' own, see `time_step`.

    Returns
    -------
    Uniform
        Its notes say what was done.

    Raises
    ------
    DataError
        If there are fewer than `MINIMUM_SAMPLES` samples.
    ConfigError
        If the rate is not positive.
    """
    if len(motion.t) < MINIMUM_SAMPLES:
        raise DataError(
            f"{motion.where}: trial {motion.name!r} has {len(motion.t)} samples, "
            f"expected at least {MINIMUM_SAMPLES}"
        )
    if rate_hz is not None and not rate_hz > 0.0:
        raise ConfigError(f"rate_hz is {rate_hz}, expected a number above 0")
    own_step, uniform = time_step(motion.t)
    t = motion.t - motion.t[0]
    dt_s = own_step if rate_hz is None else 1.0 / rate_hz
    if dt_s < own_step / MOST_FINER:
        raise ConfigError(
            f"rate_hz is {rate_hz:g}, but {motion.where} has {1.0 / own_step:.6g} rows a second, expected at most "
            f"{MOST_FINER} times that"
        )
    if uniform and abs(dt_s - own_step) <= 1e-6 * own_step:
        return Uniform(replace(motion, t=_stamps(len(t), own_step)), own_step, float(motion.t[0]))

    steps = np.diff(t)
    crowded = bool(steps.min() < CROWDED * np.median(steps))
    columns = dict(motion.columns)
    if dt_s > 1.5 * own_step:
        grid = _grid(t[-1], own_step)
        corner_hz = ANTI_ALIAS / dt_s
        columns = {
            role: curve_through(role, t, values, crowded)(grid)
            if role == "contradicted" or role in DRIVE_ROLES
            else lowpass(curve_through(role, t, values, crowded)(grid), own_step, corner_hz)
            for role, values in columns.items()
        }
        t = grid
    grid = _grid(t[-1], dt_s)
    columns = {role: curve_through(role, t, values, crowded)(grid) for role, values in columns.items()}
    was = "steps of" if uniform else "irregular steps of"
    said = f"{was} {1e3 * steps.min():.4g} to {1e3 * steps.max():.4g} ms resampled to {1e3 * dt_s:.6g} ms"
    note = Note("resampled", said, columns=("t",))
    if len(grid) < MINIMUM_SAMPLES:
        raise DataError(
            f"{motion.where}: trial {motion.name!r} has {len(grid)} samples at {1.0 / dt_s:.6g} Hz, "
            f"expected at least {MINIMUM_SAMPLES}"
        )
    notes = (*motion.notes, note)
    resampled = replace(motion, t=grid, columns=columns, notes=notes, draws=None)  # which are of other instants
    return Uniform(resampled, dt_s, float(motion.t[0]))


def _grid(end_s: float, dt_s: float) -> Floats:
    return _stamps(int(np.floor(end_s / dt_s + 1e-6)) + 1, dt_s)


def _stamps(n: int, dt_s: float) -> Floats:
    return dt_s * np.arange(n, dtype=np.float64)


def curve_through(role: str, t: Floats, values: Floats, crowded: bool) -> Curve:
    """Return the curve through a column that suits what it is, by the column's role."""
    if role in DRIVE_ROLES:
        between = (t[1:] + t[:-1]) / 2.0
        return lambda at: values[np.searchsorted(between, at, side="right")]
    if role in ("ref", "contradicted"):
        line = scipy.interpolate.make_interp_spline(t, values, k=1, axis=0)
        return lambda at: np.asarray(line(np.minimum(at, t[-1])))
    if role == "tau" or crowded:
        with np.errstate(over="ignore"):  # 1 over a slope of 1e-310; the harmonic mean is then 0
            return scipy.interpolate.PchipInterpolator(t, values, axis=0)
    return scipy.interpolate.CubicSpline(t, values, axis=0)


def _resolution(t: Floats, step: float) -> float:
    """Return how far rounding to some decimals can take stamps off their grid; 0 if they were not rounded."""
    for decimals in range(MOST_DECIMALS + 1):
        unit = 10.0**-decimals
        if unit <= 0.5 * step and np.abs(t - np.round(t, decimals)).max() <= 1e-6 * unit:
            return unit  # half of it for each stamp, and half for the first and last that span the grid
    return 0.0


def _rounded(step: float, within: float) -> float:
    """Return the shortest decimal number within some relative distance of a step."""
    numbers = (float(f"{step:.{digits}e}") for digits in count())
    return next(rounded for rounded in numbers if abs(rounded - step) <= within * step)
