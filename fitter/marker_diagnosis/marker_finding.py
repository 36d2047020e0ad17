"""The verdict on a search for what is wrong with a person's markers, judged on the evaluating trials."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from arm.model import Arm, Floats
from fitter.diagnosis.search import Verdict
from fitter.marker_diagnosis.marker_search import MarkerCause, MarkerSearch, search_markers
from fitter.marker_diagnosis.suspicion import Suspicion
from fitter.marker_diagnosis.trial_errors import TrialErrors
from protocol.markers.recording import MarkerRecording

_UNITS = {"_m": "m", "_m_rad": "m/rad", "_rad": "rad", "joint": "1"}
#: Draws of blocks for the gain's interval.
_DRAWS = 1000
#: What is neither a number of an effect nor its size.
_PLACES = ("trials",)

NEXT = {
    "marker_moved": "look where the marker sits, or record a standing trial and calibrate the limb anew",
    "label_swap": "exchange the two labels in the recording's program and export it again",
    "soft_tissue": "put a cluster where the skin slides less, or give the marker a larger std_m in the arm file",
}


@dataclass(frozen=True)
class MarkerNumber:
    """A parameter with its standard error; none for one that is no estimate, such as a joint's number."""

    value: float
    std: float | None
    unit: str


@dataclass(frozen=True)
class NamedMarkerCause:
    """A cause.

    Attributes
    ----------
    effect : str
        As in the catalogue.
    markers : tuple of str
    parameters : mapping of str to MarkerNumber
    trials : tuple of str
        The recordings in which it acts; empty for all.
    support : float
    takes_away : mapping of str to float
        Share of its markers' squared errors that it takes away, in learning and evaluating trials.
    """

    effect: str
    markers: tuple[str, ...]
    parameters: Mapping[str, MarkerNumber]
    trials: tuple[str, ...]
    support: float
    takes_away: Mapping[str, float]


@dataclass(frozen=True)
class MarkerCandidate:
    """A hypothesis that was tried on the arm as it is.

    Attributes
    ----------
    tried : Suspicion
    gain : float
        Share of all trials' squared mean errors that are those of its markers where it acts, 0 to 1.
    support : float
        Its share of the likelihood of all; 0 where nothing was accepted.
    """

    tried: Suspicion
    gain: float
    support: float


@dataclass(frozen=True)
class MarkerFinding:
    """What was found.

    Attributes
    ----------
    verdict : {"named", "ambiguous", "none", "unexplained"}
    complete : bool
        Whether markers' mean errors are no larger than the arm says that markers wander.
    causes : list of NamedMarkerCause
    candidates : list of MarkerCandidate
        All that were tried on the arm as it is, the likeliest first.
    confusable : list of (str, str)
    next_experiment : str
    before, after : mapping of str to float
        By marker, its rms distance from the motion in the evaluating trials [mm].
    rms_mm : (before, after)
        Of all markers.
    gain, ci95 : float, (low, high)
        Share of the squared distances that the causes take away, and its interval over blocks of a second.
    wander : float
        Of sound markers' mean errors, as a share of the arm's ``std_m``.
    arm : Arm
        With the causes as effects.
    by_trial : list of (name, before, after)
        Rms distance of each marker in every trial, (m,) [mm].
    """

    verdict: Verdict
    complete: bool
    causes: list[NamedMarkerCause]
    candidates: list[MarkerCandidate]
    confusable: list[tuple[str, str]]
    next_experiment: str
    before: Mapping[str, float]
    after: Mapping[str, float]
    rms_mm: tuple[float, float]
    gain: float
    ci95: tuple[float, float]
    wander: float
    arm: Arm
    by_trial: list[tuple[str, Floats, Floats]]


def diagnose_markers(
    arm: Arm,
    learn: Sequence[MarkerRecording],
    evaluate: Sequence[MarkerRecording],
    labels: Sequence[str],
    progress: Callable[[str], None] | None = None,
) -> MarkerFinding:
    """Find what is wrong with the markers of some recordings, given a calibrated arm or leg.

    Parameters
    ----------
    arm : Arm
        With [[marker]].
    learn, evaluate : sequence of MarkerRecording
        A marker may be wrong in some of them only, so all are looked at; errors are judged on the latter.
    labels : sequence of str
        What to call the recordings, learning ones first.
    progress : callable, optional
        Called with what is done.

    Raises
    ------
    ConfigError
        If the arm cannot be tracked.
    DataError
        If a recording has too few of the arm's markers.
    """
    search = search_markers(arm, [*learn, *evaluate], progress)
    judging = range(len(learn), len(labels))
    before = [search.before[r] for r in judging]
    after = [search.after[r] for r in judging]
    gain, ci95 = _gain(before, after)
    complete = search.wander.mean <= 1.0
    equals = [one for cause in search.causes for one in cause.equals]
    verdict: Verdict = "unexplained" if not complete else "none"
    if search.causes:
        verdict = "ambiguous" if equals else "named"
    effects = [cause.itself.effect.name for cause in search.causes]
    names = search.before[0].names
    by_marker = [dict(zip(names, _rms_mm(some).tolist(), strict=True)) for some in (before, after)]
    return MarkerFinding(
        verdict,
        complete,
        _causes(search, labels, len(learn)),
        _candidates(search),
        sorted({_pair(c.itself.effect.name, e.effect.name) for c in search.causes for e in c.equals}),
        _next(verdict, effects),
        by_marker[0],
        by_marker[1],
        (_total_mm(before), _total_mm(after)),
        gain,
        ci95,
        search.wander.mean,
        search.arm,
        [
            (label, _rms_mm([was]), _rms_mm([now]))
            for label, was, now in zip(labels, search.before, search.after, strict=True)
        ],
    )


