"""MP4 files, decoded again."""

import subprocess
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest

from playback.export.mp4 import write_mp4
from tests.playback.export.grey_pictures import SIZE, broken, coloured


def ffmpeg(*arguments: str) -> subprocess.CompletedProcess[bytes]:
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-hide_banner", *arguments]
    return subprocess.run(command, capture_output=True, stdin=subprocess.DEVNULL, check=False)


def decode(path: Path) -> tuple[str, np.ndarray]:
    """Return what ffmpeg says of the stream, and all frames."""
    about = ffmpeg("-i", str(path)).stderr.decode()
    raw = ffmpeg("-i", str(path), "-f", "rawvideo", "-pix_fmt", "rgb24", "-").stdout
    return about, np.frombuffer(raw, np.uint8).reshape(-1, SIZE[1], SIZE[0], 3)


def test_an_mp4_has_every_frame_in_its_place_and_time(tmp_path: Path) -> None:
    path = tmp_path / "film.mp4"
    write_mp4(path, coloured(25), SIZE, 50.0)
    about, frames = decode(path)
    assert "Video: h264" in about and "yuv420p" in about
    assert "320x180" in about and "50 fps" in about and "Duration: 00:00:00.50" in about
    assert frames.mean(axis=(1, 2, 3)) == pytest.approx(np.array([40 + 7 * k for k in range(25)]), abs=2.5)
    assert [found.name for found in tmp_path.iterdir()] == ["film.mp4"]
    assert path.read_bytes().index(b"moov") < path.read_bytes().index(b"mdat")  # plays while it loads


def test_what_breaks_off_leaves_the_file_before(tmp_path: Path) -> None:
    kept = tmp_path / "film.mp4"
    kept.write_bytes(b"the one before")
    with pytest.raises(KeyboardInterrupt):
        write_mp4(kept, broken(), SIZE, 25.0)
    assert [found.name for found in tmp_path.iterdir()] == ["film.mp4"]
    assert kept.read_bytes() == b"the one before"
