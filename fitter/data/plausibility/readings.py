"""Raw readings: in g, without gravity or with gravity turned round, in degrees a second, time in milliseconds."""

import numpy as np

from arm.accelerometer import specific_force
from arm.model import Arm, Floats
from fitter.data.motions import Measured
from fitter.data.plausibility.refusal import Refusal
from fitter.data.sensor_files import AXES, gyro_axes, gyro_role
from protocol.tables.magnitude import Size, likely

#: Samples in which a sensor's rest is sought: the window that scatters least.
_WINDOW = 32
#: Relative error of gravity as read at rest: 5 % of scale (data sheets of uncalibrated parts) and some motion.
_OF_GRAVITY = 0.1
#: Fraction of gravity below which a reading at rest is a bias: gravity was taken off.
_NOTHING = 0.05
#: Readings in these units are multiplied by this to give m/s².
_UNITS = {"g": 9.80665, "mg": 9.80665e-3}
#: Rate of accelerometers in files: 40 Hz (a watch's) to 25 kHz (a vibration sensor's).
_RATE_HZ = Size(1000.0, 0.7)
#: Top speed of a sensor on a limb or robot: 0.06 to 15 m/s.
_SPEED = Size(1.0, 0.6)
_TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
#: Gyroscopes of chips measure no more: 2000 degrees a second [rad/s].
_FASTEST_RAD_S = 35.0
#: Poses that stand for any pose.
_POSES = 64


def look(motion: Measured, arm: Arm, as_filed: bool = True) -> Measured:
    """Return raw readings, or refuse them where they cannot be m/s² of specific force or rad/s over seconds.

    Parameters
    ----------
    motion : Measured
    arm : Arm
    as_filed : bool
        Sensors are turned as the arm file says. Where that is still to be found, gravity downwards is how they are
        turned.

    Raises
    ------
    Refusal
        With the likely cause.
    """
    for sensor in arm.sensors:
        _require_radians(motion, sensor.name)
    a = motion.columns.get("a")
    gravity = float(np.linalg.norm(arm.gravity_m_s2))
    if a is None or len(a) < 4 * _WINDOW or any(sensor.highpass_hz > 0.0 for sensor in arm.sensors):
        return motion
    stated = any(f"{sensor.name}{axis}" in motion.stated for sensor in arm.sensors for axis in AXES)
    rest = _felt(resting(a), arm)
    if gravity > 0.0 and not stated:
        _require_unit(motion, rest, gravity)
    if gravity > 0.0 and as_filed:
        _require_sign(motion, rest, arm, gravity)
    if "t" not in motion.stated:
        _require_seconds(motion, arm, a)
    return motion


def resting(a: Floats) -> Floats:
    """Return what each sensor reads where it is quietest, (n_sensor, 3)."""
    n = len(a) // _WINDOW
    windows = a[: n * _WINDOW].reshape(n, _WINDOW, -1)
    means, scatter = windows.mean(axis=1), windows.var(axis=1)
    quietest = np.argmin(scatter.sum(axis=1))
    return np.asarray(means[quietest].reshape(-1, 3), dtype=np.float64)


def _felt(rest: Floats, arm: Arm) -> Floats:
    """Return what sensors feel that read this, (n_sensor, 3), by the arm file's scales and offsets."""
    bias = np.array([sensor.bias_m_s2 for sensor in arm.sensors])
    scale = np.array([sensor.scale for sensor in arm.sensors])
    felt: Floats = (rest - bias) / scale
    return felt


def _require_radians(motion: Measured, sensor: str) -> None:
    w, axes = motion.columns.get(gyro_role(sensor)), gyro_axes(sensor)
    if w is None or motion.stated & {*axes}:
        return
    fastest = float(np.abs(w).max(initial=0.0))
    if fastest > _FASTEST_RAD_S:
        raise Refusal(
            f"{motion.where}: the gyroscope of sensor {sensor!r} reads up to {fastest:.4g}: is it in deg/s? "
            f'Expected rad/s, or the unit stated, as in --columns "{axes[0]}={axes[0]}:deg,…"'
        )


def _require_unit(motion: Measured, rest: Floats, gravity: float) -> None:
    size = float(np.median(np.linalg.norm(rest, axis=1)))
    for unit, scale in _UNITS.items():
        if abs(size * scale / gravity - 1.0) < _OF_GRAVITY:
            raise Refusal(
                f"{motion.where}: at rest the sensors read {size:.4g}: are they in {unit}? Expected m/s², "
                f'{gravity:.4g} at rest, or the unit stated, as in --columns "s1x=s1x:g,…"'
            )
    if size < _NOTHING * gravity:
        raise Refusal(
            f"{motion.where}: at rest the sensors read {size:.2g} m/s²: readings without gravity? Expected "
            f"specific force, which is {gravity:.4g} m/s² upwards at rest; a sensor that is AC-coupled needs "
            "highpass_hz in the arm file, and one that was set to zero at rest needs bias_m_s2 there: what was "
            "taken off, with its sign reversed"
        )


def _require_sign(motion: Measured, rest: Floats, arm: Arm, gravity: float) -> None:
    """Refuse readings whose gravity points the other way, where that does not depend on the pose."""
    predicted = _at_rest(arm)
    mean = predicted.mean(axis=0)
    fixed = np.linalg.norm(mean, axis=1) > 0.9 * gravity
    if not fixed.any():
        return
    along = np.einsum("sk,sk->s", rest[fixed], mean[fixed]) / np.einsum("sk,sk->s", mean[fixed], mean[fixed])
    if np.all(np.abs(along + 1.0) < _OF_GRAVITY):
        raise Refusal(
            f"{motion.where}: at rest the sensors read gravity downwards: is its sign turned round, in the "
            f"readings or in gravity_m_s2 of arm {arm.name}? Expected specific force, {gravity:.4g} m/s² upwards"
        )


def _require_seconds(motion: Measured, arm: Arm, a: Floats) -> None:
    step_s = float(np.median(np.diff(motion.t)))
    if not step_s > 0.0:
        return
    steady = np.ptp(_at_rest(arm), axis=0).ravel() < 1e-3
    still = a[:, steady] - a[:, steady].mean(axis=0)
    speed = float(np.abs(np.cumsum(still, axis=0)).max() * step_s) if steady.any() else 0.0

    def log_likelihood(scale: float) -> float:
        return _RATE_HZ.log_likelihood(1.0 / (step_s * scale)) + _SPEED.log_likelihood(speed * scale)

    unit = likely({unit: log_likelihood(scale) for unit, scale in _TIMES.items()}, "s")
    if unit is not None:
        raise Refusal(
            f"{motion.where}: a sample comes every {step_s:.4g} s: is t in {unit}? Expected seconds, or its unit "
            f'stated, as in --columns "t=t:{unit}" (t=t:s if it is seconds)'
        )


def _at_rest(arm: Arm) -> Floats:
    """Return what ideal sensors read at rest in any pose, (n_pose, n_sensor, 3)."""
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (_POSES, arm.n_joint))
    return specific_force(arm, q, np.zeros_like(q), np.zeros_like(q))
