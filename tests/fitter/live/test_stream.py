"""Motions out of the messages of a daemon."""

import numpy as np
import pytest

from fitter.live.stream import MotionAssembler
from limbcal.errors import ProtocolError
from protocol.message import FRAMES, HEALTH, TRIAL

DT_S = 0.001
SECOND_NS = 1_000_000_000


def block(frame0, n=100, start_ns=0, gap=False, method="smooth", run="a"):
    """Return frames whose angles tell their number."""
    number = frame0 + np.arange(n, dtype=float)
    q = np.repeat(number[:, None], 2, axis=1)
    return FRAMES, {
        "frame0": frame0,
        "t0_ns": start_ns + frame0 * 1_000_000,
        "dt_s": DT_S,
        "n": n,
        "method": method,
        "q": q,
        "dq": np.zeros_like(q),
        "ddq": np.zeros_like(q),
        "points": np.zeros((n, 4, 3)),
        "gap": gap,
        "run": run,
    }


def sliding(frame0, method):
    """Return frames in which every sensor goes at 1 m/s and every joint at 1 rad a frame."""
    topic, fields = block(frame0, method=method)
    fields["points"] = np.repeat(fields["q"][:, :1] * DT_S, 12, axis=1).reshape(-1, 4, 3)
    return topic, fields


def phase(trial, state, frame, start_ns=0, run="a", role="learn"):
    t_ns = start_ns + frame * 1_000_000
    return TRIAL, {"trial": trial, "t_ns": t_ns, "state": state, "role": role, "run": run}


def motions(messages):
    assembler = MotionAssembler()
    found = [motion for message in messages if (motion := assembler.feed(*message)) is not None]
    return assembler, found


def stretch(first, last, **options):
    return [block(k, **options) for k in range(first, last, 100)]


def numbers(motion):
    return motion.columns["q"][:, 0].tolist()


def test_motions_of_a_short_run_are_the_benchs(short_run):
    assembler, found = motions(short_run.messages)
    assert [(motion.name, motion.role) for motion in found] == [
        ("trial 1", "learn"),
        ("trial 2", "learn"),
        ("trial 3", "evaluate"),
    ]
    assert assembler.frames == sum(fields["n"] for topic, fields in short_run.messages if topic == FRAMES)
    for k, motion in enumerate(found):
        assert motion.t[0] == pytest.approx(0.0, abs=2e-3)
        assert np.allclose(np.diff(motion.t), DT_S)
        rows = slice(k * 27000 + 2000, (k + 1) * 27000)  # what the bench drove the arm to
        assert np.allclose(motion.columns["q"][0], short_run.truth["q"][rows][0], atol=0.02)
        assert np.allclose(motion.columns["q"][-1], short_run.truth["q"][rows][-1], atol=0.02)
        assert motion.columns["points"].shape == (len(motion.t), 4, 3)
    assert not assembler.moving and assembler.trial == 3


def test_a_motion_is_cut_at_the_very_times_that_are_announced():
    messages = [*stretch(0, 600), phase(1, "begin", 330), *stretch(600, 1200), phase(1, "end", 1055)]
    assembler, (motion,) = motions(messages)
    assert numbers(motion) == list(range(330, 1056))
    assert motion.t[0] == 0.0 and motion.t[-1] == pytest.approx(0.725)
    assert motion.notes == ()


@pytest.mark.parametrize("method", ["integrate", "filter", "smooth"])
def test_what_was_dead_reckoned_loses_its_drift(method):
    """What still goes at the end of a motion is drift in what was dead-reckoned, and true in what was not."""
    frames = [sliding(k, method) for k in range(0, 1000, 100)]
    _, (motion,) = motions([phase(1, "begin", 100), *frames, phase(1, "end", 800)])
    speed = {name: np.diff(motion.columns[name].reshape(len(motion.t), -1)[:, 0]) for name in ("q", "points")}
    assert speed["points"][-2] == pytest.approx(0.0, abs=0.02 * DT_S)
    assert speed["q"][-2] == pytest.approx(0.0 if method == "integrate" else 1.0, abs=0.02)


@pytest.mark.parametrize("start_ns", [0, 1_700_000_000 * SECOND_NS])
def test_the_clock_may_count_from_anywhere(start_ns):
    messages = [
        *stretch(0, 300, start_ns=start_ns),
        phase(1, "begin", 50, start_ns),
        phase(1, "end", 250, start_ns),
    ]
    _, (motion,) = motions(messages)
    assert numbers(motion) == list(range(50, 251))
    assert np.allclose(motion.t, DT_S * np.arange(201), atol=1e-6)


def test_a_motion_may_begin_where_the_one_before_ended():
    """What came before the announcement belongs to the next motion."""
    messages = [*stretch(0, 1000), phase(1, "begin", 100), *stretch(1000, 1500), phase(1, "end", 1230)]
    messages += [phase(2, "begin", 1230), *stretch(1500, 2000), phase(2, "end", 1800)]
    _, (first, second) = motions(messages)
    assert numbers(first) == list(range(100, 1231))
    assert numbers(second) == list(range(1230, 1801))


