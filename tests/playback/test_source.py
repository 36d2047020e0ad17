"""Trials are found by their numbers, the first one without."""

import pytest

from arm.model import Arm
from limbcal.errors import ConfigError
from playback.source import Source
from tests.playback.conftest import wave


def source(arm: Arm) -> Source:
    motions = {trial: wave(trial, 0.25 * trial) for trial in (10, 2, 3)}
    return Source("waves", arm, {trial: motion.duration_s for trial, motion in motions.items()}, motions.get)


def test_trials_rise_by_number_and_the_first_is_loaded_where_none_is_said(arm: Arm) -> None:
    found = source(arm)
    assert found.trials == (2, 3, 10)
    assert [found.load(trial).duration_s for trial in (None, 2, 3, 10)] == [0.5, 0.5, 0.75, 2.5]


@pytest.mark.parametrize("trial", [0, 1, -1, 11])
def test_a_trial_that_is_not_there_is_said_with_those_that_are(arm: Arm, trial: int) -> None:
    with pytest.raises(ConfigError, match=f"^waves: there is no trial {trial}, expected one of 2, 3, 10$"):
        source(arm).load(trial)
