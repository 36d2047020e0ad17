"""Pictures into GIF, by Pillow."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from PIL import Image as Pil

from playback.export.raster import Picture
from playback.export.whole_file import whole_file

GIF_TICK_HZ = 100.0  # a GIF counts time in hundredths of a second
GIF_COLOURS = 256


def write_gif(path: Path, pictures: Iterator[Picture], rate_hz: float) -> None:
    """Write a GIF that repeats for ever. Every picture has a palette of its own; the pace keeps the time.

    Raises
    ------
    DeviceError
        If the disk fails.
    """
    few = (Pil.fromarray(picture).quantize(GIF_COLOURS, Pil.Quantize.FASTOCTREE) for picture in pictures)
    with whole_file(path) as part:
        frames = list(few)
        ticks = np.round(np.arange(len(frames) + 1) * GIF_TICK_HZ / rate_hz)
        durations = (np.diff(ticks) * 1000.0 / GIF_TICK_HZ).astype(int).tolist()
        frames[0].save(part, save_all=True, append_images=frames[1:], duration=durations, loop=0, disposal=1)
