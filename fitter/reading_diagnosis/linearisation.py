"""Readings of one trial against what they should be along a motion, and how the difference changes.

What can be undone in the readings themselves is undone there: a late sensor's frames are taken earlier, and an
AC-coupled one's are given back what it forgot, ``x = y + wc ∫ y dt + x(0)``; so everything else depends on the
motion at the frame's own instant only. What was forgotten before the trial is unknown, and noise was integrated
with the readings: such a sensor's offset walks.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.kinematics import axis_frames, rotation_from_rpy
from arm.model import Arm, Floats, Sensor, Vector3
from fitter.diagnosis.least_squares import SIGMAS
from fitter.reading_diagnosis.elimination import motion_at_knots
from fitter.reading_diagnosis.sensor_frames import TrialFrames
from limbcal.compiled import compiled
from tracking.model.expected_readings import observe, room_of
from tracking.model.observation import Observation, observation_of


@dataclass(frozen=True)
class Instruments:
    """An arm with its sensors, and what an arm file has no field for.

    Attributes
    ----------
    arm : Arm
        Its sensors' corners are taken up in ``corner_hz``.
    corner_hz, delay_s, level : (n_sensor,)
        Of AC-coupled sensors, of late ones, and of those that clip [m/s^2]; 0, 0 and infinite for the others.
    drift : (n_sensor, 3) [m/s^3]
    base : (3, 2) [m/s^2]
        Acceleration of the base, x y z, cosine and sine.
    base_hz : float
    """

    arm: Arm
    corner_hz: Floats
    delay_s: Floats
    level: Floats
    drift: Floats
    base: Floats
    base_hz: float = 0.0

    def with_sensor(self, index: int, **changes: Vector3) -> "Instruments":
        """Return a copy with one sensor changed."""
        sensors = list(self.arm.sensors)
        sensors[index] = replace(sensors[index], **changes)  # type: ignore[arg-type]
        return replace(self, arm=replace(self.arm, sensors=tuple(sensors)))

    def with_entry(self, name: str, index: int, value: Floats | float) -> "Instruments":
        """Return a copy with one sensor's row of an array changed."""
        changed = getattr(self, name).copy()
        changed[index] = value
        return replace(self, **{name: changed})

    @property
    def bias(self) -> Floats:
        """What the sensors read too much, (3 n_sensor,) [m/s^2]."""
        return np.array([sensor.bias_m_s2 for sensor in self.arm.sensors], dtype=float).ravel()


def instruments_of(arm: Arm) -> Instruments:
    """Return the sensors as the arm file has them."""
    n = len(arm.sensors)
    corner = np.array([sensor.highpass_hz for sensor in arm.sensors], dtype=float)
    plain = tuple(replace(sensor, highpass_hz=0.0) for sensor in arm.sensors)
    return Instruments(
        replace(arm, sensors=plain), corner, np.zeros(n), np.full(n, np.inf), np.zeros((n, 3)), np.zeros((3, 2))
    )


def added(vector: Vector3, change: Floats) -> Vector3:
    """Return the sum of a field of a sensor and a change."""
    x, y, z = (float(a + b) for a, b in zip(vector, change, strict=True))
    return x, y, z


def turn_by_angles(sensor: Sensor, step: float = 1e-6) -> NDArray[np.float64]:
    """Return the small turn of a sensor about its own axes for a change of roll, pitch and yaw: (3, 3)."""
    R = rotation_from_rpy(*sensor.rotation_rad)
    turns = np.empty((3, 3))
    for k in range(3):
        change = step * np.eye(3)[k]
        dR = rotation_from_rpy(*added(sensor.rotation_rad, change)) - rotation_from_rpy(
            *added(sensor.rotation_rad, -change)
        )
        W = R.T @ dR / (2.0 * step)
        turns[:, k] = (W[2, 1] - W[1, 2]) / 2.0, (W[0, 2] - W[2, 0]) / 2.0, (W[1, 0] - W[0, 1]) / 2.0
    return turns


