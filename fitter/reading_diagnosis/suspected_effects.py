"""The effects that a sensor may show: what each changes, and its columns.

A column is the slope of the expected reading by a parameter, or minus that of the reading where the effect is
undone there.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.model import Floats
from fitter.reading_diagnosis.linearisation import Instruments, Linearisation, added, turn_by_angles
from fitter.reading_diagnosis.sensor_frames import TrialFrames
from fitter.reading_diagnosis.sensor_hypotheses import Change, Columns, SensorEffect, bias_columns
from tracking.model.observation import MOUNTING


def _drift_columns(at: Linearisation, sensor: int) -> Floats:
    return bias_columns(at, sensor) * at.trial.t[:, None, None]


def _mounting_columns(at: Linearisation, sensor: int, first: int) -> Floats:
    begin = int(at.of.mounting_column[sensor]) + first
    return at.slope[:, :, begin : begin + 3]


def _scale_columns(at: Linearisation, sensor: int) -> Floats:
    scaled: Floats = _mounting_columns(at, sensor, 0) * np.array(at.instruments.arm.sensors[sensor].scale)
    return scaled


def _turn_columns(at: Linearisation, sensor: int) -> Floats:
    turned: Floats = _mounting_columns(at, sensor, 3) @ turn_by_angles(at.instruments.arm.sensors[sensor])
    return turned


def _place_columns(at: Linearisation, sensor: int) -> Floats:
    return _mounting_columns(at, sensor, MOUNTING - 3)


def _single(at: Linearisation, sensor: int, of_channels: Floats) -> Floats:
    column = np.zeros((*at.expected.shape, 1))
    column[:, 3 * sensor : 3 * sensor + 3, 0] = of_channels[:, 3 * sensor : 3 * sensor + 3]
    return column


def _delay_columns(at: Linearisation, sensor: int) -> Floats:
    return _single(at, sensor, -np.gradient(at.expected, at.trial.dt_s, axis=0))


def _corner_columns(at: Linearisation, sensor: int) -> Floats:
    return _single(at, sensor, -2.0 * np.pi * at.integral)


def _level_columns(at: Linearisation, sensor: int) -> Floats:
    return _single(at, sensor, at.clipped)


def _base_columns(at: Linearisation, _sensor: int) -> Floats:
    phase = 2.0 * np.pi * at.instruments.base_hz * at.trial.t
    felt = at.from_base()
    c, s = np.cos(phase)[:, None, None], np.sin(phase)[:, None, None]
    wave = (
        2.0
        * np.pi
        * at.trial.t[:, None]
        * (
            -np.sin(phase)[:, None] * at.instruments.base[:, 0]
            + np.cos(phase)[:, None] * at.instruments.base[:, 1]
        )
    )
    by_frequency = np.einsum("kcx,kx->kc", felt, wave)[..., None]
    return np.concatenate([felt * c, felt * s, by_frequency], axis=2)


def _changed_base(instruments: Instruments, _sensor: int, value: Floats) -> Instruments:
    return replace(instruments, base=value[:6].reshape(2, 3).T.copy(), base_hz=float(value[6]))


def _unchanged(instruments: Instruments, _sensor: int, _value: Floats) -> Instruments:
    return instruments


def _no_columns(at: Linearisation, _sensor: int) -> Floats:
    return np.empty((*at.expected.shape, 0))


def _tilt_columns(at: Linearisation, _sensor: int) -> Floats:
    return -at.from_base()[..., :2]


def _changed_gravity(instruments: Instruments, _sensor: int, value: Floats) -> Instruments:
    gravity = added(instruments.arm.gravity_m_s2, np.array([value[0], value[1], 0.0]))
    return replace(instruments, arm=replace(instruments.arm, gravity_m_s2=gravity))


def _changed_bias(instruments: Instruments, sensor: int, value: Floats) -> Instruments:
    return instruments.with_sensor(sensor, bias_m_s2=added(instruments.arm.sensors[sensor].bias_m_s2, value))


def _changed_drift(instruments: Instruments, sensor: int, value: Floats) -> Instruments:
    return instruments.with_entry("drift", sensor, instruments.drift[sensor] + value)


def _changed_scale(instruments: Instruments, sensor: int, value: Floats) -> Instruments:
    was = np.array(instruments.arm.sensors[sensor].scale)
    return instruments.with_sensor(sensor, scale=added((0.0, 0.0, 0.0), was * value))


def _changed_rotation(instruments: Instruments, sensor: int, value: Floats) -> Instruments:
    return instruments.with_sensor(sensor, rotation_rad=added(instruments.arm.sensors[sensor].rotation_rad, value))


def _changed_place(instruments: Instruments, sensor: int, value: Floats) -> Instruments:
    return instruments.with_sensor(sensor, position_m=added(instruments.arm.sensors[sensor].position_m, value))


def _changed_corner(instruments: Instruments, sensor: int, value: Floats) -> Instruments:
    return instruments.with_entry("corner_hz", sensor, max(float(value[0]), 0.0))


def _changed_level(instruments: Instruments, sensor: int, value: Floats) -> Instruments:
    return instruments.with_entry("level", sensor, float(value[0]))


def _changed_delay(instruments: Instruments, sensor: int, value: Floats) -> Instruments:
    return instruments.with_entry("delay_s", sensor, float(value[0]))


def _first_corner(
    _trials: Sequence[TrialFrames], nominal: Instruments, sensor: int, first_hz: float = 0.05
) -> Floats | None:
    return None if nominal.corner_hz[sensor] > 0.0 else np.array([first_hz])


def _first_level(trials: Sequence[TrialFrames], _nominal: Instruments, sensor: int) -> Floats:
    """Return the largest frame that a sensor reads, less what noise adds to it."""
    channels = slice(3 * sensor, 3 * sensor + 3)
    top = max(float(np.nanmax(np.abs(trial.values[:, channels]))) for trial in trials)
    return np.array([top - 2.0 * float(trials[0].std[channels].max())])


def _kind(
    name: str, parameters: str, unit: str, before: tuple[float, float], change: Change, columns: Columns
) -> SensorEffect:
    """Return an effect with numbers of the same kind: what is neutral, and how far from there they may be."""
    named = tuple((parameter, unit) for parameter in parameters.split())
    neutral, spread = ((one,) * len(named) for one in before)
    return SensorEffect(name, named, neutral, spread, change, columns)


#: A base moves with one frequency, or in any way.
EFFECTS = (
    replace(
        _kind("sensor_bias", "x_m_s2 y_m_s2 z_m_s2", "m/s^2", (0.0, 3.0), _changed_bias, bias_columns),
        is_bias=True,
    ),
    _kind("sensor_drift", "x_m_s3 y_m_s3 z_m_s3", "m/s^3", (0.0, 1.0), _changed_drift, _drift_columns),
    _kind("sensor_scale", "x y z", "1", (1.0, 1.0), _changed_scale, _scale_columns),
    _kind(
        "sensor_misalignment", "roll_rad pitch_rad yaw_rad", "rad", (0.0, 1.0), _changed_rotation, _turn_columns
    ),
    _kind("mounting_radius", "x_m y_m z_m", "m", (0.0, 0.3), _changed_place, _place_columns),
    replace(
        _kind("sensor_highpass", "corner_hz", "Hz", (0.0, 5.0), _changed_corner, _corner_columns),
        first=_first_corner,
        least=0.003,  # Hz: a lower one forgets nothing in the time of a trial
    ),
    replace(
        _kind("sensor_clipping", "level_m_s2", "m/s^2", (np.inf, 50.0), _changed_level, _level_columns),
        first=_first_level,
        is_level=True,
        is_blinding=True,
        grain="step",
    ),
    replace(
        _kind("time_skew", "delay_s", "s", (0.0, 0.1), _changed_delay, _delay_columns),
        is_blinding=True,
        grain="interval",
    ),
    SensorEffect(
        "base_motion",
        (*((f"{axis}_{part}", "m/s^2") for part in ("cos", "sin") for axis in "xyz"), ("frequency_hz", "Hz")),
        (0.0,) * 6 + (np.inf,),
        (5.0,) * 6 + (0.1,),
        _changed_base,
        _base_columns,
        whole=True,
    ),
    SensorEffect("base_motion", (), (), (), _unchanged, _no_columns, whole=True, frees_base=True),
    replace(
        _kind("gravity_tilt", "gx_m_s2 gy_m_s2", "m/s^2", (0.0, 3.0), _changed_gravity, _tilt_columns), whole=True
    ),
)
