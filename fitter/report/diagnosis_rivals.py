"""The rivals of a cause, and why they lost."""

from dataclasses import dataclass

import numpy as np

from fitter.diagnosis.diagnosis import Diagnosis
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.search import Cause
from fitter.report.diagnosis_figures import AFTER, BEFORE
from fitter.report.diagnosis_words import candidate_name, percent
from fitter.report.page import Row

#: Candidates that take away no more than this relative to the one that takes away least are named in one line.
_NEXT_TO_NOTHING = 0.01
_ROWS = 14

_BEATEN, _FAINT = "#8896a5", "#bbbbbb"


@dataclass(frozen=True)
class Rival:
    """A candidate for the place of a cause.

    Attributes
    ----------
    name : str
    gain : float
        Share of the squared residual that the model with it takes away on the evaluating trials, 0 to 1.
    verdict : str
    colour : str
    """

    name: str
    gain: float
    verdict: str
    colour: str


def rivals(found: Diagnosis, cause: Cause | None) -> list[Rival]:
    """Return what was tried in the place of a cause (or at all): the winner, its equals, the beaten."""
    search = found.search
    judging = np.array([not motion.learn for motion in found.regression.motions])
    before = search.screening_base if cause is None else cause.before
    was = max(float(before.squares[judging].sum()), np.finfo(np.float64).tiny)

    def rival(one: Candidate, verdict: str, colour: str) -> Rival:
        gain = float(np.clip(1.0 - one.squares[judging].sum() / was, 0.0, 1.0))
        return Rival(candidate_name(one.hypothesis), gain, verdict, colour)

    def ranked(some: list[Rival]) -> list[Rival]:
        return sorted(some, key=lambda one: -one.gain)

    if cause is None:
        verdict = "not above the noise" if found.finding.verdict == "none" else "explains too little"
        return ranked([rival(one, verdict, _FAINT) for one in search.first])
    equal = [rival(one, "as good: can't be distinguished", BEFORE) for one in cause.rivals]
    larger = [rival(one, "as good, but has more numbers", _BEATEN) for one in cause.larger]
    beaten = [rival(one, "beaten", _BEATEN) for one in cause.beaten]
    return [rival(cause.itself, "named", AFTER), *ranked(equal), *ranked([*larger, *beaten])]


def shown(listed: list[Rival]) -> tuple[list[Rival], list[Rival]]:
    """Return the candidates that get a row, and the rest."""
    least = min(one.gain for one in listed) + _NEXT_TO_NOTHING
    rows = [one for k, one in enumerate(listed) if k == 0 or one.gain >= least][:_ROWS]
    return rows, [one for one in listed if one not in rows]


def table_rows(rows: list[Rival]) -> list[Row]:
    """Return the table: candidate, what it takes away, how much more it leaves than the first, verdict."""
    least = max(1.0 - rows[0].gain, 1e-9)
    return [(one.name, percent(one.gain), f"{(1.0 - one.gain) / least:.3g} ×", one.verdict) for one in rows]
