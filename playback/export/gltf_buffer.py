"""The one buffer of a glTF document, and the accessors into it."""

import numpy as np
import pygltflib
from numpy.typing import NDArray

from playback.export.surface import with_normals
from playback.shape import Mesh
from playback.trajectory import Floats

_TYPES = {1: pygltflib.SCALAR, 3: pygltflib.VEC3, 4: pygltflib.VEC4}


class GltfBuffer:
    """Takes arrays and gives the numbers of their accessors.

    Parameters
    ----------
    gltf : pygltflib.GLTF2
        The document that the accessors are added to.
    """

    def __init__(self, gltf: pygltflib.GLTF2) -> None:
        self._gltf = gltf
        self._blob = bytearray()

    def floats(self, values: Floats, *, bounds: bool = False, target: int | None = None) -> int:
        """Add (n, 1), (n, 3) or (n, 4) as single precision; with the least and greatest where that is asked."""
        return self._accessor(values.astype("<f4"), pygltflib.FLOAT, bounds, target)

    def primitive(self, mesh: Mesh) -> pygltflib.Primitive:
        """Add a mesh with its normals."""
        split, normals = with_normals(mesh)
        array, indices = pygltflib.ARRAY_BUFFER, pygltflib.ELEMENT_ARRAY_BUFFER
        attributes = pygltflib.Attributes(
            POSITION=self.floats(split.vertices, bounds=True, target=array),
            NORMAL=self.floats(normals, target=array),
        )
        faces = split.faces.astype("<u4").reshape(-1, 1)
        return pygltflib.Primitive(
            attributes=attributes, indices=self._accessor(faces, pygltflib.UNSIGNED_INT, False, indices)
        )

    def close(self) -> None:
        """Hand the bytes to the document."""
        self._gltf.buffers = [pygltflib.Buffer(byteLength=len(self._blob))]
        self._gltf.set_binary_blob(bytes(self._blob))

    def _accessor(
        self, values: NDArray[np.float32] | NDArray[np.uint32], component: int, bounds: bool, target: int | None
    ) -> int:
        view = pygltflib.BufferView(buffer=0, byteOffset=len(self._blob), byteLength=values.nbytes, target=target)
        self._blob += values.tobytes()  # of four bytes each, so the next begins on four too
        self._gltf.bufferViews.append(view)
        accessor = pygltflib.Accessor(
            bufferView=len(self._gltf.bufferViews) - 1,
            componentType=component,
            count=len(values),
            type=_TYPES[values.shape[1]],
        )
        if bounds:
            accessor.min, accessor.max = values.min(axis=0).tolist(), values.max(axis=0).tolist()
        self._gltf.accessors.append(accessor)
        return len(self._gltf.accessors) - 1
