"""GIF files, read again."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from limbcal.errors import DeviceError
from playback.export.gif import write_gif
from tests.playback.export.grey_pictures import SIZE, broken, coloured


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


def test_only_what_changes_is_written_and_the_rest_stays(tmp_path: Path) -> None:
    pictures = [np.full((180, 320, 3), 200, np.uint8) for _ in range(4)]
    for k in (1, 2):
        pictures[k][20 * k : 20 * k + 10, 30:50] = (250, 10, 10)
    path = tmp_path / "film.gif"
    write_gif(path, iter(pictures), 25.0)  # the last is the first once more, with nothing on it
    with Image.open(path) as film:
        assert film.n_frames == 4
        for k, picture in enumerate(pictures):
            film.seek(k)
            np.testing.assert_allclose(np.asarray(film.convert("RGB")), picture, atol=8)
    write_gif(path, iter(pictures[:1] * 3), 25.0)
    with Image.open(path) as film:
        assert film.n_frames == 3
        film.seek(2)
        np.testing.assert_allclose(np.asarray(film.convert("RGB")), pictures[0], atol=8)


def test_each_picture_is_written_before_the_next_is_made(tmp_path: Path) -> None:
    sizes = []

    def noise() -> Iterator[np.ndarray]:
        rng = np.random.default_rng(0)
        for _ in range(6):
            sizes.append(sum(part.stat().st_size for part in tmp_path.iterdir()))
            yield rng.integers(0, 256, (SIZE[1], SIZE[0], 3), dtype=np.uint8)

    write_gif(tmp_path / "film.gif", noise(), 25.0)
    assert (np.diff(sizes[1:]) > 20_000).all()


def test_what_breaks_off_leaves_the_file_before(tmp_path: Path) -> None:
    kept = tmp_path / "film.gif"
    kept.write_bytes(b"the one before")
    with pytest.raises(KeyboardInterrupt):
        write_gif(kept, broken(), 25.0)
    assert [found.name for found in tmp_path.iterdir()] == ["film.gif"]
    assert kept.read_bytes() == b"the one before"


def test_a_full_disk_is_said(tmp_path: Path) -> None:
    (tmp_path / "not-a-folder").write_bytes(b"")
    with pytest.raises(DeviceError, match="film.gif cannot be written"):
        write_gif(tmp_path / "not-a-folder" / "film.gif", coloured(2), 25.0)