def _next(verdict: Verdict, effects: Sequence[str]) -> str:
    if effects:
        return "; ".join(dict.fromkeys(NEXT[name] for name in effects))
    if verdict == "unexplained":
        return "record a trial that moves every joint by itself and calibrate the limb anew with it"
    return "nothing: the markers are where the limb has them"


def _pair(one: str, other: str) -> tuple[str, str]:
    a, b = sorted((one, other))
    return a, b


def _causes(search: MarkerSearch, labels: Sequence[str], n_learn: int) -> list[NamedMarkerCause]:
    return [
        _named(search, cause, one, labels, n_learn)
        for cause in search.causes
        for one in (cause.itself, *cause.equals)
    ]


def _named(
    search: MarkerSearch, cause: MarkerCause, one: Suspicion, labels: Sequence[str], n_learn: int
) -> NamedMarkerCause:
    parameters = {
        name: MarkerNumber(float(value), one.std.get(name), _unit(name))  # type: ignore[arg-type]
        for name, value in one.effect.parameters.items()
        if name not in _PLACES
    }
    trials = tuple(labels[r - 1] for r in one.trials) if "trials" in one.effect.parameters else ()
    taken = {}
    if one is cause.itself:
        for role, some in (("learn", range(n_learn)), ("evaluate", range(n_learn, len(labels)))):
            places = [search.before[0].names.index(name) for name in one.effect.markers]
            was, now = (
                float(sum(trials_[r].squares[:, places].sum() for r in some))
                for trials_ in (search.before, search.after)
            )
            taken[role] = 1.0 - now / was if was > 0.0 else 0.0
    share = (
        cause.support
        if one is cause.itself
        else cause.support * float(np.exp(one.evidence - cause.itself.evidence))
    )
    return NamedMarkerCause(one.effect.name, one.effect.markers, parameters, trials, share, taken)


def _unit(name: str) -> str:
    return next(unit for end, unit in sorted(_UNITS.items(), key=lambda pair: -len(pair[0])) if name.endswith(end))


def _candidates(search: MarkerSearch) -> list[MarkerCandidate]:
    odds = np.exp([one.evidence - search.first[0].evidence for one in search.first])
    support = odds / odds.sum() if search.causes else np.zeros(len(odds))
    return [
        MarkerCandidate(one, _first_order(one, search.before), float(share))
        for one, share in zip(search.first, support, strict=True)
    ]


def _first_order(one: Suspicion, trials: Sequence[TrialErrors]) -> float:
    """Return the share of all trials' squared mean errors that are those of a hypothesis' markers and trials."""
    own = [trials[0].names.index(name) for name in one.effect.markers]
    whole = sum(float(np.nansum(trial.mean**2)) for trial in trials)
    part = sum(float(np.nansum(trials[r - 1].mean[own] ** 2)) for r in one.trials)
    return part / whole if whole > 0.0 else 0.0


def _rms_mm(trials: Sequence[TrialErrors]) -> Floats:
    squares = np.sum([trial.squares.sum(axis=0) for trial in trials], axis=0)
    seen = np.sum([np.isfinite(trial.y[..., 0]).sum(axis=0) for trial in trials], axis=0)
    return np.asarray(1e3 * np.sqrt(squares / np.where(seen > 0, seen, np.nan)))


def _total_mm(trials: Sequence[TrialErrors]) -> float:
    squares = sum(float(trial.squares.sum()) for trial in trials)
    seen = sum(int(np.isfinite(trial.y[..., 0]).sum()) for trial in trials)
    return 1e3 * float(np.sqrt(squares / max(seen, 1)))


def _gain(before: Sequence[TrialErrors], after: Sequence[TrialErrors]) -> tuple[float, tuple[float, float]]:
    was, now = (np.concatenate([trial.squares.sum(axis=1) for trial in some]) for some in (before, after))
    drawn = np.random.default_rng(0).integers(0, len(was), (_DRAWS, len(was)))
    shares = 1.0 - now[drawn].sum(axis=1) / np.maximum(was[drawn].sum(axis=1), np.finfo(np.float64).tiny)
    low, high = np.quantile(shares, [0.025, 0.975])
    return float(1.0 - now.sum() / max(was.sum(), np.finfo(np.float64).tiny)), (float(low), float(high))
