"""Sensors that calibrate themselves: readings on one rigid link must agree, whatever the motion was.

Offset, scale, misalignment and place of every sensor, and the corner of AC-coupled ones, are constants of the
smoother's state; what it knows of them after the last reading is the calibration. Nothing is learnt of what the
motion does not show: it is found by comparing what was known after with what was known before.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from arm.kinematics import rotation_from_rpy, rpy_from_rotation
from arm.model import Arm, Floats, Gyroscope, Sensor, SensorCovariance, Vector3
from tracking.clocks import CLOCK_STD_S
from tracking.discrepancy import Discrepancy
from tracking.explained_runs import exact_motions, explained, runs_smoothed
from tracking.mounting_search import likely_mounting
from tracking.observation import ABSENT, MOUNTING, Observation, observation_of
from tracking.readings import Readings
from tracking.smoothed import Smoothed
from tracking.start import MountingPrior

#: A parameter is revealed where its standard error is at most this fraction of its prior's; a convention.
_REVEALED = 0.5
#: One that keeps this fraction of it was not touched by the motion; a convention.
_UNTOUCHED = 0.95
#: A combination is described by the parameters whose loadings are at least this fraction of its length: at most
#: eight of them, as the squares of loadings add up to one.
_PART = 0.35
_AXES = "xyz"


@dataclass(frozen=True)
class SensorEstimate:
    """One number of one sensor.

    Attributes
    ----------
    sensor, name : str
        ``bias_x`` … [m/s^2], ``scale_x`` …, ``turn_x`` … [rad] and ``place_x`` … [m] as departures from the arm
        file, about the sensor's axes and along the link's; ``highpass_hz``; ``late_s``, by how much its clock is
        later than the first sensor's; of a gyroscope ``gyro_bias_x`` … [rad/s] and ``gyro_scale_x`` …
    value, std : float
    unit : str
    revealed : bool
        The motion showed it; otherwise its value is little more than the arm file's.
    """

    sensor: str
    name: str
    value: float
    std: float
    unit: str
    revealed: bool


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
        Where the arm rests when a run begins, see `tracking.smoother.Smoother`.
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
    given, axes, undecided = initial_q_rad is not None, dict[str, str](), list[str]()
    found = exact_motions(arm, runs, q0, given, prior, progress)
    if not explained(found, runs):
        arm, prior, axes, undecided = likely_mounting(arm, runs[0], q0, given, prior, progress)
        of = observation_of(arm, mountings=True)[0]
        found = runs_smoothed(arm, runs, q0, given, prior, progress)
    known, before = found[-1], found[0].before
    lengths = _revealed_lengths(of, known, before)
    instants = np.array([len(readings.values) for readings in runs])
    return SensorCalibration(
        replace(
            _with_lengths(_with_sensors(arm, of, known.final), of, known, lengths),
            sensor_covariance=_covariance(arm, of, known),
        ),
        _estimates(arm, of, known, before) + _clock_estimates(arm, known),
        undecided + _hidden(arm, of, known, before),
        sum(one.passes for one in found),
        all(one.converged for one in found),
        float(np.array([one.doubted for one in found]) @ instants / instants.sum()),
        known.discrepancy,
        lengths,
        axes,
    )


def _columns(arm: Arm, of: Observation) -> list[tuple[int, str, str, str]]:
    """Return column, sensor, name and unit of every number that is sought."""
    n, found = arm.n_joint, []
    for s, sensor in enumerate(arm.sensors):
        bias = int(of.settled_column[s]) if of.settled_column[s] != ABSENT else 3 * n + 3 * s
        found += [(bias + k, sensor.name, f"bias_{axis}", "m/s^2") for k, axis in enumerate(_AXES)]
        names = [(f"{kind}_{axis}", unit) for kind, unit in _KINDS for axis in _AXES]
        first = int(of.mounting_column[s])
        found += [(first + k, sensor.name, name, unit) for k, (name, unit) in enumerate(names)]
        if of.corner_column[s] != ABSENT:
            found.append((int(of.corner_column[s]), sensor.name, "highpass_hz", "Hz"))
    for triad, s in enumerate(arm.gyroscopes, len(arm.sensors)):
        numbers = (
            (3 * n + 3 * triad, "gyro_bias", "rad/s"),
            (int(of.gyro_scale_column[triad]), "gyro_scale", "1"),
        )
        for begin, kind, unit in numbers:
            found += [(begin + k, arm.sensors[s].name, f"{kind}_{axis}", unit) for k, axis in enumerate(_AXES)]
    return found


_KINDS = (("scale", "1"), ("turn", "rad"), ("place", "m"))


def _estimates(arm: Arm, of: Observation, known: Smoothed, before: Floats) -> list[SensorEstimate]:
    std, std_before = np.sqrt(np.diag(known.covariance)), np.sqrt(np.diag(before))
    nominal = np.zeros(len(std))
    factor = np.ones(len(std))
    for triad in np.flatnonzero(of.turning):
        nominal[of.gyro_scale_column[triad] : of.gyro_scale_column[triad] + 3] = of.scale[triad]
    for s in range(len(arm.sensors)):
        nominal[of.mounting_column[s] : of.mounting_column[s] + 3] = of.scale[s]
        if of.corner_column[s] != ABSENT:
            nominal[of.corner_column[s]], factor[of.corner_column[s]] = of.corner[s], 0.5 / np.pi
    value = (known.final + nominal) * factor
    return [
        SensorEstimate(
            sensor,
            name,
            float(value[column]),
            float(std[column] * factor[column]),
            unit,
            bool(std[column] <= _REVEALED * std_before[column]),
        )
        for column, sensor, name, unit in _columns(arm, of)
    ]


def _clock_estimates(arm: Arm, known: Smoothed) -> list[SensorEstimate]:
    """Return by how much sensors are later than the first one."""
    if known.clocks is None:
        return []
    others = slice(1, len(arm.sensors))  # gyroscopes share their clocks
    return [
        SensorEstimate(sensor.name, "late_s", float(late), float(std), "s", bool(std <= _REVEALED * CLOCK_STD_S))
        for sensor, late, std in zip(
            arm.sensors[others], known.clocks.late_s[others], known.clocks.std_s[others], strict=True
        )
    ]


def _covariance(arm: Arm, of: Observation, known: Smoothed) -> SensorCovariance:
    """Return how well biases, scales, turns and places are known together; corners are left out."""
    columns = [column for column in _columns(arm, of) if column[2] != "highpass_hz"]
    at = [column for column, *_ in columns]
    rows = known.covariance[np.ix_(at, at)]
    names = tuple(f"{sensor} {name}" for _, sensor, name, _ in columns)
    return SensorCovariance(names, tuple(tuple(row[: k + 1].tolist()) for k, row in enumerate(rows)))


def _hidden(arm: Arm, of: Observation, known: Smoothed, before: Floats) -> list[str]:
    """Name the combinations of numbers of which as little is known as before.

    In units of what was known before, the covariance has an eigenvalue of 1 along what the motion did not show.
    """
    columns, sentences = [], []
    for column, sensor, name, unit in _columns(arm, of):
        if known.covariance[column, column] > _UNTOUCHED**2 * before[column, column]:
            sentences.append(f"{sensor} {name} does not show")
        else:
            columns.append((column, sensor, name, unit))
    at = np.array([column for column, *_ in columns])
    std = np.sqrt(np.diag(before))[at]
    share, axes = np.linalg.eigh(known.covariance[np.ix_(at, at)] / np.outer(std, std))
    for k in np.flatnonzero(share > _REVEALED**2)[::-1]:
        order = np.argsort(-np.abs(axes[:, k]))
        parts = [i for i in order if abs(axes[i, k]) >= _PART] or [int(order[0])]
        names = [f"{columns[i][1]} {columns[i][2]}" for i in parts]
        if len(parts) == 1:
            sentences.append(f"{names[0]} does not show")
        else:
            signs = ["+" if axes[i, k] * axes[parts[0], k] > 0 else "-" for i in parts]
            told = " ".join(f"{sign} {name}" for sign, name in zip(signs, names, strict=True)).lstrip("+ ")
            sentences.append(f"these do not show together: {told}")
    return sentences


def _revealed_lengths(of: Observation, known: Smoothed, before: Floats) -> frozenset[tuple[int, str]]:
    """Return joints and lengths of which the motion showed much: both of a joint, if both are sought, or none."""
    found: set[tuple[int, str]] = set()
    for i, columns in enumerate(of.length_column):
        sought = {name: c for name, c in zip(("a_m", "d_m"), columns.tolist(), strict=True) if c != ABSENT}
        if all(known.covariance[c, c] <= _REVEALED**2 * before[c, c] for c in sought.values()):
            found |= {(i, name) for name in sought}
    return frozenset(found)


def _with_lengths(arm: Arm, of: Observation, known: Smoothed, lengths: frozenset[tuple[int, str]]) -> Arm:
    """Return the arm with the lengths that were found."""
    joints = list(arm.joints)
    for i, joint in enumerate(arm.joints):
        columns = dict(zip(("a_m", "d_m"), of.length_column[i].tolist(), strict=True))
        found = {name: getattr(joint, name) + float(known.final[columns[name]]) for k, name in lengths if k == i}
        if found:
            std = max(float(np.sqrt(known.covariance[columns[name], columns[name]])) for name in found)
            joints[i] = replace(joint, **found, length_std_m=std)
    return replace(arm, joints=tuple(joints))


def _with_sensors(arm: Arm, of: Observation, x: Floats) -> Arm:
    n = arm.n_joint
    sensors = []
    for s, sensor in enumerate(arm.sensors):
        first = of.mounting_column[s]
        scale, turn, place = x[first : first + MOUNTING].reshape(3, 3)
        rotation = rotation_from_rpy(*sensor.rotation_rad) @ _rotation(turn)
        corner = of.corner[s] + (x[of.corner_column[s]] if of.corner_column[s] != ABSENT else 0.0)
        settled = of.settled_column[s]
        offset = slice(settled, settled + 3) if settled != ABSENT else slice(3 * n + 3 * s, 3 * n + 3 * s + 3)
        sensors.append(
            Sensor(
                sensor.name,
                sensor.joint,
                _vector(np.add(sensor.position_m, place)),
                _vector(rpy_from_rotation(rotation)),
                _vector(np.add(sensor.scale, scale)),
                _vector(x[offset]),
                float(corner / (2.0 * np.pi)),
                _gyroscope(arm, of, s, x),
            )
        )
    return replace(arm, sensors=tuple(sensors))


def _gyroscope(arm: Arm, of: Observation, s: int, x: Floats) -> Gyroscope | None:
    """Return a sensor's gyroscope as it was found."""
    known = arm.sensors[s].gyroscope
    if known is None:
        return None
    triad = len(arm.sensors) + arm.gyroscopes.index(s)
    scale, bias = int(of.gyro_scale_column[triad]), 3 * arm.n_joint + 3 * triad
    return Gyroscope(_vector(np.add(known.scale, x[scale : scale + 3])), _vector(x[bias : bias + 3]))


def _rotation(turn: Floats) -> Floats:
    """Return ``Exp(turn)``, by Rodrigues' formula."""
    angle = float(np.linalg.norm(turn))
    K = np.cross(np.eye(3), turn)  # K v = turn x v
    if angle == 0.0:
        return np.eye(3)
    R: Floats = np.eye(3) + np.sin(angle) / angle * K + (1.0 - np.cos(angle)) / angle**2 * K @ K
    return R


def _vector(values: Floats) -> Vector3:
    x, y, z = (float(value) for value in values)
    return x, y, z
