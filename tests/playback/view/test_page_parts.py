"""What the page asks of its parts: arms, markers, ball, stage and traces, each only for what is theirs."""

from collections.abc import Iterator, Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import viser

from playback.view.feed import Picture, Pose, Row
from playback.view.page import Page, _tips
from playback.view.server import on_loop, web_server
from playback.view.timeline import LIVE_SPAN_S
from playback.view.trace import SPAN_S
from playback.view.visitors import Visitors
from tests.playback.view.test_page_told import ARM, STATE, Q, Stream, picture_of, refreshed


@pytest.fixture
def server() -> Iterator[viser.ViserServer]:
    with web_server(Visitors("127.0.0.1"), 0, "limbplay") as server:
        yield server


def paged(server: viser.ViserServer, stream: Any, twin: bool = False, **parts: Any) -> Page:
    return on_loop(server, lambda: Page(server, stream, stream.remote, ARM, ARM if twin else None, **parts))


def picture(q: np.ndarray, count: int = 1, **fields: Any) -> Picture:
    row = Row(1.5, Pose(q, np.array([0.1, 0.2, 0.3])), None)
    return Picture(count, 0, 0.0, row, "limb/play", "", 1.0, fields)


def chosen(page: Page, widget: Any, value: object) -> None:
    on_loop(page._server, lambda: setattr(widget, "value", value))
    on_loop(page._server, page._arrange)


class Markers:
    """Stands for the measured markers in the scene."""

    def __init__(self, _server: object, _arm: object, trials: Mapping[int, object]) -> None:
        self.trials = trials
        self.shown: list[tuple[object, float, list[float]]] = []
        self.wanted: list[bool] = []

    def show(self, trial: object, position_s: float, q: np.ndarray) -> None:
        self.shown.append((trial, position_s, q.tolist()))

    def seen(self, wanted: bool) -> None:
        self.wanted.append(wanted)

    def rows(self) -> list[tuple[str, str]]:
        return [("markers, 3 of 4", "1.5 mm rms")]


def test_measured_markers_are_those_of_the_instant_and_can_be_hidden(
    server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("playback.view.page.MarkerErrors", Markers)
    stream, trials = Stream(), {7: object()}
    page = paged(server, stream, markers=trials)
    markers: Any = page._markers
    assert markers.trials is trials and markers.wanted == [True]
    stream.picture = picture(Q, trial=7)
    refreshed(page)
    assert markers.shown == [(7, 1.5, Q.tolist())]
    numbers = page._numbers.content
    assert numbers.index("markers, 3 of 4") < numbers.index("q1")
    chosen(page, page._measured, False)
    assert markers.wanted[0] is True and markers.wanted[-1] is False
    stream.picture = picture(np.zeros(3), count=2)
    refreshed(page, panel=False)
    assert len(markers.shown) == 1  # of another arm nothing is known
    assert paged(server, Stream())._measured is None


def test_an_arm_stands_still_where_another_s_joints_come(server: viser.ViserServer) -> None:
    followed: list[list[float]] = []
    handle: Any = SimpleNamespace(follow=lambda tip: followed.append(tip.tolist()), rows=list)
    stream = Stream()
    page = paged(server, stream, handle=handle)
    stream.picture = picture(np.array([0.3, 0.6, 0.9]))
    refreshed(page, panel=False)
    assert tuple(page._figures[0]._links[0].wxyz) == (1.0, 0.0, 0.0, 0.0)
    assert followed == [[0.1, 0.2, 0.3]]  # the ball goes with the tip all the same


def test_names_are_hidden_and_shadows_cast_by_themselves(server: viser.ViserServer) -> None:
    page = paged(server, Stream(), twin=True)
    arm, twin = page._figures
    shades: list[bool] = []
    page._stage.shade = shades.append  # type: ignore[method-assign]
    chosen(page, page._labels, False)
    for figure in (arm, twin):
        assert not figure._labels[0].visible
        assert figure._sensors[0].visible and figure._axes[0].visible and figure._root.visible
    chosen(page, page._shadows, True)
    assert shades[0] is False and shades[-1] is True
    assert (arm._opacity, twin._opacity) == (None, 0.45)


def test_the_past_that_is_asked_for_is_as_long_as_it_is_drawn(server: viser.ViserServer) -> None:
    asked: list[float] = []
    stream: Any = Stream()
    stream.history = lambda span_s: asked.append(span_s) or []
    page = paged(server, stream)
    stream.picture, stream.remote.state = picture_of(twin=False), STATE
    refreshed(page)
    assert asked == [SPAN_S, LIVE_SPAN_S]


def test_the_stage_is_as_large_as_what_both_tips_do() -> None:
    tip, other = np.arange(6.0).reshape(2, 3), -np.arange(3.0)[None]
    remote: Any = SimpleNamespace(motion=None)
    assert _tips(None) is None and _tips(remote) is None
    remote.motion = SimpleNamespace(tip=tip, twin_tip=None)
    np.testing.assert_array_equal(_tips(remote), tip)
    remote.motion.twin_tip = other
    np.testing.assert_array_equal(_tips(remote), [*tip, *other])
