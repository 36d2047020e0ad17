"""Passes of the smoother in coarser steps, where only their motion is wanted."""

import numpy as np

from arm.model import Floats
from tracking.model.course import Course

#: Frames that are one in a coarser pass, at the most…
COARSE = 4
#: … and the rate that remains at the least [Hz]: a motion that was recorded at less is not coarsened.
_LEAST_HZ = 60.0


def stride_of(dt_s: float) -> int:
    """Return how many frames are one in a coarser pass."""
    return min(COARSE, max(1, int(1.0 / (_LEAST_HZ * dt_s))))


def every(values: Floats, stride: int) -> Floats:
    """Return the middle one of each `stride` rows; of a last few, the last one."""
    count = -(-len(values) // stride)
    picked: Floats = values[np.minimum(stride * np.arange(count) + stride // 2, len(values) - 1)]
    return picked.copy()


def coarser(course: Course, stride: int) -> Course:
    """Return the course in steps of several frames: means of readings, sums of jolts."""
    pad = -len(course.readings) % stride

    def blocks(values: Floats) -> Floats:
        padded: Floats = np.concatenate([values, np.repeat(values[-1:], pad, axis=0)])
        return padded.reshape(-1, stride, *values.shape[1:])

    present = blocks(course.present.astype(float))
    weight = present.sum(axis=1)
    total = (blocks(course.readings) * present[..., None]).sum(axis=1)
    doubt = blocks(course.doubt).mean(axis=1)
    drift = blocks(course.drift).mean(axis=1) if len(course.drift) else course.drift
    rest = blocks(course.rest)
    return course._replace(
        dt=stride * course.dt,
        readings=total / np.maximum(weight, 1.0)[:, None],
        present=weight > 0,
        noise=course.noise / stride,
        jolt=blocks(course.jolt).sum(axis=1),
        drift=drift,
        doubt=doubt * (stride / np.maximum(weight, 1.0))[:, None],
        rest=np.where((rest > 0.0).all(axis=1), rest.mean(axis=1) / stride, 0.0),
    )


def finer(coarse: Floats, n: int, stride: int) -> Floats:
    """Return coarse states at each of n frames, by straight lines between them."""
    at = (np.arange(n) - stride // 2) / stride
    low = np.clip(np.floor(at).astype(int), 0, max(0, len(coarse) - 2))
    share = (at - low)[:, None]
    high = np.minimum(low + 1, len(coarse) - 1)
    fine: Floats = coarse[low] * (1.0 - share) + coarse[high] * share
    return fine
