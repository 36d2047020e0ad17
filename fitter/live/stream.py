"""Motions cut out of a stream of frames, as `limb/trial` announces them."""

from collections import deque
from collections.abc import Mapping
from typing import Any

import numpy as np

from fitter.data.block_times import block_times
from fitter.data.drift import DriftCorrection, dead_reckoned
from fitter.data.felt import REST_S, felt_of
from fitter.data.motions import Measured
from limbcal.errors import ProtocolError
from limbcal.note import Note
from protocol.message import FRAMES, TRIAL

#: Frames are kept for at most this long before a motion is announced, which is up to a second after it began [s].
_MEMORY_S = REST_S + 1.0
_COLUMNS = ("q", "dq", "ddq", "points")


class MotionAssembler:
    """Gathers frames and gives out each motion when it has ended, without the drift of dead reckoning.

    Attributes
    ----------
    frames : int
        Frames received.
    trial, role : int, str
        Of the motion that is under way or was last; 0 and "" before the first.
    moving : bool
    """

    def __init__(self) -> None:
        self.frames = 0
        self.trial = 0
        self.role = ""
        self._begin_ns = 0
        self._run: object = None
        self._forget()

    def _forget(self) -> None:
        """Begin anew: what a daemon says before and after its restart has no clock or angle in common."""
        self.moving = False
        self._blocks: deque[Mapping[str, Any]] = deque()
        self._drift = DriftCorrection()
        self._ended_ns = -np.inf

    def feed(self, topic: str, fields: Mapping[str, Any]) -> Measured | None:
        """Take in a message and give out the motion that it completes.

        Raises
        ------
        ProtocolError
            If a field is missing or does not fit.
        """
        if fields.get("run") != self._run:
            self._run = fields.get("run")
            self._forget()
        try:
            if topic == FRAMES:
                self._take(fields)
            elif topic == TRIAL:
                return self._phase(fields)
        except (LookupError, TypeError, ValueError) as error:
            raise ProtocolError(f"{topic}: a field is missing or does not fit ({error})") from error
        return None

    def _take(self, fields: Mapping[str, Any]) -> None:
        n = int(fields["n"])
        if any(len(fields[name]) != n for name in _COLUMNS):
            raise ValueError(f"n is {n}, expected the length of {', '.join(_COLUMNS)}")
        self.frames += n
        self._blocks.append(fields)
        self._prune()

    def _prune(self) -> None:
        """Keep no more frames than the next motion may need: it may begin before it is announced."""
        while not self.moving and self._blocks[-1]["t0_ns"] - self._blocks[0]["t0_ns"] > _MEMORY_S * 1e9:
            self._blocks.popleft()

    def _phase(self, fields: Mapping[str, Any]) -> Measured | None:
        if fields["state"] == "begin":
            self.trial, self.role = int(fields["trial"]), str(fields["role"])
            self.moving, self._begin_ns = True, int(fields["t_ns"])
            return None
        if fields["state"] != "end":
            raise ValueError(f"state is {fields['state']!r}, expected 'begin' or 'end'")
        began, self.moving = self.moving and int(fields["trial"]) == self.trial, False
        if not began:  # the subscription came in the middle of a motion, or its beginning was missed
            return None
        motion = self._cut(int(fields["t_ns"]))
        if self._blocks:
            self._prune()
        return motion

    def _cut(self, end_ns: int) -> Measured | None:
        blocks = [block for block in self._blocks if block["n"]]
        if not blocks:
            return None
        fields = ([block[name] for block in blocks] for name in ("frame0", "n", "t0_ns", "dt_s"))
        t_ns = np.round(block_times(*fields))
        inside = (t_ns >= self._begin_ns) & (t_ns <= end_ns)
        if not inside.any():
            return None
        columns = {name: np.concatenate([block[name] for block in blocks])[inside] for name in _COLUMNS}
        shapes = {name: values.shape for name, values in columns.items()}
        if not shapes["q"] == shapes["dq"] == shapes["ddq"] or len(shapes["q"]) != 2 or len(shapes["points"]) != 3:
            raise ValueError(f"shapes are {shapes}")
        rows = np.cumsum([0, *(block["n"] for block in blocks)])
        lost = sum(
            bool(block["gap"]) and bool(inside[begin:end].any())
            for block, begin, end in zip(blocks, rows[:-1], rows[1:], strict=True)
        )
        notes = (Note("lost", f"{lost} block(s) of frames after lost samples"),) if lost else ()
        t = (t_ns[inside] - self._begin_ns) * 1e-9
        columns = self._drift.moving(t, columns, dead_reckoned(blocks[0]["method"]))
        felt = felt_of(blocks, self._ended_ns, self._begin_ns, end_ns)
        self._ended_ns = end_ns
        return Measured(f"trial {self.trial}", "stream", 0, t, columns, role=self.role, notes=notes, felt=felt)