@dataclass(frozen=True)
class Linearisation:
    """A trial along a motion; rows are channels, and noise is not yet made unit.

    Attributes
    ----------
    trial : TrialFrames
    instruments : Instruments
    of : Observation
    q : (n, n_joint)
    dq : (n, n_joint)
    readings : (n, n_channel) [m/s^2]
        With delay and forgetting undone.
    expected : (n, n_channel) [m/s^2]
    slope : (n, n_channel, n_state)
        By the state of `tracking.model.observation`.
    integral : (n, n_channel) [m/s]
        Of the readings without bias, since the trial began.
    clipped : (n, n_channel)
        Sign of the level where a sensor clips, else 0.
    weight : (n, n_channel)
        One over the standard deviation; 0 for what is not looked at.
    correlation : (n_channel,)
        Of a frame's noise with that of the next one: they share a sample where a sensor is read between two.
    """

    trial: TrialFrames
    instruments: Instruments
    of: Observation
    q: Floats
    dq: Floats
    readings: Floats
    expected: Floats
    slope: Floats
    integral: Floats
    clipped: Floats
    weight: Floats
    correlation: Floats

    @property
    def residual(self) -> Floats:
        """What is read beyond what is expected, (n, n_channel) [m/s^2]; 0 where nothing is looked at."""
        left: Floats = np.where(self.weight > 0.0, self.readings - self.expected, 0.0)
        return left

    def from_base(self) -> Floats:
        """Return what every channel reads of an acceleration of the base, (n, n_channel, 3)."""
        frames = axis_frames(self.instruments.arm, self.q)
        columns = np.empty((*self.expected.shape, 3))
        for s, sensor in enumerate(self.instruments.arm.sensors):
            turned = frames[:, sensor.joint - 1, :3, :3] @ rotation_from_rpy(*sensor.rotation_rad)
            columns[:, 3 * s : 3 * s + 3] = np.swapaxes(turned, 1, 2) * np.array(sensor.scale)[:, None]
        return np.where(self.clipped[..., None] != 0.0, 0.0, columns)

    def motion_rows(self, creep: float = 2e-3) -> tuple[Floats, Floats]:
        """Return slopes (n, n_channel + n_joint, 3 n_joint) by the motion, and the residual, both with unit noise.

        The last rows say that velocities are zero in a rest but for ``creep`` [rad/s or m/s]: arms creep for long.
        """
        n, n_channel = self.expected.shape
        n_joint = self.q.shape[1]
        S, r = np.zeros((n, n_channel + n_joint, 3 * n_joint)), np.zeros((n, n_channel + n_joint))
        S[:, :n_channel] = self.slope[:, :, : 3 * n_joint] * self.weight[..., None]
        r[:, :n_channel] = self.residual * self.weight
        rest = self.trial.resting
        sure = 1.0 / (creep * np.sqrt(max(rest, 1)))
        for j in range(n_joint):
            S[:rest, n_channel + j, 3 * j + 1] = sure
            r[:rest, n_channel + j] = -self.dq[:rest, j] * sure
        return S, r


