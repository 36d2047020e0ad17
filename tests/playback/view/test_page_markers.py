"""Measured markers on the page in a real browser."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

from tests.playback.tracked_markers import written
from tests.playback.view.conftest import Viewing, Window, eventually


def test_the_panel_says_how_far_markers_are_from_the_model(
    viewing: Callable[..., AbstractContextManager[Viewing]], window: Callable[[str], Window], tmp_path: Path
) -> None:
    files = written(tmp_path, off_m=(0.003, 0.0, 0.004))
    with viewing(files.motion, "--arm", files.arm, "--markers", files.recording) as shown:
        page = window(shown.facts["url"])
        shown.ask("seek", 0.1)
        eventually(lambda: page.page.get_by_text("markers, 3 of 3").count(), "three markers on the page")
        eventually(lambda: page.page.get_by_text("5.0 mm", exact=True).count(), "the toe, 5 mm off")
        shown.ask("seek", 0.25)
        eventually(lambda: page.page.get_by_text("markers, 2 of 3").count(), "a knee that is hidden")
        assert page.node("/measured markers") is not None
