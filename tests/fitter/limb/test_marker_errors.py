"""What markers are off by, and which share of their motion that leaves, against numbers in closed form."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fitter.limb.marker_errors import beyond_skin, hardly, marker_errors
from fitter.limb.marker_observations import Frames

N = 400
TURNS = Rotation.from_rotvec(np.linspace(0.0, 2.0, N)[:, None] * [0.3, -0.5, 0.8])
PLACES = np.linspace(0.0, 4.0, N)[:, None] * [1.0, 0.2, -0.1]


def frames(carried: np.ndarray) -> Frames:
    """Return frames of a base that walks and turns, of markers by their place in it."""
    y = np.einsum("kij,kmj->kmi", TURNS.as_matrix(), carried) + PLACES[:, None]
    return Frames(y, TURNS.as_matrix(), PLACES, np.zeros(N, dtype=np.int64), np.arange(N) / 100.0)


def swinging(radius_m: float) -> np.ndarray:
    """Return two markers that go round whole circles in the base."""
    at = 2.0 * np.pi * np.arange(N) / N
    around = radius_m * np.stack([np.cos(at), np.sin(at), 0.0 * at], axis=1)
    return np.stack([around + [0.0, 0.0, 0.3], -around], axis=1)


def test_what_a_base_carries_along_is_no_motion() -> None:
    one = frames(swinging(0.2))
    found = marker_errors(one, one.y)
    assert np.abs(found.distance_m).max() == 0.0 and found.explained == 1.0
    assert found.moved_m == pytest.approx(np.full((N, 2), 0.2))


def test_the_share_is_that_of_squares() -> None:
    one = frames(swinging(0.2))
    found = marker_errors(one, one.y + [0.03, 0.0, 0.04])
    assert found.distance_m == pytest.approx(np.full((N, 2), 0.05))
    assert found.explained == pytest.approx(1.0 - 0.05**2 / 0.2**2)


def test_what_was_not_seen_has_no_say() -> None:
    one = frames(swinging(0.2))
    one.y[::3, 1] = np.nan
    off = marker_errors(one, one.y + [0.0, 0.05, 0.0])
    assert np.isnan(off.distance_m[::3, 1]).all() and np.isfinite(off.distance_m[:, 0]).all()
    assert off.explained == pytest.approx(1.0 - 0.05**2 / 0.2**2, abs=1e-3)


def test_where_nothing_moves_there_is_nothing_to_explain() -> None:
    one = frames(np.zeros((N, 2, 3)))._replace(R=np.tile(np.eye(3), (N, 1, 1)), p=np.zeros((N, 3)))
    still = one._replace(y=np.zeros((N, 2, 3)))
    assert (
        marker_errors(still, still.y).explained is None and marker_errors(still, still.y + 1.0).explained is None
    )


@pytest.mark.parametrize(("off_m", "explained"), [(0.005, None), (0.013, None), (0.03, -35.0)])
def test_a_stance_has_no_motion_to_explain(off_m: float, explained: float | None) -> None:
    sway = frames(swinging(0.005))
    found = marker_errors(sway, sway.y + [0.0, 0.0, off_m]).explained
    assert found == (explained if explained is None else pytest.approx(explained))


@pytest.mark.parametrize(("explained", "said"), [(-0.5, "nothing;"), (0.125, "12.5 %")])
def test_what_is_hardly_explained_is_said(explained: float, said: str) -> None:
    assert said in hardly(explained)


def test_markers_farther_off_than_skin_slides_are_named() -> None:
    distance = np.full((50, 3), 0.008)
    distance[:, 1] = 0.11
    distance[::2, 2], distance[1::2, 2] = 0.06, np.nan
    (note,) = beyond_skin(("thigh1", "thigh2", "knee"), distance)
    assert note.kind == "beyond_skin" and note.columns == ("thigh2", "knee") and "60 to 110 mm" in note.text
    assert beyond_skin(("thigh1",), distance[:, :1]) == []
