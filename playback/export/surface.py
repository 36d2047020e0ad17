"""Normals for drawing: smooth over what is round, sharp at edges."""

import numpy as np

from playback.shape import Mesh
from playback.trajectory import Floats

#: Edges sharper than this are drawn sharp [degrees]: by look.
CREASE_DEG = 40.0


def with_normals(mesh: Mesh) -> tuple[Mesh, Floats]:
    """Return a mesh whose vertices are doubled where an edge is sharp, and a normal for each of them.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    Mesh
        The same triangles, in the same order.
    normals : ndarray of shape (k, 3)
        Means of those of the faces around the vertex that lie within 40 degrees of its own, by their area.
    """
    corners = mesh.vertices[mesh.faces]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    units = areas / np.maximum(np.linalg.norm(areas, axis=1, keepdims=True), 1e-300)
    vertex = mesh.faces.ravel()
    face = np.repeat(np.arange(len(mesh.faces)), 3)
    order = np.argsort(vertex, kind="stable")
    normals = np.empty((len(vertex), 3))
    for around in np.split(order, np.flatnonzero(np.diff(vertex[order])) + 1):
        faces = face[around]
        near = units[faces] @ units[faces].T > np.cos(np.radians(CREASE_DEG))
        normals[around] = near @ areas[faces]
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    key = np.column_stack([vertex, np.round(normals, 6)])
    _, first, index = np.unique(key, axis=0, return_index=True, return_inverse=True)
    return Mesh(mesh.vertices[vertex[first]], index.reshape(-1, 3).astype(np.int64)), normals[first]
