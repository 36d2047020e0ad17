"""Films, decoded again."""

import subprocess
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from limbcal.errors import DeviceError
from playback.export.film import write_gif, write_mp4
from playback.export.frames import pictures
from playback.export.sampled import Sampled
from playback.export.scene import PAPER, Scene

SIZE = (320, 180)


def coloured(n: int) -> Iterator[np.ndarray]:
    """Yield pictures, each of one grey of its own."""
    for k in range(n):
        yield np.full((SIZE[1], SIZE[0], 3), 40 + 7 * k, np.uint8)


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


@pytest.mark.parametrize("rate_hz", [25.0, 30.0])
def test_a_gif_keeps_the_time(tmp_path: Path, rate_hz: float) -> None:
    path = tmp_path / "film.gif"
    write_gif(path, coloured(20), rate_hz)
    with Image.open(path) as film:
        assert (film.size, film.n_frames, film.info["loop"]) == (SIZE, 20, 0)
        durations = []
        for k in range(20):
            film.seek(k)
            durations.append(film.info["duration"])
            assert float(np.asarray(film.convert("RGB")).mean()) == pytest.approx(40 + 7 * k, abs=4.0)
    assert sum(durations) == pytest.approx(20e3 / rate_hz, abs=5.0)
    assert set(durations) <= {30, 40}


def test_what_breaks_off_leaves_nothing(tmp_path: Path) -> None:
    def broken() -> Iterator[np.ndarray]:
        yield from coloured(3)
        raise KeyboardInterrupt

    kept = tmp_path / "film.mp4"
    kept.write_bytes(b"the one before")
    for write in (lambda: write_mp4(kept, broken(), SIZE, 25.0), lambda: write_gif(kept, broken(), 25.0)):
        with pytest.raises(KeyboardInterrupt):
            write()
        assert [found.name for found in tmp_path.iterdir()] == ["film.mp4"]
    assert kept.read_bytes() == b"the one before"


def test_a_full_disk_is_said(tmp_path: Path) -> None:
    (tmp_path / "not-a-folder").write_bytes(b"")
    with pytest.raises(DeviceError, match="film.gif cannot be written"):
        write_gif(tmp_path / "not-a-folder" / "film.gif", coloured(2), 25.0)


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


def test_a_legend_names_both_arms_in_their_colours(pair: Sampled) -> None:
    width, height = 640, 360
    size, left = max(11, round(height / 42)), round(0.56 * width)
    head = next(iter(pictures(pair, width, height)))[: 2 * size, left:]
    for mover in pair.movers:
        swatch = (head == np.array(mover.colours.link)).all(axis=2)
        rows, columns = np.nonzero(swatch)
        assert np.ptp(rows) + 1 == pytest.approx(0.8 * size, abs=1.5)
        assert np.ptp(columns) + 1 == pytest.approx(0.8 * size, abs=1.5)
        assert len(rows) == (np.ptp(rows) + 1) * (np.ptp(columns) + 1)


def test_one_arm_needs_no_legend(pair: Sampled) -> None:
    alone = replace(pair, movers=pair.movers[:1])
    head = next(iter(pictures(alone, 640, 360)))[:22, 358:]
    assert np.all(head == np.array(PAPER))
