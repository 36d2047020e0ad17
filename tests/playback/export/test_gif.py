"""GIF files, read again."""

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
