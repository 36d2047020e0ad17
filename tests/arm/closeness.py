"""Equality to a share of the largest number."""

import numpy as np


def close(found, expected, tolerance=1e-9):
    """Assert equality to a share of the largest number that is expected."""
    scale = max(1.0, float(np.abs(expected).max(initial=0.0)))
    np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance * scale)
