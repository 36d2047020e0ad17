"""What dead reckoning carries from sample to sample, and what it must know of the arm, as plain arrays."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.chain import Chain, chain_of
from arm.kinematics import sensor_positions
from arm.model import Arm, Floats
from tracking.model.sensor_layout import layout_of


class Reckoning(NamedTuple):
    """State and constants of the dead reckoning.

    Attributes
    ----------
    chain : Chain
    link, position, rotation, pair
        As in `tracking.model.sensor_layout.Layout`.
    start : (n_sensor, 3)
        Where the sensors were when tracking began, by the arm file; used for sliding joints only.
    baseline : (n_joint, 3)
        From the first to the second sensor of a pair when tracking began, in the base frame.
    q, q_before : (n_joint,)
        Now and one sample ago.
    velocity, moved : (n_sensor, 3)
        In the base frame.
    recent : (4, 3 * n_sensor)
        The last four readings, for the moving average; ``recent[count % 4]`` is overwritten next.
    offset : (3 * n_sensor,)
        What the sensors read too much.
    gravity : (3 * n_sensor,)
        What they read of gravity alone, with the joints where they are.
    """

    chain: Chain
    link: NDArray[np.int64]
    position: Floats
    rotation: Floats
    pair: NDArray[np.int64]
    start: Floats
    baseline: Floats
    q: Floats
    q_before: Floats
    velocity: Floats
    moved: Floats
    recent: Floats
    offset: Floats
    gravity: Floats


def reckoning_of(arm: Arm, q: Floats) -> Reckoning:
    """Return where dead reckoning begins, but for ``gravity``: at rest, at the angles ``q`` (n_joint,).

    Raises
    ------
    ConfigError
        If the arm's sensors cannot give its angles.
    """
    layout = layout_of(arm)
    start = sensor_positions(arm, q)[0]
    n_channel = 3 * len(arm.sensors)
    return Reckoning(
        chain_of(arm),
        layout.link,
        layout.position,
        layout.rotation,
        layout.pair,
        start,
        start[layout.pair[:, 1]] - start[layout.pair[:, 0]],
        q.copy(),
        q.copy(),
        np.zeros_like(start),
        np.zeros_like(start),
        np.zeros((4, n_channel)),
        np.zeros(n_channel),
        np.zeros(n_channel),
    )
