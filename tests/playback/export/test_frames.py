"""The pictures of a film: words, curves with their dots, and a line for now."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from PIL import ImageDraw

from arm.model import Arm, Joint
from playback.export.frames import CURSOR, pictures
from playback.export.plots import draw_plots
from playback.export.sampled import Sampled, sample
from playback.export.scene import PAPER, Scene
from tests.playback.export.conftest import source_of

WIDTH, HEIGHT = 500, 280
LEFT = 280  # 56 % of the width
SIZE = 11  # the smallest letters


@pytest.fixture
def written(monkeypatch: pytest.MonkeyPatch) -> list[tuple[float, float, str]]:
    """Return what is written into pictures, and where."""
    words: list[tuple[float, float, str]] = []
    plain = ImageDraw.ImageDraw.text

    def text(self: Any, xy: tuple[float, float], what: str, *args: Any, **kwargs: Any) -> None:
        words.append((*xy, what))
        plain(self, xy, what, *args, **kwargs)

    monkeypatch.setattr(ImageDraw.ImageDraw, "text", text)
    return words


def film(motion: Sampled, width: int = WIDTH, height: int = HEIGHT) -> list[np.ndarray]:
    return [picture.copy() for picture in pictures(motion, width, height)]


def test_title_trial_time_and_grid_are_written(pair: Sampled, written: list[tuple[float, float, str]]) -> None:
    film(replace(pair, movers=pair.movers[:1], trial=4))
    a_picture = len(written) // len(pair.t)
    assert [what for _, _, what in written[:a_picture]] == [pair.title, "trial 4     t = 0.00 s", "grid 100 mm"]
    title, below, _ = (y for _, y, _ in written[:a_picture])
    assert title + SIZE < below < title + 2 * SIZE  # a line of its own, right under the title
    times = [what for _, _, what in written if what.startswith("trial")]
    assert times == [f"trial 4     t = {t:.2f} s" for t in pair.t]


def test_two_arms_are_told_apart_above_the_curves(pair: Sampled, written: list[tuple[float, float, str]]) -> None:
    first = film(pair)[0]
    (x1, y1, one), (x2, y2, other) = written[3:5]
    assert (one, other) == tuple(mover.name for mover in pair.movers)
    assert LEFT < x1 < x2 < WIDTH and y1 == y2 < 2 * SIZE
    for x, y, mover in ((x1, y1, pair.movers[0]), (x2, y2, pair.movers[1])):
        chip = first[int(y + 0.5 * SIZE), int(x - 0.9 * SIZE)]
        assert tuple(chip) == mover.colours.link
        assert tuple(first[int(y + 0.5 * SIZE), int(x - 1.8 * SIZE)]) != mover.colours.link


def test_a_line_at_now_goes_over_the_curves(pair: Sampled) -> None:
    drawn = film(pair)
    plots = draw_plots(pair, WIDTH - LEFT, HEIGHT, 4 * SIZE)
    still = plots.picture.astype(int)
    for k in (0, len(pair.t) // 2, len(pair.t) - 1):
        right = drawn[k][:, LEFT:].astype(int)
        rows, columns = np.nonzero(np.any(np.abs(right - still) > 2, axis=2))
        below_words = rows >= 4 * SIZE
        rows, columns = rows[below_words], columns[below_words]
        assert np.abs(columns + 0.5 - plots.x[k]).max() < 6.0
        for top, bottom in plots.rows:
            mine = rows[(rows > top - 3) & (rows < bottom + 3)]
            assert mine.min() <= top + 2 and mine.max() >= bottom - 3
            inner, here = slice(int(top) + 4, int(bottom) - 4), int(plots.x[k])
            darker = (still - right)[inner, max(here - 2, 0) : here + 3].sum(axis=1)
            width_px = np.median(darker, axis=0) / (0.8 * (255.0 - CURSOR))
            assert np.all((width_px > 0.7) & (width_px < 2.3))


def test_every_curve_has_a_dot_of_its_colour(pair: Sampled) -> None:
    drawn = film(pair)
    plots = draw_plots(pair, WIDTH - LEFT, HEIGHT, 4 * SIZE)
    k = max(range(len(pair.t)), key=lambda k: float(np.abs(pair.movers[0].q[k] - pair.movers[1].q[k]).min()))
    for y, colour in plots.dots:
        seen = drawn[k][int(y[k]), LEFT + int(plots.x[k])]
        assert seen == pytest.approx(colour, abs=3)


def test_pictures_show_arm_and_curves(pair: Sampled) -> None:
    drawn = [picture.copy() for picture in pictures(pair, 640, 360)]
    assert len(drawn) == len(pair.t)
    assert {picture.shape for picture in drawn} == {(360, 640, 3)}
    first, last = drawn[0].astype(int), drawn[-1].astype(int)
    left = round(0.56 * 640)
    assert np.any(first[:, :left] != last[:, :left]) and np.any(first[:, left:] != last[:, left:])


@pytest.mark.parametrize(("width", "height"), [(400, 300), (160, 300)])
def test_all_of_the_arm_is_in_the_picture_all_the_time(motion: Sampled, width: int, height: int) -> None:
    bare = Scene(motion.movers, width, height)
    empty = np.array(PAPER, dtype=np.float32)
    for k in (0, 10, len(motion.t) - 1):
        bare.draw(k)
        bare._image[:] = empty
        bare._depth[:] = -1e30
        bare._draw(0, k, bare._image, bare._depth)
        drawn = np.any(bare._image != empty, axis=2)
        assert drawn.mean() > 0.01
        assert not drawn[[0, -1]].any() and not drawn[:, [0, -1]].any()


def test_one_arm_needs_no_legend(pair: Sampled) -> None:
    alone = replace(pair, movers=pair.movers[:1])
    head = next(iter(pictures(alone, 640, 360)))[:22, 358:]
    assert np.all(head == np.array(PAPER))


@pytest.mark.parametrize(("reach_m", "said"), [(3.9, "grid 500 mm"), (4.0, "grid 1 m"), (0.05, "grid 10 mm")])
def test_the_grid_s_step_is_said_in_metres_from_one_on(
    reach_m: float, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    words: list[str] = []
    monkeypatch.setattr(ImageDraw.ImageDraw, "text", lambda _, xy, what, *rest, **more: words.append(what))
    arm = Arm("long", (Joint(a_m=0.6 * reach_m), Joint(a_m=0.4 * reach_m)))
    next(pictures(sample(source_of(arm), None, 20.0, 1.0), 320, 180))
    assert words[2] == said
