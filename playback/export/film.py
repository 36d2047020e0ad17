"""Pictures into MP4, by the ffmpeg that imageio-ffmpeg brings, and GIF, by Pillow."""

from collections.abc import Iterator
from pathlib import Path

import imageio_ffmpeg
import numpy as np
from PIL import Image as Pil

from limbcal.errors import DeviceError
from playback.export.raster import Picture
from playback.export.whole_file import whole_file

GIF_TICK_HZ = 100.0  # a GIF counts time in hundredths of a second
GIF_COLOURS = 256


def write_mp4(path: Path, pictures: Iterator[Picture], size: tuple[int, int], rate_hz: float) -> None:
    """Write H.264 that every player knows (yuv420p), at a quality close to the pictures'.

    Raises
    ------
    DeviceError
        If the disk or the encoder fails.
    """
    with whole_file(path) as part:
        encoder = imageio_ffmpeg.write_frames(
            str(part),
            size,
            fps=rate_hz,
            codec="libx264",
            quality=None,
            macro_block_size=2,
            output_params=["-crf", "18", "-preset", "medium", "-movflags", "+faststart"],
        )
        try:
            encoder.send(None)
            for picture in pictures:
                encoder.send(np.ascontiguousarray(picture).tobytes())
        except OSError as error:  # what ffmpeg said is in its text, over many lines
            raise DeviceError(f"{path} cannot be encoded: {_last_line(error)}") from error
        finally:
            encoder.close()


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


def _last_line(error: OSError) -> str:
    return (str(error).strip().splitlines() or ["ffmpeg stopped"])[-1]
