"""Pictures into MP4, by the ffmpeg that imageio-ffmpeg brings."""

from collections.abc import Iterator
from pathlib import Path

import imageio_ffmpeg
import numpy as np

from limbcal.errors import DeviceError
from playback.export.raster import Picture
from playback.export.whole_file import whole_file


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


def _last_line(error: OSError) -> str:
    return (str(error).strip().splitlines() or ["ffmpeg stopped"])[-1]
