"""Measured markers in the scene, and what the panel says of them."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from arm.marker_positions import marker_positions
from playback.measured_markers import MeasuredMarkers
from playback.view.marker_errors import MarkerErrors
from tests.playback.tracked_markers import ARM

Q = np.array([0.3, -0.5])
MODELLED = marker_positions(ARM, Q[None])[0]


class Scene:
    """Keeps what is put on it, by its name."""

    def __init__(self) -> None:
        self.scene = self
        self.parts: dict[str, Any] = {}

    def add_point_cloud(self, name: str, points: np.ndarray, _colors: object, **looks: Any) -> Any:
        return self.parts.setdefault(name, SimpleNamespace(points=points, visible=True, **looks))

    def add_line_segments(self, name: str, points: np.ndarray, _colors: object, **looks: Any) -> Any:
        return self.parts.setdefault(name, SimpleNamespace(points=points, visible=True, **looks))


@pytest.fixture
def scene() -> Scene:
    return Scene()


@pytest.fixture
def errors(scene: Scene) -> MarkerErrors:
    """Markers that were seen 3, 4 and, in the second sample, no millimetres away."""
    measured = np.stack([MODELLED, MODELLED])
    measured[:, 1, 2] += 0.003
    measured[:, 2, 0] += 0.004
    measured[1, 2] = np.nan
    measured[1, 0] = np.nan
    trials = {7: MeasuredMarkers(np.array([0.0, 1.0]), measured)}
    return MarkerErrors(scene, ARM, trials)  # type: ignore[arg-type] - of a server it asks for a scene alone


def test_a_line_goes_from_the_model_to_what_was_measured(scene: Scene, errors: MarkerErrors) -> None:
    errors.show(7, 0.0, Q)
    points, lines = scene.parts["/measured markers"].points, scene.parts["/marker errors"].points
    assert lines[:, 0] == pytest.approx(MODELLED, abs=1e-6)
    assert lines[:, 1] == pytest.approx(points, abs=1e-6)
    assert np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1) == pytest.approx([0.0, 0.003, 0.004], abs=1e-6)


def test_what_was_not_seen_is_not_drawn(scene: Scene, errors: MarkerErrors) -> None:
    errors.show(7, 1.0, Q)
    lines = scene.parts["/marker errors"].points
    assert len(scene.parts["/measured markers"].points) == 1
    assert np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1) == pytest.approx([0.0, 0.003, 0.0], abs=1e-6)


def test_the_panel_has_the_farthest_first(errors: MarkerErrors) -> None:
    errors.show(7, 0.0, Q)
    rms = np.sqrt((9.0 + 16.0) / 3.0)
    assert errors.rows() == [
        ("markers, 3 of 3", f"{rms:.1f} mm rms"),
        ("toe", "4.0 mm"),
        ("knee", "3.0 mm"),
        ("hip", "0.0 mm"),
    ]


@pytest.mark.parametrize("trial", [None, 8])
def test_of_another_trial_nothing_is_known(scene: Scene, errors: MarkerErrors, trial: int | None) -> None:
    errors.show(trial, 0.0, Q)
    assert errors.rows() == [("markers", "none is seen")]
    assert len(scene.parts["/measured markers"].points) == 0


def test_they_can_be_hidden(scene: Scene, errors: MarkerErrors) -> None:
    errors.seen(False)
    assert not scene.parts["/measured markers"].visible
    assert not scene.parts["/marker errors"].visible
