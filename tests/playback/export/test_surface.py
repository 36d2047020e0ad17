"""Normals: round things are smooth, edges are sharp."""

import numpy as np
import pytest

from playback.export.surface import with_normals
from playback.shape import Mesh

CORNERS = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 2.0) for z in (0.0, 3.0)])
#: Two triangles a side, each counter-clockwise as seen from outside.
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
BOX = Mesh(CORNERS, np.array([face for a, b, c, d in SIDES for face in ((a, b, c), (a, c, d))]))


def prism(sides: int) -> Mesh:
    """Return the side of a prism: the more sides, the rounder."""
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    vertices = np.vstack([np.column_stack([ring, np.full(sides, z)]) for z in (0.0, 1.0)])
    k, after = np.arange(sides), (np.arange(sides) + 1) % sides
    faces = np.vstack([np.column_stack([k, after, after + sides]), np.column_stack([k, after + sides, k + sides])])
    return Mesh(vertices, faces.astype(np.int64))


def test_a_box_has_a_normal_a_side_at_every_corner() -> None:
    split, normals = with_normals(BOX)
    assert len(split.vertices) == 24
    for face, given in zip(split.faces, BOX.faces, strict=True):
        np.testing.assert_array_equal(split.vertices[face], CORNERS[given])
        a, b, c = CORNERS[given]
        outward = np.cross(b - a, c - a) / np.linalg.norm(np.cross(b - a, c - a))
        np.testing.assert_allclose(normals[face], np.tile(outward, (3, 1)), atol=1e-12)
        assert outward @ (CORNERS[given].mean(axis=0) - CORNERS.mean(axis=0)) > 0.0


@pytest.mark.parametrize(("sides", "smooth"), [(8, False), (10, True), (40, True)])
def test_an_edge_below_40_degrees_is_round(sides: int, smooth: bool) -> None:
    mesh = prism(sides)
    split, normals = with_normals(mesh)
    assert (len(split.vertices) == len(mesh.vertices)) == smooth
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)
    if sides == 40:
        np.testing.assert_allclose(normals[:, :2], split.vertices[:, :2], atol=0.05)
        np.testing.assert_allclose(normals[:, 2], 0.0, atol=1e-12)


def test_larger_faces_weigh_more() -> None:
    """Two faces 20 degrees apart, one of three times the area."""
    s, c = np.sin(np.radians(20.0)), np.cos(np.radians(20.0))
    vertices = np.array([[0, 0, 0], [0, 1, 0], [3, 0, 0], [-c, 0, -s]], dtype=float)
    _, normals = with_normals(Mesh(vertices, np.array([[0, 2, 1], [0, 1, 3]])))
    mean = 3.0 * np.array([0.0, 0.0, 1.0]) + np.array([-s, 0.0, c])
    shared = normals[np.abs(normals @ mean / np.linalg.norm(mean)) > 1.0 - 1e-9]
    assert len(shared) == 2


def test_a_face_without_area_has_no_direction() -> None:
    _, normals = with_normals(Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]])))
    assert np.isfinite(normals).all()
