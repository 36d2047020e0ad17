"""When following a stream ends: never while messages wait, and by the stream's own clock."""

from collections import deque
from types import SimpleNamespace

import pytest

from fitter.live.session import Session
from protocol.message import FRAMES, HEALTH, TRIAL

DT_S, N = 0.01, 100


class Stream:
    """Hands out messages, and then nothing."""

    def __init__(self, messages):
        self._messages = deque(messages)
        self.missed, self.recovered, self.restarts = {}, 0, 0
        self.stopped, self.vain = False, 0

    @property
    def waits(self):
        return bool(self._messages)

    def receive(self, timeout_ms):
        if self._messages:
            return self._messages.popleft()
        self.vain += timeout_ms > 0
        return None

    def stop(self):
        self.stopped = True


class Calibration:
    """Learns nothing, and has generations to breed while it is asked to."""

    def __init__(self, generations=0):
        self.generations = generations
        self.learn, self.evaluate, self.dynamics, self.doubt = [], [], None, ""
        self.geometry = SimpleNamespace(samples=0, generations=0, tip_rms_m=0.0)

    def breed(self):
        self.generations -= 1
        return self.generations >= 0

    def kinematics(self):
        return None


class Publisher:
    def __init__(self):
        self.last_seq = {}

    def publish(self, topic, fields):
        self.last_seq[topic] = self.last_seq.get(topic, -1) + 1


class Assembler:
    """Gives out no motion: what it would take is not of interest here."""

    frames, trial, role, moving = 0, 0, "", False

    def feed(self, _topic, _fields):
        return None


def frames(number):
    return FRAMES, {"run": "a", "seq": number, "frame0": N * number, "n": N, "dt_s": DT_S}


def phase(state, trial=1):
    return TRIAL, {"run": "a", "trial": trial, "state": state}


@pytest.fixture
def session_of(monkeypatch):
    monkeypatch.setattr("fitter.live.session.MotionAssembler", Assembler)

    def made(messages, generations=0):
        stream = Stream(messages)
        return Session(Calibration(generations), Publisher(), stream), stream

    return made


def test_it_idles_when_the_arm_has_rested_by_the_streams_clock(session_of):
    session, stream = session_of([phase("begin"), phase("end"), *map(frames, range(8))])
    session.follow(None, None, 5.0)
    assert stream.vain <= 1  # no second of ours was waited for
    assert session.account.rested_s == pytest.approx(8.0)  # and not before all had been taken


def test_a_motion_is_no_rest_however_long_it_takes(session_of):
    moving = [phase("begin"), phase("end"), phase("begin", 2), *map(frames, range(100)), phase("end", 2)]
    session, _ = session_of([*moving, *map(frames, range(100, 106))])
    session.follow(None, None, 5.0)
    assert session.account.made == 2


def test_waiting_in_vain_counts_and_learning_does_not(session_of):
    session, stream = session_of([phase("begin"), phase("end")], generations=200)
    session.follow(None, None, 0.2)
    assert session.calibration.generations < 0  # all were bred before the first wait
    assert stream.vain == 4  # of 50 ms each, as long as that may have taken


def test_heartbeats_are_no_sign_of_life(session_of):
    heartbeats = [(HEALTH, {"run": "a", "uptime_s": float(k)}) for k in range(3)]
    session, stream = session_of([phase("begin"), phase("end"), *heartbeats])
    session.follow(None, None, 0.1)
    assert stream.vain == 2


def test_what_has_come_by_the_end_of_the_time_is_taken(session_of):
    session, stream = session_of(list(map(frames, range(500))))
    session.follow(1e-9, None, None)
    assert stream.stopped and session.account.frames == 500 * N


def test_motions_that_were_made_are_expected_unless_their_number_is_given(session_of):
    session, _ = session_of([phase("begin", 7), phase("end", 7)])
    session.follow(None, None, 0.05)
    assert session.trials(None) == {"learn": 0, "evaluate": 0, "expected": 7, "lost_s": 0.0}
    assert session.trials(22)["expected"] == 22


def test_listening_is_told_by_a_heartbeat(session_of):
    session, _ = session_of([])
    session.listen()
    assert session._publisher.last_seq == {HEALTH: 0}
