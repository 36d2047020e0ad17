"""`limbplay touch` as it is typed, at length and in short."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from playback.__main__ import main
from tests.patience import PATIENCE_S
from tests.soak import Long

BARE = """
import json
from limbcal.real_time import TOUCH, ask_for_real_time
from playback.touch.pace import Pace
ask_for_real_time(TOUCH)
pace = Pace(1e-3)
while pace.now_s - pace.start_s < 20.0:
    pace.wait()
print(json.dumps({"rate": pace.held_rate_hz, "p99": pace.lateness.summary(1e-3)["p99"]}))
"""


def command(folder: Path, *arguments: str) -> list[str]:
    ends = ["--endpoint", f"ipc://{folder}/play", "--haptic", f"ipc://{folder}/haptic"]
    return [sys.executable, "-m", "playback", "touch", *arguments, *ends]


def test_a_virtual_hand_touches_pulls_and_lets_go(tmp_path: Path, long: Long) -> None:
    seconds = long.of(60.0, 2.0)
    answer = subprocess.run(
        command(tmp_path, "--device", "virtual", "--seconds", str(seconds), "--q0", "0.3,0.6", "--json"),
        capture_output=True,
        text=True,
        timeout=seconds + PATIENCE_S,
        check=False,
    )
    assert answer.returncode == 0, answer.stderr
    document = json.loads(answer.stdout)
    hand = document["hand"]
    assert document["ticks"] > 100
    assert hand["answers"] > 100
    assert hand["touches"] >= seconds / 3.0
    assert 1.0 < hand["strongest_force_N"] <= 20.0 + 1e-9
    assert document["energy_J"]["dissipated"] + document["energy_J"]["device"] >= -1e-6
    late, step = document["lateness_ms"], document["step_us"]
    long.note(
        f"haptic loop for {seconds:g} s: {document['held_rate_hz']:.2f} Hz held, late p50 {late['p50']:.3f} ms, "
        f"p99 {late['p99']:.3f} ms, max {late['max']:.3f} ms; "
        f"step p50 {step['p50']:.1f} us, p99 {step['p99']:.1f} us; "
        f"{document['overruns']} overruns; round trip p99 {hand['round_trip_ms']['p99']:.2f} ms; real time: "
        f"{document['real_time']}"
    )
    if not long.at_length:
        return
    allowed = json.loads(subprocess.run([sys.executable, "-c", BARE], capture_output=True, check=True).stdout)
    rate, p99 = allowed["rate"], allowed["p99"]
    long.note(f"a loop that does nothing here: {rate:.2f} Hz held, late p99 {p99:.3f} ms")
    if abs(rate - 1000.0) <= 0.5:  # a virtual machine that is held up cannot be in time
        assert abs(document["held_rate_hz"] - 1000.0) <= 1.0
    if p99 < 0.25:
        assert late["p99"] < 0.5


def test_a_signal_ends_it_cleanly(tmp_path: Path) -> None:
    with subprocess.Popen(
        command(tmp_path, "--json", "--wall", "0,1,0,-0.5"),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        for line in process.stderr:
            if "devices on" in line:
                break
        process.send_signal(signal.SIGTERM)
        answer, words = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0
    assert json.loads(answer)["arm"] == "dd-arm"
    assert "stopped" in words
    assert "Traceback" not in words


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--wall", "0,0,0,1"], "expected a normal that is not zero"),
        (["--stiffness", "-1"], "stiffness is -1"),
        (["--seconds", "0"], "--seconds is 0, expected above 0"),
        (["--seconds", "nan"], "--seconds is nan, expected above 0"),
        (["--rate-hz", "1e6"], "rate_hz is 1e+06, expected 100 to 5000"),
        (["--device", "virtual", "--keys", "keys"], "--device virtual has no key"),
        (["--haptic", "tcp://0.0.0.0:5774", "--endpoint", "tcp://127.0.0.1:*"], "which other machines can reach"),
    ],
)
def test_what_is_wrong_is_said_in_a_sentence(arguments: list[str], said: str, capsys) -> None:
    assert main(["touch", *arguments]) == 2
    assert said in capsys.readouterr().err
