"""`fitter subscribe`: a real publisher on one side, a real subscriber on the other."""

import json
import signal
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
import zmq

from arm.arm_file import load_arm, save_arm
from arm.model import Control
from fitter.live.calibration import Calibration
from protocol.message import DYNAMICS, FRAMES, HEALTH, KINEMATICS, TRIAL, encode
from protocol.recording import RecordingWriter
from protocol.subscriber import Subscriber
from tests.fitter.commands.followed import LIMIT, names, until
from tests.patience import PATIENCE_MS

#: A test that waits in vain fails.
FILES = ["calibrated.toml", "dynamics.json", "kinematics.json", "motions.npz", "report.html"]


@pytest.fixture
def listener(place):
    """Listen to the fitter: its endpoint and a subscriber to it, there before the fitter is."""
    endpoint = f"ipc://{place}/fits"
    with zmq.Context() as context, Subscriber(context, endpoint, ("",)) as subscriber:
        yield endpoint, subscriber


def heard(subscriber):
    messages = []
    while (message := subscriber.receive(200)) is not None:
        messages.append(message)
    return messages


def test_the_arm_is_learnt_while_it_moves(fitter, stream, listener, short_run, tmp_path):
    endpoint, subscriber = listener
    out = tmp_path / "new" / "out"
    with stream("tcp://127.0.0.1:*") as daemon:
        common = ("--connect", daemon.endpoint, "--endpoint", endpoint, "--arm", "dd-arm", "--compare", "dd-arm")
        outcome = fitter("subscribe", *common, *LIMIT, "--trials", 3, "--out", out)
    assert outcome.code == 0
    document = outcome.document
    assert set(document) == {"stream", "trials", "notes", "kinematics", "dynamics"}
    published = document["stream"]
    assert set(published) == {"frames", "motions", "missed_messages", "recovered_messages", "daemon_restarts"}
    made = {"learn": 2, "evaluate": 1, "expected": 3, "lost_s": 0.0}
    assert document["trials"] == document["dynamics"]["trials"] == made and document["notes"] == []
    assert (published["motions"], published["missed_messages"], published["daemon_restarts"]) == (3, 0, 0)
    assert document["dynamics"]["parameters"]["I2"]["value"] == pytest.approx(0.471209, rel=0.01)
    assert document["kinematics"]["parameters"]["a2"]["value"] == pytest.approx(0.3, abs=2e-3)
    assert document["dynamics"]["angle_error_deg"]["evaluate"]["mean"] < 0.5
    for words in ("trial 1: ", "learnt from", "trial 3: ", "kept for evaluation", "report: "):
        assert words in outcome.said

    assert names(out) == FILES
    for part in ("kinematics", "dynamics"):
        assert json.loads((out / f"{part}.json").read_text()) == document[part]
    assert load_arm(out / "calibrated.toml").base_parameters.keys() >= {"I1+m2*L1^2", "I2"}
    motions = np.load(out / "motions.npz")
    assert np.unique(motions["trial"]).tolist() == [1, 2, 3]
    report = (out / "report.html").read_text(encoding="utf-8")
    assert "http://" not in report and "https://" not in report
    assert all(number in report for number in ("0.7300", "12.70", "1.985", "1.986", "the paper"))

    messages = heard(subscriber)
    by_topic = {topic: [fields for name, fields in messages if name == topic] for topic, _ in messages}
    assert set(by_topic) == {KINEMATICS, DYNAMICS, HEALTH}
    assert set(by_topic[KINEMATICS][-1]) == {
        *("v", "arm", "run", "seq"),
        *("generation", "frames", "parameters", "error"),
    }
    assert set(by_topic[DYNAMICS][-1]) == {
        *("v", "arm", "run", "seq"),
        *("generation", "samples", "parameters", "error"),
    }
    sequences = [fields["seq"] for fields in by_topic[DYNAMICS]]
    # After either learning motion, and at the end; a subscriber may be connected only after the first.
    assert sequences in ([0, 1, 2], [1, 2])
    assert len({fields["run"] for _, fields in messages}) == 1 and messages[0][1]["arm"] == "dd-arm"
    final = by_topic[DYNAMICS][-1]["parameters"]
    assert final["I2"]["value"] == document["dynamics"]["parameters"]["I2"]["value"]
    final = by_topic[KINEMATICS][-1]["parameters"]
    assert final["a1"]["value"] == document["kinematics"]["parameters"]["a1"]["value"]
    assert by_topic[HEALTH][-1]["last_seq"][DYNAMICS] == 2 and by_topic[HEALTH][-1]["uptime_s"] > 0.0


