"""The standard bench: point-to-point motions by seed, and accelerometers with their errors.

A trial begins with a rest at the target before it and then is driven to the next one; trials follow each
other on one clock, and so do the arm's effects. The motion is simulated at 4 kHz and interpolated to the sensors'
rate by a polynomial through angle, velocity and acceleration, which keeps all three consistent.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.accelerometer import specific_force
from arm.counts import COUNT_M_S2
from arm.effects.effect_table import changed
from arm.effects.sensor_effects import SensorEffects
from arm.highpass import HighPass
from arm.model import Arm, Floats
from arm.simulation import GearedMotion, Motion, simulate
from limbcal.errors import ConfigError


@dataclass(frozen=True)
class Bench:
    """The sizes of the bench; ``rate_hz`` is the sensors'."""

    rate_hz: float = 32000.0
    trial_s: float = 6.75
    rest_s: float = 0.5
    learning: int = 5
    evaluating: int = 17
    span_rad: float = 1.2
    simulation_hz: float = 4000.0

    @property
    def trials(self) -> int:
        """Number of trials."""
        return self.learning + self.evaluating


@dataclass(frozen=True)
class SensorErrors:
    """What keeps the sensors from reading what the arm file says; arrays are (n_sensor, 3)."""

    noise_m_s2: float
    bias_m_s2: Floats
    scale: Floats
    misalignment_rad: Floats
    offset_m: Floats


def targets(bench: Bench, n_joint: int, seed: int) -> Floats:
    """Return where the arm rests before the first trial and where each trial drives it.

    Returns
    -------
    (trials + 1, n_joint) [rad or m]
    """
    rng = np.random.default_rng([seed, 1])
    drawn = rng.uniform(-bench.span_rad, bench.span_rad, (bench.trials, n_joint))
    return np.vstack([np.zeros(n_joint), drawn])


def motions(arm: Arm, bench: Bench, seed: int) -> Iterator[Motion]:
    """Yield the bench's trials one by one, sampled at ``bench.rate_hz``; every ``t`` starts at 0.

    Raises
    ------
    ConfigError
        If the arm has no control law to drive it.
    """
    if arm.control.law == "measured":
        raise ConfigError(f"arm {arm.name!r}: control.law is 'measured'; the bench needs 'pd', 'pda' or 'p'")
    goals = targets(bench, arm.n_joint, seed)
    step = 1.0 / bench.simulation_hz
    n, rest = round(bench.trial_s / step), round(bench.rest_s / step)
    q, dq = rest_angles(arm, goals[0]), np.zeros(arm.n_joint)
    for trial, (before, goal) in enumerate(itertools.pairwise(goals)):
        # One sample more than the trial has: where it ends, the next one begins.
        ref = np.vstack([np.tile(before, (rest, 1)), np.tile(goal, (n - rest + 1, 1))])
        motion = simulate(arm, ref, step, q, dq, t0_s=trial * bench.trial_s, trial=trial + 1)
        q, dq = motion.q[-1], motion.dq[-1]
        yield densify(motion, bench.rate_hz, round(bench.trial_s * bench.rate_hz))


def rest_angles(arm: Arm, target: Floats) -> Floats:
    """Return where the arm comes to rest under its control: at the target, but for what gravity adds.

    Parameters
    ----------
    arm : Arm
    target : (n_joint,)

    Returns
    -------
    (n_joint,) [rad or m]
    """
    ref = np.tile(target, (60_000, 1))
    settled: Floats
    if not arm.effects:  # what stays where it is for a step stays there: nothing changes with time
        begun = simulate(arm, ref[:2], 1e-3, target, t0_s=-60.0)
        if not begun.dq.any() and np.array_equal(begun.q, ref[:2]):
            settled = begun.q[-1]
            return settled
    settled = simulate(arm, ref, 1e-3, target, t0_s=-60.0).q[-1]  # before the run begins
    return settled


def densify(motion: Motion, rate_hz: float, n_sample: int) -> Motion:
    """Return a motion sampled at another rate, from its first instant on.

    Between two samples runs the polynomial of fifth degree through their angles and two derivatives.

    Raises
    ------
    ConfigError
        If the motion is shorter than what is asked for.
    """
    step = motion.t[1] - motion.t[0]
    t = np.arange(n_sample) / rate_hz
    k = np.floor(t / step + 1e-9).astype(np.intp)
    if k[-1] > len(motion.t) - 1:
        raise ConfigError(f"a motion of {motion.t[-1]:.6g} s cannot give {n_sample} samples at {rate_hz:g} Hz")
    s = (t / step - k)[:, None]
    seen = _quintic(motion.q, motion.dq, motion.ddq, k, s, step)
    if not isinstance(motion, GearedMotion):
        return Motion(t, *seen, motion.tau[k], motion.ref[k])
    links = _quintic(motion.link_q, motion.link_dq, motion.link_ddq, k, s, step)
    return GearedMotion(t, *seen, motion.tau[k], motion.ref[k], *links)


