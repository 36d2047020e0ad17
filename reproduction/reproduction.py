"""All of the paper's experiments: which there are, and running several of them side by side."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import ModuleType

import fitter.single_thread  # noqa: F401 - the processes that it starts inherit it
from fitter.parallel.spawned import in_order, tell
from fitter.report.figures import png
from limbcal.errors import LimbcalError
from reproduction import fig6, fig7, fig8, table1, table2, table3, table4, table5, table6
from reproduction.experiment import Experiment, Settings, silent

#: In the paper's order.
EXPERIMENTS: dict[str, ModuleType] = {
    "table1": table1,
    "table2": table2,
    "table3": table3,
    "table4": table4,
    "table5": table5,
    "table6": table6,
    "fig6": fig6,
    "fig7": fig7,
    "fig8": fig8,
}
#: Those that share the readings of the sensed bench run in one process, which keeps them; the longest come first.
_TOGETHER = (
    ("table1",),
    ("fig8", "fig7", "table2"),
    ("fig6",),
    ("table3",),
    ("table6",),
    ("table5",),
    ("table4",),
)

#: Told an experiment's name, and what is being done.
Progress = Callable[[str, str], None]


@dataclass(frozen=True)
class Outcome:
    """What came of an experiment: its tables and its pictures as PNG; or why there are none.

    Attributes
    ----------
    name : str
    experiment : Experiment or None
        Its figures stay where it was run.
    pictures : tuple of (bytes, str)
        PNG and caption.
    error : LimbcalError or None
    """

    name: str
    experiment: Experiment | None
    pictures: tuple[tuple[bytes, str], ...] = ()
    error: LimbcalError | None = None


def reproduce(names: Sequence[str], settings: Settings, jobs: int, progress: Progress) -> list[Outcome]:
    """Run some experiments.

    Parameters
    ----------
    names : sequence of str
        Of `EXPERIMENTS`.
    settings : Settings
        Its own ``progress`` is not used.
    jobs : int
        Processes, of which no more are started than there are groups of experiments that share their data.
    progress : callable

    Returns
    -------
    list of Outcome
        In the paper's order. One that failed does not stop the others.
    """
    groups = [tuple(name for name in group if name in names) for group in _TOGETHER]
    groups = [group for group in groups if group]
    work = partial(_run_group, settings=replace(settings, progress=silent))
    found = [outcome for outcomes in in_order(work, groups, jobs, hear=progress) for outcome in outcomes]
    order = list(EXPERIMENTS)
    return sorted(found, key=lambda outcome: order.index(outcome.name))


def run_one(name: str, settings: Settings) -> Outcome:
    """Run one experiment and render its pictures."""
    run: Callable[[Settings], Experiment] = EXPERIMENTS[name].run
    try:
        found = run(settings)
    except LimbcalError as error:
        return Outcome(name, None, error=error)
    pictures = tuple((png(picture.figure), picture.caption) for picture in found.pictures)
    return Outcome(name, replace(found, pictures=()), pictures)


def _run_group(names: Sequence[str], settings: Settings) -> list[Outcome]:
    outcomes = []
    for name in names:

        def said(what: str, of: str = name) -> None:
            tell(of, what)

        outcomes.append(run_one(name, replace(settings, progress=said)))
        tell(name, "")
    return outcomes