def test_the_same_seed_gives_the_same_bytes(fitter, stream, place, short_run, tmp_path):
    for name in ("first", "second"):
        with stream("tcp://127.0.0.1:*", until(short_run.messages, 1, "end")) as daemon:
            common = ("--connect", daemon.endpoint, "--endpoint", f"ipc://{place}/{name}", "--arm", "dd-arm")
            outcome = fitter("subscribe", *common, *LIMIT, "--trials", 1, "--seed", 7, "--out", tmp_path / name)
            assert outcome.code == 0
    for name in ("calibrated.toml", "kinematics.json", "motions.npz"):
        assert (tmp_path / "first" / name).read_bytes() == (tmp_path / "second" / name).read_bytes(), name


def test_a_late_subscription_learns_from_the_next_motion(fitter, stream, place, short_run, tmp_path):
    """The arm is taken from what the stream says of itself, and so is the arm to compare with."""
    begun = len(until(short_run.messages, 1, "begin"))
    late = short_run.messages[begun + 3 :]
    with stream("tcp://127.0.0.1:*", late) as daemon:
        common = ("--connect", daemon.endpoint, "--endpoint", f"ipc://{place}/fits", "--compare", "dd-arm")
        outcome = fitter("subscribe", *common, *LIMIT, "--trials", 2, "--out", tmp_path)
    assert outcome.code == 0
    assert "trial 1:" not in outcome.said and "trial 2: " in outcome.said and "trial 3: " in outcome.said
    assert outcome.document["stream"]["motions"] == 2
    assert "1.986" in (tmp_path / "report.html").read_text(encoding="utf-8")


def recorded(path, run, messages):
    """Record messages as a daemon does; return them encoded, and a heartbeat that names the file."""
    seq, sent = {FRAMES: -1, TRIAL: -1}, []
    with RecordingWriter(path, "", "") as writer:
        for topic, fields in messages:
            seq[topic] += 1
            sent.append(encode(topic, {**fields, "arm": "dd-arm", "run": run, "seq": seq[topic]}))
            writer.write(topic, sent[-1][1], 0)
    heartbeat = {"arm": "dd-arm", "run": run, "seq": 0, "last_seq": seq, "recording": str(path)}
    return [*sent, encode(HEALTH, heartbeat)]


def test_a_late_subscription_ends_with_the_same_as_an_early_one(fitter, stream, place, short_run, tmp_path):
    sent = recorded(tmp_path / "arm-12345678.mcap", "a run", short_run.messages)
    begun = len(until(short_run.messages, 2, "begin"))
    for name, heard in (("early", sent), ("late", sent[begun + 3 :])):
        with stream("tcp://127.0.0.1:*", heard) as daemon:
            common = ("--connect", daemon.endpoint, "--endpoint", f"ipc://{place}/{name}")
            outcome = fitter("subscribe", *common, *LIMIT, "--trials", 3, "--out", tmp_path / name)
        assert outcome.code == 0
        assert outcome.document["trials"] == {"learn": 2, "evaluate": 1, "expected": 3, "lost_s": 0.0}
        assert outcome.document["stream"]["missed_messages"] == 0
        assert (outcome.document["stream"]["recovered_messages"] > 0) == (name == "late")
    for name in ("calibrated.toml", "kinematics.json", "motions.npz"):
        assert (tmp_path / "early" / name).read_bytes() == (tmp_path / "late" / name).read_bytes(), name


