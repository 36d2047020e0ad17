"""Sensors that calibrate themselves: readings on one rigid link must agree, whatever the motion was.

Offset, scale, misalignment and place of every sensor, and the corner of AC-coupled ones, are constants of the
smoother's state; what it knows of them after the last reading is the calibration. Nothing is learnt of what the
motion does not show: it is found by comparing what was known after with what was known before.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from arm.model import Arm, Floats
from tracking.model.discrepancy import Discrepancy
from tracking.model.initial_state import MountingPrior
from tracking.model.observation import ABSENT, Observation, observation_of
from tracking.model.readings import Readings
from tracking.smoother.calibrated_arm import with_lengths, with_sensors
from tracking.smoother.explained_runs import exact_motions, explained, runs_smoothed
from tracking.smoother.mounting_search import likely_mounting
from tracking.smoother.sensor_estimates import (
    REVEALED,
    SensorEstimate,
    clock_estimates,
    covariance_of,
    estimates_of,
    hidden_of,
)
from tracking.smoother.smoothed import Smoothed


@dataclass(frozen=True)
class SensorCalibration:
    """What was learnt of an arm's sensors.

    Attributes
    ----------
    arm : Arm
        With its sensors as they were found.
    estimates : list of SensorEstimate
    hidden : list of str
        What the motion could not reveal, a sentence each.
    passes : int
    converged : bool
        The passes ended, and in some orientation of the sensors lengths and places are near the file's.
    doubted : float
        Share of the instants at which no motion explains the readings.
    discrepancy : Discrepancy or None
        What the model lacks of the readings, if no sensors explain them to their noise.
    lengths : frozenset of (int, str)
        Joints, from 0, and which of their lengths were found: ``a_m``, ``d_m``.
    axes : dict of str to str
        Of each sensor whose axes are exchanged or reversed against the file: which of the file's its x, y, z are.
    """

    arm: Arm
    estimates: list[SensorEstimate]
    hidden: list[str]
    passes: int
    converged: bool
    doubted: float
    discrepancy: Discrepancy | None = None
    lengths: frozenset[tuple[int, str]] = frozenset()
    axes: dict[str, str] = field(default_factory=dict)


def calibrate_sensors(
    arm: Arm,
    runs: Sequence[Readings],
    initial_q_rad: Floats | None,
    prior: MountingPrior,
    progress: Callable[[int], None] | None = None,
) -> SensorCalibration:
    """Find offset, scale, misalignment and place of every sensor from ordinary motions.

    Parameters
    ----------
    arm : Arm
    runs : sequence of Readings
        One after the other, each beginning with a rest; what one showed is known to the next.
    initial_q_rad : (n_joint,) or None
        Where the arm rests when a run begins, see `tracking.smoother.smoother.Smoother`.
    prior : MountingPrior
        How far off the sensors may be.
    progress : callable, optional
        Told the number of passes after each.

    Returns
    -------
    SensorCalibration
    """
    q0 = np.zeros(arm.n_joint) if initial_q_rad is None else initial_q_rad
    arm = replace(arm, sensor_covariance=None)  # it is found anew
    of = observation_of(arm, mountings=True)[0]
    given, axes, undecided, is_found = initial_q_rad is not None, dict[str, str](), list[str](), True
    found = exact_motions(arm, runs, q0, given, prior, progress, explaining=True)
    if not explained(found, runs):
        arm, prior, axes, undecided, is_found = likely_mounting(arm, runs[0], q0, given, prior, progress)
        of = observation_of(arm, mountings=True)[0]
        found = runs_smoothed(arm, runs, q0, given, prior, progress)
    known, before = found[-1], found[0].before
    lengths = _revealed_lengths(of, known, before)
    instants = np.array([len(readings.values) for readings in runs])
    return SensorCalibration(
        replace(
            with_lengths(with_sensors(arm, of, known.final), of, known, lengths),
            sensor_covariance=covariance_of(arm, of, known),
        ),
        estimates_of(arm, of, known, before) + clock_estimates(arm, known),
        undecided + hidden_of(arm, of, known, before),
        sum(one.passes for one in found),
        is_found and all(one.converged for one in found),
        float(np.array([one.doubted for one in found]) @ instants / instants.sum()),
        known.discrepancy,
        lengths,
        axes,
    )


def _revealed_lengths(of: Observation, known: Smoothed, before: Floats) -> frozenset[tuple[int, str]]:
    """Return joints and lengths of which the motion showed much: both of a joint, if both are sought, or none."""
    found: set[tuple[int, str]] = set()
    for i, columns in enumerate(of.length_column):
        sought = {name: c for name, c in zip(("a_m", "d_m"), columns.tolist(), strict=True) if c != ABSENT}
        if all(known.covariance[c, c] <= REVEALED**2 * before[c, c] for c in sought.values()):
            found |= {(i, name) for name in sought}
    return frozenset(found)
