"""The line behind a tip: where the tip was, the last stretch of time only, and paler the longer ago."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from playback.view.stage import BACKGROUND
from playback.view.trace import SPAN_S, Trace

COLOUR = (200, 10, 60)


class Stage:
    """Keeps the line that is put on it."""

    def __init__(self) -> None:
        self.scene = self
        self.line: Any = None

    def add_line_segments(self, name: str, points: np.ndarray, colors: np.ndarray, **looks: Any) -> Any:
        self.line = SimpleNamespace(name=name, points=points, colors=colors, **looks)
        return self.line


@pytest.fixture
def stage() -> Stage:
    return Stage()


@pytest.fixture
def trace(stage: Stage) -> Trace:
    return Trace(stage, "/trace", COLOUR)  # type: ignore[arg-type] - of a server it asks for a line alone


def circle(t: np.ndarray) -> list[np.ndarray]:
    return list(np.column_stack([np.cos(t), np.sin(t), 0.1 * t]))


def test_it_runs_through_where_the_tip_was_lately(stage: Stage, trace: Trace) -> None:
    t = np.linspace(0.0, 5.0, 1001)
    trace.show(list(t), circle(t))
    points = stage.line.points
    assert stage.line.visible
    assert points.shape == (len(stage.line.colors), 2, 3)
    assert points[1:, 0] == pytest.approx(points[:-1, 1])  # each segment begins where the one before ends
    assert points[0, 0] == pytest.approx(circle(np.array([5.0 - SPAN_S]))[0], abs=1e-4)
    assert points[-1, 1] == pytest.approx(circle(np.array([5.0]))[0], abs=1e-6)
    at = points[:, 0, 2] / 0.1
    assert points[:, 0, :2] == pytest.approx(np.column_stack([np.cos(at), np.sin(at)]), abs=1e-4)
    assert np.diff(at) == pytest.approx(at[1] - at[0], rel=1e-2)


def test_a_short_way_begins_where_it_begins(stage: Stage, trace: Trace) -> None:
    trace.show([0.0, 0.1], circle(np.array([0.0, 0.1])))
    assert stage.line.visible
    assert stage.line.points[0, 0] == pytest.approx([1.0, 0.0, 0.0])


def test_one_place_is_no_way_nor_is_one_that_nobody_wants(stage: Stage, trace: Trace) -> None:
    t = np.linspace(0.0, 5.0, 11)
    assert not stage.line.visible
    trace.show([0.0], circle(np.zeros(1)))
    assert not stage.line.visible
    trace.wanted = False
    trace.show(list(t), circle(t))
    assert not stage.line.visible
    trace.wanted = True
    trace.show(list(t), circle(t))
    assert stage.line.visible


def test_it_fades_into_the_background(stage: Stage, trace: Trace) -> None:
    colors = stage.line.colors.astype(float)
    assert colors[0, 0] == pytest.approx(BACKGROUND, abs=1.0)
    assert colors[-1, 1] == pytest.approx(COLOUR, abs=1.0)
    off = np.linalg.norm(colors[:, 0] - np.array(COLOUR), axis=1)
    assert np.all(np.diff(off) < 0.0)


def test_it_moves_with_its_arm(stage: Stage, trace: Trace) -> None:
    trace.stand_at(np.array([1.0, 2.0, 3.0]))
    assert tuple(stage.line.position) == (1.0, 2.0, 3.0)
