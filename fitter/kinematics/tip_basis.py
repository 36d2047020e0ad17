"""The tip as a linear function of products of sines and cosines of the joint angles.

Each factor of eq. (2) is linear in ``1, cos q, sin q`` of its joint (``1, q`` where it slides), so the tip is
linear in the products of one of these for every joint: ``r = C(alpha, a, d, beta, theta_offset) phi(q)``.
Joint 1 is the slowest index of the products and the first product is the constant.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from limbcal.errors import ConfigError

Complexes = NDArray[np.complex128]

#: The geometry of one joint, in the order of `arm.chain.Chain.geometry`, and its units.
GEOMETRY = ("alpha", "a", "d", "beta", "theta_offset")
UNITS = ("rad", "m", "m", "rad", "rad")


def geometry_names(n_joint: int) -> tuple[str, ...]:
    """Return ``alpha1, a1, d1, beta1, theta_offset1, alpha2, …``."""
    return tuple(f"{name}{i + 1}" for i in range(n_joint) for name in GEOMETRY)


def geometry_of(arm: Arm) -> Floats:
    """Return the arm's geometry, (n_joint, 5)."""
    return np.array([[j.alpha_rad, j.a_m, j.d_m, j.beta_rad, j.theta_offset_rad] for j in arm.joints])


def with_geometry(arm: Arm, geometry: Floats) -> Arm:
    """Return the arm with another geometry, (n_joint, 5)."""
    fields = ("alpha_rad", "a_m", "d_m", "beta_rad", "theta_offset_rad")
    return arm.with_joints(**dict(zip(fields, geometry.T, strict=True)))


def expect_chain(arm: Arm) -> None:
    """Look whether the tip is a product of all joints' factors.

    Raises
    ------
    ConfigError
        If the arm is a tree, or a joint hangs elsewhere than at the far end of the link before it.
    """
    if not arm.is_serial:
        raise ConfigError(
            f"arm {arm.name!r} is a tree, or a joint hangs elsewhere than at the far end of the link before it; "
            "a geometry is learnt from a tip of a serial chain only"
        )


def turning(arm: Arm) -> tuple[bool, ...]:
    """Return which joints turn."""
    return tuple(joint.type == "revolute" for joint in arm.joints)


def basis(revolute: Sequence[bool], q: Floats) -> Floats:
    """Return phi(q).

    Parameters
    ----------
    revolute : (n_joint,) bool
    q : (n_sample, n_joint) [rad or m]

    Returns
    -------
    (n_sample, n_basis)
        n_basis is the product over the joints of 3 where it turns and 2 where it slides.
    """
    products: Floats = np.ones((len(q), 1))
    for turns, angle in zip(revolute, q.T, strict=True):
        one = np.ones_like(angle)
        own = np.stack([one, np.cos(angle), np.sin(angle)] if turns else [one, angle], axis=1)
        products = (products[:, :, None] * own[:, None, :]).reshape(len(q), -1)
    return products


def coefficients(revolute: Sequence[bool], geometry: Floats) -> Floats:
    """Return C with ``tip = C phi(q)``, for many geometries at once.

    Parameters
    ----------
    revolute : (n_joint,) bool
    geometry : (n_individual, n_joint, 5)
        alpha, a, d, beta, theta offset.

    Returns
    -------
    (n_individual, 3, n_basis)
    """
    n = len(geometry)
    tip = np.zeros((n, 1, 4))
    tip[:, 0, 3] = 1.0  # the origin of frame n
    for joint in range(len(revolute) - 1, -1, -1):  # eq. (2), from the tip inwards
        parts = _joint_parts(revolute[joint], geometry[:, joint])
        tip = np.matmul(tip[:, None], np.swapaxes(parts, -1, -2)).reshape(n, -1, 4)
    return np.ascontiguousarray(np.swapaxes(tip[:, :, :3], 1, 2))


def jacobian(revolute: Sequence[bool], geometry: Floats, which: NDArray[np.intp]) -> Floats:
    """Return how C changes with some of the geometry's numbers.

    Parameters
    ----------
    revolute : (n_joint,) bool
    geometry : (n_joint, 5)
    which : (n_parameter,) int
        Places in the flattened geometry.

    Returns
    -------
    (n_parameter, 3, n_basis)
    """
    step = 1e-5  # C is smooth, its numbers near one: the error of central differences is about 1e-10
    moved = np.tile(geometry.ravel(), (2, len(which), 1))
    moved[0, np.arange(len(which)), which] += step
    moved[1, np.arange(len(which)), which] -= step
    C = coefficients(revolute, moved.reshape(-1, *geometry.shape)).reshape(2, len(which), 3, -1)
    return np.asarray((C[0] - C[1]) / (2.0 * step), dtype=np.float64)


def _joint_parts(revolute: bool, geometry: Floats) -> Floats:
    """Return the matrices T_k of eq. (1) as ``T = sum_k T_k b_k(q)``, (n_individual, 3 or 2, 4, 4)."""
    alpha, a, d, beta, offset = geometry.T
    ca, sa, cb, sb = np.cos(alpha), np.sin(alpha), np.cos(beta), np.sin(beta)
    c, s = np.cos(offset), np.sin(offset)
    zero = np.zeros_like(a)
    # Columns of Rot(y, beta) Rot(x, alpha), and what Rot(z, theta) makes of the first two.
    x, y, z = (
        np.stack([cb, zero, -sb], 1),
        np.stack([sa * sb, ca, sa * cb], 1),
        np.stack([ca * sb, -sa, ca * cb], 1),
    )
    along, across = c[:, None] * x + s[:, None] * y, c[:, None] * y - s[:, None] * x
    parts = np.zeros((len(a), 3 if revolute else 2, 4, 4))
    parts[:, 0, :3, 2], parts[:, 0, :3, 3], parts[:, 0, 3, 3] = z, d[:, None] * z, 1.0
    if revolute:
        # theta = q + offset: cos q turns x to `along` and y to `across`, sin q to `across` and -`along`.
        parts[:, 1, :3, 0], parts[:, 1, :3, 1], parts[:, 1, :3, 3] = along, across, a[:, None] * along
        parts[:, 2, :3, 0], parts[:, 2, :3, 1], parts[:, 2, :3, 3] = across, -along, a[:, None] * across
    else:
        parts[:, 0, :3, 0], parts[:, 0, :3, 1] = along, across
        parts[:, 0, :3, 3] += a[:, None] * along
        parts[:, 1, :3, 3] = z  # d = d_m + q
    return parts
