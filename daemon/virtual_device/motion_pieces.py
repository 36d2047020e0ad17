"""The process that computes the virtual arm's samples, see `daemon.virtual_device.motion_source`."""

from collections.abc import Iterator
from dataclasses import replace
from multiprocessing.connection import Connection

from daemon.virtual_device.bench_plan import BenchPlan, Stretch
from daemon.virtual_device.virtual_motion import stretches
from limbcal.compilation import said_when_compiling
from limbcal.errors import LimbcalError

#: Handed over a quarter of a second at a time: taking one delays the stream by a fraction of a millisecond.
_PIECE_S = 0.25


def send_pieces(sender: Connection, plan: BenchPlan) -> None:
    """Send one piece after the other, or why there is none, for as long as somebody takes them."""
    try:
        pieces = _pieces(plan)
        with said_when_compiling("limbd virtual"):
            sender.send(next(pieces))
        for piece in pieces:
            sender.send(piece)  # waits until the device wants more; its end ends this process too
    except LimbcalError as error:
        sender.send(error)
    except BrokenPipeError:
        return


def _pieces(plan: BenchPlan) -> Iterator[Stretch]:
    size = max(1, round(_PIECE_S * plan.rate_hz))
    for stretch in stretches(plan):
        for begin in range(0, len(stretch.counts), size):
            truth = stretch.truth if begin == 0 else {}
            yield replace(stretch, counts=stretch.counts[begin : begin + size], truth=truth)
