"""The benchmark of a minute of markers has 40 of them, and a limb that follows them."""

import pytest

from benchmarks.marker_minute import CLUSTERS, timed


@pytest.mark.parametrize("preset", CLUSTERS)
def test_a_limb_with_forty_markers_is_timed(preset: str) -> None:
    found = timed(preset, seconds=2.0)
    assert found["markers"] == 40
    assert min(found["fit_s"], found["track_s"]) > 0.0
    # three axes of 3 mm each, and less what angles and places take up
    assert found["rms_mm"] == pytest.approx(3.0 * 3**0.5, rel=0.15)
