"""Sines and cosines of many angles at once: without branches, so that a processor takes several at a time.

An angle is brought within an eighth of a turn by taking off quarter turns, in three parts so that nothing is lost
(Cody and Waite 1980), where the series of fdlibm hold to the last bit but one (Sun Microsystems 1993).
"""

import numpy as np

from arm.model import Floats
from limbcal.compiled import compiled

#: Half pi as a sum: the first two have 33 bits each, so products with up to 20 bits of quarter turns are exact.
_HALF_PI = (1.57079632673412561417e00, 6.07710050630396597660e-11, 2.02226624879595063154e-21)
_QUARTERS_PER_RAD = 0.6366197723675814
#: Angle beyond which the library is asked [rad]: it has fewer quarter turns than the parts of half pi allow.
_MOST_QUARTERS = 2.0**20
_S = (
    -1.66666666666666324348e-01,
    8.33333333332248946124e-03,
    -1.98412698298579493134e-04,
    2.75573137070700676789e-06,
    -2.50507602534068634195e-08,
    1.58969099521155010221e-10,
)
_C = (
    4.16666666666666019037e-02,
    -1.38888888888741095749e-03,
    2.48015872894767294178e-05,
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)


@compiled
def sines_cosines(angles: Floats) -> tuple[Floats, Floats]:
    """Return the sines and the cosines of angles [rad], each shaped like these.

    Parameters
    ----------
    angles : contiguous array
    """
    sine, cosine = np.empty_like(angles), np.empty_like(angles)
    flat, flat_sine, flat_cosine = angles.ravel(), sine.ravel(), cosine.ravel()
    near = True
    for k in range(flat.size):
        near &= abs(flat[k]) < _MOST_QUARTERS  # nor is one that is no number
    if near:
        _fill(flat, flat_sine, flat_cosine)
    else:
        flat_sine[:], flat_cosine[:] = np.sin(flat), np.cos(flat)
    return sine, cosine


@compiled
def _fill(angles: Floats, sine: Floats, cosine: Floats) -> None:
    for k in range(angles.size):
        quarters = np.floor(angles[k] * _QUARTERS_PER_RAD + 0.5)
        x = ((angles[k] - quarters * _HALF_PI[0]) - quarters * _HALF_PI[1]) - quarters * _HALF_PI[2]
        z = x * x
        s = x + x * z * (_S[0] + z * (_S[1] + z * (_S[2] + z * (_S[3] + z * (_S[4] + z * _S[5])))))
        c = z * z * (_C[0] + z * (_C[1] + z * (_C[2] + z * (_C[3] + z * (_C[4] + z * _C[5])))))
        c = 1.0 - (0.5 * z - c)
        odd = quarters - 2.0 * np.floor(0.5 * quarters)  # 1 where sine and cosine change places
        half = np.floor(0.5 * quarters)
        turned = 1.0 - 2.0 * (half - 2.0 * np.floor(0.5 * half))  # -1 after half a turn
        sine[k] = turned * (s if odd == 0.0 else c)
        cosine[k] = turned * (c if odd == 0.0 else -s)
