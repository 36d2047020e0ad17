"""The pictures of a film: the arm on the left, its joints over time on the right."""

from collections.abc import Iterator
from pathlib import Path

import matplotlib
import numpy as np
from PIL import Image as Pil
from PIL import ImageDraw, ImageFont

from playback.export.plots import INK, draw_plots
from playback.export.raster import Picture, draw_stroke
from playback.export.sampled import Sampled
from playback.export.scene import Scene

ARM_SHARE = 0.56  # of the width
HEAD_LINES = 4  # in letters' heights, for title and legend
CURSOR = np.array([120.0, 126.0, 138.0])


def pictures(motion: Sampled, width: int, height: int) -> Iterator[Picture]:
    """Yield the picture of every frame, (height, width, 3) of uint8; each is valid until the next."""
    left = round(ARM_SHARE * width)
    size = max(11, round(height / 42))
    scene = Scene(motion.movers, left, height, HEAD_LINES * size)
    plots = draw_plots(motion, width - left, height, HEAD_LINES * size)
    picture = np.empty((height, width, 3), np.uint8)
    words = _Words(motion, scene.grid_m, left, height, size)
    graph = plots.picture.astype(np.float32)
    for k, t in enumerate(motion.t):
        picture[:, :left] = scene.draw(k)
        drawn = graph.copy()
        for top, bottom in plots.rows:
            ends = np.array([[plots.x[k], top], [plots.x[k], bottom]])
            draw_stroke(ends[0], ends[1], 0.5, CURSOR, 0.8, drawn)
        for y, colour in plots.dots:
            place = np.array([plots.x[k], y[k]])
            draw_stroke(place, place, size / 3.6, colour, 1.0, drawn)
        picture[:, left:] = np.clip(drawn + 0.5, 0.0, 255.0).astype(np.uint8)
        yield words.over(picture, float(t))


class _Words:
    """What is written into every picture."""

    def __init__(self, motion: Sampled, grid_m: float, width: int, height: int, size: int) -> None:
        fonts = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
        self._plain = ImageFont.truetype(str(fonts / "DejaVuSans.ttf"), size)
        self._bold = ImageFont.truetype(str(fonts / "DejaVuSans-Bold.ttf"), size)
        self._motion, self._size, self._corner = motion, size, (width, height)
        self._grid = f"grid {1e3 * grid_m:g} mm" if grid_m < 1.0 else f"grid {grid_m:g} m"

    def over(self, picture: Picture, t: float) -> Picture:
        page = Pil.fromarray(picture)
        pen, size, (width, height) = ImageDraw.Draw(page), self._size, self._corner
        pen.text((size, size), self._motion.title, INK, self._bold)
        pen.text((size, 2.4 * size), f"trial {self._motion.trial}     t = {t:.2f} s", INK, self._plain)
        pen.text((width - size, height - size), self._grid, CURSOR_INK, self._plain, anchor="rs")
        x = float(width + size)
        for mover in self._motion.movers if len(self._motion.movers) > 1 else ():
            pen.rectangle((x, 1.1 * size, x + 0.8 * size, 1.9 * size), fill=mover.colours.link)
            pen.text((x + 1.3 * size, size), mover.name, INK, self._plain)
            x += 3.0 * size + pen.textlength(mover.name, self._plain)
        return np.asarray(page)


CURSOR_INK = tuple(int(value) for value in CURSOR)
