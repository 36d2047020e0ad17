"""`fitter sensors`: what sensors read and where they sit, from ordinary motions."""

import argparse
from pathlib import Path

import numpy as np
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from arm.arm_file import save_arm
from fitter.commands.arm_option import questioned_arm
from fitter.commands.options import add_arm, add_columns, add_out, joint_values, make_room, positive
from fitter.data.raw import load_raw
from fitter.report.parameter_table import parameter_table
from fitter.sensing.sensors import SensorsFit, fit_sensors
from fitter.sensing.verdict import DOUBTED
from limbcal.command import Document, console, say, say_notes, show
from limbcal.note import documents, of_source
from tracking.model.initial_state import MountingPrior

_PRIOR = MountingPrior()

#: As it stands in the help.
EXAMPLE = "fitter sensors readings.csv --arm my-arm.toml --out sensed.toml"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter sensors` takes."""
    parser.add_argument("data", nargs="+", type=Path, metavar="DATA", help="raw accelerations: files or folders")
    add_arm(parser)
    parser.add_argument("--initial-q", metavar="Q1,…", help="where the arm rests at the start [rad or m]")
    for option, unit, default in (
        ("--scale-std", "scale", _PRIOR.scale),
        ("--turn-std-deg", "mounting angles [deg]", round(np.rad2deg(_PRIOR.turn_rad), 1)),
        ("--place-std-mm", "places [mm]", 1e3 * _PRIOR.place_m),
    ):
        parser.add_argument(
            option,
            type=positive,
            default=default,
            metavar="S",
            help=f"standard deviation of the sensors' {unit} from what the arm file says ({default:g})",
        )
    parser.add_argument(
        "--highpass-hz",
        type=positive,
        metavar="F",
        help="all sensors are AC-coupled with about this corner, which is to be found (as the arm file says)",
    )
    add_columns(parser)
    add_out(parser, "the arm with its sensors as found, as an arm file")
    parser.set_defaults(action=sensors)


def sensors(arguments: argparse.Namespace) -> Document:
    """Calibrate the sensors and write the arm."""
    arm = questioned_arm(arguments.arm)
    names = [sensor.name for sensor in arm.sensors]
    runs = load_raw(
        arguments.data,
        names,
        arm.n_joint,
        arguments.columns,
        rate_hz=arguments.rate_hz,
        arm=arm,
        as_filed=False,
    )
    given = arguments.initial_q
    q0 = None if given is None else joint_values(given, arm, "--initial-q")
    prior = MountingPrior(
        arguments.scale_std, float(np.deg2rad(arguments.turn_std_deg)), 1e-3 * arguments.place_std_mm
    )
    make_room(arguments.out, read=arguments.data)
    notes = [note for run in runs for note in of_source(run.notes, run.name)]
    say_notes(notes)
    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("filtering", total=None)
        fit = fit_sensors(
            arm,
            runs,
            q0,
            prior,
            highpass_hz=arguments.highpass_hz,
            progress=lambda done: progress.update(task, description=f"smoothing: pass {done} done"),
        )
    save_arm(fit.arm, arguments.out)
    _print(fit)
    show(f"sensors of {fit.samples} readings -> {arguments.out}")
    return {**fit.document(), "out": str(arguments.out), "notes": documents(notes)}


def _print(fit: SensorsFit) -> None:
    for sensor, numbers in fit.parameters().items():
        show(parameter_table(f"{fit.arm.name}: {sensor}", numbers, {}))
    found = fit.calibration
    for name, axes in found.axes.items():
        say(f"warning: {name} is turned against its file: its x, y, z are the file's {axes}")
    if found.hidden:
        show("not revealed by this motion:")
        for sentence in found.hidden:
            show(f"  {sentence}")
    show(f"{100 * found.doubted:.2g} % of the instants fit no motion of the arm; {found.passes} passes")
    if (lacks := found.discrepancy) is not None:
        base = f", and its base moves by {lacks.base_std:.2g} m/s^2" if lacks.base_std else ""
        say(
            f"warning: however its sensors sit, the readings differ from arm {fit.arm.name!r} by "
            f"{lacks.lack_std:.2g} m/s^2 rms beyond the sensors' noise{base} (play, flex, impacts, clocks); the "
            "intervals allow for that"
        )
    elif found.doubted > DOUBTED:
        say(
            f"warning: these readings contradict arm {fit.arm.name!r}; check its joints, and whether a sensor is "
            "loose or sits on another link than its file says"
        )
