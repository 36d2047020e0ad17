"""Pictures into GIF, one after the other; Pillow compresses them."""

import struct
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from PIL import Image as Pil
from PIL.GifImagePlugin import getdata

from playback.export.raster import Picture
from playback.export.whole_file import whole_file

GIF_TICK_HZ = 100.0  # a GIF counts time in hundredths of a second
#: Of a picture's 256 colours the last lets the picture before be seen.
_TRANSPARENT = 255
#: Version 89a, and after width and height: no palette for all, no background, square pixels (GIF89a, 17 and 18).
_BEGIN, _NO_PALETTE = b"GIF89a", bytes([0x70, 0, 0])
#: Netscape's extension, which repeats the film for ever.
_FOR_EVER = b"!\xff\x0bNETSCAPE2.0\x03\x01\x00\x00\x00"
_END = b";"
#: What follows is drawn over a picture.
_KEEP = 1


def write_gif(path: Path, pictures: Iterator[Picture], rate_hz: float) -> None:
    """Write a GIF that repeats for ever. Every picture has a palette of its own; the pace keeps the time.

    Pillow's own writer of films keeps every picture until the last; here each is written as it comes, as far as it
    differs from the one before.

    Raises
    ------
    DeviceError
        If the disk fails.
    """
    before: Picture | None = None
    with whole_file(path) as part, part.open("wb") as file:
        for k, picture in enumerate(pictures):
            if before is None:
                high, wide = picture.shape[:2]
                file.write(_BEGIN + struct.pack("<HH", wide, high) + _NO_PALETTE + _FOR_EVER)
            begin, end = np.round(np.array([k, k + 1]) * GIF_TICK_HZ / rate_hz)
            file.writelines(_frame(picture, before, int(end - begin)))
            before = picture.copy()
        file.write(_END)


def _frame(picture: Picture, before: Picture | None, ticks: int) -> list[bytes]:
    """Return the bytes of the part of a picture that differs from the one before."""
    changed = np.ones(picture.shape[:2], dtype=bool) if before is None else (picture != before).any(axis=2)
    rows, columns = (np.flatnonzero(changed.any(axis=axis)) for axis in (1, 0))
    # where nothing differs, one pixel keeps the time
    top, bottom = (rows[0], rows[-1] + 1) if len(rows) else (0, 1)
    left, right = (columns[0], columns[-1] + 1) if len(columns) else (0, 1)
    part = slice(top, bottom), slice(left, right)
    few = Pil.fromarray(np.ascontiguousarray(picture[part])).quantize(_TRANSPARENT, Pil.Quantize.FASTOCTREE)
    drawn = Pil.fromarray(np.where(changed[part], np.asarray(few), np.uint8(_TRANSPARENT)))
    palette = few.getpalette() or []
    drawn.putpalette(palette + [0] * (3 * (_TRANSPARENT + 1) - len(palette)))
    milliseconds = int(1000.0 / GIF_TICK_HZ) * ticks
    return getdata(
        drawn,
        (int(left), int(top)),
        duration=milliseconds,
        disposal=_KEEP,
        transparency=_TRANSPARENT,
        include_color_table=True,
    )
