"""The samples of a plan are sent a quarter of a second at a time, with the truth of a stretch once."""

from dataclasses import replace
from multiprocessing import Pipe
from threading import Thread

import numpy as np

from arm.arm_file import load_arm
from arm.model import Control
from daemon.virtual_device.bench_plan import BenchPlan
from daemon.virtual_device.motion_pieces import send_pieces
from daemon.virtual_device.virtual_motion import stretches
from limbcal.errors import LimbcalError

RATE_HZ, PIECE = 500.0, 125
PLAN = BenchPlan(load_arm("dd-arm"), 4, RATE_HZ, trials=1)


def test_pieces_are_the_stretches_and_end_when_nobody_takes_them() -> None:
    receiver, sender = Pipe(duplex=False)
    process = Thread(target=send_pieces, args=(sender, PLAN))
    process.start()
    whole = next(iter(stretches(PLAN)))
    pieces = [receiver.recv() for _ in range(4)]
    receiver.close()
    process.join()  # a broken pipe ends it
    sender.close()
    assert [len(piece.counts) for piece in pieces] == [PIECE] * 4
    np.testing.assert_array_equal(np.concatenate([piece.counts for piece in pieces]), whole.counts[: 4 * PIECE])
    assert [bool(piece.truth) for piece in pieces] == [True, False, False, False]


def test_why_there_is_no_motion_is_sent_in_its_stead() -> None:
    receiver, sender = Pipe(duplex=False)
    with receiver, sender:
        send_pieces(sender, replace(PLAN, arm=replace(PLAN.arm, control=Control())))
        assert isinstance(receiver.recv(), LimbcalError)
