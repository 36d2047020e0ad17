"""The part of noise-corrected sums that is more than chance.

A corrected gram matrix has the right expectation, but nothing keeps it positive: where the angles hardly moved
it is a small difference of large numbers. What share of a direction's measured power is motion and not noise
is its *reliability*; measured from n samples it scatters by about ``(1 - share) sqrt(2 / n)``. A direction
whose reliability is not above that scatter is left out, as one in which nothing moved: the cost does not know
it, and what the parameters do there is unobservable.
"""

import numpy as np

from arm.model import Floats
from fitter.search.whitened import Whitened

#: Standard errors by which motion has to stand out.
_OUTSTANDING = 4.0


def reliable(measured: Whitened, gram: Floats, moment: Floats, power: Floats, samples: int) -> Whitened:
    """Return the cost that corrected sums make of a coefficient matrix, in the directions that can be relied on.

    Parameters
    ----------
    measured : Whitened
        Of the sums as they were measured.
    gram, moment, power : (n, n), (n, 3), (3,)
        Of the corrected ones.
    samples : int

    Returns
    -------
    Whitened
        W has orthogonal rows in the metric of the measured sums.
    """
    if not len(measured.W):
        return measured
    back = np.linalg.pinv(measured.W)
    share, axes = np.linalg.eigh(back.T @ gram @ back)
    is_determined = share > _OUTSTANDING * np.sqrt(2.0 / max(samples, 1)) * np.clip(1.0 - share, 0.0, 1.0)
    is_determined &= share > 0.0
    root = np.sqrt(share[is_determined])
    W = root[:, None] * (axes[:, is_determined].T @ measured.W)
    z = (axes[:, is_determined].T @ (back.T @ moment)) / root[:, None]
    rest = np.maximum(power - np.sum(z * z, axis=0), 0.0)
    return Whitened(W, z, rest, measured.kept, measured.folded, measured.scale)
