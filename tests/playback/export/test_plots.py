"""The curves beside the arm: where a frame's dot is, there is its curve's colour."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from arm.model import Arm, Joint
from playback.export import plots as module
from playback.export.plots import draw_plots
from playback.export.sampled import Mover, Sampled
from playback.shape import REAL

WIDTH, HEIGHT, HEAD = 360, 420, 50


def test_each_dot_lies_on_its_curve(motion: Sampled) -> None:
    plots = draw_plots(motion, WIDTH, HEIGHT, HEAD)
    assert plots.picture.shape == (HEIGHT, WIDTH, 3)
    n_joint = motion.movers[0].arm.n_joint
    assert len(plots.rows) == n_joint and len(plots.dots) == n_joint * len(motion.movers)
    for y, colour in plots.dots:
        for k in range(0, len(motion.t), 7):
            row, column = round(float(y[k])), round(float(plots.x[k]))
            around = plots.picture[row - 2 : row + 3, column - 2 : column + 3].reshape(-1, 3).astype(float)
            assert np.abs(around - colour).max(axis=1).min() < 60.0


def test_plots_are_below_the_head_one_below_the_other(motion: Sampled) -> None:
    plots = draw_plots(motion, WIDTH, HEIGHT, HEAD)
    assert plots.rows[0][0] == pytest.approx(HEAD, abs=0.3)
    edges = np.ravel(plots.rows)
    assert np.all(np.diff(edges) > 0.0) and edges[-1] < HEIGHT
    for (top, bottom), dots in zip(
        plots.rows, np.array_split(np.arange(len(plots.dots)), len(plots.rows)), strict=True
    ):
        for dot in dots:
            assert np.all((plots.dots[dot][0] >= top) & (plots.dots[dot][0] <= bottom))


def test_time_runs_from_edge_to_edge(motion: Sampled) -> None:
    x = draw_plots(motion, WIDTH, HEIGHT, HEAD).x
    assert (x[0], x[-1]) == (pytest.approx(62.0, abs=0.3), pytest.approx(WIDTH - 24.0, abs=0.3))
    assert np.diff(x) == pytest.approx((x[-1] - x[0]) / (len(x) - 1))


def test_more_is_further_up(pair: Sampled) -> None:
    plots = draw_plots(pair, WIDTH, HEIGHT, HEAD)
    (twin, _), (own, _) = plots.dots[:2]  # the arm's own lies on top, and is drawn last
    for y, mover in ((own, pair.movers[0]), (twin, pair.movers[1])):
        assert np.corrcoef(y, mover.q[:, 0])[0, 1] == pytest.approx(-1.0)
    ways = np.ptp(own) / np.ptp(twin)
    assert ways == pytest.approx(np.ptp(pair.movers[0].q[:, 0]) / np.ptp(pair.movers[1].q[:, 0]))


@pytest.mark.parametrize("height", [240, 420, 1080])
def test_below_the_last_there_is_room_for_the_time(pair: Sampled, height: int) -> None:
    plots = draw_plots(pair, WIDTH, height, HEAD)
    left = height - plots.rows[-1][1]
    assert 20.0 < left <= min(0.2 * height, 52.0) + 1.0
    ink = np.any(plots.picture[-int(left) :].astype(int).min(axis=2, keepdims=True) < 120, axis=(1, 2))
    assert ink.sum() > 5 and not ink[-1]  # numbers and a word, none of them cut off
    heights = np.diff(plots.rows, axis=1)
    gap = plots.rows[1][0] - plots.rows[0][1]
    assert heights == pytest.approx(heights[0, 0], abs=1.0) and 0.0 < gap < 0.2 * heights[0, 0]


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """Return the figures that are drawn."""
    figures: list[Figure] = []

    def figure(*args: Any, **kwargs: Any) -> Figure:
        figures.append(Figure(*args, **kwargs))
        return figures[-1]

    monkeypatch.setattr(module, "Figure", figure)
    return figures


def test_an_arm_s_curve_is_whole_and_its_twin_s_dashed_beneath(pair: Sampled, drawn: list[Figure]) -> None:
    draw_plots(pair, WIDTH, HEIGHT, HEAD)
    (figure,) = drawn
    for j, ax in enumerate(figure.axes):
        twin, own = ax.lines  # in the order in which they are drawn
        for line, mover, style in ((own, pair.movers[0], "-"), (twin, pair.movers[1], "--")):
            np.testing.assert_allclose(line.get_ydata(), np.degrees(mover.q[:, j]))
            assert (line.get_linewidth(), line.get_linestyle()) == (1.6, style)
            assert line.get_color() == pytest.approx(tuple(part / 255.0 for part in mover.colours.trace))
        assert ax.get_xlim() == pytest.approx((0.0, 0.5))
        assert ax.get_ylabel() == f"$q_{{{j + 1}}}$ [°]"
    assert [ax.get_xlabel() for ax in figure.axes] == ["", "time [s]"]


def test_what_slides_is_drawn_in_millimetres(drawn: list[Figure]) -> None:
    arm = Arm("slide", (Joint(a_m=0.1), Joint("prismatic"), Joint("prismatic")))
    t = np.linspace(0.0, 2.0, 5)
    q = np.column_stack([t, 0.1 * t, 0.15 * t])
    draw_plots(Sampled("slide", 1, 2.0, t, (Mover("slide", arm, q, q, q, REAL),)), WIDTH, HEIGHT, HEAD)
    turned, slid, farther = drawn[0].axes
    assert (turned.get_ylabel(), slid.get_ylabel()) == ("$q_{1}$ [°]", "$q_{2}$ [mm]")
    np.testing.assert_allclose(slid.lines[0].get_ydata(), [0.0, 50.0, 100.0, 150.0, 200.0])
    marks = [
        [mark for mark in ax.get_yticks().tolist() if ax.get_ylim()[0] <= mark <= ax.get_ylim()[1]]
        for ax in (slid, farther)
    ]
    assert marks == [[0.0, 100.0, 200.0], [0.0, 100.0, 200.0, 300.0]]  # four spaces at the most


def test_a_single_frame_is_at_the_left_edge(pair: Sampled) -> None:
    mover = pair.movers[0]
    one = replace(mover, q=mover.q[:1], dq=mover.dq[:1], ddq=mover.ddq[:1])
    plots = draw_plots(replace(pair, t=pair.t[:1], movers=(one,)), WIDTH, HEIGHT, HEAD)
    assert plots.x == pytest.approx([62.0])
