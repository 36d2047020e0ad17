"""The page without a browser: what it says of a stream, which arms it shows, and how often it looks."""

import threading
import time
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import viser

from arm.arm_file import load_arm
from arm.kinematics import tip_position
from playback.view.feed import Picture, Pose, Row
from playback.view.page import ALONE, BESIDE, ON_TOP, PANEL_EVERY, RATE_HZ, Page
from playback.view.server import on_loop, web_server
from playback.view.visitors import Visitors

ARM = load_arm("dd-arm")
Q, TWIN_Q = np.array([0.3, 0.6]), np.array([0.1, 0.2])
STATE: dict[str, Any] = {
    **{"source": "day.mcap", "playing": False, "live": False, "position_s": 1.5, "duration_s": 3.0},
    **{"trial": 1, "trials": [1], "speed": 1.0, "loop": False},
}


def picture_of(twin: bool = True, count: int = 1, age_s: float = 0.0, source: str = "") -> Picture:
    pose, other = (Pose(q, tip_position(ARM, q[None])[0]) for q in (Q, TWIN_Q))
    row = Row(1.0, pose, other if twin else None)
    return Picture(count, 0, time.monotonic() - age_s, row, "limb/play", source, 1.0, {})


class Stream:
    """A feed and a remote whose words the test puts into their mouths."""

    def __init__(self) -> None:
        self.endpoint = "tcp://feed"
        self.picture: Picture | None = None
        self.rows: list[Row] = []
        self.wanted: list[tuple[str, object]] = []
        self.remote = SimpleNamespace(endpoint="tcp://control", state=None, motion=None, want=self._want)

    def newest(self) -> Picture | None:
        return self.picture

    def history(self, _span_s: float) -> list[Row]:
        return self.rows

    def _want(self, cmd: str, value: object = None) -> None:
        self.wanted.append((cmd, value))


MakePage = Callable[..., tuple[Page, Stream]]


@pytest.fixture
def page() -> Iterator[MakePage]:
    """Return what makes a page that is really served."""
    with web_server(Visitors("127.0.0.1"), 0, "limbplay") as server:

        def make(twin: bool = True, controlled: bool = True) -> tuple[Page, Stream]:
            stream = Stream()
            remote: Any = stream.remote if controlled else None
            made = on_loop(server, lambda: Page(server, stream, remote, ARM, ARM if twin else None))
            return made, stream

        yield make


def refreshed(page: Page, panel: bool = True) -> str:
    server: viser.ViserServer = page._server
    on_loop(server, lambda: page.refresh(panel))
    return str(page._head.content)


@pytest.mark.parametrize(
    ("state", "age_s", "badge", "source"),
    [
        (None, 0.0, "no answer", "tcp://control"),
        (STATE, 9.0, "paused", "day.mcap"),
        ({**STATE, "playing": True}, 0.0, "playing", "day.mcap"),
        ({**STATE, "live": True}, 0.0, "live", "day.mcap"),
        ({**STATE, "live": True}, 2.1, "silent", "day.mcap"),
        ({**STATE, "live": True}, None, "silent", "day.mcap"),
    ],
)
def test_it_says_how_a_playback_is_doing(
    page: MakePage, state: dict[str, Any] | None, age_s: float | None, badge: str, source: str
) -> None:
    shown, stream = page()
    stream.remote.state = state
    stream.picture = None if age_s is None else picture_of(age_s=age_s)
    head = refreshed(shown)
    assert badge in head and source in head


@pytest.mark.parametrize(("age_s", "badge"), [(1.0, "live"), (2.1, "silent"), (None, "silent")])
def test_a_stream_without_control_is_live_or_silent(page: MakePage, age_s: float | None, badge: str) -> None:
    shown, stream = page(controlled=False)
    stream.picture = None if age_s is None else picture_of(age_s=age_s)
    head = refreshed(shown)
    assert badge in head and "tcp://feed" in head
    stream.picture = picture_of(count=2, source="filter")
    assert "filter" in refreshed(shown)


