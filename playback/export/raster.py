"""Drawing into arrays: shaded triangles with a depth, discs and strokes, and the way down to a picture."""

import math

import numpy as np
from numpy.typing import NDArray

from limbcal.compiled import compiled
from playback.shape import Faces
from playback.trajectory import Floats

Image = NDArray[np.float32]
Picture = NDArray[np.uint8]
FINER = 2  # pixels drawn across one of the picture, against jagged edges
FAR = -1e30
SAME = 1.0  # [px]: two arms that lie in each other must not flicker

# towards the light, in the camera's frame: right, up, towards the viewer
_LIGHT = (-0.39, 0.59, 0.71)
#: Light from all around, from the lamp, and mirrored, as fractions of white: by look.
_AMBIENT, _DIFFUSE, _GLOSS = 0.46, 0.52, 0.16


@compiled
def draw_mesh(corners: Floats, normals: Floats, faces: Faces, colour: Floats, image: Image, depth: Image) -> None:
    """Draw triangles where they are nearer than what is there.

    Parameters
    ----------
    corners : (k, 3)
        Right and down [px], and towards the viewer.
    normals : (k, 3)
        Of length 1: right, up, towards the viewer.
    faces : (m, 3)
        Counter-clockwise as seen from outside; those turned away are left out.
    colour : (3,)
        0 to 255.
    image, depth : (height, width, 3) and (height, width)
        Drawn into.
    """
    height, width = depth.shape
    for f in range(len(faces)):
        a, b, c = faces[f]
        ax, ay = corners[a, 0], corners[a, 1]
        bx, by = corners[b, 0], corners[b, 1]
        cx, cy = corners[c, 0], corners[c, 1]
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        if area >= 0.0:  # y goes down, so what faces the viewer turns the other way round
            continue
        left, right = max(0, math.ceil(min(ax, bx, cx))), min(width - 1, math.floor(max(ax, bx, cx)))
        top, bottom = max(0, math.ceil(min(ay, by, cy))), min(height - 1, math.floor(max(ay, by, cy)))
        u_step, v_step = (by - cy) / area, (cy - ay) / area  # of the shares of a and b, a pixel to the right
        for y in range(top, bottom + 1):
            u = ((bx - left) * (cy - y) - (cx - left) * (by - y)) / area - u_step
            v = ((cx - left) * (ay - y) - (ax - left) * (cy - y)) / area - v_step
            for x in range(left, right + 1):
                u += u_step
                v += v_step
                w = 1.0 - u - v
                if u < 0.0 or v < 0.0 or w < 0.0:
                    continue
                near = u * corners[a, 2] + v * corners[b, 2] + w * corners[c, 2]
                if near <= depth[y, x]:
                    continue
                nx = u * normals[a, 0] + v * normals[b, 0] + w * normals[c, 0]
                ny = u * normals[a, 1] + v * normals[b, 1] + w * normals[c, 1]
                nz = u * normals[a, 2] + v * normals[b, 2] + w * normals[c, 2]
                length = math.sqrt(nx * nx + ny * ny + nz * nz) + 1e-30
                lit = max(0.0, (nx * _LIGHT[0] + ny * _LIGHT[1] + nz * _LIGHT[2]) / length)
                gloss = 255.0 * _GLOSS * lit**24
                depth[y, x] = near
                for k in range(3):
                    image[y, x, k] = min(255.0, colour[k] * (_AMBIENT + _DIFFUSE * lit) + gloss)


@compiled
def draw_stroke(start: Floats, end: Floats, radius: float, colour: Floats, opacity: float, image: Image) -> None:
    """Draw a line with round ends between two points [px], with soft edges."""
    height, width = image.shape[0], image.shape[1]
    dx, dy = end[0] - start[0], end[1] - start[1]
    square = dx * dx + dy * dy
    reach = radius + 1.0
    left, right = min(start[0], end[0]) - reach, max(start[0], end[0]) + reach
    top, bottom = min(start[1], end[1]) - reach, max(start[1], end[1]) + reach
    for y in range(max(0, math.ceil(top)), min(height - 1, math.floor(bottom)) + 1):
        for x in range(max(0, math.ceil(left)), min(width - 1, math.floor(right)) + 1):
            along = 0.0
            if square > 0.0:
                along = min(1.0, max(0.0, ((x - start[0]) * dx + (y - start[1]) * dy) / square))
            off = math.hypot(x - start[0] - along * dx, y - start[1] - along * dy)
            cover = opacity * min(1.0, max(0.0, radius + 0.5 - off))
            for k in range(3):
                image[y, x, k] += cover * (colour[k] - image[y, x, k])


@compiled
def lay_over(upper: Image, upper_depth: Image, opacity: float, image: Image, depth: Image) -> None:
    """Blend what was drawn in another image over this one, where it is nearer by more than rounding."""
    for y in range(depth.shape[0]):
        for x in range(depth.shape[1]):
            if upper_depth[y, x] > depth[y, x] + SAME:
                for k in range(3):
                    image[y, x, k] += opacity * (upper[y, x, k] - image[y, x, k])


@compiled
def resolve(image: Image, picture: Picture) -> None:
    """Fill in a picture (h, w, 3) with the means of the finer pixels (2 h, 2 w, 3)."""
    for y in range(picture.shape[0]):
        for x in range(picture.shape[1]):
            for k in range(3):
                total = 0.0
                for i in range(FINER):
                    for j in range(FINER):
                        total += image[FINER * y + i, FINER * x + j, k]
                picture[y, x, k] = np.uint8(min(255.0, max(0.0, total / (FINER * FINER) + 0.5)))
