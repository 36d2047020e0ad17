"""Arrays in the one buffer, read again as glTF 2.0 lays them out."""

import numpy as np
import pygltflib
import pytest

from playback.export.gltf_buffer import GltfBuffer
from playback.shape import Mesh

#: A tetrahedron: its edges are sharp, so each face has corners of its own.
CORNERS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def test_accessors_lie_one_behind_the_other() -> None:
    gltf = pygltflib.GLTF2()
    buffer = GltfBuffer(gltf)
    arrays = [np.arange(5.0)[:, None], np.arange(6.0).reshape(2, 3) - 2.5, np.eye(4)]
    assert [buffer.floats(one, bounds=one.shape[1] == 3) for one in arrays] == [0, 1, 2]
    buffer.close()
    blob, begin = gltf.binary_blob(), 0
    kinds = (pygltflib.SCALAR, pygltflib.VEC3, pygltflib.VEC4)
    for one, accessor, kind in zip(arrays, gltf.accessors, kinds, strict=True):
        view = gltf.bufferViews[accessor.bufferView]
        assert (view.buffer, view.byteOffset, view.byteLength, view.target) == (0, begin, 4 * one.size, None)
        assert (accessor.count, accessor.type, accessor.componentType) == (len(one), kind, pygltflib.FLOAT)
        np.testing.assert_array_equal(np.frombuffer(blob, "<f4", one.size, begin).reshape(one.shape), one)
        begin += 4 * one.size
    assert gltf.buffers[0].byteLength == len(blob) == begin
    assert (gltf.accessors[1].min, gltf.accessors[1].max) == ([-2.5, -1.5, -0.5], [0.5, 1.5, 2.5])
    assert not gltf.accessors[0].min and not gltf.accessors[2].max  # where nobody asked


def test_a_mesh_is_corners_normals_and_triangles() -> None:
    gltf = pygltflib.GLTF2()
    buffer = GltfBuffer(gltf)
    found = buffer.primitive(Mesh(CORNERS, FACES))
    buffer.close()
    blob = gltf.binary_blob()

    def values(index: int, dtype: str, target: int) -> np.ndarray:
        view = gltf.bufferViews[gltf.accessors[index].bufferView]
        assert view.target == target
        return np.frombuffer(blob[view.byteOffset : view.byteOffset + view.byteLength], dtype)

    corners, normals = (
        values(index, "<f4", pygltflib.ARRAY_BUFFER).reshape(-1, 3)
        for index in (found.attributes.POSITION, found.attributes.NORMAL)
    )
    triangles = values(found.indices, "<u4", pygltflib.ELEMENT_ARRAY_BUFFER).reshape(-1, 3)
    assert gltf.accessors[found.indices].componentType == pygltflib.UNSIGNED_INT
    assert (len(corners), len(triangles)) == (12, 4)
    np.testing.assert_array_equal(corners[triangles], CORNERS[FACES])
    for triangle, face in zip(triangles, FACES, strict=True):
        across = np.cross(*(CORNERS[face[1:]] - CORNERS[face[0]]))
        assert normals[triangle] == pytest.approx(np.tile(across / np.linalg.norm(across), (3, 1)), abs=1e-6)
    position = gltf.accessors[found.attributes.POSITION]
    assert (position.min, position.max) == ([0.0, 0.0, 0.0], [1.0, 2.0, 3.0])