def linearise(
    trial: TrialFrames, instruments: Instruments, c: Floats, without: NDArray[np.bool_] | None = None
) -> Linearisation:
    """Return a trial along the motion with spline coefficients c (n + 2, n_joint).

    Parameters
    ----------
    trial : TrialFrames
    instruments : Instruments
    c : (n + 2, n_joint)
    without : (n_sensor,) bool, optional
        Sensors that are not looked at.
    """
    arm = instruments.arm
    n, n_channel = trial.values.shape
    of, size = observation_of(arm.with_gyroscopes(()), mountings=True)
    q, dq, ddq = np.empty((3, n, arm.n_joint))
    motion_at_knots(c, trial.dt_s, q, dq, ddq)
    readings, weight, correlation = trial.values.copy(), trial.weight.copy(), np.zeros(n_channel)
    for s in np.flatnonzero(instruments.delay_s).tolist():
        channels, late = slice(3 * s, 3 * s + 3), instruments.delay_s[s] / trial.dt_s
        readings[:, channels] = trial.advanced(s, instruments.delay_s[s])
        rows = [np.clip(np.arange(n) + int(step), 0, n - 1) for step in (np.floor(late), np.ceil(late))]
        weight[:, channels] = np.minimum(*(trial.weight[row, channels] for row in rows))
        read = np.arange(n) + late  # before the first frame and after the last one nothing was
        weight[(read < 0.0) | (read > n - 1.0), channels] = 0.0
        # Reading between two samples, at the ends of a frame, takes a little off its noise.
        share = (instruments.delay_s[s] * trial.raw.rate_hz) % 1.0
        shared = share * (1.0 - share) / trial.factor
        weight[:, channels] /= np.sqrt(1.0 - 2.0 * shared)
        correlation[channels] = shared / (1.0 - 2.0 * shared)
    lost = np.isnan(readings)
    readings[lost] = 0.0
    since = (trial.t - trial.t[0] + 0.5 * trial.dt_s)[:, None]
    integral = trial.integral - instruments.bias * since
    readings += 2.0 * np.pi * np.repeat(instruments.corner_hz, 3) * integral
    expected, slope = np.empty((n, n_channel)), np.zeros((n, n_channel, size))
    x = np.zeros(size)
    x[3 * arm.n_joint : 3 * arm.n_joint + n_channel] = instruments.bias
    _observe_along(of, x, q, dq, ddq, expected, slope)
    expected += instruments.drift.ravel() * trial.t[:, None]
    weight[lost] = 0.0
    if without is not None:
        weight *= ~np.repeat(without, 3)
    clipped = _clip(trial, instruments, readings, expected, slope, weight)
    known = readings, expected, slope, integral, clipped, weight, correlation
    found = Linearisation(trial, instruments, of, q, dq, *known)
    if instruments.base.any():
        phase = 2.0 * np.pi * instruments.base_hz * trial.t
        wave = np.column_stack([np.cos(phase), np.sin(phase)]) @ instruments.base.T
        expected += np.einsum("kcx,kx->kc", found.from_base(), wave)
        _turn_base(found, wave)
    return found


def _turn_base(at: Linearisation, wave: Floats) -> None:
    """Add to the slopes that a joint turns the sensors beyond it against the base's acceleration (n, 3)."""
    arm, felt = at.instruments.arm, at.from_base()
    axes = axis_frames(arm, at.q)[:, :, :3, 2]
    for j, joint in enumerate(arm.joints):
        if joint.type == "revolute":
            turned = np.einsum("kcx,kx->kc", felt, np.cross(wave, axes[:, j]))
            beyond = np.repeat([sensor.joint > j for sensor in arm.sensors], 3)
            at.slope[:, beyond, 3 * j] += turned[:, beyond]


def _clip(
    trial: TrialFrames, instruments: Instruments, readings: Floats, expected: Floats, slope: Floats, weight: Floats
) -> Floats:
    """Let clipped frames say no more than that they read the level; return which those are."""
    clipped = np.zeros_like(expected)
    level = np.repeat(instruments.level, 3)
    if not np.isfinite(level).any():
        return clipped
    margin = SIGMAS * trial.std * np.sqrt(trial.factor)
    near = trial.largest >= level - margin
    flat = np.abs(readings) >= level - SIGMAS * trial.std
    weight[near & ~flat] = 0.0  # partly clipped, or about to be
    clipped[near & flat] = np.sign(readings[near & flat])
    where = clipped != 0.0
    expected[where] = (clipped * np.where(np.isfinite(level), level, 0.0))[where]
    slope[where] = 0.0
    return clipped


@compiled
def _observe_along(
    of: Observation, x: Floats, q: Floats, dq: Floats, ddq: Floats, expected: Floats, slope: Floats
) -> None:
    n_joint = q.shape[1]
    room = room_of(n_joint)
    for k in range(q.shape[0]):
        for j in range(n_joint):
            x[3 * j], x[3 * j + 1], x[3 * j + 2] = q[k, j], dq[k, j], ddq[k, j]
        observe(of, room, x, expected[k], slope[k])
