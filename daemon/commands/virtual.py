"""`limbd virtual`."""

import argparse
import math
from pathlib import Path

from daemon.commands.options import not_negative, positive, whole
from daemon.virtual_device.fault_schedule import KINDS, faults_of

#: As it stands in the help.
EXAMPLE = "limbd virtual --link device --trials 5"
#: Beyond this it is no clock any more.
_MOST_PPM = 500_000.0
#: Number of samples of ten sensors that fit in a payload of at most 65535 bytes.
_MOST_SAMPLES = 1024


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    add = parser.add_argument
    add("--link", type=Path, metavar="PATH", help="make a symbolic link to the port")
    add("--arm", default="dd-arm", metavar="A", help="arm file or built-in arm (default dd-arm)")
    add("--seed", type=whole, default=0, metavar="N", help="draws motions and sensors' errors")
    add("--rate-hz", type=positive, default=32000.0, metavar="R", help="what INFO says (default 32000)")
    add("--sampled-hz", type=positive, metavar="R", help="the rate that it really has, by an honest clock")
    add("--clock-ppm", type=_ppm, default=0.0, metavar="P", help="its clock is fast by this, and samples with it")
    add("--wraps-s", type=not_negative, metavar="S", help="a tick counter of 32 bits that passes zero after S")
    add("--frame-samples", type=_frame, default=32, metavar="N", help="samples in a frame (default 32)")
    add("--speed", type=positive, default=1.0, metavar="X", help="times faster than real time")
    add("--trials", type=whole, default=22, metavar="N", help="motions before it rests (default 22)")
    add("--noise", type=not_negative, default=1.0, metavar="F", help="factor on noise and bias")
    add("--quiet-sensors", dest="noise", action="store_const", const=0.0, help="no noise and no bias")
    add("--imperfect-mounting", action="store_true", help="sensors sit not quite where they should")
    add(
        "--highpass-hz",
        type=not_negative,
        metavar="F",
        help="AC-couple all sensors, with this corner (default: as the arm file says)",
    )
    add(
        "--fault",
        default="",
        metavar="SCHEDULE",
        help="what goes wrong and when, as in 'unplug@5+1/3, flip@0+60*1e-5'; kinds: " + ", ".join(KINDS),
    )
    add("--patient", action="store_true", help="wait while the host does not read, instead of losing frames")
    add("--truth", type=Path, metavar="FILE", help="write the true motion here (.npz) at the end")
    parser.set_defaults(action=be_device)


def be_device(arguments: argparse.Namespace) -> None:
    """Be a device until a stop is asked for."""
    from arm.arm_file import load_arm
    from daemon.virtual_device.bench_plan import BenchPlan
    from daemon.virtual_device.virtual_device import Timing
    from daemon.virtual_device.virtual_loop import VirtualOptions, serve

    clock = 1.0 + 1e-6 * arguments.clock_ppm
    sampled_hz = clock * (arguments.sampled_hz or arguments.rate_hz)
    timing = Timing(sampled_hz, clock, arguments.wraps_s, arguments.frame_samples)
    plan = BenchPlan(
        arm=load_arm(arguments.arm),
        seed=arguments.seed,
        rate_hz=sampled_hz,
        trials=arguments.trials,
        noise=arguments.noise,
        imperfect_mounting=arguments.imperfect_mounting,
        highpass_hz=arguments.highpass_hz,
    )
    faults = faults_of(arguments.fault)
    serve(
        VirtualOptions(
            plan=plan,
            claimed_hz=arguments.rate_hz,
            timing=timing,
            speed=arguments.speed,
            link=arguments.link,
            truth=arguments.truth,
            as_json=arguments.json,
            faults=faults,
            patient=arguments.patient,
        )
    )


def _ppm(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not abs(value) <= _MOST_PPM:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from -{_MOST_PPM:g} to {_MOST_PPM:g}")
    return value


def _frame(text: str) -> int:
    value = whole(text)
    if not 1 <= value <= _MOST_SAMPLES:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 1 to {_MOST_SAMPLES}")
    return value
