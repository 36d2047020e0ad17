"""`limbd zero`: what the accelerometers read while the arm rests, less what gravity shows them there."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from rich.table import Table
from rich.text import Text

from arm.accelerometer import specific_force
from arm.arm_file import preset_names, save_arm
from arm.model import Arm, Floats
from daemon.config.config import Setup
from daemon.zero_offset.sample_burst import sample_burst
from limbcal.command import say, show
from limbcal.digits import NORMAL_95, with_half_width
from limbcal.errors import ConfigError, NotIdentifiable
from tracking.model.noise import noise_of

#: Length of a mean [s]: long enough to average out the hum of motors that hold the arm, at 50 Hz and above.
_CELL_S = 0.1
#: An accelerometer's zero wanders by about this much within seconds [m/s^2].
_WANDER_M_S2 = 0.002
#: Standard deviations, of noise and wander together, beyond which it is a motion: by chance once in 1.7 million.
_SIGMAS = 5.0
#: More than any accelerometer's zero is off by [m/s^2]: a convention.
_INCREDIBLE_M_S2 = 3.0
#: Of a bias in the arm file [m/s^2]: a tenth of a microgee.
_DECIMALS = 6


@dataclass(frozen=True)
class RestBias:
    """What is to be taken off the sensors' readings, and its standard error; both (n_sensor, 3) [m/s^2]."""

    bias_m_s2: Floats
    std: Floats


def bias_at_rest(arm: Arm, q: Floats, readings: Floats, rate_hz: float) -> RestBias:
    """Return what the sensors of a resting arm read beyond gravity.

    Parameters
    ----------
    arm : Arm
        Says how its sensors are turned, and their scale; an AC-coupled one does not feel gravity.
    q : (n_joint,)
        Where the arm rests.
    readings : (n_sample, 3 * n_sensor) [m/s^2]
        Half a second or more.
    rate_hz : float

    Raises
    ------
    NotIdentifiable
        If the arm moves.
    """
    size = max(1, round(_CELL_S * rate_hz))
    n_cell = len(readings) // size
    cells = readings[: n_cell * size].reshape(n_cell, size, -1).mean(axis=1)
    noise = noise_of(readings, rate_hz)
    _check_rest(arm, cells, np.sqrt(noise.of_mean(size) + _WANDER_M_S2**2))
    std = np.sqrt(cells.var(axis=0, ddof=1) / n_cell + noise.rounding)
    scale = np.array([sensor.scale for sensor in arm.sensors])
    feels_gravity = np.array([[sensor.highpass_hz == 0.0] for sensor in arm.sensors])
    still = np.zeros((1, arm.n_joint))
    gravity = feels_gravity * scale * specific_force(arm, q[None], still, still)[0]
    return RestBias(cells.mean(axis=0).reshape(-1, 3) - gravity, std.reshape(-1, 3))


def zero_sensors(setup: Setup, seconds: float, out: Path | None) -> dict[str, object]:
    """Measure the sensors' biases, write them into an arm file and show them; return the JSON document.

    Raises
    ------
    ConfigError
        If there is no file to write to, or the device is not the arm's.
    DeviceError
        If the device fails or the file cannot be written.
    NotIdentifiable
        If the arm moves.
    """
    arm, config = setup.arm, setup.config
    if out is None and config.arm.file in preset_names():
        raise ConfigError(f"arm {config.arm.file!r} is built in and cannot be written, expected --out FILE")
    out = Path(config.arm.file) if out is None else out
    q = np.zeros(arm.n_joint) if setup.initial_q_rad is None else setup.initial_q_rad
    rate_hz, readings = sample_burst(config.device.port, config.device.baud, arm, seconds)
    readings = readings[:, : 3 * len(arm.sensors)]  # the filter learns a gyroscope's offset in any rest
    found = bias_at_rest(arm, q, readings, rate_hz)
    bias = np.round(found.bias_m_s2, _DECIMALS)
    sensors = [replace(s, bias_m_s2=tuple(b.tolist())) for s, b in zip(arm.sensors, bias, strict=True)]
    save_arm(replace(arm, sensors=tuple(sensors)), out)
    _show(arm, bias, found.std, out)
    return {
        "out": str(out),
        "seconds": len(readings) / rate_hz,
        "samples": len(readings),
        "sensors": {
            sensor.name: {"bias_m_s2": b, "std": std}
            for sensor, b, std in zip(arm.sensors, bias, found.std, strict=True)
        },
    }


def _check_rest(arm: Arm, cells: Floats, sigma: Floats) -> None:
    """Raise if the readings did not stay what they are.

    A tracker's detector takes a quarter of a second for a rest and says no more than yes or no; here seconds of
    readings must be one rest, in spite of humming motors, and who moved the arm must hear where it shows.
    """
    off = np.abs(cells - np.median(cells, axis=0))
    row, channel = np.unravel_index(np.argmax(off / sigma), off.shape)
    if off[row, channel] > _SIGMAS * sigma[channel]:
        name = f"{arm.sensors[channel // 3].name}{'xyz'[channel % 3]}"
        raise NotIdentifiable(
            f"the arm moves: {name} is {off[row, channel]:.3g} m/s² off its median after {row * _CELL_S:.1f} s, "
            f"expected less than {_SIGMAS * sigma[channel]:.2g} m/s² while it rests"
        )


def _show(arm: Arm, bias: Floats, std: Floats, out: Path) -> None:
    table = Table(title="bias, m/s², ± half of the 95 % interval")
    for title in ("sensor", "x", "y", "z"):
        table.add_column(title, justify="left" if title == "sensor" else "right")
    for sensor, b, error in zip(arm.sensors, bias, std, strict=True):
        half_widths = NORMAL_95 * error
        cells = [" ± ".join(with_half_width(*pair)) for pair in zip(b, half_widths, strict=True)]
        table.add_row(Text(sensor.name), *cells)
    show(table)
    for sensor, b in zip(arm.sensors, bias, strict=True):
        if np.abs(b).max() > _INCREDIBLE_M_S2:
            say(
                f"warning: {sensor.name} is off by {np.abs(b).max():.1f} m/s², more than accelerometers are: does "
                "the arm rest at tracking.initial_q_rad, and is the sensor turned as the arm file says?"
            )
    show(f"written to {out}")
