"""Do the sensors contradict a rigid arm, whatever drove it, and why: the sensor half of `fitter diagnose`."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from arm.effects.catalogue import catalogue
from arm.model import Arm, Effect, Floats
from fitter.data.raw import RawRun
from fitter.diagnosis.least_squares import ROUNDED, SIGMAS, UNEXPLAINED
from fitter.diagnosis.next_experiment import next_for_sensors
from fitter.diagnosis.search import Verdict
from fitter.reading_diagnosis.free_base import base_course
from fitter.reading_diagnosis.linearisation import Linearisation
from fitter.reading_diagnosis.sensor_fit import judge
from fitter.reading_diagnosis.sensor_frames import trials_of
from fitter.reading_diagnosis.sensor_hypotheses import Fitted, Suspect
from fitter.reading_diagnosis.sensor_residual import dependence_of_residual, judging_residuals
from fitter.reading_diagnosis.sensor_search import Search, Tried
from fitter.reading_diagnosis.sensor_verdict import (
    Cause,
    Course,
    Decision,
    Number,
    SensorCandidate,
    SensorCause,
    SensorFinding,
    decide,
)
from fitter.reading_diagnosis.trial_equations import Trials
from limbcal.errors import ConfigError, DataError, NotIdentifiable
from tracking.model.noise import step_of


def diagnose_sensors(
    arm: Arm,
    learn: Sequence[RawRun],
    evaluate: Sequence[RawRun],
    progress: Callable[[], None] | None = None,
    *,
    seed: int = 0,
) -> SensorFinding:
    """Say whether the sensors contradict a rigid arm, which of them, and why.

    Parameters
    ----------
    arm : Arm
        With its sensors; the run begins with the arm at its zero where gravity doesn't show its angles.
    learn, evaluate : sequence of RawRun
        Trials to learn from and to judge by, each beginning with a rest. Angles that come with them are not used.
    progress : callable, optional
        Called after every fit.
    seed : int
        Of the draws that the support and the residual's description need.

    Raises
    ------
    ConfigError
        If the arm has no sensors, or there is no trial of either kind.
    DataError
        If readings don't fit the sensors.
    NotIdentifiable
        If the sensors have no more channels than the arm has joints.
    """
    if not arm.sensors:
        raise ConfigError(f"arm {arm.name!r} has no [[sensor]], expected those whose readings are to be diagnosed")
    if 3 * len(arm.sensors) <= arm.n_joint:
        raise NotIdentifiable(
            f"{len(arm.sensors)} sensor(s) can't contradict an arm of {arm.n_joint} joints, expected more channels"
        )
    learned = trials_of(arm, learn)
    trials = trials_of(arm, [*learn, *evaluate])
    if not learned or len(trials) == len(learned):
        judging = len(trials) - len(learned)
        raise DataError(f"{len(learned)} trials to learn from, {judging} to judge by, expected some of both")
    search = Search(Trials(arm, trials, len(learned)), progress)
    rng = np.random.default_rng(seed)
    decision = decide(search, rng)
    return _finding(arm, search, decision, rng)


def _finding(arm: Arm, search: Search, decision: Decision, rng: np.random.Generator) -> SensorFinding:
    before, after = search.contradiction(_unhelped(search, decision)), search.contradiction(decision.fitted)
    white = after.sigmas < SIGMAS
    verdict: Verdict = "none"
    if decision.causes:
        verdict = "ambiguous" if any(cause.equals for cause in decision.causes) else "named"
        if not white and after.excess > UNEXPLAINED * before.excess:
            verdict = "unexplained"
    elif not white:
        verdict = "unexplained"
    causes = tuple(one for cause in decision.causes for one in _causes(arm, search, decision, cause))
    confusable = {
        tuple(sorted((a.suspect.effect, b.suspect.effect)))
        for cause in decision.causes
        for a, b in combinations((cause.tried, *cause.equals), 2)
    }
    pairs = tuple(sorted((a, b) for a, b in confusable))
    judged = judging_residuals(search.trials, decision.fitted)
    unhelped = judging_residuals(search.trials, _unhelped(search, decision))
    residual = dependence_of_residual(judged, white, rng)
    was, remains = _rms(arm, unhelped), _rms(arm, judged)
    return SensorFinding(
        verdict,
        causes if verdict != "unexplained" else (),
        _candidates(arm, search, decision),
        pairs,
        next_for_sensors(
            verdict, pairs, [(cause.effect, *cause.sensors) for cause in causes], residual.depends_on
        ),
        was,
        remains,
        float(np.clip(1.0 - _square(remains) / _square(was), 0.0, 1.0)) if decision.causes else 0.0,
        before.sigmas,
        before.excess,
        float(np.sqrt(max(1.0 + after.excess, 0.0))),
        residual,
        _extended(arm, causes) if verdict == "named" else arm,
        _course(unhelped, judged),
    )


def _unhelped(search: Search, decision: Decision) -> Fitted:
    """Return the arm file's own sensors with usual biases; those whose bias is a cause have none."""
    suspects = [cause.tried.suspect for cause in decision.causes]
    odd = [one.sensor for one in suspects if one.kind.is_bias and one.sensor is not None]
    if not odd:
        return search.base
    bias = search.base.hypothesis.bias.copy()
    bias[odd] = 0.0
    return judge(search.trials, replace(search.base, hypothesis=replace(search.base.hypothesis, bias=bias)))


