"""Schedules of faults: what acts when, and every mistake."""

import pytest

from daemon.virtual_device.fault_schedule import KINDS, Fault, acting, faults_of
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


def test_what_is_taken_where_nothing_is_said() -> None:
    faults = {fault.kind: fault for fault in faults_of(",".join(f"{kind}@1" for kind in KINDS))}
    values = {"garbage": 1000.0, "flip": 1e-5, "drop": 0.01, "double": 0.01, "reorder": 0.01}
    assert {kind: fault.value for kind, fault in faults.items()} == {**dict.fromkeys(KINDS, 0.0), **values}
    assert {(fault.start_s, fault.lasts_s, fault.every_s) for fault in faults.values()} == {(1.0, 0.1, None)}


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("drop@2.5+1.5*0.25/4", Fault("drop", 2.5, 1.5, 0.25, 4.0)),
        ("flip@.5*1e-3", Fault("flip", 0.5, 0.1, 1e-3, None)),
        (" silent@1e1+2. ", Fault("silent", 10.0, 2.0, 0.0, None)),
        ("unplug@0+1/1.001", Fault("unplug", 0.0, 1.0, 0.0, 1.001)),
    ],
)
def test_an_entry_says_when_for_how_long_how_much_and_how_often(text: str, fault: Fault) -> None:
    assert faults_of(text) == (fault,)


@pytest.mark.parametrize("text", ["unplug@5+1/1", "unplug@5+1/0.5", "unplug@5/0.1", "unplug@5+1/0"])
def test_a_fault_is_over_before_it_comes_again(text: str) -> None:
    with pytest.raises(ConfigError, match="comes again before it is over"):
        faults_of(text)


@pytest.mark.parametrize(
    ("at_s", "acts"),
    [(1.9, False), (2.0, True), (2.49, True), (2.5, False), (3.0, False), (5.0, True), (5.5, False)],
)
def test_a_fault_acts_from_its_beginning_until_it_is_over(at_s: float, acts: bool) -> None:
    assert Fault("drop", 2.0, 0.5, 0.1, 3.0).acts(at_s) == acts
    assert Fault("drop", 2.0, 0.5, 0.1, None).acts(at_s) == (acts and at_s < 5.0)