def test_a_subscription_in_the_middle_of_a_motion_waits_for_the_next():
    messages = [*stretch(500, 1000), phase(4, "end", 900), *stretch(1000, 2000), phase(5, "begin", 1500)]
    messages += [*stretch(2000, 3000), phase(5, "end", 2900)]
    assembler, (motion,) = motions(messages)
    assert motion.name == "trial 5" and numbers(motion) == list(range(1500, 2901))


def test_a_lost_announcement_costs_its_motion_only():
    begin_lost = [*stretch(0, 1000), phase(1, "end", 900), phase(2, "begin", 950), *stretch(1000, 1500)]
    _, found = motions([*begin_lost, phase(2, "end", 1400)])
    assert [numbers(motion) for motion in found] == [list(range(950, 1401))]
    end_lost = [*stretch(0, 500), phase(1, "begin", 100), *stretch(500, 1000), phase(2, "begin", 800)]
    _, found = motions([*end_lost, *stretch(1000, 1500), phase(2, "end", 1300)])
    assert [(motion.name, numbers(motion)) for motion in found] == [("trial 2", list(range(800, 1301)))]


def test_a_daemon_that_starts_anew_shares_nothing_with_the_one_before():
    messages = [*stretch(0, 1000), phase(7, "begin", 500)]
    messages += [*stretch(0, 1000, run="b"), phase(1, "begin", 600, run="b"), phase(1, "end", 900, run="b")]
    assembler, (motion,) = motions(messages)
    assert motion.name == "trial 1" and numbers(motion) == list(range(600, 901))
    messages[2:] = [phase(1, "end", 900, run="b")]  # that it began was never said
    assert motions(messages)[1] == []


def test_no_more_is_kept_than_the_next_motion_may_need():
    assembler, _ = motions(stretch(0, 10_000))
    assert len(assembler._blocks) <= 32
    assembler, _ = motions([phase(1, "begin", 0), *stretch(0, 10_000)])
    assert len(assembler._blocks) == 100
    assembler.feed(*phase(1, "end", 9000))
    assert len(assembler._blocks) <= 32


def test_lost_samples_are_noted_where_they_were_lost():
    messages = [block(0, gap=True), *stretch(100, 500), phase(1, "begin", 250), block(600, gap=True)]
    _, (motion,) = motions([*messages, *stretch(700, 1000), phase(1, "end", 900)])
    assert [note.text for note in motion.notes] == ["1 block(s) of frames after lost samples"]
    assert len(motion.t) == 551
    assert np.diff(motion.t).max() == pytest.approx(0.101)


def test_nothing_between_an_announcement_and_the_next_is_no_motion():
    assert motions([phase(1, "begin", 0), phase(1, "end", 1000)])[1] == []
    assert motions([*stretch(0, 100), phase(1, "begin", 500), phase(1, "end", 1000)])[1] == []
    assert motions([phase(1, "begin", 0), block(0, n=0), phase(1, "end", 1000)])[1] == []


def test_other_topics_are_passed_over():
    assert motions([(HEALTH, {"uptime_s": 1.0, "run": "a"})])[1] == []


@pytest.mark.parametrize(
    "change",
    [
        {"q": None},
        {"q": np.zeros((99, 2))},
        {"q": np.zeros((100, 3))},
        {"q": np.zeros(100), "dq": np.zeros(100), "ddq": np.zeros(100)},
        {"points": np.zeros((100, 12))},
        {"points": "none"},
        {"n": "many"},
        {"n": 1e9},
        {"dt_s": None},
        {"t0_ns": None},
        {"t0_ns": "now"},
        {"method": 1, "gap": None, "dq": [[0.0]]},
    ],
)
def test_frames_with_a_field_that_does_not_fit(change):
    for name, value in change.items():
        broken = dict(block(0)[1])
        broken.update({name: value} if value is not None else {})
        if value is None:
            del broken[name]
    broken.update({name: value for name, value in change.items() if value is not None})
    with pytest.raises(ProtocolError, match="limb/.*: a field is missing or does not fit"):
        motions([phase(1, "begin", 0), (FRAMES, broken), *stretch(100, 200), phase(1, "end", 150)])


@pytest.mark.parametrize("change", [{"state": "stopped"}, {"t_ns": "now"}, {"state": None}, {"trial": "first"}])
def test_announcements_with_a_field_that_does_not_fit(change):
    fields = phase(1, "begin", 0)[1] | change
    if change.get("state", "") is None:
        del fields["state"]
    with pytest.raises(ProtocolError, match="limb/trial: a field is missing or does not fit"):
        motions([(TRIAL, fields)])


def test_the_end_of_another_motion_completes_none():
    first, last = phase(1, "begin", 100), phase(2, "end", 800, role="evaluate")
    assembler, found = motions([*stretch(0, 300), first, *stretch(300, 900), last])
    assert (found, assembler.moving) == ([], False)
    _, found = motions(
        [first, *stretch(0, 900), last, phase(3, "begin", 950), *stretch(900, 1200), phase(3, "end", 1100)]
    )
    assert [motion.name for motion in found] == ["trial 3"]
