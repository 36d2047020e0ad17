"""The page in a real browser: it shows the arms, and its widgets move them."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path

import numpy as np
import pytest

from playback.source import Source
from tests.playback.view.conftest import Viewing, Window, eventually

RATE_HZ = 100.0


@pytest.fixture(scope="module")
def shown(viewing: Callable[..., AbstractContextManager[Viewing]], motion_file: Path) -> Iterator[Viewing]:
    """Show the three waves, beside themselves as their own twin."""
    with viewing(motion_file, "--arm", "dd-arm", "--twin", motion_file, "--trial", 3) as shown:
        yield shown


def _blue(picture: np.ndarray) -> float:
    """Return how much of a picture is the blue of the arm's links."""
    red, green, blue = np.moveaxis(picture, -1, 0)
    return float(np.mean((blue > red + 0.12) & (blue > green + 0.03) & (blue < 0.9)))


def test_the_arm_is_seen_and_play_moves_it(
    shown: Viewing, window: Callable[[str], Window], tmp_path: Path
) -> None:
    page = window(shown.facts["url"])
    still = eventually(
        lambda: picture if _blue(picture := page.picture(tmp_path / "still.png")) > 0.004 else None,
        "a blue arm in the picture",
    )
    before = page.joints()
    page.beside("Loop", "checkbox").check()
    page.press("Play")
    eventually(lambda: shown.state()["playing"] and shown.state()["loop"], "a playback that plays")
    eventually(lambda: bool(np.abs(page.joints() - before).max() > 0.2), "an arm that moves")
    assert np.abs(page.joints("/twin") - before).max() > 0.05
    page.press("Pause")
    eventually(lambda: not shown.state()["playing"], "a playback that pauses")
    shown.ask("seek", 0.8)
    eventually(lambda: bool(np.abs(page.joints() - before).max() > 0.5), "an arm that is elsewhere")
    eventually(lambda: bool(np.abs(page.picture(tmp_path / "moved.png") - still).mean() > 1e-3), "another picture")


@pytest.mark.parametrize("place", [1.234, 0.0])
def test_a_seek_lands_within_one_frame(
    shown: Viewing, source: Source, window: Callable[[str], Window], place: float
) -> None:
    page = window(shown.facts["url"])
    field = page.beside("Time (s)", "text")
    field.fill(f"{place}")
    field.press("Enter")
    eventually(lambda: bool(abs(shown.state()["position_s"] - place) <= 1.0 / RATE_HZ), "a playback at that place")
    motion = source.load(3)
    wanted = motion.at(np.array([place]))[0][0]
    off = np.abs(motion.at(np.array([place - 1 / RATE_HZ, place + 1 / RATE_HZ]))[0] - wanted).max() + 1e-3
    eventually(lambda: bool(np.abs(page.joints() - wanted).max() <= off), "an arm at that place on the page")
    assert np.abs(page.joints("/twin") - wanted).max() <= off
