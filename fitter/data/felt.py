"""What the sensors read during a motion, as it comes along with the frames of a stream."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracking.model.noise import Noise
from tracking.model.readings import Readings

Floats = NDArray[np.float64]

#: Readings are averaged over so long before a motion is estimated anew from all of them [s]: an arm's motion has
#: next to nothing above 100 Hz.
STEP_S = 0.004
#: Length of the rest before a motion that is estimated with it [s]; the live fitter keeps no more.
REST_S = 2.0


@dataclass(frozen=True)
class Felt:
    """Readings from the rest before a motion to the rest after it.

    Attributes
    ----------
    readings : Readings
    t_s : ndarray of shape (n,)
        Times of the readings [s], 0 at the motion's beginning.
    q, end_q : ndarray of shape (n_joint,)
        Where the tracker says the arm rests before and after.
    q_std : ndarray of shape (n_joint,), or None
        How well it knows ``q``, if it says so.
    """

    readings: Readings
    t_s: Floats
    q: Floats
    end_q: Floats
    q_std: Floats | None


def felt_of(blocks: Sequence[Mapping[str, Any]], after_ns: float, begin_ns: int, end_ns: int) -> Felt | None:
    """Put the readings of blocks of frames on one grid; None where a block has none.

    Parameters
    ----------
    blocks : sequence of mapping
        Fields of `limb/frames` in order.
    after_ns : float
        Readings until then belong to the motion before; those of longer than `REST_S` before the motion do not
        count either.
    begin_ns, end_ns : int
        When the motion began and ended.
    """
    after_ns = max(after_ns, begin_ns - REST_S * 1e9)
    blocks = [block for block in blocks if block["t0_ns"] > after_ns and block["t0_ns"] <= end_ns]
    if not blocks or any(block.get("a") is None for block in blocks) or blocks[-1].get("a_noise") is None:
        return None
    dt_s, noise, first = float(blocks[0]["dt_s"]), np.asarray(blocks[-1]["a_noise"]), int(blocks[0]["frame0"])
    n = int(blocks[-1]["frame0"]) + int(blocks[-1]["n"]) - first
    step = max(1, round(STEP_S / dt_s))
    if n < 2 * step:
        return None
    values = np.full((n, np.asarray(blocks[0]["a"]).shape[1]), np.nan)
    for block in blocks:
        row = int(block["frame0"]) - first
        values[row : row + int(block["n"])] = block["a"]
    n = n // step
    readings = values[: n * step].reshape(n, step, -1).mean(axis=1)
    t0_s = 1e-9 * (blocks[0]["t0_ns"] - begin_ns) + 0.5 * (step - 1) * dt_s
    claim = blocks[0].get("q_std")
    return Felt(
        Readings(readings, step * dt_s, 0.0, Noise(noise[0], noise[1]), step),
        t0_s + step * dt_s * np.arange(n),
        np.asarray(blocks[0]["q"])[0],
        np.asarray(blocks[-1]["q"])[-1],
        None if claim is None else np.asarray(claim)[0],
    )
