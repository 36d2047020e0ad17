"""Where motion ends and noise begins, on spectra made to measure."""

import numpy as np
import pytest

from fitter.data.bandwidth import Signal, motion_edge_hz

DT_S = 0.002
N = 5000


def swing(highest_hz, seed=0, n=N):
    """Random motion whose acceleration is as strong at all frequencies up to a highest one."""
    rng = np.random.default_rng(seed)
    frequency = np.fft.rfftfreq(n, DT_S)
    inside = (frequency > 0.3) & (frequency < highest_hz)
    spectrum = np.zeros(len(frequency), dtype=complex)
    phase = np.exp(2j * np.pi * rng.uniform(size=inside.sum()))
    spectrum[inside] = phase / (2 * np.pi * frequency[inside]) ** 2
    q = np.fft.irfft(spectrum, n)
    return (q / q.std())[:, None]


@pytest.mark.parametrize("highest_hz", [2.0, 5.0, 12.0])
@pytest.mark.parametrize("noise", [1e-6, 1e-5, 1e-4])
def test_the_edge_lies_where_the_motion_ends(highest_hz, noise):
    rng = np.random.default_rng(1)
    trials = [Signal(swing(highest_hz, k) + noise * rng.normal(size=(N, 1)), DT_S, 2) for k in range(3)]
    assert highest_hz / 1.4 < motion_edge_hz(trials) < highest_hz * 1.5


@pytest.mark.parametrize("missing", [0, 1, 2])
def test_it_is_the_same_from_angle_velocity_and_acceleration(missing):
    t = DT_S * np.arange(N)
    omega = 2 * np.pi * np.array([0.7, 1.9, 4.1])
    order = 2 - missing
    column = (omega ** (order - 1) * np.sin(np.multiply.outer(t, omega) + order * np.pi / 2)).sum(1)
    noise = 1e-4 * np.random.default_rng(0).normal(size=N) * (1000.0, 30.0, 1.0)[missing]
    assert 3.5 < motion_edge_hz([Signal((column + noise)[:, None], DT_S, missing)]) < 6.5


def test_harmonics_of_a_swing_belong_to_the_motion():
    t = DT_S * np.arange(N)
    q = np.sin(2 * np.pi * 1.3 * t) + 0.02 * np.sin(2 * np.pi * 3.9 * t)
    noise = 2e-4 * np.random.default_rng(0).normal(size=N)
    assert 3.9 < motion_edge_hz([Signal((q + noise)[:, None], DT_S, 2)]) < 6.5


def test_a_resonance_far_above_does_not():
    t = DT_S * np.arange(N)
    ripple = 1e-4 * np.sin(2 * np.pi * 60.0 * t)
    noise = 1e-5 * np.random.default_rng(0).normal(size=N)
    assert motion_edge_hz([Signal(swing(4.0) + (ripple + noise)[:, None], DT_S, 2)]) < 6.0


def test_a_ripple_that_is_stronger_than_the_motion_is_none():
    """By its acceleration, not by its speed."""
    t = DT_S * np.arange(N)
    ripple = 1e-2 * np.sin(2 * np.pi * 60.0 * t)
    noise = 1e-5 * np.random.default_rng(0).normal(size=N)
    assert 4.0 < motion_edge_hz([Signal(swing(4.0) + (ripple + noise)[:, None], DT_S, 2)]) < 6.0


def test_a_still_trial_does_not_spoil_the_others():
    rng = np.random.default_rng(2)
    moving = Signal(swing(4.0) + 1e-5 * rng.normal(size=(N, 1)), DT_S, 2)
    still = Signal(1e-5 * rng.normal(size=(N, 1)), DT_S, 2)
    alone, together = motion_edge_hz([moving]), motion_edge_hz([moving, still])
    assert abs(together - alone) < 0.15 * alone


def test_where_nothing_is_to_be_filtered_there_is_no_edge():
    rng = np.random.default_rng(0)
    t = DT_S * np.arange(N)
    assert motion_edge_hz([Signal(np.zeros((N, 2)), DT_S, 2)]) is None
    assert motion_edge_hz([Signal(rng.normal(size=(16, 2)), DT_S, 2)]) is None
    step = np.exp(-5 * t)[:, None]  # a clean transient fills the whole range
    assert motion_edge_hz([Signal(step, DT_S, 2)]) is None


def test_trials_of_other_rates_count_together():
    rng = np.random.default_rng(0)
    fine = swing(4.0) + 1e-5 * rng.normal(size=(N, 1))
    coarse = swing(4.0, 1) + 1e-5 * rng.normal(size=(N, 1))
    edge = motion_edge_hz([Signal(fine, DT_S, 2), Signal(coarse[::4], 4 * DT_S, 2)])
    assert 3.0 < edge < 6.0


def test_of_noise_alone_nothing_is_kept():
    assert motion_edge_hz([Signal(np.random.default_rng(0).normal(size=(N, 2)), DT_S, 2)]) < 1.0


@pytest.mark.parametrize("noise", [2e-4, 1e-3, 6e-2])
def test_a_motion_that_begins_with_a_jump_has_an_edge_too(noise):
    """Its spectrum falls so slowly that nothing stands far above the valley."""
    t, rng = DT_S * np.arange(3375), np.random.default_rng(3)
    late = np.maximum(t - 0.5, 0.0)
    q = 1.0 - (1.0 + 3.0 * late) * np.exp(-3.0 * late)  # a critically damped answer to a step
    edge = motion_edge_hz([Signal((q + noise * rng.normal(size=len(t)))[:, None], DT_S, 2) for _ in range(5)])
    assert edge is not None and 0.5 < edge < 8.0


@pytest.mark.parametrize("missing", [0, 1, 2])
@pytest.mark.parametrize("n", [2, 3, 5, 9, 17])
def test_too_few_samples_for_bands_say_nothing(n, missing):
    assert motion_edge_hz([Signal(swing(5.0)[:n], DT_S, missing)]) is None
