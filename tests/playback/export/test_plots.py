"""The curves beside the arm: where a frame's dot is, there is its curve's colour."""

import numpy as np
import pytest

from playback.export.plots import draw_plots
from playback.export.sampled import Sampled

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
