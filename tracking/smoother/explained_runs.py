"""Several recordings with the same sensors, smoothed one after the other; what one showed is known to the next."""

from collections.abc import Callable, Sequence

from arm.model import Arm, Floats
from limbcal.errors import DataError
from tracking.model.initial_state import MountingPrior
from tracking.model.readings import Readings
from tracking.smoother.discrepancy_smoother import DiscrepancySmoother
from tracking.smoother.smoothed import Smoothed
from tracking.smoother.smoother import Smoother


def exact_motions(
    arm: Arm,
    runs: Sequence[Readings],
    q: Floats,
    given: bool,
    prior: MountingPrior,
    progress: Callable[[int], None] | None,
    explaining: bool = False,
) -> list[Smoothed]:
    """Return the motions of an exact arm whose sensors' clocks agree, or if only that explains them, differ.

    With ``explaining`` they are wanted only if they explain the runs.
    """
    found = _exact(arm, runs, q, given, prior, False, progress, explaining)
    if not found or explained(found, runs):
        return found
    late = _exact(arm, runs, q, given, prior, True, progress, True)
    return late if explained(late, runs) else found


def _exact(
    arm: Arm,
    runs: Sequence[Readings],
    q: Floats,
    given: bool,
    prior: MountingPrior,
    clocks: bool,
    progress: Callable[[int], None] | None,
    explaining: bool,
) -> list[Smoothed]:
    """Return motions of an exact arm, each with what the runs before showed, up to one that is not explained."""
    exact, found = Smoother(arm, q, given, prior, clocks), list[Smoothed]()
    try:
        for readings in runs:
            known = found[-1] if found else None
            found.append(exact.smooth(readings, fine=False, known=known, progress=progress, explaining=explaining))
            if not found[-1].is_exact:
                break
    except DataError:
        pass
    return found


def explained(found: Sequence[Smoothed], runs: Sequence[Readings]) -> bool:
    """Say whether motions of an exact arm explain all runs."""
    return len(found) == len(runs) and found[-1].is_exact


def runs_smoothed(
    arm: Arm,
    runs: Sequence[Readings],
    q: Floats,
    given: bool,
    prior: MountingPrior,
    progress: Callable[[int], None] | None,
) -> list[Smoothed]:
    """Return the motions of all runs, each with what the runs before it showed of the sensors.

    If no such arm explains a run to the sensors' noise, what the model lacks is learnt from all of them.
    """
    found = exact_motions(arm, runs, q, given, prior, progress)
    if explained(found, runs):
        return found
    exacts: list[Smoothed | None] = [*found, *[None] * (len(runs) - len(found))]
    robust, found = DiscrepancySmoother(arm, q, given, prior), []
    for readings, one in zip(runs, exacts, strict=True):
        found.append(robust.smooth(readings, one, found[-1] if found else None, progress))
    return found