def _quintic(
    q: Floats, dq: Floats, ddq: Floats, k: NDArray[np.intp], s: Floats, step: float
) -> tuple[Floats, Floats, Floats]:
    """Return angle, velocity and acceleration a share s (n_sample, 1) of a step after samples k."""
    after = np.minimum(k + 1, len(q) - 1)
    s2, s3 = s * s, s * s * s
    d1 = q[after] - q[k]
    v0, v1 = dq[k] * step, dq[after] * step
    a0, a1 = ddq[k] * step**2 / 2, ddq[after] * step**2 / 2
    c3 = 10 * d1 - 6 * v0 - 4 * v1 - 3 * a0 + a1
    c4 = -15 * d1 + 8 * v0 + 7 * v1 + 3 * a0 - 2 * a1
    c5 = 6 * d1 - 3 * v0 - 3 * v1 - a0 + a1
    return (
        q[k] + s * v0 + s2 * a0 + s3 * (c3 + s * (c4 + s * c5)),
        (v0 + 2 * s * a0 + s2 * (3 * c3 + s * (4 * c4 + s * 5 * c5))) / step,
        (2 * a0 + s * (6 * c3 + s * (12 * c4 + s * 20 * c5))) / step**2,
    )


def draw_sensor_errors(
    arm: Arm, rng: np.random.Generator, noise: float = 1.0, imperfect_mounting: bool = False
) -> SensorErrors:
    """Draw the bench's sensor errors.

    Parameters
    ----------
    arm : Arm
    rng : Generator
    noise : float
        Factor on white noise (0.02 m/s^2 rms a sample) and bias (0.02 m/s^2 rms an axis); 0 for neither.
    imperfect_mounting : bool
        Add 0.3 degrees of misalignment, 0.3 % of scale and 0.5 mm of position, all rms.
    """
    shape = (len(arm.sensors), 3)
    mounting = float(imperfect_mounting)
    return SensorErrors(
        noise_m_s2=0.02 * noise,
        bias_m_s2=0.02 * noise * rng.normal(size=shape),
        scale=1.0 + 0.003 * mounting * rng.normal(size=shape),
        misalignment_rad=np.deg2rad(0.3) * mounting * rng.normal(size=shape),
        offset_m=0.0005 * mounting * rng.normal(size=shape),
    )


def with_errors(arm: Arm, errors: SensorErrors) -> Arm:
    """Return the arm with its sensors where and as they really sit, and what they really read; all but noise."""
    sensors = [
        replace(
            sensor,
            position_m=tuple(np.add(sensor.position_m, errors.offset_m[k]).tolist()),
            rotation_rad=tuple(np.add(sensor.rotation_rad, errors.misalignment_rad[k]).tolist()),
            scale=tuple(np.multiply(sensor.scale, errors.scale[k]).tolist()),
            bias_m_s2=tuple(np.add(sensor.bias_m_s2, errors.bias_m_s2[k]).tolist()),
        )
        for k, sensor in enumerate(arm.sensors)
    ]
    return replace(arm, sensors=tuple(sensors))


class Sensors:
    """The sensors of an arm and their converters, over motions that follow each other on one clock.

    The element and its charge amplifier scale the specific force and, where they are AC-coupled, forget it; bias
    and noise are the converter's and stay.

    Parameters
    ----------
    arm : Arm
        As its file has it; scale, bias and corner of its sensors count as well, and so do its effects.
    errors : SensorErrors
    rate_hz : float
        Of the motions' samples.
    rng : Generator
        Draws the noise.
    """

    def __init__(self, arm: Arm, errors: SensorErrors, rate_hz: float, rng: np.random.Generator) -> None:
        self._arm = with_errors(changed(arm), errors)
        self._effects = SensorEffects(self._arm, rate_hz)
        self._scale = np.ravel([sensor.scale for sensor in self._arm.sensors])
        self._bias_m_s2 = np.ravel([sensor.bias_m_s2 for sensor in self._arm.sensors])
        self._high_pass = HighPass(np.repeat([sensor.highpass_hz for sensor in self._arm.sensors], 3), rate_hz)
        self._noise_m_s2 = errors.noise_m_s2
        self._rng = rng

    def counts(self, motion: Motion) -> NDArray[np.int16]:
        """Return what the converters give out: 16 bits over +-5 g, clipped.

        Returns
        -------
        (n_sample, 3 * n_sensor)
            Multiply by `COUNT_M_S2` for m/s^2.
        """
        links = (motion.q, motion.dq, motion.ddq)
        if isinstance(motion, GearedMotion):
            links = (motion.link_q, motion.link_dq, motion.link_ddq)
        force = self._effects.felt(specific_force(self._arm, *links), links[0])
        a = force.reshape(len(force), -1)
        a *= self._scale
        self._high_pass.apply(a)
        a += self._bias_m_s2
        a = self._effects.read(force).reshape(len(force), -1)
        if self._noise_m_s2 > 0.0:
            a += self._noise_m_s2 * self._rng.standard_normal(a.shape)
        a = self._effects.converted(force).reshape(len(force), -1)
        return np.clip(np.rint(a / COUNT_M_S2), -32768, 32767).astype(np.int16)
