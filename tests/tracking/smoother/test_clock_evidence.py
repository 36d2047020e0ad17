"""Effects of sensors: what blocks say adds up to what all readings say, and what speaks for few is refused."""

import numpy as np
import pytest

from tracking.smoother.clock_evidence import EffectSlopes, accepted, effect_slopes

PRIOR_S = 0.03


def slopes_of(late: np.ndarray, information: float = 1e6) -> EffectSlopes:
    """Return slopes of blocks (n_block, n_clock) that each show another lateness [s], all as well."""
    n_block, n_clock = late.shape
    each = np.tile(information / n_block * np.eye(n_clock), (n_block, 1, 1))
    return EffectSlopes(np.einsum("bij,bj->bi", each, late), each, np.full(n_clock, PRIOR_S))


def test_readings_without_any_motion_say_what_a_line_does() -> None:
    """White noise about a line: least squares, block by block."""
    rng, noise, late = np.random.default_rng(0), 0.02, 0.01
    slopes = rng.standard_normal((1, 100, 3))
    readings = late * slopes[0] + noise * rng.standard_normal((100, 3))
    precision = np.full(readings.shape, noise**-2)
    information = np.array([[np.sum(slopes**2) / noise**2]])
    found = effect_slopes(readings / noise**2, precision, slopes, information, np.array([PRIOR_S]), 30)
    assert found.gradient.shape == (3, 1)  # the last 40 instants are one block
    np.testing.assert_allclose(found.information[0, 0, 0], np.sum(slopes[0, :30] ** 2) / noise**2, rtol=1e-9)
    estimate = found.gradient.sum() / information[0, 0]
    assert abs(estimate - late) < 4.0 / np.sqrt(information[0, 0])
    assert accepted(found) == [0]


def test_a_clock_that_all_blocks_show_is_accepted_and_others_are_not() -> None:
    late = np.column_stack([np.zeros(8), np.full(8, 0.005), np.full(8, -0.0001)])
    assert accepted(slopes_of(late)) == [1]


def test_a_clock_that_one_block_shows_is_refused() -> None:
    """The others foretell nothing of that one, and are spoilt by it."""
    late = np.zeros((8, 1))
    late[3] = 0.04
    whole = slopes_of(late)
    assert whole.gradient.sum() ** 2 / whole.information.sum() / 2.0 > 10.0  # by itself it would be believed
    assert accepted(whole) == []


def test_one_block_foretells_nothing() -> None:
    assert accepted(slopes_of(np.full((1, 2), 0.01))) == []


@pytest.mark.parametrize(("late_s", "kept"), [(0.0035, []), (0.006, [0])])
def test_the_odds_must_be_a_hundred_to_one(late_s: float, kept: list[int]) -> None:
    """Known to 1 ms by a prior of 30 ms, 3.5 ms are 2.7 nats and 6 ms are 14.6."""
    assert accepted(slopes_of(np.full((8, 1), late_s))) == kept


def test_readings_count_as_many_times_less_as_their_errors_are_dispersed() -> None:
    """6 ms known to 1 ms speak by 14.6 nats; where the model's errors are ten times as large, by 1.5."""
    error, slopes = np.full((80, 3), 6e-3 * 1e6 / 240.0), np.ones((1, 80, 3))
    precision, rest = np.full(error.shape, 1e6 / 240.0), (np.array([[1e6]]), np.array([PRIOR_S]), 10)
    assert accepted(effect_slopes(error, precision, slopes, *rest)) == [0]
    assert accepted(effect_slopes(error, precision, slopes, *rest, 10.0)) == []


@pytest.mark.parametrize("true", [0, 1])
def test_of_two_effects_that_are_alike_the_one_that_is_there_is_accepted(true: int) -> None:
    """A sine and its sign share 8 / pi^2 of their power: alone, either is believed where only the other is."""
    noise, sine = 0.02, np.sin(np.arange(0.0, 16.0 * np.pi, 0.1))
    slopes = np.stack([sine / np.sqrt(np.mean(sine**2)), np.sign(sine)])[:, :, None]
    error = 0.02 * slopes[true] / noise**2
    information = np.einsum("akc,bkc->ab", slopes, slopes) / noise**2
    shared = information[0, 1] ** 2 / (information[0, 0] * information[1, 1])
    assert shared == pytest.approx(8.0 / np.pi**2, abs=5e-3)
    precision = np.full(error.shape, noise**-2)
    for asked, expected in (([0, 1], [true]), ([1 - true], [0])):
        prior, own = np.full(len(asked), PRIOR_S), information[np.ix_(asked, asked)]
        assert accepted(effect_slopes(error, precision, slopes[asked], own, prior, 60)) == expected
