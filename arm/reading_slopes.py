"""What accelerometers read, and how that changes with everything it depends on: compiled, one instant at a time.

The slopes are tangents of the recursion in `arm.newton_euler`: each starts at its joint and is carried outwards by
the same steps, linearised. A turn of joint j by a small angle, seen from the links beyond it, is a turn of all
motion that comes from before it by minus that angle, which is why nothing but the joint's own frame is needed.
"""

import numpy as np

from arm.chain import Chain
from arm.model import Floats
from arm.triple import Triple, cross, turned_back
from limbcal.compiled import compiled

#: Slopes a joint: by q, dq, ddq, and by the lengths a and d of its link.
SEEDS = 5


@compiled
def row(a: Floats) -> Triple:
    """Return three numbers as a triple."""
    return a[0], a[1], a[2]


@compiled
def total(a: Triple, b: Triple) -> Triple:
    """Return ``a + b``."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@compiled
def at_lever(w: Triple, dw: Triple, s: Triple) -> Triple:
    """Return ``dw x s + w x (w x s)``: what a point at s has beyond its link's origin."""
    return total(cross(dw, s), cross(w, cross(w, s)))


@compiled
def lever_slope(w: Triple, tw: Triple, tdw: Triple, s: Triple) -> Triple:
    """Return the slope of `at_lever` along (tw, tdw)."""
    return total(cross(tdw, s), total(cross(tw, cross(w, s)), cross(w, cross(tw, s))))


@compiled
def motion_slopes(chain: Chain, R: Floats, p: Floats, motion: Floats, dq: Floats, slopes: Floats) -> None:
    """Fill in how omega, omega_dot and v_dot of every link change: slopes (n, 5 n, 3, 3), zero where they don't.

    Slope ``5 j + k`` is that by q, dq, ddq of joint j and by ``a``, ``d`` of its link (k from 0 to 4), in the axes
    of the link that moves. ``R, p, motion`` are as `poses` and `rigid_motion` leave them. Joints that are not on a
    link's way to the base don't move it.
    """
    z = (0.0, 0.0, 1.0)
    for i in range(dq.size):
        v = dq[i]
        w, dw, dv = row(motion[i, 0]), row(motion[i, 1]), row(motion[i, 2])
        parent = chain.parent[i]
        if parent >= 0:
            before_w, before_dw, lever = row(motion[parent, 0]), row(motion[parent, 1]), row(p[i])
            for k in range(SEEDS * (parent + 1)):
                came = slopes[parent, k]
                tw, tdw, tdv = row(came[0]), row(came[1]), row(came[2])
                tdv = turned_back(R[i], total(tdv, lever_slope(before_w, tw, tdw, lever)))
                if k == SEEDS * parent + 3:  # the far end of the link before, if the joint hangs there
                    tdv = turned_back(R[i], at_lever(before_w, before_dw, (chain.hang[i, 0], 0.0, 0.0)))
                tw, tdw = turned_back(R[i], tw), turned_back(R[i], tdw)
                if chain.revolute[i]:
                    tdw = (tdw[0] + tw[1] * v, tdw[1] - tw[0] * v, tdw[2])
                else:
                    tdv = (tdv[0] + 2.0 * tw[1] * v, tdv[1] - 2.0 * tw[0] * v, tdv[2])
                put(slopes[i, k], tw, tdw, tdv)
        own = slopes[i, SEEDS * i : SEEDS * (i + 1)]
        coriolis = cross(w, z)
        along = at_lever(w, dw, z)  # a shift along the axis; for a joint that turns, of what came before it
        if chain.revolute[i]:
            came_dw = (dw[0] - coriolis[0] * v, dw[1] - coriolis[1] * v, 0.0)
            came_w = (w[0], w[1], 0.0)
            tw, tdw = cross(came_w, z), cross(came_dw, z)
            put(own[0], tw, (tdw[0] + tw[1] * v, tdw[1] - tw[0] * v, 0.0), cross(dv, z))
            put(own[1], z, coriolis, (0.0, 0.0, 0.0))
            put(own[2], (0.0, 0.0, 0.0), z, (0.0, 0.0, 0.0))
            before = motion[parent] if parent >= 0 else np.zeros((3, 3))
            put(own[4], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), shift_before(R[i], before))
        else:
            put(own[0], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), along)
            put(own[1], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (2.0 * coriolis[0], 2.0 * coriolis[1], 0.0))
            put(own[2], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), z)
            put(own[4], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), along)
        put(own[3], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))  # a link's own far end moves no link of it


@compiled
def shift_before(R: Floats, before: Floats) -> Triple:
    """Return by how much v_dot changes with d: the shift lies along this axis and rides on the link before."""
    w, dw = turned_back(R, row(before[0])), turned_back(R, row(before[1]))
    return at_lever(w, dw, (0.0, 0.0, 1.0))


@compiled
def put(slope: Floats, tw: Triple, tdw: Triple, tdv: Triple) -> None:
    """Write three triples."""
    for c in range(3):
        slope[0, c], slope[1, c], slope[2, c] = tw[c], tdw[c], tdv[c]
