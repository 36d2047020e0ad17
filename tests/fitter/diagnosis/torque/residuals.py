"""Residuals with a background that is known, and pulses hidden in it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.model import Floats
from fitter.data.derivatives import lowpass
from fitter.diagnosis.torque.background import Background, Rows, outputs, state_space
from fitter.diagnosis.torque.pulse_column import pulse_means
from fitter.diagnosis.torque.residual_torque import ResidualTorque

STEP_S, LASTS_S, BAND_HZ = 0.04, 10.0, 12.5


def coloured(rng: np.random.Generator, std: float = 0.05, time_constant_s: float = 0.3) -> Floats:
    """Return an Ornstein-Uhlenbeck process with white noise of a fifth of its size, (n,) [N m]."""
    n = round(LASTS_S / STEP_S)
    kept = np.exp(-STEP_S / time_constant_s)
    x = np.zeros(n)
    x[0] = std * rng.normal()
    for k in range(1, n):
        x[k] = kept * x[k - 1] + std * np.sqrt(1.0 - kept**2) * rng.normal()
    return x + 0.2 * std * rng.normal(size=n)


def trial(rng: np.random.Generator, pulses: Sequence[tuple[float, float, float, str]] = ()) -> ResidualTorque:
    """Return a residual of one joint with pulses of a start, a duration, a size and a form."""
    t = np.arange(round(LASTS_S / STEP_S)) * STEP_S
    r = coloured(rng)
    for start_s, duration_s, size, form in pulses:
        r += size * pulse_means(t, STEP_S, start_s, duration_s, form)
    torque = np.sin(2.0 * np.pi * 0.7 * t)[:, None]
    known = np.ones((len(t), 1), dtype=bool)
    noise = np.array([0.005]), np.array([0.0])
    return ResidualTorque(t, r[:, None], known, torque, BAND_HZ, *noise, *np.zeros((2, len(t), 1)), ~known)


def finer(part: ResidualTorque, parts: int = 8) -> ResidualTorque:
    """Return a residual with some samples a row, each as the row."""
    step_s = STEP_S / parts
    t = (np.arange(parts * len(part.t)) - 0.5 * (parts - 1)) * step_s
    rows = ("r", "known", "torque", "friction", "turning", "at_rest")
    return replace(part, t=t, **{name: np.repeat(getattr(part, name), parts, axis=0) for name in rows})


def filtered_pulse(start_s: float, duration_s: float, size: float, form: str, parts: int = 8) -> Floats:
    """Return a pulse as rows have it, (n,): behind the band's filter, the mean of some parts of each step."""
    fine_s = STEP_S / parts
    t = (np.arange(parts * round(LASTS_S / STEP_S)) - 0.5 * (parts - 1)) * fine_s
    samples = lowpass(size * pulse_means(t, fine_s, start_s, duration_s, form), fine_s, BAND_HZ)
    return np.asarray(samples.reshape(-1, parts).mean(axis=1))


def drawn(model: Background, rows: Rows, rng: np.random.Generator) -> Rows:
    """Return rows whose residual is drawn from a background of normal noise."""
    F, Q, P, white = state_space(model.numbers, rows.step_s, rows.torque_noise, rows.angle_noise)
    C, std = outputs(rows.signals, rows.step_s), np.sqrt(white + model.uneven_variance(rows))
    state = rng.multivariate_normal(np.zeros(len(F)), P, method="svd")
    new = rng.multivariate_normal(np.zeros(len(F)), Q, len(C), method="svd")
    r = std * rng.standard_normal(len(C))
    for k in range(len(C)):
        r[k] += C[k] @ state
        state = F @ state + new[k]
    return replace(rows, r=r)
