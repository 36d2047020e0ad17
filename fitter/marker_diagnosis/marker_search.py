"""The search for what is wrong with markers: causes one after the other, the motion found anew with each."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.model import Arm, Effect
from fitter.marker_diagnosis.marker_hypotheses import Wander, suspicions
from fitter.marker_diagnosis.suspicion import Suspicion
from fitter.marker_diagnosis.trial_errors import TrialErrors, trial_errors
from protocol.markers.recording import MarkerRecording

#: Odds that a cause must have against none, all that were tried being as likely before: 100:1 is decisive
#: (Jeffreys 1961) [nats].
ODDS_NATS = float(np.log(100.0))
#: Evidence by which one hypothesis must beat another to be told apart from it: 20:1 (Kass and Raftery 1995)
#: [nats].
EQUAL_NATS = float(np.log(20.0))
#: Causes at the most.
_MOST = 8
#: Passes in which causes' numbers are found anew beside each other.
_PASSES = 2


@dataclass(frozen=True)
class MarkerCause:
    """An accepted cause and those that explain as much.

    Attributes
    ----------
    itself : Suspicion
    equals : tuple of Suspicion
    support : float
        Of it and its equals together with all others of the same markers: its share of the likelihood.
    """

    itself: Suspicion
    equals: tuple[Suspicion, ...]
    support: float


@dataclass(frozen=True)
class MarkerSearch:
    """What the search came to.

    Attributes
    ----------
    causes : tuple of MarkerCause
        With their numbers beside each other.
    first : list of Suspicion
        All that were tried on the arm as it is, the likeliest first.
    before, after : list of TrialErrors
    wander : Wander
        Of sound markers, with the causes.
    arm : Arm
        With the causes as effects.
    """

    causes: tuple[MarkerCause, ...]
    first: list[Suspicion]
    before: list[TrialErrors]
    after: list[TrialErrors]
    wander: Wander
    arm: Arm


def search_markers(
    arm: Arm, recordings: Sequence[MarkerRecording], progress: Callable[[str], None] | None = None
) -> MarkerSearch:
    """Find what is wrong with the markers of some recordings.

    Parameters
    ----------
    arm : Arm
        Calibrated, with [[marker]].
    recordings : sequence of MarkerRecording
        Trials to learn from, and those to judge on.
    progress : callable, optional
        Called with what is done.
    """
    tell = progress or (lambda _what: None)
    tell("tracking")
    before = tracked(arm, recordings)
    now, causes, first = before, list[MarkerCause](), list[Suspicion]()
    while len(causes) < _MOST:
        tried, _ = suspicions(now)
        first = first or tried
        taken = {(one.itself.effect.name, one.itself.effect.markers) for one in causes}
        able = [one for one in tried if (one.effect.name, one.effect.markers) not in taken]
        if not able or able[0].evidence < ODDS_NATS + np.log(len(tried)):
            break
        cause = _cause(able)
        extended = with_effects(arm, [*causes, cause])
        tell(f"tracking with {cause.itself.effect.name}")
        again = tracked(extended, recordings)
        if _misfit(again) >= _misfit(now):
            break
        causes.append(cause)
        now = again
    for _ in range(_PASSES if causes else 0):
        causes = _found_anew(causes, now)
        now = tracked(with_effects(arm, causes), recordings)
    return MarkerSearch(tuple(causes), first, before, now, suspicions(now)[1], with_effects(arm, causes))


def tracked(arm: Arm, recordings: Sequence[MarkerRecording]) -> list[TrialErrors]:
    """Return the errors of all recordings' markers."""
    return [trial_errors(arm, recording, k) for k, recording in enumerate(recordings, 1)]


def with_effects(arm: Arm, causes: Sequence[MarkerCause]) -> Arm:
    """Return the arm with causes as effects: names are exchanged last, for they belong to places."""
    effects = sorted((one.itself.effect for one in causes), key=lambda one: one.name == "label_swap")
    return replace(arm, effects=(*arm.effects, *effects))


def _cause(able: Sequence[Suspicion]) -> MarkerCause:
    best = able[0]
    rivals = [one for one in able if set(one.effect.markers) & set(best.effect.markers)]
    odds = np.exp([one.evidence - best.evidence for one in rivals])
    equals = tuple(
        one for one in rivals if one.effect.name != best.effect.name and best.evidence - one.evidence < EQUAL_NATS
    )
    return MarkerCause(best, equals, float(1.0 / odds.sum()))


def _misfit(trials: Sequence[TrialErrors]) -> float:
    """Return the sum of squared distances of all markers from the motion, in units of their ``std_m``."""
    return sum(float(np.sum(trial.squares / trial.std_m**2)) for trial in trials)


def _found_anew(causes: Sequence[MarkerCause], trials: Sequence[TrialErrors]) -> list[MarkerCause]:
    """Return causes with what still remains of them added to their numbers."""
    remaining, _ = suspicions(trials)
    corrected = []
    for cause in causes:
        effect = cause.itself.effect
        more = next(
            (
                one
                for one in remaining
                if one.effect.name == effect.name
                and one.effect.markers == effect.markers
                and one.trials == cause.itself.trials
                and one.effect.parameters.get("joint") == effect.parameters.get("joint")
            ),
            None,
        )
        if more is not None and cause.itself.std:
            added = {
                name: float(effect.parameters[name]) + float(more.effect.parameters[name])  # type: ignore[arg-type]
                for name in cause.itself.std
            }
            itself = replace(cause.itself, effect=_with(effect, added), std=more.std)
            corrected.append(replace(cause, itself=itself))
        else:
            corrected.append(cause)
    return corrected


def _with(effect: Effect, numbers: dict[str, float]) -> Effect:
    return replace(effect, parameters={**effect.parameters, **numbers})
