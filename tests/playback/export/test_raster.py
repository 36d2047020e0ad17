"""Drawing against what geometry says."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from playback.export.raster import FAR, draw_mesh, draw_stroke, lay_over, resolve

RED, BLUE = np.array([200.0, 0.0, 0.0]), np.array([0.0, 0.0, 200.0])


def blank(height: int = 60, width: int = 80) -> tuple[np.ndarray, np.ndarray]:
    return np.zeros((height, width, 3), np.float32), np.full((height, width), FAR, np.float32)


def triangle(points: list[tuple[float, float]], near: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    corners = np.array([[x, y, near] for x, y in points])
    return corners, np.tile([0.0, 0.0, 1.0], (3, 1)), np.array([[0, 1, 2]])


whole = st.integers(2, 58)


@settings(deadline=None)
@given(st.lists(st.tuples(whole, whole), min_size=3, max_size=3))
def test_a_triangle_fills_its_area_if_it_faces_the_viewer(points: list[tuple[int, int]]) -> None:
    (ax, ay), (bx, by), (cx, cy) = points
    area = 0.5 * ((bx - ax) * (cy - ay) - (cx - ax) * (by - ay))
    image, depth = blank(60, 60)
    draw_mesh(*triangle(points, 1.0), RED, image, depth)
    if area >= 0.0:
        assert not image.any()
    else:  # Pick: pixels inside and on the edges
        edges = math.gcd(ax - bx, ay - by) + math.gcd(bx - cx, by - cy) + math.gcd(cx - ax, cy - ay)
        assert np.count_nonzero(depth > FAR) == pytest.approx(-area + edges / 2 + 1, abs=edges)


def test_the_nearer_hides_the_farther_whatever_comes_first() -> None:
    square = [(10.0, 40.0), (40.0, 40.0), (25.0, 10.0)]
    for order in ((1, 2), (2, 1)):
        image, depth = blank()
        for near in order:
            draw_mesh(*triangle(square, float(near)), RED if near == 1 else BLUE, image, depth)
        assert image[30, 25, 2] > 0.0 and depth[30, 25] == 2.0
        assert np.all(image[..., 0][depth == 2.0] <= image[..., 2][depth == 2.0])


def test_what_is_seen_through_lies_only_over_what_is_farther() -> None:
    image, depth = blank(4, 4)
    upper, upper_depth = np.full_like(image, 100.0), np.full_like(depth, 10.0)
    depth[:, 2:] = 9.5
    lay_over(upper, upper_depth, 0.5, image, depth)
    assert np.all(image[:, :2] == 50.0) and np.all(image[:, 2:] == 0.0)


def test_a_stroke_has_its_width() -> None:
    image, _ = blank()
    draw_stroke(np.array([10.0, 30.0]), np.array([70.0, 30.0]), 2.0, np.full(3, 1.0), 1.0, image)
    assert image[:, 40, 0].sum() == pytest.approx(4.0, abs=1.0)
    assert image[30, 5:75, 0].sum() == pytest.approx(64.0, abs=1.5)


def test_a_picture_is_the_mean_of_finer_pixels() -> None:
    fine = np.random.default_rng(0).uniform(0.0, 255.0, (20, 30, 3)).astype(np.float32)
    picture = np.empty((10, 15, 3), np.uint8)
    resolve(fine, picture)
    assert np.abs(picture - fine.reshape(10, 2, 15, 2, 3).mean(axis=(1, 3))).max() <= 0.51
