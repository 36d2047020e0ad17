"""Pulses are found in coloured residuals, with their errors; what is no pulse is not."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.data.derivatives import lowpass
from fitter.diagnosis.torque.pulse_column import pulse_means
from fitter.diagnosis.torque.pulses import find_pulses
from tests.fitter.diagnosis.torque.residuals import BAND_HZ, STEP_S, coloured, finer, trial

HIDDEN = {0: [(2.0, 0.2, 0.5, "rectangular"), (6.5, 0.25, -0.6, "bell")], 2: [(4.0, 0.3, 0.4, "rectangular")]}


def test_all_pulses_are_found_and_no_others():
    rng = np.random.default_rng(4)
    found = find_pulses([trial(rng, HIDDEN.get(k, ())) for k in range(3)])
    hidden = [(k, *pulse) for k, pulses in HIDDEN.items() for pulse in pulses]
    assert [pulse.trial for pulse in found] == [k for k, *_ in hidden]
    for pulse, (_, start_s, duration_s, size, _) in zip(found, hidden, strict=True):
        assert pulse.joint == 0
        assert pulse.start_s == pytest.approx(start_s, abs=0.05)
        assert pulse.duration_s == pytest.approx(duration_s, abs=0.06)
        assert abs(pulse.torque_N_m - size) < 3.5 * pulse.torque_std
        assert 0.0 < pulse.start_std < 0.05
        assert 0.0 < pulse.duration_std < 0.05


def test_a_large_pulse_is_not_taken_for_background():
    """By the background of all blocks, which holds it, the lesser one behind it is found in its stead."""
    rng, noise = np.random.default_rng(0), 1e-3
    trials = [finer(replace(part, r=noise / 0.05 * part.r)) for part in (trial(rng), trial(rng))]
    for start_s, duration_s, size in ((2.0, 0.2, 1.4), (2.25, 0.1, -0.13)):
        step_s = trials[0].t[1] - trials[0].t[0]
        pulse = size * pulse_means(trials[0].t, step_s, start_s, duration_s, "rectangular")
        trials[0].r[:, 0] += lowpass(pulse, step_s, BAND_HZ)
    found = find_pulses([replace(part, torque_noise=np.array([0.1 * noise])) for part in trials])
    assert found[0].start_s == pytest.approx(2.0, abs=0.01)
    assert found[0].torque_N_m == pytest.approx(1.4, rel=0.1)


def test_a_push_that_the_motor_resists_is_no_error_in_proportion_to_its_torque():
    """The motor's torque holds the push, and an error of its gain explained most of it."""
    rng = np.random.default_rng(9)
    trials = []
    for k in range(2):
        part = trial(rng)
        burst = np.exp(-0.5 * ((part.t - 8.0) / 0.15) ** 2)[:, None]
        torque = 0.02 * part.torque + burst
        pulse = (k == 0) * 2.0 * pulse_means(part.t, STEP_S, 4.0, 0.2, "rectangular")[:, None]
        r = part.r + 0.15 * torque + 0.02 * np.gradient(torque, STEP_S, axis=0) + pulse
        trials.append(replace(part, r=r, torque=torque - pulse))
    (found,) = find_pulses(trials)
    assert found.start_s == pytest.approx(4.0, abs=0.02)
    assert found.torque_N_m == pytest.approx(2.0, abs=3.5 * found.torque_std)


def test_single_rows_of_great_error_are_no_pulses():
    rng = np.random.default_rng(5)
    outlying = trial(rng)
    at = rng.integers(0, len(outlying.t), 12)
    outlying.r[at, 0] += rng.choice([-1.0, 1.0], 12) * 0.4
    assert find_pulses([outlying, trial(rng)]) == []


def test_nothing_is_found_where_nothing_is_known():
    part = trial(np.random.default_rng(6), [(4.0, 0.3, 0.6, "rectangular")])
    part.known[95:115] = False
    assert find_pulses([part]) == []


@pytest.mark.parametrize("start_s", [3.7, 3.83, 3.9])
def test_a_pulse_that_begins_at_rest_is_found(start_s):
    """Its size and its end are known; when it began, only that it was while nothing was seen."""
    part = trial(np.random.default_rng(7), [(start_s, 4.4 - start_s, 0.8, "rectangular")])
    part.known[:, 0] = part.t > 4.0
    (found,) = find_pulses([part])
    assert found.torque_N_m == pytest.approx(0.8, abs=4.0 * found.torque_std)
    half_s = np.sqrt(3.0) * found.start_std  # of a uniform distribution
    assert abs(found.start_s - start_s) < half_s < 0.5
    assert found.start_s + found.duration_s == pytest.approx(4.4, abs=0.06)


def test_a_pulse_too_short_for_the_band_is_found_by_its_impulse():
    """It may have been shorter and larger: neither its torque nor its duration is known, their product is."""
    hidden = [(4.01, 0.02, 5.0, "rectangular")]
    (found,) = find_pulses([trial(np.random.default_rng(3), hidden), trial(np.random.default_rng(30))])
    assert found.impulse == pytest.approx(0.1, abs=3.0 * found.impulse_std)
    assert abs(found.torque_N_m) < 2.0 * found.torque_std


def test_pulses_that_are_much_of_what_is_known_are_found():
    rng = np.random.default_rng(8)
    sizes = {1: 2.0, 4: -1.8, 6: 2.2}
    trials = [trial(rng, [(4.0, 0.3, sizes[k], "rectangular")] if k in sizes else ()) for k in range(8)]
    for part in trials:  # once and again for some tenths of a second
        part.known[:, 0] = (part.t % 3.0 > 2.6) | ((part.t > 4.08) & (part.t < 4.28))
    found = find_pulses(trials)
    assert [pulse.trial for pulse in found] == list(sizes)
    for pulse, size in zip(found, sizes.values(), strict=True):
        assert pulse.torque_N_m == pytest.approx(size, rel=0.3)


def test_of_bursts_of_louder_background_none_is_a_pulse():
    rng = np.random.default_rng(9)
    trials = [trial(rng) for _ in range(8)]
    for part in trials:
        loud = part.t % 1.1 < 0.4
        part.r[loud, 0] += 4.0 * coloured(rng)[loud]
    assert find_pulses(trials) == []
