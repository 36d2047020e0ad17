"""One physically possible arm among the many that share their base parameters.

A link is possible when its pseudo-inertia is positive definite (Traversaro 2016): its mass is positive and
its inertia is that of some distribution of mass. Written as ``J = U U^T`` with a triangle U whose diagonal is
an exponential (Rucker and Wensing 2022), every set of numbers is a possible link, so the search is free.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy
import scipy.linalg

from arm.model import Arm, Floats, Link

#: What stands in for a link that the arm file leaves without a possible inertia: a rod of 1 kg.
_ROD = (0.01, 0.02, 0.02, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 1.0)
#: Steps of the search for possible links before it is given up: there may be none.
_TRIES = 60
_ROWS, _COLS = np.triu_indices(4)


def pseudo_inertia(parameters: Floats) -> Floats:
    """Return the pseudo-inertia of ten standard parameters.

    Parameters
    ----------
    parameters : (10,)
        xx yy zz xy xz yz, m*sx m*sy m*sz, m.

    Returns
    -------
    (4, 4)
        Positive definite where the link is physically possible.
    """
    xx, yy, zz, xy, xz, yz, sx, sy, sz, m = parameters
    half = (xx + yy + zz) / 2
    return np.array(
        [[half - xx, -xy, -xz, sx], [-xy, half - yy, -yz, sy], [-xz, -yz, half - zz, sz], [sx, sy, sz, m]]
    )


def is_possible(parameters: Floats) -> bool:
    """Say whether some distribution of mass has these ten parameters."""
    return bool(np.linalg.eigvalsh(pseudo_inertia(parameters))[0] > 0.0)


def links_with(arm: Arm, combination: Floats, values: Floats) -> Sequence[Link]:
    """Return links with given combinations of their parameters, near the arm's own.

    Parameters
    ----------
    arm : Arm
    combination : (n_base, 10 * n_joint)
    values : (n_base,)

    Returns
    -------
    sequence of Link
        Possible ones where they can be found, else the nearest that have the combinations. Every first moment has
        a mass that holds it: a link that the arm leaves without any is taken to be a rod.
    """
    start = np.array([p if is_possible(p) else _ROD for p in _standard(arm)])
    unit = np.maximum(np.abs(values), 1e-3 * max(1e-12, float(np.abs(values).max(initial=0.0))))
    x0 = np.concatenate([_log_triangle(p) for p in start])

    def mismatch(x: Floats, pull: float) -> Floats:
        return np.concatenate([(combination @ _parameters(x) - values) / unit, pull * (x - x0)])

    def slopes(x: Floats, pull: float) -> Floats:
        return np.vstack([combination @ _slopes(x) / unit[:, None], pull * np.eye(len(x))])

    x = x0
    for pull in (1e-1, 1e-3, 1e-5):  # towards the combinations by steps, so that it stays near the start
        x = scipy.optimize.least_squares(mismatch, x, slopes, args=(pull,), method="trf", max_nfev=_TRIES).x
    found = _onto(combination, values, _parameters(x))
    if not all(is_possible(p) for p in found.reshape(-1, 10)):
        found = _onto(combination, values, start.ravel())
    return [_with_parameters(joint.link, p) for joint, p in zip(arm.joints, found.reshape(-1, 10), strict=True)]


def link_parameters(link: Link) -> Floats:
    """Return the ten standard parameters of a link: xx yy zz xy xz yz, m*sx m*sy m*sz, m, (10,)."""
    return np.array([*link.inertia_kg_m2, *(link.mass_kg * s for s in link.com_m), link.mass_kg])


def _standard(arm: Arm) -> Floats:
    return np.array([link_parameters(joint.link) for joint in arm.joints])


def _onto(combination: Floats, values: Floats, parameters: Floats) -> Floats:
    """Move parameters by the least that gives them the combinations exactly."""
    step = scipy.linalg.lstsq(combination, values - combination @ parameters)[0]
    return np.asarray(parameters + step, dtype=np.float64)


def _with_parameters(link: Link, p: Floats) -> Link:
    xx, yy, zz, xy, xz, yz, sx, sy, sz, m = p.tolist()
    if m == 0.0:  # a file has no place for the first moment of no mass
        return replace(link, mass_kg=0.0, inertia_kg_m2=(xx, yy, zz, xy, xz, yz))
    return replace(link, mass_kg=m, com_m=(sx / m, sy / m, sz / m), inertia_kg_m2=(xx, yy, zz, xy, xz, yz))


def _log_triangle(parameters: Floats) -> Floats:
    # U U^T with U upper triangular: the Cholesky factor of the matrix read backwards, turned round again.
    U = np.linalg.cholesky(pseudo_inertia(parameters)[::-1, ::-1])[::-1, ::-1]
    x = U[_ROWS, _COLS]
    x[_ROWS == _COLS] = np.log(x[_ROWS == _COLS])
    return np.asarray(x, dtype=np.float64)


def _triangles(x: Floats) -> Floats:
    """Return the triangles U of all links from ten numbers each, (n_link, 4, 4)."""
    rows = x.reshape(-1, 10)
    U = np.zeros((len(rows), 4, 4))
    U[:, _ROWS, _COLS] = rows
    U[:, range(4), range(4)] = np.exp(U[:, range(4), range(4)])
    return U


def _parameters(x: Floats) -> Floats:
    """Return the standard parameters of all links from their log-triangles, ten numbers each."""
    U = _triangles(x)
    return _of_pseudo_inertias(U @ U.transpose(0, 2, 1)).ravel()


def _slopes(x: Floats) -> Floats:
    """Return the derivatives of `_parameters`, (10 n_link, 10 n_link): dJ = dU U^T + U dU^T."""
    U = _triangles(x)
    n, pairs = len(U), list(zip(_ROWS.tolist(), _COLS.tolist(), strict=True))
    dJ = np.zeros((n, len(pairs), 4, 4))
    for k, (row, col) in enumerate(pairs):
        column = U[:, :, col] * (U[:, row, row, None] if row == col else 1.0)
        dJ[:, k, row, :] += column
        dJ[:, k, :, row] += column
    return np.asarray(scipy.linalg.block_diag(*_of_pseudo_inertias(dJ).transpose(0, 2, 1)))


def _of_pseudo_inertias(J: Floats) -> Floats:
    """Return the standard parameters of pseudo-inertias (…, 4, 4), (…, 10)."""
    trace = J[..., 0, 0] + J[..., 1, 1] + J[..., 2, 2]
    columns = [*(trace - J[..., i, i] for i in range(3)), -J[..., 0, 1], -J[..., 0, 2], -J[..., 1, 2]]
    return np.stack([*columns, *(J[..., i, 3] for i in range(4))], axis=-1)
