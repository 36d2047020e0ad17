"""Ledgers of samples and the frames that are entered in them."""

import numpy as np

from daemon.reception.sample_ledger import SampleLedger
from protocol.serial_frame import SamplesFrame


def frames(n: int, first_sequence: int, rate_hz: float, tick_hz: float, samples: int = 32) -> list[SamplesFrame]:
    counts = np.zeros((samples, 12), dtype=np.int16)
    return [
        SamplesFrame((first_sequence + k) % 2**32, round(1000 + k * samples * tick_hz / rate_hz), counts)
        for k in range(n)
    ]


def entered(ledger: SampleLedger, frame: SamplesFrame) -> int:
    lost = ledger.missing(frame)
    assert lost is not None
    ledger.enter(frame, lost)
    return lost


def frame_at(sequence: int, ticks: int, samples: int = 32) -> SamplesFrame:
    return SamplesFrame(sequence % 2**32, ticks, np.zeros((samples, 12), dtype=np.int16))


def after(first: SamplesFrame, rate_hz: float = 8000.0, tick_hz: float = 1e6) -> SampleLedger:
    """Return a ledger into which one frame was entered; 125 ticks a sample, 4000 a frame."""
    ledger = SampleLedger(rate_hz, tick_hz)
    ledger.enter(first, 0)
    return ledger
