"""What `limbplay touch` takes where nothing is given, and what it says, with a loop that only counts."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from playback.__main__ import main
from playback.commands import touch
from playback.touch.limit import Coupling

SPREAD = {"p50": None, "p99": None, "max": None}


class Process:
    """Stands for the process of the loop."""

    made: "Process"

    def __init__(self, *arguments: Any) -> None:
        self.arguments = arguments
        self.endpoint, self.haptic = "tcp://play", "tcp://haptic"
        self.beats = 0
        Process.made = self

    def start(self) -> None:
        pass

    def health(self) -> dict[str, Any]:
        return {
            **{"held_rate_hz": 999.987, "lateness_ms": SPREAD, "step_us": SPREAD, "energy_J": {"passive": False}},
            **{"stiffness_N_m": 400.4, "connected": False, "force_N": 0.0, "real_time": False},
            "resets": 0,
        }

    def wait_health(self) -> dict[str, Any]:
        self.beats += 1
        if self.beats == 1:
            return self.health()
        return {
            **self.health(),
            **{
                "lateness_ms": {"p99": 0.1234, "max": 1.5},
                "step_us": {"p99": 12.4},
                "energy_J": {"passive": True},
            },
            **{"connected": True, "force_N": 2.345, "resets": 3},
        }

    def close(self) -> dict[str, Any]:
        return {"ticks": 7}


class Hand:
    """Stands for the virtual hand."""

    def __init__(self, haptic: str, rate_hz: float) -> None:
        self.given = {"haptic": haptic, "rate_hz": rate_hz}

    def start(self) -> None:
        pass

    def check(self) -> None:
        pass

    def close(self) -> dict[str, Any]:
        return self.given


@pytest.fixture(autouse=True)
def _no_processes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(touch, "TouchProcess", Process)
    monkeypatch.setattr(touch, "VirtualHand", Hand)


def touched(*arguments: str) -> Process:
    assert main(["touch", "--seconds", "0.001", *arguments]) == 0
    return Process.made


def test_by_default_it_waits_for_a_device_on_this_machine() -> None:
    arm, q0, rate_hz, coupling, endpoint, haptic, keys = touched().arguments
    assert (arm.name, q0, rate_hz, keys) == ("dd-arm", None, 1000.0, None)
    assert coupling == Coupling()
    assert (endpoint, haptic) == ("tcp://127.0.0.1:5772", "tcp://127.0.0.1:5774")


def test_all_that_was_typed_is_passed_on() -> None:
    options = [
        "--arm",
        "dd-arm-vertical",
        "--q0",
        "0.5,-1",
        "--rate-hz",
        "500",
        "--endpoint",
        "e",
        "--haptic",
        "h",
    ]
    options += ["--stiffness", "10", "--damping", "2", "--device-damping", "3", "--max-force", "4", "--keys", "k"]
    options += ["--wall", "0,0,2,1", "--wall-stiffness", "50"]
    arm, q0, rate_hz, coupling, *ends = touched(*options).arguments
    assert (arm.name, rate_hz, ends) == ("dd-arm-vertical", 500.0, ["e", "h", Path("k")])
    np.testing.assert_array_equal(q0, [0.5, -1.0])
    assert coupling == Coupling(10.0, 2.0, 3.0, 4.0, wall=(0.0, 0.0, 2.0, 1.0), wall_stiffness=50.0)


def test_the_answer_is_what_loop_and_hand_have_to_tell(capsys: pytest.CaptureFixture[str]) -> None:
    touched("--device", "virtual", "--rate-hz", "500", "--json")
    assert json.loads(capsys.readouterr().out) == {
        **{"arm": "dd-arm", "endpoint": "tcp://play", "haptic": "tcp://haptic", "ticks": 7},
        "hand": {"haptic": "tcp://haptic", "rate_hz": 500.0},
    }
    touched("--json")
    assert "hand" not in json.loads(capsys.readouterr().out)


def test_once_a_second_it_says_how_it_goes(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now_s, slept = [100.0], []

    def sleep(seconds: float) -> None:
        slept.append(seconds)
        now_s[0] += seconds

    monkeypatch.setattr(touch.time, "monotonic", lambda: now_s[0])
    monkeypatch.setattr(touch.time, "sleep", sleep)
    assert main(["touch", "--seconds", "1.5"]) == 0
    assert slept == [1.0, 0.5]
    said = capsys.readouterr().err
    nobody = "999.99 Hz, late p99 0.000 ms (max 0.000), step p99 0 us, 400 N/m, nobody touches it, NOT passive"
    held = "999.99 Hz, late p99 0.123 ms (max 1.500), step p99 12 us, 400 N/m, 2.35 N, passive, ran away 3 time(s)"
    words = " ".join(said.split())
    assert words.index(nobody) < words.index(held)
    assert "real-time scheduling is not allowed here" in words


@pytest.mark.parametrize("q0", ["1", "1,2,3", "1,nan", "1,inf", "1,", "a,b"])
def test_a_joint_rests_at_a_number(q0: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["touch", "--q0", q0]) == 2
    assert f"--q0 is '{q0}', expected 2 numbers with commas between them" in capsys.readouterr().err
