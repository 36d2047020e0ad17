"""The mass matrix by composite bodies: link i and all links that hang on it, as if their joints were locked.

Row i of M is what a unit acceleration of joint i, and of no other, takes at the joints up to i: the force and
moment that move the composite body i, passed on towards the base (Walker and Orin 1982; Featherstone, Rigid Body
Dynamics Algorithms, section 6.2).
"""

from arm.chain import Chain
from arm.model import Floats
from arm.triple import Triple, cross, turned
from limbcal.compiled import compiled, inlined

#: xx yy zz xy xz yz of the inertia tensor about a frame's origin.
Tensor = tuple[float, float, float, float, float, float]


@compiled
def turned_tensor(R: Floats, J: Tensor) -> Tensor:
    """Return ``R J R^T``."""
    xx, yy, zz, xy, xz, yz = J
    x, y, z = turned(R, (xx, xy, xz)), turned(R, (xy, yy, yz)), turned(R, (xz, yz, zz))  # columns of R J
    a, b, c = (
        turned(R, (x[0], y[0], z[0])),
        turned(R, (x[1], y[1], z[1])),
        turned(R, (x[2], y[2], z[2])),
    )
    return a[0], b[1], c[2], a[1], a[2], b[2]


@compiled
def tensor_about(J: Tensor, s: Triple, mass: float, p: Triple) -> Tensor:
    """Return the tensor about an origin from which its own one is at ``p``; ``s`` is m times the centre of mass.

    Steiner's theorem, where neither origin need be the centre of mass.
    """
    x, y, z = p
    twice = 2.0 * (x * s[0] + y * s[1] + z * s[2]) + mass * (x * x + y * y + z * z)
    return (
        J[0] + twice - 2.0 * x * s[0] - mass * x * x,
        J[1] + twice - 2.0 * y * s[1] - mass * y * y,
        J[2] + twice - 2.0 * z * s[2] - mass * z * z,
        J[3] - x * s[1] - y * s[0] - mass * x * y,
        J[4] - x * s[2] - z * s[0] - mass * x * z,
        J[5] - y * s[2] - z * s[1] - mass * y * z,
    )


@inlined
def mass_rows(chain: Chain, R: Floats, p: Floats, branch: Floats, M: Floats) -> None:
    """Fill in the mass matrix, (n, n); R and p are as `arm.newton_euler.poses` fills them in.

    In ``branch`` (n, 10) branches wait until their parent's turn comes; it is zero before and after.
    """
    n, branched = M.shape[0], False
    J, s, mass = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0  # what is beyond link n
    for i in range(n - 1, -1, -1):
        xx, yy, zz, xy, xz, yz, sx, sy, sz, own = chain.inertial[i]
        J = (J[0] + xx, J[1] + yy, J[2] + zz, J[3] + xy, J[4] + xz, J[5] + yz)
        s, mass = (s[0] + sx, s[1] + sy, s[2] + sz), mass + own
        if branched:
            J = (
                J[0] + branch[i, 0],
                J[1] + branch[i, 1],
                J[2] + branch[i, 2],
                J[3] + branch[i, 3],
                J[4] + branch[i, 4],
                J[5] + branch[i, 5],
            )
            s, mass = (s[0] + branch[i, 6], s[1] + branch[i, 7], s[2] + branch[i, 8]), mass + branch[i, 9]
            for k in range(10):
                branch[i, k] = 0.0
        if chain.revolute[i]:  # about z: dv = z x s / m, N = J z
            f, m = (-s[1], s[0], 0.0), (J[4], J[5], J[2])
        else:  # along z: dv = z, N = s x z
            f, m = (0.0, 0.0, mass), (s[1], -s[0], 0.0)
        j = i
        while j >= 0:
            M[i, j] = M[j, i] = m[2] if chain.revolute[j] else f[2]
            f, m = turned(R[j], f), turned(R[j], m)
            lever = cross((p[j, 0], p[j, 1], p[j, 2]), f)
            m = (m[0] + lever[0], m[1] + lever[1], m[2] + lever[2])
            before = chain.parent[j]
            if before != j - 1:
                for aside in range(before + 1, j):  # links that this force does not pass
                    M[i, aside] = M[aside, i] = 0.0
            j = before
        at = (p[i, 0], p[i, 1], p[i, 2])
        turned_s = turned(R[i], s)
        J = tensor_about(turned_tensor(R[i], J), turned_s, mass, at)
        s = (turned_s[0] + mass * at[0], turned_s[1] + mass * at[1], turned_s[2] + mass * at[2])
        before = chain.parent[i]
        if before != i - 1:
            if before >= 0:
                branched = True
                for k in range(6):
                    branch[before, k] += J[k]
                for k in range(3):
                    branch[before, 6 + k] += s[k]
                branch[before, 9] += mass
            J, s, mass = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0
