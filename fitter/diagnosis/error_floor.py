r"""The noise of the equations under a model: causes change the masses that noise of the angles is multiplied by.

The residual of one draw of noise that passes the filters of the data gives the weights of a model.

The floor: the model's discrepancy, as noise of each joint's equation in addition to the sensors'.

.. math:: S_j(f) = P_j + D_j + E_j Q_j (2 \pi f)^4

``P`` and ``Q`` are the sensors' noise under the model. ``D`` is a white missing torque, and ``E`` more noise of
the angles than is known of, both by maximum likelihood (Whittle 1953) from the residual of the learning
trials. Where the model is exact there is no floor: ``D = 0, E = 1``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import scipy
import scipy.fft
from numpy.typing import NDArray

from arm.model import Arm, Floats
from fitter.diagnosis.cutoff import BAND_SHARE, noise_of_angles, white_noise
from fitter.diagnosis.equations import Equations
from fitter.diagnosis.errors_in_variables import noisier
from fitter.diagnosis.evidence import NOISE_VARIANCE_TOLERANCE, Floor
from fitter.diagnosis.holding_torque import holding_sizes
from fitter.diagnosis.least_squares import NEGLIGIBLE, ROUNDED, TINY, scaled_lstsq
from fitter.diagnosis.model import BARE, Candidate, Model
from fitter.diagnosis.motion import SAMPLES, Motion
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.weighting import Weighting


def regression_of(
    arm: Arm,
    motions: Sequence[Motion],
    denied: tuple[str, ...] = (),
    known: tuple[int, float] | None = None,
    given: Model = BARE,
) -> Regression:
    """Return the equations of a run whose noise is only guessed from a first fit of the base model.

    Parameters
    ----------
    arm : Arm
        Geometry, gravity, law.
    motions : sequence of Motion
        Learning ones first.
    denied : tuple of str
        See `Regression`.
    known : (column, value), optional
    given : Model
        What acts in addition to every model, see `Equations`.
    """
    crude = Equations(arm, first_weighting(arm, motions), denied, known, given)
    rows = [crude.rows(Model(), motion) for motion in motions if motion.learn]
    values = scaled_lstsq(
        np.vstack([one.design for one in rows]), np.concatenate([one.target.ravel() for one in rows])
    )
    weighted = reweighted(crude, crude.weighting, Model(), values, motions, noisier(arm, motions))
    return Regression(arm, motions, weighted, denied, known, given)


def reweighted(
    equations: Equations,
    used: Weighting,
    model: Model,
    x: Floats,
    motions: Sequence[Motion],
    louder: Mapping[int, Motion],
    part: float = 0.5,
) -> Weighting:
    """Return the filter that makes the noise white under a model.

    Parameters
    ----------
    equations : Equations
    used : Weighting
        It says how large the torque's own noise is, and how wide the band.
    model : Model
    x : (n_factor,)
    motions : sequence of Motion
    louder : mapping of int to Motion
        The same with as much noise again, by their numbers.
    part : float
        Noise is measured above this part of the band, where differentiated angles are all of it.
    """
    n_joint = equations.arm.n_joint
    total, count = np.zeros((n_joint, n_joint)), 0
    white = np.diag(used.torque_noise**2)
    for motion in motions:
        plain, noisy = (equations.residual_torque(model, x, one) for one in (motion, louder[motion.number]))
        window = np.hanning(len(plain))[:, None]
        f = np.fft.rfftfreq(len(plain), motion.dt_s)
        inside = (f >= part * used.band_hz) & (f <= used.band_hz)
        scale = (2.0 * np.pi * f[inside]) ** 4
        spectrum = np.fft.rfft(window * (noisy - plain), axis=0)[inside]
        spectrum /= np.sqrt(np.sum(window**2) * scale)[:, None]
        total += np.real(spectrum.T @ spectrum.conj()) - white * np.sum(1.0 / scale)
        count += int(np.count_nonzero(inside))
    size, axes = np.linalg.eigh(total / max(count, 1))
    least = np.sqrt(ROUNDED) * max(float(size.max()), TINY)
    found = replace(used, acceleration_noise=(axes * np.maximum(size, least)) @ axes.T)
    return replace(found, holding=holding_sizes(equations, found, model, x, motions))


def first_weighting(arm: Arm, motions: Sequence[Motion]) -> Weighting:
    """Return the filter for a run of which no more is known: every joint turns a mass of one by itself.

    Parameters
    ----------
    arm : Arm
        Its law says how the noise of the angles enters a torque that was not measured.
    motions : sequence of Motion
    """
    angle = noise_of_angles([motion.trial for motion in motions])
    u = np.concatenate([motion.u for motion in motions])
    if all("tau" in motion.trial.whole for motion in motions):
        torque = white_noise([motion.trial.whole["tau"] for motion in motions])
    elif arm.control.kp and motions[0].trial.tau is None:
        torque = np.abs(arm.control.kp) * angle
    else:
        torque = np.zeros(arm.n_joint)
    # What counts is the noise's density; the slower grid has the same with fewer samples.
    thinned = np.sqrt(np.mean([motion.trial.dt_s / motion.dt_s for motion in motions]))
    torque, angle = thinned * torque, thinned * angle
    torque = np.maximum(torque, NEGLIGIBLE**2 * np.maximum(np.sqrt(np.mean(u**2, axis=0)), 1e-9))
    q = np.concatenate([motion.q for motion in motions])
    angle = np.maximum(angle, 1e-9 * np.maximum(np.std(q, axis=0), 1.0))
    acceleration = np.diag(angle**2)
    dt_s = max(motion.dt_s for motion in motions)
    corner = min(*(motion.trial.cutoff_hz for motion in motions), 0.4 / dt_s)
    band = BAND_SHARE * corner
    return Weighting(torque, acceleration, band, max(1, int(1.0 / (dt_s * 0.5 * SAMPLES * band))), {})


def floored(regression: Regression, candidate: Candidate) -> tuple[Weighting, Weighting, Floor]:
    """Return the weights under a model by the sensors' noise alone, and with its floor, and the floor.

    Parameters
    ----------
    regression : Regression
        Its weights may have a floor already.
    candidate : Candidate
    """
    model, x = candidate.model, candidate.x
    own = reweighted(regression.equations, regression.sensors, model, x, regression.motions, regression.noisier)
    f, power, freedom = _spectra(regression, candidate)
    omega = (2.0 * np.pi * f) ** 4
    n_joint = len(own.torque_noise)
    ratio, white, steep = np.ones(n_joint), np.zeros(n_joint), np.ones(n_joint)
    for j in range(n_joint):
        torque, angle = own.torque_noise[j] ** 2, own.acceleration_noise[j, j] * omega
        ratio[j] = float(np.sum(power[:, j] / (torque + angle)) / np.sum(freedom[:, j]))
        if ratio[j] > NOISE_VARIANCE_TOLERANCE:
            variance, steep[j] = _likeliest(power[:, j], freedom[:, j], torque, angle)
            white[j] = np.sqrt(variance)
    root = np.sqrt(steep)
    with_floor = replace(
        own,
        torque_noise=np.sqrt(own.torque_noise**2 + white**2),
        acceleration_noise=own.acceleration_noise * np.outer(root, root),
    )
    return own, with_floor, Floor(ratio, white, steep)


def part_of_floor(own: Weighting, with_floor: Weighting) -> float:
    """Return which part of the equations' variance is the floor's, averaged over band and joints, 0 to 1."""
    f = own.frequencies[:, None]
    variances = [
        one.torque_noise**2 + np.diag(one.acceleration_noise) * (2.0 * np.pi * f) ** 4 for one in (own, with_floor)
    ]
    return float(np.mean(1.0 - variances[0] / variances[1]))


def _spectra(regression: Regression, candidate: Candidate) -> tuple[Floats, Floats, Floats]:
    """Return frequencies (n,), the residual's power there, and its degrees of freedom, (n, n_joint).

    Residuals are white under the weights in use, without anything along the axes of what is not known, such as
    what holds a joint: how much of that is left in them depends on how large it was. They get back the colour that
    the weights took.
    """
    weighting = regression.weighting
    parts: list[Sequence[Floats]] = []
    for motion in regression.learning:
        residual = regression.rows(candidate.model, motion).residual(candidate.x)
        white = _known(weighting, motion, residual.reshape(-1, 1)).reshape(residual.shape)
        f = np.fft.rfftfreq(len(white), weighting.stride * motion.dt_s).astype(np.float64)
        inside = (f > 0.0) & (weighting.band(f) == 1.0)
        root = np.linalg.cholesky(np.array([weighting.covariance(at) for at in f[inside]]))
        colour = (root @ np.fft.rfft(white, axis=0)[inside, :, None])[:, :, 0]
        free = root @ _freedom(weighting, motion)[inside] @ root.mT
        freedom = np.einsum("fjj->fj", free).real / np.sum(root**2, axis=2)
        parts.append((f[inside], np.abs(colour) ** 2 / len(white), np.maximum(freedom, np.sqrt(ROUNDED))))
    f, power, freedom = (np.concatenate(column) for column in zip(*parts, strict=True))
    return f, np.asarray(power, dtype=np.float64), freedom


def _known(weighting: Weighting, motion: Motion, flat: Floats) -> Floats:
    """Return white rows (n_slower * n_joint, n_column) without anything along the axes of what is not known."""
    axes, _ = weighting.axes(motion)
    return np.asarray(flat - axes @ (axes.T @ flat), dtype=np.float64)


def _freedom(weighting: Weighting, motion: Motion) -> NDArray[np.complex128]:
    r"""Return the covariance of the remaining white noise at every frequency, (n, n_joint, n_joint).

    All along the axes ``u`` of what is not known is eliminated, so of the noise's power
    ``I - \sum U(f) U(f)^H / n`` is left: little of it where a joint rests and the frequency is low.
    """
    axes, _ = weighting.axes(motion)
    rows = axes.reshape(-1, motion.q.shape[1], axes.shape[1])
    spectra = scipy.fft.rfft(rows, axis=0) / np.sqrt(len(rows))
    return np.asarray(np.eye(rows.shape[1]) - spectra @ spectra.conj().mT, dtype=np.complex128)


def _likeliest(power: Floats, freedom: Floats, torque: Floats | float, angle: Floats) -> tuple[float, float]:
    """Return D and E of one joint: least sum of freedom log S + power / S."""

    def loss(at: Floats) -> float:
        S = torque + np.exp(at[0]) + angle * (1.0 + np.exp(at[1]))
        return float(np.sum(freedom * np.log(S) + power / S))

    mean = max(float(power.sum() / freedom.sum()), TINY)
    options = {"xatol": NEGLIGIBLE, "fatol": NEGLIGIBLE}  # of logarithms
    starts = [(white, steep) for white in (1.0, 0.1) for steep in (0.0, 4.0)]  # either, or a part of both
    found = [
        scipy.optimize.minimize(  # type: ignore[call-overload]
            loss, np.array([np.log(mean * white), steep]), method="Nelder-Mead", options=options
        )
        for white, steep in starts
    ]
    best = min(found, key=lambda one: float(one.fun))
    return float(np.exp(best.x[0])), 1.0 + float(np.exp(best.x[1]))
