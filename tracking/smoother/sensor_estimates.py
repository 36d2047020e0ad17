"""What the smoother knows of sensors after the last reading: each number, what did not show, their covariance."""

from dataclasses import dataclass

import numpy as np

from arm.model import Arm, Floats, SensorCovariance
from tracking.model.clocks import CLOCK_STD_S
from tracking.model.observation import ABSENT, Observation
from tracking.smoother.smoothed import Smoothed

#: A parameter is revealed where its standard error is at most this fraction of its prior's; a convention.
REVEALED = 0.5
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


def estimates_of(arm: Arm, of: Observation, known: Smoothed, before: Floats) -> list[SensorEstimate]:
    """Return every number of every sensor; ``before`` (n_state, n_state) is the covariance before any reading."""
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
            bool(std[column] <= REVEALED * std_before[column]),
        )
        for column, sensor, name, unit in _columns(arm, of)
    ]


def clock_estimates(arm: Arm, known: Smoothed) -> list[SensorEstimate]:
    """Return by how much sensors are later than the first one."""
    if known.clocks is None:
        return []
    others = slice(1, len(arm.sensors))  # gyroscopes share their clocks
    return [
        SensorEstimate(sensor.name, "late_s", float(late), float(std), "s", bool(std <= REVEALED * CLOCK_STD_S))
        for sensor, late, std in zip(
            arm.sensors[others], known.clocks.late_s[others], known.clocks.std_s[others], strict=True
        )
    ]


def covariance_of(arm: Arm, of: Observation, known: Smoothed) -> SensorCovariance:
    """Return how well biases, scales, turns and places are known together; corners are left out."""
    columns = [column for column in _columns(arm, of) if column[2] != "highpass_hz"]
    at = [column for column, *_ in columns]
    rows = known.covariance[np.ix_(at, at)]
    names = tuple(f"{sensor} {name}" for _, sensor, name, _ in columns)
    return SensorCovariance(names, tuple(tuple(row[: k + 1].tolist()) for k, row in enumerate(rows)))


def hidden_of(arm: Arm, of: Observation, known: Smoothed, before: Floats) -> list[str]:
    """Name the combinations of numbers of which as little is known as before.

    In units of what was known before, the covariance has an eigenvalue of 1 along what the motion did not show.
    """
    columns, sentences = [], []
    for column, sensor, name, unit in _columns(arm, of):
        if known.covariance[column, column] > _UNTOUCHED**2 * before[column, column]:
            sentences.append(f"{sensor} {name} does not show")
        else:
            columns.append((column, sensor, name, unit))
    at = np.array([column for column, *_ in columns], dtype=np.intp)
    std = np.sqrt(np.diag(before))[at]
    share, axes = np.linalg.eigh(known.covariance[np.ix_(at, at)] / np.outer(std, std))
    for k in np.flatnonzero(share > REVEALED**2)[::-1]:
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
