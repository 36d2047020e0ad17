"""Schedules of faults: what acts when, and every mistake."""

import pytest

from daemon.fault_schedule import acting, faults_of
from limbcal.errors import ConfigError


def test_a_schedule_says_what_acts_when() -> None:
    faults = faults_of("unplug@5+1/3, flip@0+60*1e-5,drop@2")
    assert [sorted(acting(faults, at)) for at in (0.0, 2.05, 2.2, 4.9, 5.0, 6.1, 8.5, 60.5, 65.5)] == [
        ["flip"],
        ["drop", "flip"],
        ["flip"],
        ["flip"],
        ["flip", "unplug"],
        ["flip"],
        ["flip", "unplug"],
        [],
        ["unplug"],
    ]
    assert acting(faults, 2.0) == {"flip": 1e-5, "drop": 0.01}
    assert faults_of("") == ()


def test_every_mistake_is_listed() -> None:
    with pytest.raises(ConfigError) as caught:
        faults_of("fire@3, unplug@, silent@1+2*3, unplug@1+5/4, flip@1+2")
    assert len(caught.value.mistakes) == 4
    assert "expected KIND@START" in caught.value.mistakes[0]
    assert "has a value, expected none for silent" in caught.value.mistakes[2]
    assert "comes again before it is over" in caught.value.mistakes[3]