def test_what_stands_still_is_asked_for_once_nothing_was_heard(page: MakePage) -> None:
    shown, stream = page()
    for state in ({**STATE, "playing": True}, {**STATE, "live": True}, None):
        stream.remote.state = state
        refreshed(shown)
    assert stream.wanted == []
    stream.remote.state = STATE
    refreshed(shown, panel=False)
    assert stream.wanted == []
    refreshed(shown)
    assert stream.wanted == [("seek", 1.5)]
    stream.picture = picture_of()
    refreshed(shown)
    assert len(stream.wanted) == 1


def test_a_playback_that_is_gone_and_comes_back_leaves_the_page_as_it_was(page: MakePage) -> None:
    shown, stream = page()
    for state, badge in ((STATE, "paused"), (None, "no answer"), (STATE, "paused")):
        stream.remote.state = state
        assert badge in refreshed(shown)
        assert shown._controls is not None
        assert shown._controls.time.disabled == (state is None)


def test_each_picture_is_drawn_once(page: MakePage) -> None:
    shown, stream = page()
    for count, drawn in ((1, 1), (1, 1), (2, 2), (2, 2), (9, 3)):
        stream.picture = picture_of(count=count)
        refreshed(shown, panel=False)
        assert shown.pictures == drawn
    assert f"{np.degrees(Q[0]):.2f}°" not in shown._numbers.content
    refreshed(shown)
    assert f"{np.degrees(Q[0]):.2f}°" in shown._numbers.content


def test_arm_and_twin_are_where_their_joints_are(page: MakePage) -> None:
    shown, stream = page()
    stream.picture = picture_of()
    refreshed(shown)
    for figure, q in zip(shown._figures, (Q, TWIN_Q), strict=True):
        turn = figure._links[0].wxyz
        assert 2.0 * np.arctan2(turn[3], turn[0]) == pytest.approx(q[0])
    stream.picture = picture_of(twin=False, count=2)
    assert refreshed(shown)


def test_the_traces_are_those_of_the_tips(page: MakePage) -> None:
    shown, stream = page()
    stream.picture = picture_of()
    before = stream.picture.row
    stream.rows = [Row(0.5, Pose(Q, np.zeros(3)), None), Row(0.8, before.real, before.twin)]
    refreshed(shown)
    real, twin = (trace._line for trace in shown._traces)
    assert real.visible and twin.visible
    assert real.points[-1, 1] == pytest.approx(before.real.tip, abs=1e-6)
    assert before.twin is not None and twin.points[-1, 1] == pytest.approx(before.twin.tip, abs=1e-6)
    assert real.points[0, 0] == pytest.approx(np.zeros(3), abs=1e-6)  # the twin was not there yet
    assert twin.points[0, 0] == pytest.approx(before.twin.tip, abs=1e-6)


@pytest.mark.parametrize(
    ("place", "seen", "named", "apart"),
    [(BESIDE, True, True, True), (ON_TOP, True, False, False), (ALONE, False, False, False)],
)
def test_the_twin_is_where_it_is_wanted(page: MakePage, place: str, seen: bool, named: bool, apart: bool) -> None:
    shown, _ = page()
    assert shown._place is not None and shown._place.value == BESIDE
    on_loop(shown._server, lambda: setattr(shown._place, "value", place))
    on_loop(shown._server, shown._arrange)
    (arm, twin), (_, trace) = shown._figures, shown._traces
    assert arm._root.visible and twin._root.visible == seen
    assert (twin._labels[0].visible, arm._labels[0].visible) == (named, True)
    assert tuple(arm._root.position) == (0.0, 0.0, 0.0)
    assert (np.linalg.norm(twin._root.position) > 0.3) == apart
    assert tuple(trace._line.position) == tuple(twin._root.position)
    assert (trace.wanted, shown._traces[0].wanted) == (seen, True)


