r"""Equations of an arm under law (5) that no slow equilibrium trajectory reaches.

With a free trajectory ``r_j(t)`` for every joint,

.. math:: W_j(q, \dot q, \ddot q)\, b - k_{vj} \dot q_j + k_{pj} q_j = k_{pj} r_j(t),

any ``b`` and any gains satisfy some ``r``: motion alone tells nothing. What may be assumed is that ``r`` is slower
than what the body makes of it: a spline with two knots a period of its bandwidth. The part of the equation that is
orthogonal to all such splines is homogeneous in ``(b, k_p)``; ``k_v`` multiplies what viscous friction does.
"""

from dataclasses import dataclass

import numpy as np
import scipy
import scipy.fft

from arm.base_parameters import BaseParameters
from arm.model import Arm, Floats
from fitter.controller.law_columns import law_rows
from fitter.controller.row_noise import RowNoise
from fitter.data.derivatives import lowpass
from fitter.data.refilter import wider
from fitter.data.trial import Trial

#: Degree of the splines; one of two knots a period leaves 3 % of a sine of its bandwidth, and 2e-4 of half of it.
_DEGREE = 5
#: Knots a period of a spline's bandwidth.
_KNOTS = 2.0
#: Corner [Hz] at the least: up to there voluntary movement has next to all of its power (Winter 2009).
_CORNER_HZ = 6.0
#: Samples a period of the corner that are kept.
_SAMPLES = 5.0
#: Corner of the equations, in corners of a plain fit: the noise that comes in is a part of the model.
_WIDER = 3.0
#: A corner is at most this fraction of the sampling rate.
_HIGHEST = 0.15
#: Corner of the angles, in corners of the equations (`fitter.data.trials`): what their noise passes.
_ANGLES = 2.25
#: Draws of noise that its products are averaged over.
_DRAWS = 8
#: Noise [rad] that angles have at the least: some are computed, and exact.
_LEAST_RAD = 1e-7
#: Rms of fourth differences of white noise of rms 1; median of the size of a normal deviate.
_FOURTH, _MEDIAN = 70.0**0.5, 0.6745


@dataclass(frozen=True)
class EquilibriumColumns:
    """Unknowns of an arm under law (5): base parameters without dry friction, then kp of every joint.

    Attributes
    ----------
    names, units : tuple of str
        ``D1-kv1`` stands for what multiplies a joint's velocity.
    kept : tuple of int
        Places in the columns of `law_rows`.
    reference : int
        The last link's inertia, to which ratios are taken.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    kept: tuple[int, ...]
    reference: int


def angle_noise(trial: Trial) -> Floats:
    """Return the rms of what is white in a trial's angles as they were measured, (n_joint,) [rad or m].

    Motion has next to nothing in a fourth difference, of which the median is taken.
    """
    q = trial.whole.get("q", trial.q)
    size = np.median(np.abs(np.diff(q, 4, axis=0)), axis=0) / (_MEDIAN * _FOURTH)
    return np.asarray(np.maximum(size, _LEAST_RAD), dtype=np.float64)


class TrialEquations:
    """A trial's equations, with the noise that errors of its angles make.

    Parameters
    ----------
    arm : Arm
        Its geometry and gravity.
    base : BaseParameters
    columns : EquilibriumColumns
    trial : Trial
    rng : numpy.random.Generator
        Draws the noise.
    """

    def __init__(
        self, arm: Arm, base: BaseParameters, columns: EquilibriumColumns, trial: Trial, rng: np.random.Generator
    ) -> None:
        noise = angle_noise(trial)
        limit_hz = _HIGHEST / trial.dt_s
        wanted_hz = min(max(_WIDER * trial.band_hz, _CORNER_HZ), limit_hz)
        wide = wider(trial, max(wanted_hz / trial.band_hz, 1.0))
        smooth_hz = wide.band_hz if np.isfinite(wide.band_hz) else _CORNER_HZ
        self.corner_hz = corner = float(min(smooth_hz, limit_hz))
        step = max(1, int(1.0 / (_SAMPLES * corner * trial.dt_s)))
        end = round(1.0 / (corner * trial.dt_s))  # a filter's own ends are its guess

        def seen(rows: Floats) -> Floats:
            return lowpass(rows, trial.dt_s, corner, ends="even")[end : len(rows) - end : step]

        def rows_at(q: Floats, dq: Floats, ddq: Floats) -> Floats:
            return law_rows(arm, base, q, dq, ddq, -q)[..., list(columns.kept)]

        plain = rows_at(wide.q, wide.dq, wide.ddq)
        self.rows = seen(plain)
        self.t = np.arange(len(self.rows), dtype=np.float64) * (step * trial.dt_s)
        self._noise = []
        for _ in range(_DRAWS):
            e = _drawn(rng, noise, len(wide.q), trial.dt_s, _ANGLES * corner)
            noisy = rows_at(wide.q + e[0], wide.dq + e[1], wide.ddq + e[2])
            self._noise.append(seen(noisy - plain))

    @property
    def seconds(self) -> float:
        """How long the trial is [s]."""
        return float(self.t[-1] - self.t[0])

    def beyond(self, bandwidth_hz: float) -> tuple[Floats, RowNoise]:
        """Return the equations that no trajectory of some bandwidth reaches, by frequency, and their noise.

        Parameters
        ----------
        bandwidth_hz : float

        Returns
        -------
        rows : (n_frequency * n_joint, n_column)
        noise : RowNoise
        """
        Q: Floats = np.linalg.qr(_splines(self.t, bandwidth_hz))[0]
        hz = np.arange(len(self.t)) / (2.0 * (self.t[-1] + self.t[1] - 2.0 * self.t[0]))
        used = (hz > bandwidth_hz) & (hz < self.corner_hz)

        def spectrum(rows: Floats) -> Floats:
            flat = rows.reshape(len(rows), -1)
            left = (flat - Q @ (Q.T @ flat)).reshape(rows.shape)
            return np.asarray(scipy.fft.dct(left, axis=0, norm="ortho")[used])

        rows = spectrum(self.rows)
        return rows.reshape(-1, rows.shape[2]), RowNoise(np.stack([spectrum(one) for one in self._noise]))


def _splines(t: Floats, bandwidth_hz: float) -> Floats:
    """Return the splines of some bandwidth at some times, (n_sample, n_spline)."""
    parts = max(int(np.ceil(_KNOTS * bandwidth_hz * (t[-1] - t[0]))), 1)
    inner = np.linspace(t[0], t[-1], parts + 1)
    knots = np.concatenate([np.full(_DEGREE, t[0]), inner, np.full(_DEGREE, t[-1])])
    return np.asarray(scipy.interpolate.BSpline.design_matrix(t, knots, _DEGREE).toarray())


def _drawn(rng: np.random.Generator, noise: Floats, n: int, dt_s: float, limit_hz: float) -> list[Floats]:
    """Return white noise of angles up to some frequency, and its two derivatives, each (n_sample, n_joint)."""
    spectrum = np.fft.rfft(rng.standard_normal((n, len(noise))) * noise, axis=0)
    omega = 2.0 * np.pi * np.fft.rfftfreq(n, dt_s)[:, None]
    spectrum = np.where(omega < 2.0 * np.pi * limit_hz, spectrum, 0.0)
    return [np.asarray(np.fft.irfft(spectrum * (1j * omega) ** k, n, axis=0)) for k in range(3)]