def test_fewer_motions_than_were_made_are_said_everywhere(fitter, stream, place, short_run, tmp_path):
    """The second motion is lost on the way, and nothing is recorded."""
    second = slice(len(until(short_run.messages, 2, "begin")) - 1, len(until(short_run.messages, 2, "end")))
    sent, seq = [], {FRAMES: -1, TRIAL: -1}
    for topic, fields in short_run.messages:
        seq[topic] += 1
        sent.append(encode(topic, {**fields, "arm": "dd-arm", "run": "a run", "seq": seq[topic]}))
    lost_s = sum(f["n"] * f["dt_s"] for topic, f in short_run.messages[second] if topic == FRAMES)
    heartbeat = {"arm": "dd-arm", "run": "a run", "seq": 0, "last_seq": seq, "recording": None}
    del sent[second]
    with stream("tcp://127.0.0.1:*", [*sent, encode(HEALTH, heartbeat)]) as daemon:
        common = ("--connect", daemon.endpoint, "--endpoint", f"ipc://{place}/fits")
        outcome = fitter("subscribe", *common, *LIMIT, "--idle", "0.5", "--out", tmp_path)
    assert outcome.code == 4
    trials = outcome.document["trials"]
    assert (trials["learn"], trials["evaluate"], trials["expected"]) == (1, 1, 3)
    assert trials["lost_s"] == pytest.approx(lost_s)
    assert json.loads((tmp_path / "dynamics.json").read_text())["trials"] == trials
    assert {note["kind"] for note in outcome.document["notes"]} == {"missed"}
    assert "nothing is recorded from which they could be read" in outcome.said
    assert "2 of 3 motions were used (1 learnt from, 1 held back to evaluate)" in outcome.said
    report = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert 'class="alarm"' in report and "of 3 that were made" in report
    assert names(tmp_path) == FILES


def test_it_ends_when_no_motion_has_ended_for_a_while(fitter, stream, place, short_run):
    with stream("tcp://127.0.0.1:*", until(short_run.messages, 1, "end")) as daemon:
        common = ("--connect", daemon.endpoint, "--endpoint", f"ipc://{place}/fits", "--arm", "dd-arm")
        outcome = fitter("subscribe", *common, *LIMIT, "--idle", "0.3")
    assert outcome.code == 0
    assert outcome.document["stream"]["motions"] == 1
    assert outcome.document["dynamics"]["torque_rms_N_m"]["evaluate"] is None


def test_missed_messages_are_counted_and_what_they_cost_is_said(fitter, stream, place, short_run):
    published = until(short_run.messages, 1, "end")
    seq = {FRAMES: 0, TRIAL: 0}
    sent = []
    for topic, fields in published:
        number = seq[topic]
        seq[topic] += 1
        if not (topic == FRAMES and 15 <= number < 17):
            sent.append(encode(topic, {**fields, "arm": "dd-arm", "run": "run 1", "seq": number}))
    with stream("tcp://127.0.0.1:*", sent) as daemon:
        common = ("--connect", daemon.endpoint, "--endpoint", f"ipc://{place}/fits", "--arm", "dd-arm")
        outcome = fitter("subscribe", *common, *LIMIT, "--trials", 1)
    assert outcome.code == 0 and outcome.document["stream"]["missed_messages"] == 2
    assert "parted at 1 hole(s) of up to 0.201 s, 2 piece(s) kept" in outcome.said
    assert "trial 1#2: " in outcome.said and "messages from number 15 on did not come" in outcome.said


def test_after_a_message_of_another_version_nothing_learnt_is_lost(fitter, stream, place, short_run, tmp_path):
    published = until(short_run.messages, 1, "end")
    parts = encode(FRAMES, {**published[0][1], "arm": "dd-arm", "run": "run 1", "seq": 1000})
    newer = [parts[0], parts[1].replace(b"\xa1v\x01", b"\xa1v\x02")]
    assert newer != parts
    with stream("tcp://127.0.0.1:*", [*published, newer]) as daemon:
        common = ("--connect", daemon.endpoint, "--endpoint", f"ipc://{place}/fits", "--arm", "dd-arm")
        outcome = fitter("subscribe", *common, *LIMIT, "--out", tmp_path)
    assert outcome.code == 2
    assert outcome.errors == ["error: limb/frames: message version is 2, expected 1"]
    assert names(tmp_path) == FILES
    learnt = json.loads((tmp_path / "dynamics.json").read_text())["parameters"]
    assert outcome.document["dynamics"]["parameters"] == learnt and outcome.document["trials"]["learn"] == 1
    assert learnt["I2"]["value"] == pytest.approx(0.471209, rel=0.02)


