"""`limbplay touch`: the calibrated arm, simulated in real time and felt."""

import argparse
import math
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from arm.arm_file import load_arm
from arm.model import Arm, Floats
from limbcal.command import Document, say
from limbcal.errors import ConfigError
from limbcal.notify import notify
from playback.touch.hand import VirtualHand
from playback.touch.limit import Coupling
from playback.touch.process import TouchProcess

DEFAULT_ENDPOINT = "tcp://127.0.0.1:5772"
DEFAULT_HAPTIC = "tcp://127.0.0.1:5774"
DEFAULT_ARM = "dd-arm"
_HEARTBEAT_S = 1.0
_ASKED = Coupling()
_FIELDS = {
    "stiffness": "stiffness",
    "damping": "damping",
    "device-damping": "device",
    "max-force": "max_force",
}

#: As it stands in the help.
EXAMPLE = "limbplay touch --arm calibrated.toml --device virtual"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `limbplay touch` takes."""
    parser.add_argument(
        "--arm", default=DEFAULT_ARM, metavar="ARM", help=f"arm file or built-in arm ({DEFAULT_ARM})"
    )
    parser.add_argument("--q0", metavar="Q1,Q2,…", help="where it rests at first, rad or m (all zero)")
    parser.add_argument(
        "--device",
        choices=("none", "virtual"),
        default="none",
        help="virtual: a simulated hand touches, pulls and lets go; none: wait for a device on --haptic",
    )
    parser.add_argument("--rate-hz", type=float, default=1000.0, metavar="R", help="ticks a second (1000)")
    parser.add_argument("--seconds", type=float, metavar="S", help="how long, by default until stopped")
    for name, unit, what in (
        ("stiffness", "N/m", "of the coupling"),
        ("damping", "N s/m", "of the coupling"),
        ("device-damping", "N s/m", "that device and hand have of their own, at least"),
        ("max-force", "N", "that the hand feels at most"),
    ):
        default = getattr(_ASKED, _FIELDS[name])
        parser.add_argument(
            f"--{name}", type=float, default=default, metavar="X", help=f"{unit}, {what} ({default:g})"
        )
    parser.add_argument(
        "--wall", metavar="NX,NY,NZ,C", help="a plane that stops the hand, which is free where n.x >= C (m)"
    )
    parser.add_argument(
        "--wall-stiffness", type=float, metavar="X", help="N/m, of the wall (the stiffest that is passive)"
    )
    parser.add_argument(
        "--endpoint", default=DEFAULT_ENDPOINT, metavar="E", help=f"where to publish ({DEFAULT_ENDPOINT})"
    )
    parser.add_argument(
        "--haptic", default=DEFAULT_HAPTIC, metavar="E", help=f"where devices speak ({DEFAULT_HAPTIC})"
    )
    parser.add_argument(
        "--keys", type=Path, metavar="DIR", help="let in only whom `limbd keys new` has listed here"
    )
    parser.set_defaults(action=touch)


def touch(arguments: argparse.Namespace) -> Document:
    """Run until stopped, or for a time [s]; the answer is how well it went."""
    seconds = math.inf if arguments.seconds is None else arguments.seconds
    if not seconds > 0.0:
        raise ConfigError(f"--seconds is {seconds:g}, expected above 0")
    if arguments.device == "virtual" and arguments.keys is not None:
        raise ConfigError("--device virtual has no key; expected --keys without it, and a device that has one")
    arm = load_arm(arguments.arm)
    process = TouchProcess(
        arm,
        _start(arm, arguments.q0),
        arguments.rate_hz,
        _coupling(arguments),
        arguments.endpoint,
        arguments.haptic,
        arguments.keys,
    )
    hand: VirtualHand | None = None
    summary: dict[str, Any] = {}
    try:
        with ExitStack() as stack:
            stack.callback(lambda: summary.update(process.close()))
            say(f"{arm.name}: preparing the simulation")
            process.start()
            say(f"{arm.name} on {process.endpoint}, devices on {process.haptic}")
            if not process.health()["real_time"]:
                say("real-time scheduling is not allowed here (limit of real-time priority): ticks may come late")
            if arguments.device == "virtual":
                hand = VirtualHand(process.haptic, rate_hz=arguments.rate_hz)
                stack.callback(lambda: summary.update(hand=hand.close()))
                hand.start()
            notify(READY=1, STATUS=f"touching {arm.name} on {process.haptic}")
            _watch(process, hand, seconds)
    except KeyboardInterrupt:  # a stop that was asked for still has an answer
        say("stopped")
    return {"arm": arm.name, "endpoint": process.endpoint, "haptic": process.haptic, **summary}


def _watch(process: TouchProcess, hand: VirtualHand | None, seconds: float) -> None:
    """Say once a second how it goes, until it is time."""
    end_s = time.monotonic() + seconds
    while (left_s := end_s - time.monotonic()) > 0.0:
        time.sleep(min(_HEARTBEAT_S, left_s))
        health = process.wait_health()
        if hand is not None:
            hand.check()
        notify(WATCHDOG=1, STATUS=_words(health))
        say(_words(health))


def _words(health: dict[str, Any]) -> str:
    late, step, energy = health["lateness_ms"], health["step_us"], health["energy_J"]
    held = f"{health['force_N']:.2f} N" if health["connected"] else "nobody touches it"
    balance = "passive" if energy["passive"] else "NOT passive"
    if health["resets"]:
        balance += f", ran away {health['resets']} time(s) and was put back: expected gains that go with the step"
    return (
        f"{health['held_rate_hz']:.2f} Hz, late p99 {late['p99'] or 0.0:.3f} ms (max {late['max'] or 0.0:.3f}), "
        f"step p99 {step['p99'] or 0.0:.0f} us, {health['stiffness_N_m']:.0f} N/m, {held}, {balance}"
    )


def _numbers(name: str, text: str, n: int) -> Floats:
    try:
        values = np.array([float(part) for part in text.split(",")])
    except ValueError as error:
        raise ConfigError(f"{name} is {text!r}, expected {n} numbers with commas between them") from error
    if len(values) != n or not np.isfinite(values).all():
        raise ConfigError(f"{name} is {text!r}, expected {n} numbers with commas between them")
    return values


def _start(arm: Arm, text: str | None) -> Floats | None:
    return None if text is None else _numbers("--q0", text, arm.n_joint)


def _coupling(arguments: argparse.Namespace) -> Coupling:
    wall = None
    if arguments.wall is not None:
        x, y, z, offset = _numbers("--wall", arguments.wall, 4).tolist()
        wall = (x, y, z, offset)
    return Coupling(
        stiffness=arguments.stiffness,
        damping=arguments.damping,
        device=arguments.device_damping,
        max_force=arguments.max_force,
        wall=wall,
        wall_stiffness=arguments.wall_stiffness,
    )
