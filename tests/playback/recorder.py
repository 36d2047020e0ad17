"""A made-up motion, recorded as the daemon would."""

import uuid
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from arm.arm_file import format_arm
from arm.model import Arm
from protocol.message import FRAMES, TRIAL, encode
from protocol.recording import RecordingWriter

START_NS = 1_700_000_000_000_000_000
DT_S = 1e-3
BLOCK = 10


def motion(k: np.ndarray) -> np.ndarray:
    return np.column_stack([np.sin(0.01 * k), np.cos(0.02 * k)])


class Recorder:
    """Records a made-up motion into one file."""

    def __init__(self, path: Path, arm: Arm, run: str | None = None) -> None:
        self.writer = RecordingWriter(path, format_arm(arm), "")
        self.common = {"arm": arm.name, "run": run or str(uuid.uuid4())}

    def write(self, topic: str, t_ns: int, fields: Mapping[str, object]) -> None:
        self.writer.write(topic, encode(topic, {**self.common, "seq": 0, **fields})[1], t_ns)

    def block(self, frame0: int, n: int = BLOCK, *, gap: bool = False, **other: object) -> None:
        q = motion(np.arange(frame0, frame0 + n))
        t0_ns = START_NS + frame0 * 1_000_000
        fields = {"frame0": frame0, "t0_ns": t0_ns, "dt_s": DT_S, "n": n, "method": "integrate", "gap": gap}
        fields |= {"q": q, "dq": 2 * q, "ddq": 3 * q, "tip": np.zeros((n, 3)), "points": np.zeros((n, 4, 3))}
        self.write(FRAMES, t0_ns, fields | other)

    def blocks(self, first: int, end: int) -> None:
        for frame0 in range(first, end, BLOCK):
            self.block(frame0)

    def mark(self, state: str, trial: int, frame: int) -> None:
        t_ns = START_NS + frame * 1_000_000
        self.write(TRIAL, t_ns, {"trial": trial, "t_ns": t_ns, "state": state, "role": "learn"})
