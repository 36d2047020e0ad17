"""Decimated readings of a whole recording, with its gaps."""

import numpy as np
import pytest

from limbcal.errors import ConfigError, DataError
from tracking.model.readings import Readings, ReadingsBuilder

RATE_HZ, N_CHANNEL = 4000.0, 3


def noise(n: int, seed: int = 0) -> np.ndarray:
    return np.array([0.0, 0.0, 9.8]) + 0.02 * np.random.default_rng(seed).normal(size=(n, N_CHANNEL))


def built(*pieces: np.ndarray | int, rate_hz: float = RATE_HZ, frame_rate_hz: float = 1000.0) -> Readings:
    """Return what becomes of samples and, as numbers, gaps."""
    builder = ReadingsBuilder(rate_hz, N_CHANNEL, frame_rate_hz)
    for piece in pieces:
        if isinstance(piece, int):
            builder.gap(piece)
        else:
            builder.push(piece)
    return builder.done()


@pytest.mark.parametrize(
    ("rate_hz", "frame_rate_hz", "factor"),
    [(4000.0, 1000.0, 4), (4000.0, 900.0, 4), (4000.0, 8000.0, 1), (1500.0, 1000.0, 2), (1000.0, 250.0, 4)],
)
def test_frames_are_a_whole_number_of_samples(rate_hz: float, frame_rate_hz: float, factor: int) -> None:
    made = built(noise(800), rate_hz=rate_hz, frame_rate_hz=frame_rate_hz)
    assert (made.factor, made.dt_s) == (factor, pytest.approx(factor / rate_hz))
    assert made.t0_s == pytest.approx((factor // 2) / rate_hz)
    assert len(made.values) == pytest.approx(800 / factor, abs=1)


def test_a_slow_motion_is_what_it_was_at_each_frame_s_time() -> None:
    t = np.arange(4000) / RATE_HZ
    slow = np.column_stack([np.sin(6.0 * t), np.cos(6.0 * t), t])
    made = built(slow[:1001], slow[1001:])
    at = made.t0_s + made.dt_s * np.arange(len(made.values))
    expected = np.column_stack([np.sin(6.0 * at), np.cos(6.0 * at), at])
    np.testing.assert_allclose(made.values[5:-5], expected[5:-5], atol=1e-3)
    assert made.present.all()


def test_what_was_lost_is_no_number_and_takes_its_time() -> None:
    made = built(noise(1000), 400, noise(1000, 1))
    assert len(made.values) == pytest.approx(600, abs=1)
    (lost,) = np.nonzero(~made.present)
    assert len(lost) == pytest.approx(100, abs=2) and lost[0] == pytest.approx(250, abs=2)
    assert np.all(np.diff(lost) == 1) and np.isnan(made.values[lost]).all()


def test_noise_is_learnt_from_the_longest_stretch() -> None:
    loud = 5.0 * (noise(500) - [0.0, 0.0, 9.8])
    for pieces in ((loud, 100, noise(4000)), (noise(4000), 100, loud)):
        std = np.sqrt(built(*pieces).noise.variance)
        assert std == pytest.approx(np.full(N_CHANNEL, 0.02), rel=0.2)


def test_the_first_quarter_of_a_second_has_a_mean_of_its_own() -> None:
    step = noise(4000)
    step[1100:] += 3.0
    assert built(step).first_mean == pytest.approx([0.0, 0.0, 9.8], abs=0.01)
    early = built(noise(200), 400, noise(4000))
    assert early.first_mean == pytest.approx([0.0, 0.0, 9.8], abs=0.01)


def test_it_begins_steadily_where_it_rests_without_a_gap() -> None:
    assert built(noise(4000)).begins_steadily
    moving = noise(4000)
    moving[:, 0] += np.sin(np.arange(4000) / 300.0)
    assert not built(moving).begins_steadily
    assert built(moving).begins_in_motion and not built(noise(4000)).begins_in_motion
    late = noise(4000)
    late[1400:] += np.sin(np.arange(2600) / 300.0)[:, None]
    assert built(late).begins_steadily  # what comes later does not count
    for untold in (built(noise(400), 100, noise(4000)), built(noise(800))):  # a gap, or not long enough
        assert not untold.begins_steadily and not untold.begins_in_motion


@pytest.mark.parametrize("rates", [(0.0, 1000.0), (4000.0, 0.0), (-1.0, 1000.0), (np.nan, 1000.0)])
def test_rates_are_above_nought(rates: tuple[float, float]) -> None:
    with pytest.raises(ConfigError, match="expected more than 0"):
        ReadingsBuilder(rates[0], N_CHANNEL, rates[1])


@pytest.mark.parametrize("shape", [(8,), (8, 2), (8, 4), (8, 3, 1)])
def test_samples_have_a_column_a_channel(shape: tuple[int, ...]) -> None:
    with pytest.raises(DataError, match=r"readings have shape .*, expected \(n, 3\)"):
        ReadingsBuilder(RATE_HZ, N_CHANNEL).push(np.zeros(shape))


def test_eight_samples_without_a_gap_are_enough() -> None:
    assert len(built(noise(7), 4, noise(8)).values) > 0
    with pytest.raises(DataError, match="7 samples without a gap, expected at least 8"):
        built(noise(7), 4, noise(6))
    with pytest.raises(DataError, match="0 samples without a gap"):
        built()
