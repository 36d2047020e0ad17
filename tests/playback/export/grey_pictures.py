"""Pictures of which each has a grey of its own."""

from collections.abc import Iterator

import numpy as np

SIZE = (320, 180)


def coloured(n: int) -> Iterator[np.ndarray]:
    """Yield pictures, each of one grey of its own."""
    for k in range(n):
        yield np.full((SIZE[1], SIZE[0], 3), 40 + 7 * k, np.uint8)


def broken() -> Iterator[np.ndarray]:
    """Yield three pictures and be interrupted."""
    yield from coloured(3)
    raise KeyboardInterrupt
