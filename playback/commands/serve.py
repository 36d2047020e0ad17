"""`limbplay serve`: a recorded or simulated motion, streamed on its own time."""

import argparse
import math
import time
from contextlib import ExitStack
from pathlib import Path

import zmq

from arm.arm_file import load_arm
from limbcal.command import Document, console
from limbcal.errors import ConfigError
from limbcal.notify import notify
from playback.file_source import file_source
from playback.player import Clocks, Player
from playback.recording_source import recording_source
from playback.server import Server
from playback.simulated_source import simulated_source
from playback.source import Source
from protocol.curve import gate_of
from protocol.motion_file import SUFFIXES

DEFAULT_ENDPOINT = "tcp://127.0.0.1:5772"
DEFAULT_CONTROL = "tcp://127.0.0.1:5773"
DEFAULT_ARM = "dd-arm"
MAX_RATE_HZ = 1000.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `limbplay serve` takes."""
    parser.add_argument(
        "source",
        nargs="?",
        type=Path,
        metavar="SOURCE",
        help="a recording of limbd (.mcap) or joint motion (.csv, .npz, .parquet) to play",
    )
    parser.add_argument(
        "--arm",
        metavar="ARM",
        help="arm file or built-in arm; by default the recording's own, and dd-arm for joint motion",
    )
    parser.add_argument(
        "--reference",
        type=Path,
        metavar="FILE",
        help="in place of SOURCE: columns t, ref1… that the arm follows in a simulation under its law",
    )
    parser.add_argument("--trial", type=int, metavar="N", help="trial to load first, by default the lowest")
    parser.add_argument("--rate-hz", type=float, default=100.0, metavar="R", help="messages a second (100)")
    parser.add_argument(
        "--endpoint", default=DEFAULT_ENDPOINT, metavar="E", help=f"where to publish ({DEFAULT_ENDPOINT})"
    )
    parser.add_argument(
        "--control", default=DEFAULT_CONTROL, metavar="E", help=f"where to take requests ({DEFAULT_CONTROL})"
    )
    parser.add_argument(
        "--keys", type=Path, metavar="DIR", help="let in only whom `limbd keys new` has listed here"
    )
    parser.add_argument("--play", action="store_true", help="start at once, without waiting for a request")
    parser.add_argument("--once", action="store_true", help="leave when a trial was played to its end")
    parser.set_defaults(action=serve)


def serve(arguments: argparse.Namespace) -> Document:
    """Serve until stopped, or once; the answer is the state at the end."""
    rate_hz = arguments.rate_hz
    if not (math.isfinite(rate_hz) and 0.0 < rate_hz <= MAX_RATE_HZ):
        raise ConfigError(f"--rate-hz is {rate_hz:g}, expected above 0 and at most {MAX_RATE_HZ:g}")
    source = _open_source(arguments.source, arguments.reference, arguments.arm)
    clocks = Clocks(time.monotonic, time.time_ns)
    player = Player(source, rate_hz, clocks, arguments.trial)
    with ExitStack() as stack:
        context = stack.enter_context(zmq.Context())
        gate = stack.enter_context(gate_of(context, arguments.keys))
        server = stack.enter_context(
            Server(context, player, clocks, time.sleep, arguments.endpoint, arguments.control, gate)
        )
        _say(f"{source.name}: {len(source.trials)} trial(s) on {server.endpoint}, control on {server.control}")
        if arguments.play:
            player.play()
        notify(READY=1, STATUS=f"serving {source.name} on {server.endpoint}")
        try:
            server.serve(once=arguments.once)
        except KeyboardInterrupt:  # a stop that was asked for still has an answer
            _say("stopped")
        return server.state()


def _open_source(path: Path | None, reference: Path | None, arm: str | None) -> Source:
    if (path is None) == (reference is None):
        found = "neither is given" if path is None else "both are given"
        raise ConfigError(f"limbplay serve takes either SOURCE or --reference, but {found}")
    if reference is not None:
        if arm is None:
            raise ConfigError("--arm is missing: --reference needs the arm that is to be simulated")
        return simulated_source(reference, load_arm(arm))
    assert path is not None  # the first check leaves nothing else
    if path.suffix.lower() == ".mcap":
        return recording_source(path, None if arm is None else load_arm(arm), _say)
    if path.suffix.lower() not in SUFFIXES:
        expected = ", ".join((".mcap", *SUFFIXES))
        raise ConfigError(f"{path}: the suffix is {path.suffix!r}, expected one of {expected}")
    if arm is None:
        _say(f"no --arm given: tip and points are those of {DEFAULT_ARM}")
    return file_source(path, load_arm(arm or DEFAULT_ARM))


def _say(sentence: str) -> None:
    console.print(sentence, markup=False, soft_wrap=True)
