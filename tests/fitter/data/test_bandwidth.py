"""Where motion ends and noise begins, on spectra made to measure."""

from dataclasses import replace

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


def spectral(level, missing=0, n=N):
    """Return columns whose acceleration has a level at each multiple of 0.1 Hz, and no more than that.

    Neighbouring parts are a quarter of a period apart, so that a window which adds them up leaves the level
    between them as it is.
    """
    frequency = np.fft.rfftfreq(n, DT_S)
    parts = np.sqrt(level(frequency)) * 1j ** (np.arange(len(frequency)) % 4)
    values = np.fft.irfft(parts, n)
    for _ in range(missing):
        values = np.concatenate([[0.0], np.cumsum(values)]) * DT_S
    return Signal(values[:, None], DT_S, missing)


def bands(*humps, high=1.0, low=1e-4):
    """Return a level that is high from one frequency to another, and low elsewhere."""

    def level(frequency):
        inside = [(frequency > begin - 0.05) & (frequency < end + 0.05) for begin, end in humps]
        return np.where(np.any(inside, axis=0), high, low)

    return level


#: Bands are 0.4 Hz wide, then a third of an octave: 0.4, 0.8, 1.2, 1.6, 2.016, 2.54, 3.2, 4.032 … Hz.
THIRD = 2.0 ** (1.0 / 3.0)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("high", [1.0, 100.0])
def test_between_two_bands_the_edge_is_where_power_is_ten_times_the_floor(size, high):
    """The band up to 4.032 Hz has nine parts; two at its end are smoothed to 5/4 and 1/4, the last is low."""
    signal = spectral(bands((0.4, 3.8), high=high))
    mean = high * 7.5 / 9.0
    share = np.log(mean / 1e-3) / np.log(mean / 1e-4)
    edge = 3.2 * np.sqrt(THIRD) * THIRD**share
    found = motion_edge_hz([replace(signal, values=size * signal.values)])
    assert found == pytest.approx(edge, rel=2e-3)


@pytest.mark.parametrize("missing", [1, 2])
def test_angles_and_velocities_are_differentiated_first(missing):
    direct, derived = (motion_edge_hz([spectral(bands((0.4, 3.8)), m)]) for m in (0, missing))
    assert derived == pytest.approx(direct, rel=2e-3)


@pytest.mark.parametrize(
    ("hump", "edge_hz"),
    [
        ((2.8, 2.8), 3.2),  # its band lies at 2.85 Hz, and that of the motion at 0.98
        ((3.6, 3.6), 1.2),  # 3.59 Hz are more than three times that
    ],
)
def test_motion_goes_on_within_three_times_its_frequency(hump, edge_hz):
    found = motion_edge_hz([spectral(bands((1.0, 1.0), hump))])
    assert edge_hz * 0.95 < found < edge_hz * 1.25


def test_from_one_hump_to_the_next_it_goes_on():
    found = motion_edge_hz([spectral(bands((1.0, 1.0), (2.8, 2.8), (7.2, 7.8)))])
    assert 8.0 < found < 9.6


@pytest.mark.parametrize(("end_hz", "fills"), [(101.0, False), (127.0, True), (249.0, True)])
def test_beyond_half_of_the_range_nothing_is_filtered(end_hz, fills):
    """Half of 250 Hz."""
    found = motion_edge_hz([spectral(bands((0.4, end_hz)))])
    assert (found is None) == fills and (fills or 102.0 < found < 125.0)


def test_a_motion_below_ten_times_the_floor_ends_in_noise_that_rises():
    """Five times the valley up to 8 Hz; noise of an angle, as the fourth power, is the valley's level at 16 Hz."""

    def level(frequency):
        return np.where(frequency < 8.0, 5.0, np.maximum(1.0, (frequency / 16.0) ** 4))

    # Ten times the noise is 1 at 16 Hz over the fourth root of ten, 9 Hz: the band before it is that at 7.2 Hz.
    found = motion_edge_hz([spectral(level, 2)])
    assert found == pytest.approx(6.4 * np.sqrt(THIRD), rel=2e-3)
    assert motion_edge_hz([spectral(lambda f: np.where(f < 8.0, 5.0, 1.0))]) is None  # nothing rises


def test_bands_count_all_trials_and_joints():
    """Power is the mean over parts and trials: a trial of noise alone halves it."""
    moving, still = spectral(bands((0.4, 3.8))), spectral(bands())
    mean = (7.5 / 9.0 + 1e-4) / 2.0
    share = np.log(mean / 1e-3) / np.log(mean / 1e-4)
    found = motion_edge_hz([moving, still])
    assert found == pytest.approx(3.2 * np.sqrt(THIRD) * THIRD**share, rel=3e-3)
    beside = replace(moving, values=np.hstack([moving.values, moving.values]))
    assert motion_edge_hz([beside]) == pytest.approx(motion_edge_hz([moving]))


def test_the_lowest_bands_are_as_wide_as_four_parts():
    """From 0.4 to 0.8 and 1.2 Hz; of the four parts up to 0.7 Hz two are smoothed to 5/4 and one to 1/4."""
    share = np.log(3.75 / 4.0 / 1e-3) / np.log(3.75 / 4.0 / 1e-4)
    edge = np.sqrt(0.4 * 0.8) * np.sqrt(3.0) ** share
    assert motion_edge_hz([spectral(bands((0.4, 0.6)))]) == pytest.approx(edge, rel=2e-3)
