"""What a tracker says of itself, once it has seen a whole run."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace

from tracking.consistency import Consistency
from tracking.smoothed import Smoothed

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
    """

    innovation: float | None = None
    doubted: float | None = None
    wrong: bool | None = None
    passes: int | None = None
    converged: bool | None = None
    discrepancy_m_s2: float | None = None
    base_m_s2: float | None = None


def verdict_of(said: Consistency | Smoothed, frames: int) -> Verdict:
    """Return what a filter or a smoother says after so many frames."""
    if isinstance(said, Smoothed):
        claim = Verdict(doubted=said.doubted, passes=said.passes, converged=said.converged)
        if said.discrepancy is None:
            return replace(claim, wrong=said.doubted > DOUBTED)
        lacks = said.discrepancy
        return replace(claim, wrong=True, discrepancy_m_s2=lacks.lack_std, base_m_s2=lacks.base_std)
    if said.size is None:  # a tracker that claims nothing
        return Verdict()
    return Verdict(
        innovation=said.size,
        doubted=said.doubted / max(1, frames),
        wrong=said.wrong,
        discrepancy_m_s2=said.discrepancy_m_s2,
        base_m_s2=said.base_m_s2,
    )


def overall(verdicts: Sequence[Verdict], frames: Sequence[int]) -> dict[str, object]:
    """Return what is said of several runs, of so many frames each, for a JSON document.

    ``innovation`` and ``doubted`` are means over the frames; ``passes``, what the model lacks and how its base
    moves are the most of any run.
    """
    known = [asdict(verdict) for verdict in verdicts]
    document: dict[str, object] = {}
    for name in ("innovation", "doubted"):
        shares = [(one[name], n) for one, n in zip(known, frames, strict=True) if one[name] is not None]
        if shares:
            document[name] = sum(value * n for value, n in shares) / sum(n for _, n in shares)
    rules = (("wrong", any), ("passes", max), ("converged", all), ("discrepancy_m_s2", max), ("base_m_s2", max))
    for name, of in rules:
        found = [one[name] for one in known if one[name] is not None]
        if found:
            document[name] = of(found)
    return document
