"""Pulses that are known to be near are found where they are, with errors that hold."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from fitter.data.derivatives import lowpass
from fitter.diagnosis.torque.likeliest_pulses import at_likeliest, still_likely
from fitter.diagnosis.torque.pulse import Pulse
from fitter.diagnosis.torque.pulse_column import pulse_means
from tests.fitter.diagnosis.torque.residuals import BAND_HZ, finer, trial


def pushed(part, *pulses):
    """Return a residual with pulses behind the filter that it has passed, and near guesses of them."""
    step_s = part.t[1] - part.t[0]
    for start_s, duration_s, size in pulses:
        part.r[:, 0] += lowpass(
            size * pulse_means(part.t, step_s, start_s, duration_s, "rectangular"), step_s, BAND_HZ
        )
    near = [(start_s + 0.02, 1.1 * duration_s, 0.8 * size) for start_s, duration_s, size in pulses]
    return [Pulse(0, 0, *one, *[0.1] * 4, "rectangular", 0.0, 0.0) for one in near]


def errors(found, start_s, duration_s, size):
    off = found.start_s - start_s, found.duration_s - duration_s, found.torque_N_m - size
    return np.array(off) / (found.start_std, found.duration_std, found.torque_std)


@pytest.mark.parametrize("noise", [1.0, 1e-3])
def test_errors_of_the_likeliest_pulses_are_those_that_they_are_off_by(noise):
    """8 pushes of any size, in background that resembles itself for as long as they last, and in hardly any."""
    rng, off = np.random.default_rng(11), []
    for _ in range(8):
        hidden = rng.uniform(2.0, 7.0), rng.uniform(0.2, 0.5), rng.uniform(0.4, 1.0)
        part = trial(rng)
        part = finer(replace(part, r=noise * part.r, torque_noise=noise * part.torque_noise))
        (found,) = at_likeliest([part], pushed(part, hidden))
        off.append(errors(found, *hidden))
    low, high = scipy.stats.chi2.ppf([0.001, 0.999], np.size(off)) / np.size(off)
    assert low < np.mean(np.square(off)) < high


def test_pulses_that_overlap_in_the_filter_are_estimated_beside_each_other():
    part = finer(trial(np.random.default_rng(12)))
    hidden = [(3.0, 0.4, 1.0), (3.5, 0.3, -0.8)]
    for found, one in zip(at_likeliest([part], pushed(part, *hidden)), hidden, strict=True):
        assert np.all(np.abs(errors(found, *one)) < 4.0)


def test_only_pulses_that_the_residual_has_are_likely_in_it():
    part = finer(trial(np.random.default_rng(13)))
    near = pushed(part, (3.0, 0.4, 1.0))
    elsewhere = replace(near[0], start_s=6.5)
    (kept,) = still_likely([part], [*near, elsewhere])
    assert kept.start_s == pytest.approx(3.0, abs=0.05)


def test_no_pulse_is_likely_in_a_residual_without_any():
    parts = [finer(trial(np.random.default_rng(seed))) for seed in range(20, 24)]
    near = [Pulse(k, 0, 4.0, 0.3, 0.1, *[0.1] * 4, "rectangular", 0.0, 0.0) for k in range(len(parts))]
    assert still_likely(parts, near) == []
