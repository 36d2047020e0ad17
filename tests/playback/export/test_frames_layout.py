"""Where words, colours and marks of a film's picture are, to the pixel, and how they look."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from PIL import ImageDraw, ImageFont

from arm.model import Arm, Joint
from playback.export import frames
from playback.export.frames import pictures
from playback.export.plots import draw_plots
from playback.export.sampled import Sampled, sample
from tests.playback.export.conftest import source_of

WIDTH, HEIGHT, LEFT = 500, 280, 280


def brief(motion: Sampled) -> Sampled:
    """Return the first two frames of a motion."""
    movers = tuple(replace(one, q=one.q[:2], dq=one.dq[:2], ddq=one.ddq[:2]) for one in motion.movers)
    return replace(motion, t=motion.t[:2], movers=movers)


def test_words_stand_in_corners_and_names_behind_their_colours(
    pair: Sampled, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By hand, for letters of 11 pixels."""
    words: list[tuple[str, tuple[float, float], Any, str, Any]] = []
    chips: list[tuple[tuple[float, ...], Any]] = []

    def text(_: Any, xy: tuple[float, float], what: str, fill: Any, font: Any, anchor: Any = None) -> None:
        words.append((what, xy, fill, f"{font.getname()[1]} {font.size}", anchor))

    monkeypatch.setattr(ImageDraw.ImageDraw, "text", text)
    monkeypatch.setattr(ImageDraw.ImageDraw, "rectangle", lambda _, xy, fill: chips.append((xy, fill)))
    next(pictures(pair, WIDTH, HEIGHT))
    path = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"
    one, other = (mover.name for mover in pair.movers)
    further = 33.0 + ImageFont.truetype(str(path), 11).getlength(one)
    assert words == [
        (pair.title, (11, 11), "#30343b", "Bold 11", None),
        ("trial 1     t = 0.00 s", (11, pytest.approx(26.4)), "#30343b", "Book 11", None),
        ("grid 100 mm", (269, 269), (120, 126, 138), "Book 11", "rs"),
        (one, (pytest.approx(305.3), 11), "#30343b", "Book 11", None),
        (other, (pytest.approx(305.3 + further), 11), "#30343b", "Book 11", None),
    ]
    assert [fill for _, fill in chips] == [mover.colours.link for mover in pair.movers]
    for k, (corners, _) in enumerate(chips):
        assert corners == pytest.approx((291.0 + k * further, 12.1, 299.8 + k * further, 20.9))


def test_a_pale_line_and_solid_dots_mark_what_is_now(pair: Sampled, monkeypatch: pytest.MonkeyPatch) -> None:
    strokes: list[tuple[Any, ...]] = []
    monkeypatch.setattr(frames, "draw_stroke", lambda *stroke: strokes.append(stroke[:5]))
    first, second = (picture.copy() for picture in pictures(brief(pair), WIDTH, HEIGHT))
    plots = draw_plots(brief(pair), WIDTH - LEFT, HEIGHT, 44)
    below = slice(44, None)  # words are above
    for drawn in (first, second):
        np.testing.assert_array_equal(drawn[below, LEFT:], plots.picture[below])
    assert len(strokes) == 2 * (2 + 4)  # a line a joint, and a dot a curve
    for k, found in enumerate((strokes[:6], strokes[6:])):
        for (start, end, *look), (top, bottom) in zip(found[:2], plots.rows, strict=True):
            assert (start.tolist(), end.tolist()) == ([plots.x[k], top], [plots.x[k], bottom])
            radius, colour, opacity = look
            assert (radius, colour.tolist(), opacity) == (0.5, [120.0, 126.0, 138.0], 0.8)
        for (start, end, radius, colour, opacity), (y, own) in zip(found[2:], plots.dots, strict=True):
            assert start.tolist() == end.tolist() == [plots.x[k], y[k]]
            assert (radius, opacity) == (pytest.approx(3.0556, abs=1e-4), 1.0)
            assert colour.tolist() == own.tolist()


@pytest.mark.parametrize(("reach_m", "said"), [(3.9, "grid 500 mm"), (4.0, "grid 1 m"), (0.05, "grid 10 mm")])
def test_the_grid_s_step_is_said_in_metres_from_one_on(
    reach_m: float, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    words: list[str] = []
    monkeypatch.setattr(ImageDraw.ImageDraw, "text", lambda _, xy, what, *rest, **more: words.append(what))
    arm = Arm("long", (Joint(a_m=0.6 * reach_m), Joint(a_m=0.4 * reach_m)))
    next(pictures(sample(source_of(arm), None, 20.0, 1.0), 320, 180))
    assert words[2] == said