def _causes(arm: Arm, search: Search, decision: Decision, cause: Cause) -> list[SensorCause]:
    found = []
    for tried in (cause.tried, *cause.equals):
        fitted = decision.fitted if tried.suspect in decision.fitted.hypothesis.suspects else tried.fitted
        assert fitted is not None, "what was accepted was fitted"
        wider = np.sqrt(search.noise * max(1.0, 1.0 + search.contradiction(fitted).excess))
        support = cause.support / (1 + len(cause.equals))
        found.append(
            SensorCause(
                tried.suspect.effect,
                _sensors(arm, tried.suspect),
                _course_of_base(search.trials, fitted)
                if tried.suspect.kind.frees_base
                else _numbers(fitted, tried.suspect, wider, _grain(search.trials, tried.suspect)),
                support,
            )
        )
    return found


def _sensors(arm: Arm, suspect: Suspect) -> tuple[str, ...]:
    return () if suspect.sensor is None else (arm.sensors[suspect.sensor].name,)


def _grain(trials: Trials, suspect: Suspect) -> float:
    """Return what a converter leaves unknown of a level or a delay: a step or an interval, evenly distributed."""
    raw = trials.trials[0].raw
    if suspect.sensor is not None and suspect.kind.grain == "step":
        step = step_of(raw.a[:, 3 * suspect.sensor : 3 * suspect.sensor + 3])
        return float(step[np.isfinite(step)].max(initial=0.0) / np.sqrt(12.0))
    return 1.0 / raw.rate_hz / np.sqrt(12.0) if suspect.kind.grain == "interval" else 0.0


def _numbers(fitted: Fitted, suspect: Suspect, wider: float, grain: float) -> dict[str, Number]:
    place = fitted.hypothesis.suspects.index(suspect)
    value, std = fitted.hypothesis.values[place], np.hypot(wider * fitted.std(place), grain)
    if suspect.kind.begins_neutral or not suspect.kind.whole:
        rows = zip(suspect.kind.parameters, value, std, strict=True)
        return {name: Number(float(v), float(s), unit) for (name, unit), v, s in rows}
    c, s = value[:3], value[3:6]
    size = np.maximum(np.hypot(c, s), ROUNDED)
    rms = np.where(s < 0.0, -1.0, 1.0) * size / np.sqrt(2.0)
    spread = np.sqrt(((c * std[:3]) ** 2 + (s * std[3:6]) ** 2) / 2.0) / size
    numbers = {f"{axis}_m_s2": Number(float(rms[k]), float(spread[k]), "m/s^2") for k, axis in enumerate("xyz")}
    return numbers | {"frequency_hz": Number(float(value[6]), float(std[6]), "Hz")}


def _course_of_base(trials: Trials, fitted: Fitted) -> dict[str, Number]:
    """Return the rms acceleration of a base that moves in any way, with its standard error over judging trials."""
    judging = range(trials.n_learn, len(trials.trials))
    courses = [base_course(trials, fitted, k) for k in judging]
    each = np.array([np.sqrt(np.mean(course**2, axis=0)) for course in courses])
    rms = np.sqrt(np.mean(np.concatenate(courses) ** 2, axis=0))
    std = each.std(axis=0, ddof=1) / np.sqrt(len(each)) if len(each) > 1 else np.full(3, np.nan)
    return {f"{axis}_m_s2": Number(float(rms[k]), float(std[k]), "m/s^2") for k, axis in enumerate("xyz")}


def _candidates(arm: Arm, search: Search, decision: Decision) -> tuple[SensorCandidate, ...]:
    start = search.score(search.base)
    best = min((tried.score for tried in decision.first if tried.fitted is not None), default=start)
    whole = max(start - best, search.contradiction(search.base).beyond, ROUNDED)
    supports = {
        tried.suspect: cause.support / (1 + len(cause.equals))
        for cause in decision.causes
        for tried in (cause.tried, *cause.equals)
    }

    def gain(tried: Tried) -> float:
        return float(np.clip((start - tried.score) / whole, 0.0, 1.0))

    return tuple(
        SensorCandidate(
            tried.suspect.effect, _sensors(arm, tried.suspect), gain(tried), supports.get(tried.suspect, 0.0)
        )
        for tried in decision.first
    )


def _square(rms: Mapping[str, float]) -> float:
    return max(sum(one**2 for one in rms.values()), ROUNDED**2)


def _rms(arm: Arm, judged: list[Linearisation]) -> dict[str, float]:
    """Return the rms of what no motion explains, a frame counted as it counts in the verdict, by sensor.

    A jolt between two frames, which no motion follows, hardly counts there.
    """
    residual, weight = (np.concatenate([getattr(at, name) for at in judged]) for name in ("residual", "weight"))
    total = np.sum(weight**2, axis=0)
    square = np.sum((weight * residual) ** 2, axis=0) / np.where(total > 0.0, total, 1.0)
    rms = np.sqrt(square.reshape(len(arm.sensors), 3).sum(axis=1))
    return {sensor.name: float(value) for sensor, value in zip(arm.sensors, rms, strict=True)}


def _extended(arm: Arm, causes: Sequence[SensorCause]) -> Arm:
    effects = [
        Effect(
            cause.effect,
            {name: number.value for name, number in cause.parameters.items()},
            sensors=cause.sensors,
        )
        for cause in causes
        if set(cause.parameters) == {parameter.name for parameter in catalogue()[cause.effect].parameters}
    ]  # a base that moves in any way is no effect of an arm file
    return replace(arm, effects=(*arm.effects, *effects))


def _course(before: list[Linearisation], after: list[Linearisation]) -> Course:
    def columns(found: list[Floats]) -> Floats:
        whole = np.concatenate(found)
        return whole.reshape(len(whole), -1, 3)

    return Course(
        np.concatenate([at.trial.t for at in after]),
        columns([at.residual for at in before]),
        columns([at.residual for at in after]),
        columns([at.expected for at in after]),
    )