def test_what_cannot_be_written_is_still_printed(fitter, stream, place, short_run, tmp_path):
    (tmp_path / "motions.npz").mkdir()
    with stream("tcp://127.0.0.1:*", until(short_run.messages, 1, "end")) as daemon:
        common = ("--connect", daemon.endpoint, "--endpoint", f"ipc://{place}/fits", "--arm", "dd-arm")
        outcome = fitter("subscribe", *common, *LIMIT, "--trials", 1, "--out", tmp_path)
    assert outcome.code == 3 and "motions.npz: cannot be written" in outcome.errors[0]
    assert outcome.document["dynamics"]["parameters"]["I2"]["value"] == pytest.approx(0.471209, rel=0.02)
    assert outcome.document["trials"]["learn"] == 1


def test_geometry_alone_is_worth_writing(fitter, stream, place, short_run, tmp_path):
    save_arm(replace(short_run.arm, control=Control("measured")), tmp_path / "arm.toml")
    with stream("tcp://127.0.0.1:*", until(short_run.messages, 1, "end")) as daemon:
        common = ("--connect", daemon.endpoint, "--endpoint", f"ipc://{place}/fits")
        arm, out = tmp_path / "arm.toml", tmp_path / "out"
        outcome = fitter("subscribe", *common, *LIMIT, "--arm", arm, "--trials", 1, "--out", out)
    assert outcome.code == 0 and set(outcome.document) == {"stream", "trials", "notes", "kinematics"}
    assert "has no torque, but control.law" in outcome.said
    assert names(out) == ["calibrated.toml", "kinematics.json"]


def test_sigterm_writes_what_was_learnt(stream, listener, short_run, tmp_path):
    endpoint, subscriber = listener
    moving = until(short_run.messages, 2, "begin")
    with stream("tcp://127.0.0.1:*", [*moving, *short_run.messages[len(moving) :][:10]]) as daemon:
        command = [sys.executable, "-m", "fitter", "subscribe", "--arm", "dd-arm", "--connect", daemon.endpoint]
        process = subprocess.Popen(
            [*command, "--endpoint", endpoint, "--out", str(tmp_path / "out"), "--json"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        try:
            while True:
                message = subscriber.receive(PATIENCE_MS)
                assert message is not None
                if message[0] == DYNAMICS:
                    break
            assert daemon.sent.wait(PATIENCE_MS / 1000)
            process.send_signal(signal.SIGTERM)
            out, err = process.communicate(timeout=PATIENCE_MS / 1000)
        finally:
            process.kill()
            process.wait()
    assert process.returncode == 0, err
    assert "stopped" in err and "Traceback" not in err and "error" not in err
    assert json.loads(out)["stream"]["motions"] == 1
    assert names(tmp_path / "out") == FILES


def test_a_stop_while_it_concludes_loses_nothing(fitter, stream, place, short_run, tmp_path, monkeypatch):
    learn = Calibration.learn_dynamics

    def learn_once(calibration):
        if calibration.dynamics is not None:
            raise KeyboardInterrupt
        learn(calibration)

    monkeypatch.setattr(Calibration, "learn_dynamics", learn_once)
    with stream("tcp://127.0.0.1:*", until(short_run.messages, 1, "end")) as daemon:
        common = ("--connect", daemon.endpoint, "--endpoint", f"ipc://{place}/fits", "--arm", "dd-arm")
        outcome = fitter("subscribe", *common, *LIMIT, "--trials", 1, "--out", tmp_path)
    assert (outcome.code, names(tmp_path)) == (0, FILES)
    assert "stopped: written is what was known" in outcome.said
    assert outcome.document["dynamics"]["parameters"]["I2"]["value"] == pytest.approx(0.471209, rel=0.02)
