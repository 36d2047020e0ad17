"""`limbplay serve`: a recorded or simulated motion, streamed on its own time."""

import argparse
import math
import time
from contextlib import ExitStack
from pathlib import Path

import zmq

from arm.arm_file import load_arm
from limbcal.command import Document, say
from limbcal.errors import ConfigError
from limbcal.notify import notify
from limbcal.real_time import PLAYER, ask_for_real_time
from playback.commands.source_options import DEFAULT_ARM, add_source_arguments, open_source
from playback.control_message import DEFAULT_CONTROL
from playback.live import LivePlayer
from playback.player import Player
from playback.playhead import Clocks
from playback.server import Server
from protocol.curve import gate_of, load_client_key
from protocol.message import FRAMES
from protocol.subscriber import Subscriber

DEFAULT_ENDPOINT = "tcp://127.0.0.1:5772"
DEFAULT_LIVE = "tcp://127.0.0.1:5770"
MAX_RATE_HZ = 1000.0

#: As it stands in the help.
EXAMPLE = "limbplay serve motion.csv --arm calibrated.toml"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `limbplay serve` takes."""
    add_source_arguments(parser)
    parser.add_argument(
        "--live",
        nargs="?",
        const=DEFAULT_LIVE,
        metavar="E",
        help=f"in place of SOURCE: pass on what a daemon publishes there ({DEFAULT_LIVE})",
    )
    parser.add_argument("--key", type=Path, metavar="FILE", help="client's key, where the daemon asks for one")
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
    clocks = Clocks(time.monotonic, time.time_ns)
    with ExitStack() as stack:
        context = stack.enter_context(zmq.Context())
        player = _player(arguments, rate_hz, clocks, context, stack)
        ask_for_real_time(PLAYER, context)  # what took long, reading and compiling, is done
        gate = stack.enter_context(gate_of(context, arguments.keys))
        server = stack.enter_context(
            Server(context, player, clocks, time.sleep, arguments.endpoint, arguments.control, gate)
        )
        trials = f": {len(player.source.trials)} trial(s)" if isinstance(player, Player) else ""
        say(f"{player.name}{trials} on {server.endpoint}, control on {server.control}")
        if arguments.play:
            player.play()
        notify(READY=1, STATUS=f"serving {player.name} on {server.endpoint}")
        try:
            server.serve(once=arguments.once)
        except KeyboardInterrupt:  # a stop that was asked for still has an answer
            say("stopped")
        return server.state()


def _player(
    arguments: argparse.Namespace,
    rate_hz: float,
    clocks: Clocks,
    context: "zmq.Context[zmq.Socket[bytes]]",
    stack: ExitStack,
) -> Player | LivePlayer:
    if arguments.live is None:
        return Player(open_source(arguments), rate_hz, clocks, arguments.trial)
    for name in ("source", "reference", "twin", "trial", "columns"):
        if getattr(arguments, name) is not None:
            raise ConfigError(f"--live and {name} are both given: a live stream is played as it comes")
    if arguments.once:
        raise ConfigError("--live and --once are both given: a live stream has no end to leave at")
    if arguments.arm is None:
        say(f"no --arm given: what moves is taken for {DEFAULT_ARM}")
    arm = load_arm(arguments.arm or DEFAULT_ARM)
    key = None if arguments.key is None else load_client_key(arguments.key)
    subscriber = stack.enter_context(Subscriber(context, arguments.live, [FRAMES], key, watched=True))
    return LivePlayer(subscriber, arguments.live, arm)
