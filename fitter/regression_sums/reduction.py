"""Recordings of any length to torque sums, in one pass and in bounded memory."""

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from arm.base_parameters import BaseParameters
from arm.model import Arm
from arm.structural_parameters import structural_parameters
from fitter.data.derived_trial import derive
from fitter.data.plausibility.questions import questioned
from fitter.data.reading import Reading, find_corner_hz, stretches_of
from fitter.data.recordings import by_run
from fitter.data.resample import Uniform, resample, split_at_holes
from fitter.data.standstill import REST_SPEED
from fitter.data.stretches import Stretch
from fitter.data.torque_target import has_unknown_target
from fitter.data.trial import Role
from fitter.data.trial_filter import FIT_CORNER
from fitter.data.trials import require_period
from fitter.parallel.spawned import in_order
from fitter.regression_sums.running_sums import RunningSums
from fitter.regression_sums.saved_sums import ArmSums, equation_of
from fitter.regression_sums.torque_sums import TorqueSums, add_up, finished
from fitter.regression_sums.trial_sums import add_stretch, trial_sums
from limbcal.errors import DataError
from limbcal.note import Note, of_source
from protocol.tables.columns import parse_mapping
from protocol.tables.files import expand


@dataclass(frozen=True)
class Reduced:
    """A file's sums.

    Attributes
    ----------
    sums : TorqueSums or None
        Of its learning trials in the file's order; None if it holds evaluating ones only.
    trials : tuple of str
        Their names.
    notes : tuple of Note
        What was done to each.
    longest_s : float
        Length of the longest of them [s].
    """

    sums: TorqueSums | None
    trials: tuple[str, ...]
    notes: tuple[Note, ...]
    longest_s: float


@dataclass(frozen=True)
class Reduction:
    """A set of trials as sums, and what was done to get there.

    Attributes
    ----------
    saved : ArmSums
    cutoff_hz, band_hz : float
        The corners of both filters; infinite where nothing was filtered.
    notes : tuple of Note
    """

    saved: ArmSums
    cutoff_hz: float
    band_hz: float
    notes: tuple[Note, ...]


def reduce_trials(
    arm: Arm,
    sources: Sequence[Path],
    *,
    columns: str | None = None,
    rate_hz: float | None = None,
    cutoff_hz: float | None = None,
    omitted: Role | None = "evaluate",
    as_tracked: bool = False,
    rest_speed: float = REST_SPEED,
    workers: int = 1,
    dask: str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Reduction:
    """Reduce a set of learning trials, file by file and in bounded memory.

    Files are independent of each other once the corner of their filter is known. It is found in a first pass over
    the set, or as much of it as memory allows; the notes say so. Whoever reduces a file, its sums stand in the
    order of the files: any number of processes and a cluster give the same bytes as one process does.

    Parameters
    ----------
    arm : Arm
        Its geometry, gravity and control law.
    sources : sequence of Path
        Files and folders.
    columns, rate_hz, cutoff_hz, as_tracked
        As in `fitter.data.trials.load_trials`.
    omitted : {"learn", "evaluate"}, optional
        Trials that a recording marks so are omitted; None where trials of other files are held back.
    rest_speed : float [rad/s or m/s]
    workers, dask
        As in `fitter.parallel.spawned.in_order`.
    progress : callable, optional
        Called after every file: how many are done, and of how many.

    Raises
    ------
    ConfigError
        If an argument is wrong.
    DataError
        If a file cannot be read or used.
    """
    parse_mapping(columns, arm.n_joint)
    equation, files = equation_of(arm, rest_speed), [path.absolute() for path in expand(sources)]
    notes: list[Note] = []
    if cutoff_hz is None:
        cutoff_hz, samples = find_corner_hz(files, arm.n_joint, columns, rate_hz)
        if samples is not None:
            said = f"the corner of {cutoff_hz:.4g} Hz was found in the first {samples} samples"
            notes.append(Note("filtered", said))
    reading = Reading(
        columns, rate_hz, cutoff_hz, FIT_CORNER * cutoff_hz, omitted=omitted, again=None if as_tracked else arm
    )
    parts: list[TorqueSums] = []
    trials: list[str] = []
    longest_s = 0.0
    work, runs = partial(reduce_file, arm, rest_speed, reading), by_run(files)
    with closing(in_order(work, runs, workers, dask)) as results:  # closed: whatever happens, no process stays
        for done, reduced in enumerate(results, 1):
            notes += reduced.notes
            longest_s = max(longest_s, reduced.longest_s)
            if reduced.sums is not None:
                parts.append(reduced.sums)
                trials += reduced.trials
            if progress is not None:
                progress(done, len(runs))
    if not parts:
        raise DataError(f"{', '.join(map(str, files))}: no learning trial in it")
    require_period(cutoff_hz, longest_s)
    saved = ArmSums(equation, add_up(parts), tuple(trials))
    return Reduction(saved, cutoff_hz, reading.band_hz, tuple(notes))


def reduce_file(arm: Arm, rest_speed: float, reading: Reading, files: Sequence[Path]) -> Reduced:
    """Reduce one file, or the recordings of one run.

    Raises
    ------
    DataError
        If it cannot be read or has no torque where the law is "measured".
    """
    base = structural_parameters(arm)
    parts: list[TorqueSums] = []
    trials: list[str] = []
    notes: list[Note] = []
    long: RunningSums | None = None
    long_s = longest_s = 0.0
    for stretch in stretches_of(files, arm.n_joint, reading):
        if stretch.whole:
            (motion,) = questioned([stretch.motion], arm)
            for piece in split_at_holes(motion):
                uniform = resample(piece, reading.rate_hz)
                longest_s = max(longest_s, len(uniform.measured.t) * uniform.dt_s)
                trial = derive(uniform, reading.cutoff_hz, reading.band_hz)
                parts.append(trial_sums(arm, base, trial, rest_speed))
                trials.append(trial.name)
                notes += of_source(trial.notes, trial.name)
            continue
        if long is None:
            long_s = 0.0
            questioned([stretch.motion], arm)  # what is wrong with a column's unit shows in its beginning
            long = RunningSums(arm.n_joint, len(base.independent))
        said = _add(long, arm, base, rest_speed, reading, stretch)
        long_s += (stretch.counted.stop - stretch.counted.start) * stretch.step_s
        if stretch.ends:
            parts.append(finished(long))
            longest_s = max(longest_s, long_s)
            trials.append(stretch.motion.name)
            notes += of_source(said, stretch.motion.name)
            long = None
    return Reduced(add_up(parts) if parts else None, tuple(trials), tuple(notes), longest_s)


def _add(
    long: RunningSums, arm: Arm, base: BaseParameters, rest_speed: float, reading: Reading, stretch: Stretch
) -> tuple[Note, ...]:
    """Add what counts of a stretch, and return what was done to it."""
    trial = derive(Uniform(stretch.motion, stretch.step_s), reading.cutoff_hz, reading.band_hz)
    if has_unknown_target(arm, trial):
        raise DataError(
            f"{stretch.motion.where}: trial {trial.name!r} goes on for more than {long.samples + len(trial.q)} "
            "samples and has no target; expected columns ref1…, or trials that are one motion each"
        )
    begin = max(0, stretch.counted.start - trial.trimmed)
    end = min(len(trial.q), stretch.counted.stop - trial.trimmed)
    add_stretch(long, arm, base, trial, slice(0, len(trial.q)), slice(begin, end), rest_speed)
    return trial.notes
