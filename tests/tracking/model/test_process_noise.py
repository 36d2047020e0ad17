"""How an arm may change of itself, and what is too much to be noise."""

import pytest
from scipy.stats import chi2

from tracking.model.process_noise import FILTER_PUSH_STD, SMOOTHER_PUSH_STD, WANDER_STD, alarm_limit


@pytest.mark.parametrize("n_miss", [1, 3, 12, 14])
def test_noise_raises_an_alarm_once_in_a_million(n_miss: int) -> None:
    assert alarm_limit(n_miss) == pytest.approx(chi2.isf(1e-6, n_miss))


def test_accelerations_wander_faster_where_all_is_known_afterwards() -> None:
    assert (FILTER_PUSH_STD, SMOOTHER_PUSH_STD, WANDER_STD) == (3.0, 50.0, 2e-5)
