"""`fitter subscribe --diagnose`: why the simulation is wrong, said when the last motion has ended."""

import json
from dataclasses import replace

import pytest
import zmq

from arm.arm_file import load_arm, save_arm
from arm.model import Tip
from fitter.commands.live_diagnosis import parted
from fitter.diagnosis import diagnosis
from limbcal.errors import DataError
from protocol.message import DIAGNOSIS, TRIAL
from protocol.subscriber import Subscriber
from tests.conftest import run_of

FIELDS = (
    "verdict complete left causes candidates confusable next_experiment before after gain residual explained "
    "structure suspected notes polished polish judged"
)


def heard(subscriber, topic):
    messages = []
    while (message := subscriber.receive(200)) is not None:
        messages += [message[1]] if message[0] == topic else []
    return messages


@pytest.fixture(scope="module")
def upper_run():
    """Return a short run of the first link alone: the effects of one joint are weighed in a fifth of the time."""
    arm = load_arm("dd-arm")
    sensors = tuple(sensor for sensor in arm.sensors if sensor.joint == 1)
    control = replace(arm.control, kp=arm.control.kp[:1], kv=arm.control.kv[:1])
    tip = Tip(sensors[-1].name)
    return run_of(replace(arm, name="upper-arm", joints=arm.joints[:1], sensors=sensors, control=control, tip=tip))


def test_the_diagnosis_is_published_and_written(fitter, stream, place, upper_run, tmp_path, monkeypatch):
    """Of a motion from dead reckoning, which lacks much: after one cause the search for more is left out."""
    monkeypatch.setattr(diagnosis, "MOST_CAUSES", 1)
    endpoint, arm_file = f"ipc://{place}/fits", tmp_path / "arm.toml"
    save_arm(upper_run.arm, arm_file)
    with (
        zmq.Context() as context,
        Subscriber(context, endpoint, (DIAGNOSIS,)) as subscriber,
        stream("tcp://127.0.0.1:*", upper_run.messages, "upper-arm") as daemon,
    ):
        common = ("--connect", daemon.endpoint, "--endpoint", endpoint, "--arm", arm_file, "--seconds", "120")
        outcome = fitter("subscribe", *common, "--trials", 3, "--diagnose", "--out", tmp_path)
        published = heard(subscriber, DIAGNOSIS)
    assert outcome.code == 0
    found = outcome.document["diagnosis"]
    assert found["verdict"] in ("named", "ambiguous", "none", "unexplained")
    assert f"diagnosis: {found['verdict']}" in outcome.said

    (message,) = published
    assert set(message) == {"v", "arm", "run", "seq", *FIELDS.split()} and message["arm"] == "upper-arm"
    assert {name: message[name] for name in FIELDS.split()} == found

    folder = tmp_path / "diagnosis"
    assert json.loads((folder / "diagnosis.json").read_text()) == found
    assert load_arm(folder / "extended.toml").name == "upper-arm"
    assert (folder / "report.html").exists() and (tmp_path / "report.html").exists()


def test_a_diagnosis_that_fails_leaves_the_calibration_alone(fitter, stream, place, short_run, tmp_path):
    ended = next(
        k
        for k, (topic, fields) in enumerate(short_run.messages)
        if topic == TRIAL and (fields["trial"], fields["state"]) == (1, "end")
    )
    with stream("tcp://127.0.0.1:*", short_run.messages[: ended + 1]) as daemon:
        common = ("--connect", daemon.endpoint, "--endpoint", f"ipc://{place}/fits", "--arm", "dd-arm")
        outcome = fitter("subscribe", *common, "--seconds", "60", "--trials", 1, "--diagnose", "--out", tmp_path)
    assert outcome.code == 0
    assert (
        "the diagnosis is left out: 1 motion(s), expected at least 2: what is learnt from cannot" in outcome.said
    )
    assert "dynamics" in outcome.document and "diagnosis" not in outcome.document
    assert not (tmp_path / "diagnosis").exists()


@pytest.mark.parametrize(
    ("learn", "evaluate", "expected"),
    [
        ("abc", "de", ("abc", "de")),
        ("abcde", "", ("abc", "de")),
        ("", "abcd", ("ab", "cd")),
    ],
)
def test_motions_are_parted_by_role_or_in_halves(learn, evaluate, expected):
    assert tuple("".join(part) for part in parted(list(learn), list(evaluate))) == expected


@pytest.mark.parametrize("alone", [("a", ""), ("", "a"), ("", "")])
def test_one_motion_cannot_be_parted(alone):
    with pytest.raises(DataError, match="expected at least 2"):
        parted(list(alone[0]), list(alone[1]))
