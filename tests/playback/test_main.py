"""The commands as they are typed."""

import json
from pathlib import Path

import numpy as np
import pytest

from playback.__main__ import main
from protocol.message import HEALTH, PLAY
from protocol.subscriber import Subscriber
from tests.patience import PATIENCE_MS


def test_once_plays_to_the_end_and_says_how_it_went(start, motion_file: Path) -> None:
    with start(motion_file, "--trial", 2, "--rate-hz", 250, "--play", "--once", "--json") as running:
        answer, words = running.process.communicate()
        assert running.process.returncode == 0
    state = json.loads(answer)
    assert (state["trial"], state["finished"], state["playing"]) == (2, 1, False)
    assert (state["position_s"], state["rate_hz"]) == (1.0, 250.0)
    assert f"3 trial(s) on {running.endpoint}, control on {running.control}" in words
    assert "dd-arm" in words  # the arm that was taken, since none was given


def test_a_simulation_is_streamed_on_request(start, tmp_path: Path) -> None:
    reference = tmp_path / "reference.csv"
    rows = ["t,ref1,ref2"] + [f"{k / 1000:.3f},{0.5 * (k > 50)},{-0.3 * (k > 50)}" for k in range(401)]
    reference.write_text("\n".join(rows) + "\n", encoding="utf-8")
    with start("--arm", "dd-arm", "--reference", reference, "--once") as running:
        with Subscriber(running.context, running.endpoint, [PLAY, HEALTH]) as subscriber:
            while subscriber.receive(PATIENCE_MS)[0] != HEALTH:
                pass
            running.ask("play")
            frames = []
            while len(frames) < 41:
                topic, fields = subscriber.receive(PATIENCE_MS)
                frames += [fields] if topic == PLAY else []
        assert running.process.wait() == 0
        running.process.communicate()
    assert {frame["method"] for frame in frames} == {"simulate"}
    assert {frame["source"] for frame in frames} == {"simulation of dd-arm following reference.csv"}
    q = np.concatenate([frame["q"] for frame in frames])
    assert np.all(q[:5] == 0.0)
    assert q[-1, 0] > 0.05
    assert q[-1, 1] < 0.0


def test_send_asks_a_running_playback(start, motion_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with start(motion_file) as running:
        running.ask("state")  # it is there: `send` is not as patient
        control = ["--control", running.control]
        assert main(["send", "load", "--trial", "2", "--json", *control]) == 0
        assert json.loads(capsys.readouterr().out)["state"]["trial"] == 2
        assert main(["send", "list", *control]) == 0
        said = capsys.readouterr().out
        assert "state trial: 2" in said
        assert "trials: [{'trial': 1, 'duration_s': 0.5}" in said
        assert main(["send", "load", "--trial", "9", "--json", *control]) == 2
        output = capsys.readouterr()
        assert json.loads(output.out)["ok"] is False
        assert "there is no trial 9" in output.err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["serve"], "a motion is missing: expected SOURCE or --reference"),
        (["serve", "a.csv", "--reference", "b.csv"], "SOURCE and --reference are both given"),
        (["serve", "--reference", "b.csv"], "--arm is missing"),
        (["serve", "--reference", "b.csv", "--twin", "dd-arm"], "--twin is given without SOURCE"),
        (["serve", "a.csv", "--live"], "--live and source are both given"),
        (["serve", "{motion}", "--twin", "dd-arm"], "no column 'ref1' among its columns"),
        (["send", "seek"], "seek: --position goes with seek, and is missing"),
        (["send", "play", "--speed", "2"], "play: --speed goes with speed, and only with it"),
        (["serve", "a.avi"], "a.avi: the suffix is '.avi', expected one of .mcap, .csv, .tsv, .parquet, .npz"),
        (["serve", "nowhere.csv"], "nowhere.csv: there is no such file"),
        (["serve", "nowhere.mcap"], "nowhere.mcap cannot be read"),
        (["serve", "{motion}", "--arm", "nobody"], "arm 'nobody'"),
        (["serve", "{motion}", "--rate-hz", "0"], "--rate-hz is 0, expected above 0"),
        (["serve", "{motion}", "--rate-hz", "nan"], "--rate-hz is nan"),
        (["serve", "{motion}", "--rate-hz", "fast"], "invalid float value: 'fast'"),
        (["serve", "{motion}", "--trial", "4"], "there is no trial 4, expected one of 1, 2, 3"),
        (["serve", "{motion}", "--endpoint", "nonsense"], "endpoint is 'nonsense'"),
        (["serve", "{motion}", "--endpoint", "tcp://127.0.0.1:*", "--control", "bad"], "endpoint is 'bad'"),
        (["send", "load"], "--trial goes with load"),
        (["send", "play", "--trial", "1"], "--trial goes with load"),
        (["send", "dance"], "there is no command 'dance'"),
        (["send", "state", "--control", "nonsense"], "endpoint is 'nonsense'"),
        ([], "COMMAND missing"),
    ],
)
def test_a_mistake_is_one_sentence_and_exit_code_2(
    arguments: list[str], said: str, motion_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([argument.format(motion=motion_file) for argument in arguments]) == 2
    output = capsys.readouterr()
    assert said in output.err
    assert output.out == ""
    assert "Traceback" not in output.err


def test_a_taken_endpoint_is_exit_code_3(start, motion_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with start(motion_file) as running:
        running.ask("state")
        assert main(["serve", str(motion_file), "--endpoint", running.endpoint]) == 3
    assert f"{running.endpoint} is already taken" in capsys.readouterr().err


def test_nobody_there_is_exit_code_3(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("playback.commands.send.TIMEOUT_MS", 50)
    assert main(["send", "state", "--control", f"ipc://{tmp_path}/nobody"]) == 3
    assert "no answer within 0.05 s" in capsys.readouterr().err


def test_help_is_there(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["serve", "--help"])
    assert not ended.value.code
    assert "--rate-hz" in capsys.readouterr().out
