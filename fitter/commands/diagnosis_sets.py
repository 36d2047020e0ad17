"""The trials that `fitter diagnose` learns from, evaluates on and judges by: three sets that share nothing."""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from arm.model import Arm
from fitter.data.motions import Measured
from fitter.data.trials import read_set
from limbcal.errors import ConfigError
from protocol.tables.files import expand

#: Rows that two sets of one file may share by chance: at a rest, or at two starts that are alike.
_BY_CHANCE = 32
_USED = {"": "learnt from", "--evaluate": "evaluated on"}


@dataclass(frozen=True)
class TrialSet:
    """Where one set of trials is.

    Attributes
    ----------
    option : str
        How it is asked for; nothing for the learning trials.
    sources : sequence of Path
    columns : str or None
        Its mapping of foreign columns.
    as_tracked : bool
        Take the motions of recordings as the tracker gave them out, not estimated again.
    """

    option: str
    sources: Sequence[Path]
    columns: str | None
    as_tracked: bool = False

    def only(self, source: Path) -> "TrialSet":
        """Return what is of one of its sources."""
        return replace(self, sources=[source])

    def read(self, arm: Arm, rate_hz: float | None) -> list[Measured]:
        """Return its trials, questioned; none where there are no sources."""
        if not self.sources:
            return []
        return read_set(
            self.sources, arm.n_joint, self.columns, rate_hz=rate_hz, arm=arm, as_tracked=self.as_tracked
        )


def add_sets(parser: argparse.ArgumentParser) -> None:
    """Add the sets that are held back, and mappings of their own."""
    parser.add_argument(
        "--evaluate",
        nargs="+",
        type=Path,
        default=[],
        metavar="EVAL",
        help="trials to judge on, held back (those that a recording marks as evaluating)",
    )
    parser.add_argument(
        "--judge",
        nargs="+",
        type=Path,
        default=[],
        metavar="SET",
        help="further trials that have no say in anything: the arm found is only compared with them",
    )
    for name in ("evaluate", "judge"):
        parser.add_argument(
            f"--{name}-columns",
            metavar="MAP",
            help=f"where the columns of --{name} are, if elsewhere than --columns says: other cells of one file",
        )


def sets_of(arguments: argparse.Namespace) -> tuple[TrialSet, TrialSet, TrialSet]:
    """Return the sets for learning, evaluating and judging.

    Raises
    ------
    ConfigError
        If a file is in two sets by the same columns, or a mapping is of no set.
    """
    columns: str | None = arguments.columns
    as_tracked: bool = arguments.as_tracked
    sets = [TrialSet("", arguments.learn, columns, as_tracked)]
    for name in ("evaluate", "judge"):
        sources, own = getattr(arguments, name), getattr(arguments, f"{name}_columns")
        if own is not None and not sources:
            raise ConfigError(f"--{name}-columns is given without --{name}, expected both")
        sets.append(TrialSet(f"--{name}", sources, columns if own is None else own, as_tracked))
    for first, second in ((0, 1), (0, 2), (1, 2)):
        _require_apart(sets[first], sets[second])
    return sets[0], sets[1], sets[2]


def require_other_samples(sets: Sequence[tuple[TrialSet, Sequence[Measured]]]) -> None:
    """Raise a ConfigError where two sets take the same samples out of one file, by mappings that differ.

    Parameters
    ----------
    sets : sequence of (TrialSet, trials)
    """
    for k, (first, learnt) in enumerate(sets):
        for second, held_back in sets[k + 1 :]:
            for one in learnt:
                for other in held_back:
                    if one.where == other.where and one.role == other.role and _overlap(one, other):
                        raise ConfigError(
                            f"{second.option}: {other.name} has samples that are {_USED[first.option]}, "
                            "expected trials that have none in common"
                        )


def _require_apart(first: TrialSet, second: TrialSet) -> None:
    if not first.sources or not second.sources or first.columns != second.columns:
        return
    held_back = {path.resolve() for path in expand(second.sources)}
    both = [str(path) for path in expand(first.sources) if path.resolve() in held_back]
    if both:
        raise ConfigError(f"{second.option}: {both[0]} is {_USED[first.option]}, expected trials that are not")


def _overlap(one: Measured, other: Measured) -> bool:
    """Say whether two motions share a run of moving samples."""
    a, b = (np.ascontiguousarray(motion.columns["q"]) for motion in (one, other))
    runs = {
        part.tobytes()
        for part in (a[k : k + _BY_CHANCE] for k in range(0, len(a) - _BY_CHANCE + 1, _BY_CHANCE))
        if np.all(np.ptp(part, axis=0) > 0.0)
    }
    return any(b[k : k + _BY_CHANCE].tobytes() in runs for k in range(len(b) - _BY_CHANCE + 1))
