r"""What is not known of the torque: the filter that makes its noise white, and the shapes of what has no spectrum.

A joint's row is ``Y p + C c = u``. Its noise is that of the torque, white, and that of the angles differentiated
twice, with a power spectrum

    S(f) = diag(s_u^2) + mean(M diag(s_q^2) M^T) (2 pi f)^4,

a matrix, for the noise of one angle enters the equations of all joints. Both sides pass the zero-phase filter
``L^-1`` with ``L L^T = S``, and what lies beyond the columns' corner is cut off. The residual of the true model is
then white with variance 1, so that plain least squares is all but maximum likelihood, and no frequency is thrown
away that has information. A slower grid holds all that remains.

What holds a stuck joint, what a jump has done within the step it came in, and what the ends of a motion do have
shapes. Those of any size are eliminated from the equations, those whose size is known roughly only weigh less
(`weighting`).
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from arm.model import Floats

#: The band falls off, as a squared sine, over this fraction of it: 3/8 of the noise in there pass.
_EDGE = 0.2


#: How long the weight of an equation takes to rise from 0 to 1 at an end [s].
RISE_S = 0.06
#: A joint that is this slow for so long is stuck: one that only turns round is through in a millisecond [s].
STUCK_S = 0.012
#: Well inside a rest is what lasts this long once this much is cut off at both its ends [s].
LASTS_S = 0.1


@dataclass(frozen=True)
class Whitening:
    """The filter that makes noise white.

    Attributes
    ----------
    torque_noise : (n_joint,)
        White part of the noise, as rms a sample.
    acceleration_noise : (n_joint, n_joint)
        Factor of ``(2 pi f)^4`` in the noise's covariance a sample.
    band_hz : float
    stride : int
        Decimation factor.
    """

    torque_noise: Floats
    acceleration_noise: Floats
    band_hz: float
    stride: int
    _windows: dict[tuple[int, float], tuple[Floats, Floats, int]] = field(
        default_factory=dict, init=False, repr=False
    )

    @property
    def seen_hz(self) -> float:
        """Where the noise of differentiated angles outgrows that of the torque, at the last joint to."""
        rate = np.sqrt(
            np.max(
                self.torque_noise
                / np.sqrt(np.maximum(np.diag(self.acceleration_noise), np.finfo(np.float64).tiny))
            )
        )
        return float(np.clip(rate / (2.0 * np.pi), 1.0, self.band_hz))

    @property
    def frequencies(self) -> Floats:
        """Frequencies over which what is smooth is averaged over the band, (20,) [Hz]."""
        return self.band_hz * np.linspace(0.0, 1.0, 20)

    def covariance(self, f: float) -> Floats:
        """Return the noise's covariance a sample at a frequency [Hz], (n_joint, n_joint)."""
        return np.diag(self.torque_noise**2) + self.acceleration_noise * (2.0 * np.pi * f) ** 4

    def mean_noise(self, joint: int, weight: Floats, dt_s: float) -> float:
        """Return the noise of a weighted mean of a joint's unfiltered equation, rms [N m or N].

        The angles' noise enters it by the weight's second derivative, for a mean of differences is one of ends.

        Parameters
        ----------
        joint : int
        weight : (n_sample,)
        dt_s : float
        """
        bend = np.diff(np.pad(weight, 2), 2) / dt_s**2
        white, angles = self.torque_noise[joint], self.acceleration_noise[joint, joint]
        return float(np.sqrt(white**2 * (weight @ weight) + angles * (bend @ bend)))

    def white(self, rows: Floats, dt_s: float, joints: slice = slice(None)) -> Floats:
        """Return rows of some joints, filtered and on the slower grid, (n_slower, n_joint, …)."""
        n, n_row, rest = len(rows), rows.shape[1], rows.shape[2:]
        gain, weight, slower = self._window(n, dt_s)
        flat = rows.reshape(n, -1) * weight
        kept = len(gain)  # nothing is left beyond the band
        part = scipy.fft.rfft(flat, slower * self.stride, axis=0)[:kept].view(np.float64).reshape(kept, n_row, -1)
        passed = (gain[:, :, joints] @ part).reshape(kept, -1).view(np.complex128)
        white = scipy.fft.irfft(passed, slower, axis=0)[: -(-n // self.stride)]
        return np.asarray(white, dtype=np.float64).reshape(len(white), gain.shape[1], *rest)

    def _window(self, n: int, dt_s: float) -> tuple[Floats, Floats, int]:
        """Return gains (n_frequency, n_joint, n_joint), weights (n, 1) and the size of the slower grid."""
        key = n, dt_s
        if key not in self._windows:
            slower = scipy.fft.next_fast_len(-(-(n + round(1.0 / dt_s)) // self.stride), real=True)
            f = scipy.fft.rfftfreq(slower * self.stride, dt_s)
            band = self.band(f)
            f, band = f[band > 0.0], band[band > 0.0]
            noise = np.diag(self.torque_noise**2) + self.acceleration_noise * (2 * np.pi * f[:, None, None]) ** 4
            root = np.linalg.inv(np.linalg.cholesky(noise))
            gain = root * (band / np.sqrt(self.stride))[:, None, None]
            self._windows[key] = gain, end_weight(n, dt_s)[:, None], slower
        return self._windows[key]

    def band(self, f: Floats) -> Floats:
        """Return the share of an amplitude that passes at some frequencies [Hz]."""
        edge = np.clip((self.band_hz - f) / (_EDGE * self.band_hz), 0.0, 1.0)
        return np.asarray(np.sin(np.pi / 2.0 * edge) ** 2, dtype=np.float64)

    def flat_share(self, dt_s: float) -> float:
        """Return which share of the slower grid's frequencies lies where the band is flat, 0 to 1."""
        return min(2.0 * self.stride * dt_s * (1.0 - _EDGE) * self.band_hz, 1.0)

    def n_in_band(self, n_slower: int, dt_s: float) -> float:
        """Return the effective number of observations in some samples of the slower grid."""
        return 2.0 * self.stride * dt_s * (1.0 - 0.625 * _EDGE) * self.band_hz * n_slower


def end_weight(n: int, dt_s: float) -> Floats:
    """Return a weight that rises smoothly from 0 at one end of a motion and falls to 0 at the other."""
    rise = min(max(1, round(RISE_S / dt_s)), n // 2)
    weight = np.ones(n)
    weight[:rise] = np.sin(np.pi / 2.0 * (np.arange(rise) + 0.5) / rise) ** 2
    weight[n - rise :] = weight[:rise][::-1]
    return weight


def end_shapes(n: int, dt_s: float) -> Floats:
    """Return the torques, to be weighted, that the weight makes of the angles' noise at both ends, (n_sample, 4).

    At each it makes an impulse and its derivative.
    """
    weight = end_weight(n, dt_s)
    first, second = np.gradient(weight), np.gradient(np.gradient(weight))
    halves = np.arange(n) < n // 2
    shapes = np.stack([first * halves, second * halves, first * ~halves, second * ~halves], axis=1)
    return np.asarray(shapes / weight[:, None], dtype=np.float64)


def holding_shapes(stuck: NDArray[np.bool_], dt_s: float) -> Floats:
    """Return the shapes of which the torque is made up that holds one joint, (n_sample, n_shape).

    It is as smooth as the drive's is meanwhile: linear B-splines with knots `RISE_S` apart.
    """
    n = len(stuck)
    shapes = [np.zeros((n, 0))]
    for begin, end in intervals(stuck):
        knots = _knots(begin, end, dt_s)
        samples = np.arange(begin, end)
        for k in range(len(knots)):
            spline = np.zeros(n)
            spline[begin:end] = np.interp(samples, knots, np.eye(len(knots))[k])
            shapes.append(spline[:, None])
    return np.concatenate(shapes, axis=1)


def rest_shapes(stuck: NDArray[np.bool_], dt_s: float) -> Floats:
    """Return torques that last as long as one long rest of a joint each, (n_sample, n_rest)."""
    rests = [(begin, end) for begin, end in intervals(stuck) if (end - begin) * dt_s >= LASTS_S + 2.0 * RISE_S]
    shapes = np.zeros((len(stuck), len(rests)))
    for k, (begin, end) in enumerate(rests):
        shapes[begin:end, k] = 1.0
    return shapes


def _knots(begin: int, end: int, dt_s: float, ends_s: tuple[float, ...] = (0.0, 0.015, 0.03)) -> Floats:
    """Return the knots of a rest's B-splines, in samples: close at its ends, less close between."""
    near = np.array(ends_s) / dt_s
    near = near[(near == 0.0) | (near < 0.5 * (end - 1 - begin))]
    low, high = begin + near[-1], end - 1 - near[-1]
    count = max(1, round((high - low) * dt_s / RISE_S)) + 1
    return np.concatenate([begin + near[:-1], np.linspace(low, high, count), end - 1 - near[:-1][::-1]])


def lasting(stuck: NDArray[np.bool_], dt_s: float) -> NDArray[np.bool_]:
    """Return what of a mask (n_sample, n_joint) lasts: a joint that passes through zero speed is not stuck."""
    kept = np.zeros(stuck.shape, dtype=np.bool_)
    for j in range(stuck.shape[1]):
        for begin, end in intervals(stuck[:, j]):
            if end - begin >= STUCK_S / dt_s:
                kept[begin:end, j] = True
    return kept


def intervals(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return where a mask (n_sample,) is set: the first sample of each run, and the first behind it."""
    edges = np.diff(np.concatenate([[0], mask.astype(np.int8), [0]]))
    return list(zip(np.flatnonzero(edges == 1).tolist(), np.flatnonzero(edges == -1).tolist(), strict=True))


def inner_rests(stuck: NDArray[np.bool_], dt_s: float) -> list[slice]:
    """Return the samples well inside the rests of one joint, (n_sample,): there it does stand still."""
    cut = round(RISE_S / dt_s)
    return [
        slice(begin + cut, end - cut)
        for begin, end in intervals(stuck)
        if (end - begin - 2 * cut) * dt_s >= LASTS_S
    ]


def jump_shapes(jumps: Sequence[tuple[float, int, float]], n: int, n_joint: int) -> Floats:
    """Return the impulses by which jumps of the torque may be off, one standard error each, (n, n_joint, n_jump).

    A jump comes at some instant between two samples, and a fast loop takes part of it back before the next.

    Parameters
    ----------
    jumps : sequence of (sample, joint, error)
        As `Motion.jumps` has them.
    n, n_joint : int
    """
    shapes = np.zeros((n, n_joint, len(jumps)))
    for k, (at, joint, error) in enumerate(jumps):
        first = min(int(at), n - 1)
        part = at - first
        shapes[first, joint, k] = (1.0 - part) * error
        shapes[min(first + 1, n - 1), joint, k] += part * error
    return shapes