def test_what_is_shown_of_them_is_chosen(page: MakePage) -> None:
    shown, _ = page(twin=False)
    assert shown._place is None and len(shown._figures) == len(shown._traces) == 1
    arm = shown._figures[0]
    assert arm._sensors[0].visible and arm._labels[0].visible and arm._axes[0].visible and shown._traces[0].wanted
    for widget in (shown._sensors, shown._axes, shown._paths):
        on_loop(shown._server, lambda widget=widget: setattr(widget, "value", False))
    on_loop(shown._server, shown._arrange)
    assert not (
        arm._sensors[0].visible or arm._labels[0].visible or arm._axes[0].visible or shown._traces[0].wanted
    )
    assert arm._root.visible


def test_it_looks_sixty_times_a_second_and_leaves_out_what_is_late(
    page: MakePage, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown, _ = page(twin=False)
    now_s, looked = 100.0, []
    holdups = {20: 0.5, 40: 0.017}  # a long one, and one of about a picture

    def refresh(panel: bool) -> None:
        nonlocal now_s
        looked.append((now_s, panel))
        now_s += holdups.get(len(looked), 0.001)

    def sleep(seconds: float) -> None:
        nonlocal now_s
        assert seconds >= 0.0
        now_s += seconds

    monkeypatch.setattr(shown, "refresh", refresh)
    clock = SimpleNamespace(monotonic=lambda: now_s, sleep=sleep)
    monkeypatch.setattr("playback.view.page.time", clock)
    shown.run(lambda: now_s > 102.0)
    times = np.array([at for at, _ in looked]) - 100.0
    frames = times * RATE_HZ
    late = np.abs(frames - np.round(frames)) > 1e-6
    assert late.sum() <= 2  # those behind the hold-ups
    assert len(looked) == pytest.approx(2.0 * RATE_HZ - 0.5 * RATE_HZ, abs=3)
    assert sum(panel for _, panel in looked) == pytest.approx(len(looked) / PANEL_EVERY, abs=2)
    assert np.diff(times[25:38]) == pytest.approx(1.0 / RATE_HZ)
    assert looked[0][1] and not looked[1][1] and looked[PANEL_EVERY][1]


def test_a_page_is_over_when_what_it_shows_is(page: MakePage) -> None:
    shown, stream = page()
    stream.picture = picture_of()
    over = threading.Event()
    thread = threading.Thread(target=shown.run, args=(over.is_set,))
    thread.start()
    while not shown.pictures:
        threading.Event().wait(0.01)
    over.set()
    thread.join(30.0)
    assert not thread.is_alive()


def test_the_time_line_shows_the_whole_motion_or_what_was_heard(
    page: MakePage, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown, stream = page()
    drawn: list[tuple[float, list[Row]]] = []
    taken: list[object] = []
    monkeypatch.setattr(shown._timeline, "draw", lambda position_s, rows: drawn.append((position_s, rows)))
    monkeypatch.setattr(shown._timeline, "take", taken.append)
    stream.remote.state, stream.picture = STATE, picture_of()
    stream.rows = [stream.picture.row]
    refreshed(shown)
    assert drawn == [(1.0, stream.rows)] and taken == []
    stream.remote.motion = motion = object()
    for _ in range(2):
        refreshed(shown)
        assert drawn[-1] == (1.0, []) and taken == [motion]


def test_before_the_first_picture_time_stands_at_zero(page: MakePage, monkeypatch: pytest.MonkeyPatch) -> None:
    shown, stream = page()
    drawn: list[float] = []
    monkeypatch.setattr(shown._timeline, "draw", lambda position_s, _rows: drawn.append(position_s))
    refreshed(shown)
    stream.picture = picture_of()
    refreshed(shown)
    assert drawn == [0.0, 1.0]


def test_where_the_arm_can_be_touched_the_page_says_how_it_goes() -> None:
    held = SimpleNamespace(rows=lambda: [("Force", "1.25 N")], follow=lambda _tip: None)
    with web_server(Visitors("127.0.0.1"), 0, "limbplay") as server:
        plain, touched = (
            on_loop(server, lambda handle=handle: Page(server, Stream(), None, ARM, None, handle))
            for handle in (None, held)
        )
        refreshed(plain)
        refreshed(touched)
        assert plain._touch is None and "1.25 N" in touched._touch.content
