"""What a tracker says of itself, once it has seen a whole run."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from tracking.model.innovation_test import Consistency
from tracking.smoother.smoothed import SIGMAS, Smoothed

#: Readings contradict the arm if more of them than this are doubted.
DOUBTED = 0.01


@dataclass(frozen=True)
class Verdict:
    """What a tracker says of itself; None where its method says nothing of the kind.

    Attributes
    ----------
    innovation : float or None
        Mean squared misprediction by the filter's own claim: about 1 or less where it is right.
    doubted : float or None
        Share of the frames whose readings no motion of the arm explains.
    wrong : bool or None
        The readings contradict the arm.
    passes : int or None
        Of the smoother.
    converged : bool or None
        The smoother's passes came to an end.
    discrepancy_m_s2, base_m_s2 : float or None
        What the arm's model lacks of a reading, and the acceleration of its base along each axis, rms; None where
        the arm explains the readings to the sensors' noise.
    discrepancy_rad_s : float or None
        What the arm's model lacks of a gyroscope's reading, rms, by the smoother; None without gyroscopes.
    late_s : float or None
        The largest difference of a sensor's clock from the first one's; None where all clocks agree, or none is
        known to differ.
    place_off_m, turn_off_rad : float or None
        The largest departures of a sensor's place and rotation from the arm's file, where only such explain the
        readings.
    """

    innovation: float | None = None
    doubted: float | None = None
    wrong: bool | None = None
    passes: int | None = None
    converged: bool | None = None
    discrepancy_m_s2: float | None = None
    base_m_s2: float | None = None
    discrepancy_rad_s: float | None = None
    late_s: float | None = None
    place_off_m: float | None = None
    turn_off_rad: float | None = None


def verdict_of(found: Consistency | Smoothed, frames: int) -> Verdict:
    """Return what a filter or a smoother says after a number of frames."""
    if isinstance(found, Smoothed):
        claim = Verdict(doubted=found.doubted, passes=found.passes, converged=found.converged, late_s=_late(found))
        if found.discrepancy is None:
            if found.mounted_elsewhere is None:
                return replace(claim, wrong=found.doubted > DOUBTED)
            place, turn = found.mounted_elsewhere
            return replace(claim, wrong=True, place_off_m=place, turn_off_rad=turn)
        lacks = found.discrepancy
        return replace(
            claim,
            wrong=True,
            discrepancy_m_s2=lacks.lack_std,
            base_m_s2=lacks.base_std,
            discrepancy_rad_s=lacks.rate_lack_std or None,
        )
    if found.size is None:  # a tracker that claims nothing
        return Verdict()
    return Verdict(
        innovation=found.size,
        doubted=found.doubted / max(1, frames),
        wrong=found.wrong,
        discrepancy_m_s2=found.discrepancy_m_s2,
        base_m_s2=found.base_m_s2,
    )


def _late(found: Smoothed) -> float | None:
    """Return the largest difference of clocks among those that are no chance; None if there is none."""
    if found.clocks is None:
        return None
    late, std = found.clocks
    shown = np.abs(late) > SIGMAS * std
    return float(late[np.argmax(np.abs(late) * shown)]) if shown.any() else None


def overall(verdicts: Sequence[Verdict], frames: Sequence[int]) -> dict[str, object]:
    """Return the merged verdict of several runs, by their numbers of frames, as JSON has it: without None."""
    return {name: value for name, value in asdict(merged(verdicts, frames)).items() if value is not None}


def merged(verdicts: Sequence[Verdict], frames: Sequence[int]) -> Verdict:
    """Return the merged verdict of several runs, or windows of a run, weighted by their numbers of frames.

    ``innovation`` and ``doubted`` are means over the frames; ``passes``, what the model lacks, how its base
    moves, how late a sensor is and how far it sits from its place are the most of any run.
    """
    known = [asdict(verdict) for verdict in verdicts]
    values: dict[str, Any] = {}
    for name in ("innovation", "doubted"):
        shares = [(one[name], n) for one, n in zip(known, frames, strict=True) if one[name] is not None]
        if shares:
            values[name] = sum(value * n for value, n in shares) / sum(n for _, n in shares)
    most = (
        ("passes", max),
        ("discrepancy_m_s2", max),
        ("base_m_s2", max),
        ("discrepancy_rad_s", max),
        ("late_s", partial(max, key=abs)),
        ("place_off_m", max),
        ("turn_off_rad", max),
    )
    for name, of in (("wrong", any), ("converged", all), *most):
        found = [one[name] for one in known if one[name] is not None]
        if found:
            values[name] = of(found)
    return Verdict(**values)
