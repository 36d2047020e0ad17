"""Up to which frequency a motion stands out from the noise of its measurement.

Joint motion has its power at low frequencies, and noise of an angle grows with the fourth power of the
frequency once it is differentiated twice. The spectrum of the acceleration therefore falls from the motion into
a valley and climbs again with the noise. The valley's floor is the noise where it matters, and it also holds what
is no white noise: ripple of an encoder, vibration of the rig. A fit that sees frequencies beyond the motion's
takes that for acceleration and shrinks every inertia.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: The motion's power must be this many times the valley's floor (10 dB) to be fitted.
SIGNAL_TO_NOISE = 10.0
#: From one band of the spectrum to the next, and how many bins each must hold.
WIDER = 2.0 ** (1.0 / 3.0)
BINS_A_BAND = 4
#: A swing has power at its odd harmonics and little between them: motion may go on up to this many times higher.
HARMONIC = 3.0
#: A motion that fills this share of the Nyquist range needs no filter.
FULL_RANGE = 0.5


@dataclass(frozen=True)
class Signal:
    """Columns that become an acceleration after ``missing`` differentiations.

    Attributes
    ----------
    values : ndarray of shape (n, n_joint)
        Angles (2), velocities (1) or accelerations (0).
    dt_s : float
        Step [s].
    missing : int
        Differentiations to go.
    """

    values: Floats
    dt_s: float
    missing: int


def motion_edge_hz(signals: Sequence[Signal]) -> float | None:
    """Return the frequency above which acceleration is no longer well above noise.

    Parameters
    ----------
    signals : sequence of Signal
        The trials of one set; their spectra are added up over trials and joints.

    Returns
    -------
    float or None
        The highest frequency [Hz] at which the power of the acceleration is ten times the floor of the valley
        between motion and noise. Where the valley's floor is motion itself, which falls off slowly after a jump
        of the acceleration: ten times the white noise seen beyond the valley. None if the motion fills the
        measured range, so that noise is no matter.
    """
    nyquist = min(0.5 / signal.dt_s for signal in signals)
    longest = max(len(signal.values) * signal.dt_s for signal in signals)
    edges = _band_edges(BINS_A_BAND / longest, nyquist, 1.0 / longest)
    if len(edges) < 4:
        return None
    power = np.zeros(len(edges) - 1)
    count = np.zeros(len(edges) - 1)
    for signal in signals:
        frequency, spectrum = _acceleration_spectrum(signal)
        band = np.searchsorted(edges, frequency, side="right") - 1
        inside = (band >= 0) & (band < len(power))
        np.add.at(power, band[inside], spectrum[inside])
        np.add.at(count, band[inside], 1.0)
    centre = np.sqrt(edges[:-1] * edges[1:])
    level = power / count

    floor = np.minimum.accumulate(level[::-1])[::-1]  # what is seen at this frequency or above
    strong = level >= SIGNAL_TO_NOISE * floor
    k = int(np.argmax(level / centre**2))  # where the velocity has most of its power: certainly motion
    if not strong[k]:
        return _edge_above_white_noise(centre, level, 2 * max(signal.missing for signal in signals))
    while (further := np.flatnonzero(strong & (centre > centre[k]) & (centre <= HARMONIC * centre[k]))).size:
        k = int(further[-1])
    if k + 1 == len(level):
        return None
    threshold = SIGNAL_TO_NOISE * floor[k]
    share = np.log(level[k] / threshold) / np.log(level[k] / level[k + 1])
    edge = float(centre[k] * (centre[k + 1] / centre[k]) ** share)
    return None if edge > FULL_RANGE * nyquist else edge


def _edge_above_white_noise(centre: Floats, level: Floats, power: int) -> float | None:
    """Return where acceleration sinks to ten times the noise that rises with a power of the frequency."""
    valley = int(np.argmin(level))
    noisy = np.flatnonzero((np.arange(len(level)) > valley) & (level > SIGNAL_TO_NOISE * level[valley]))
    if not len(noisy):
        return None
    noise = np.median(level[noisy] / centre[noisy] ** power) * centre**power
    sunk = np.flatnonzero(level < SIGNAL_TO_NOISE * noise)
    return float(centre[max(int(sunk[0]) - 1, 0)]) if len(sunk) else None


def _acceleration_spectrum(signal: Signal) -> tuple[Floats, Floats]:
    """Return frequencies and the power density of the acceleration, summed over the joints."""
    differences = np.diff(signal.values, n=signal.missing, axis=0) / signal.dt_s**signal.missing
    frequency, density = scipy.signal.periodogram(
        scipy.signal.detrend(differences, axis=0, type="constant"), fs=1.0 / signal.dt_s, window="hann", axis=0
    )
    # what differences lose against derivatives
    response = np.sinc(frequency * signal.dt_s) ** (2 * signal.missing)
    return frequency, density.sum(axis=1) / response


def _band_edges(lowest: float, highest: float, resolution: float) -> Floats:
    """Return edges of bands that are an equal part of an octave, or wider where bins are scarce."""
    edges = [lowest]
    while (following := max(edges[-1] * WIDER, edges[-1] + BINS_A_BAND * resolution)) < highest:
        edges.append(following)
    return np.array([*edges[:-1], highest])
