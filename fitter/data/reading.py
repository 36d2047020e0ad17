"""Sets of learning trials of any length, read motion by motion or stretch by stretch."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm
from fitter.data.blocks import read_blocks
from fitter.data.estimated_again import recorded_motions
from fitter.data.motions import Measured
from fitter.data.recordings import by_run, read_frames
from fitter.data.resample import Uniform, resample, split_at_holes
from fitter.data.stretches import Stretch, stretches
from fitter.data.trial import Role
from fitter.data.trial_filter import choose_cutoff_hz
from fitter.data.windows import SPLINE_SAMPLES, forgetting_samples
from limbcal.errors import DataError
from protocol.tables.columns import parse_mapping
from protocol.tables.files import RECORDINGS, expand

Floats = NDArray[np.float64]

#: Rows read at a time.
BLOCK_ROWS = 65_536
#: Joint values of a stretch, samples times joints: some 200 bytes each while it is filtered and reduced.
STRETCH_VALUES = 500_000
#: Joint values in which the corner is looked for, so that this is of bounded memory too.
CORNER_VALUES = 4_000_000


@dataclass(frozen=True)
class Reading:
    """How files are read and filtered.

    Attributes
    ----------
    columns : str, optional
        Mapping of foreign columns.
    rate_hz : float, optional
        Rate to resample to.
    cutoff_hz, band_hz : float
        Corners of the filter of derived columns and of the fit's, see `fitter.data.trials.load_trials`.
    stretch : int
        Joint values of a longer motion are reduced stretch by stretch.
    omitted : {"learn", "evaluate"}, optional
        Motions of recordings with this role are passed over.
    again : Arm, optional
        Motions of recordings are estimated again as this arm's; as the tracker gave them out unless given.
    """

    columns: str | None = None
    rate_hz: float | None = None
    cutoff_hz: float = np.inf
    band_hz: float = np.inf
    stretch: int = STRETCH_VALUES
    omitted: Role | None = "evaluate"
    again: Arm | None = None


def find_corner_hz(
    sources: Sequence[Path], n_joint: int, columns: str | None = None, rate_hz: float | None = None
) -> tuple[float, int | None]:
    """Find the corner of the filter of derived columns, as `load_trials` does but in bounded memory.

    Returns
    -------
    corner_hz : float
        Infinite where nothing is to be filtered: the motion fills its range, or comes from a tracker.
    samples : int or None
        In how many samples it was looked for, the set's first ones, if not in all.
    """
    files = expand(sources)
    if all(path.suffix.lower() in RECORDINGS for path in files):
        return np.inf, None  # a tracker's motion is smooth already
    budget = CORNER_VALUES // n_joint
    reading = Reading(columns, rate_hz, stretch=CORNER_VALUES)
    motions: list[Measured] = []
    seen = 0
    runs = by_run(files)
    for stretch in (part for one in runs for part in stretches_of(one, n_joint, reading, only_nearest=True)):
        if seen >= budget or not stretch.begins:
            return choose_cutoff_hz(_uniform(motions, rate_hz)), seen
        motions.append(stretch.motion)
        seen += len(stretch.motion.t)
    if not motions:
        raise DataError(f"{', '.join(map(str, files))}: no learning trial in it")
    return choose_cutoff_hz(_uniform(motions, rate_hz)), None


def _uniform(motions: Sequence[Measured], rate_hz: float | None) -> list[Uniform]:
    return [resample(piece, rate_hz) for motion in motions for piece in split_at_holes(motion)]


def stretches_of(
    files: Sequence[Path], n_joint: int, reading: Reading, only_nearest: bool = False
) -> Iterator[Stretch]:
    """Read the trials of a file, or of the recordings of one run, but those omitted.

    Of each only the columns nearest to an acceleration are read, if no more is wanted.
    """
    path = files[0]
    if path.suffix.lower() in RECORDINGS:
        again = reading.again
        for motion in read_frames(files, n_joint) if again is None else recorded_motions(files, again):
            if reading.omitted is None or motion.role != reading.omitted:
                yield Stretch(motion, slice(0, len(motion.t)), True, True)
        return
    blocks = read_blocks(path, n_joint, parse_mapping(reading.columns, n_joint), reading.rate_hz, BLOCK_ROWS)
    if only_nearest:
        blocks = (replace(block, columns=_nearest(block)) for block in blocks)

    def margin(step_s: float) -> int:
        return forgetting_samples(step_s, reading.cutoff_hz, reading.band_hz) + SPLINE_SAMPLES

    yield from stretches(blocks, max(1, reading.stretch // n_joint), margin, reading.rate_hz)


def _nearest(block: Measured) -> dict[str, Floats]:
    name = next(name for name in ("ddq", "dq", "q") if name in block.columns)
    return {name: block.columns[name]}
