"""Fitting a hypothesis about the sensors together with the motion, on some trials, and judging it on others.

Gauss and Newton's method: along the motion and sensors found so far readings are linearised, the motion is
eliminated trial by trial, the rest is solved for the hypothesis' parameters, and the motion follows.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.model import Floats
from fitter.diagnosis.least_squares import ITERATIONS, UNEXPLAINED
from fitter.reading_diagnosis.elimination import go_back
from fitter.reading_diagnosis.sensor_hypotheses import Fitted, SensorHypothesis, with_theta
from fitter.reading_diagnosis.trial_equations import Trials

#: A motion that moves less from pass to pass has been found [rad or m].
_STILL = 1e-3


def fit(
    trials: Trials,
    hypothesis: SensorHypothesis,
    motions: Sequence[Floats],
    passes: int = ITERATIONS,
    halvings: int = 3,
) -> Fitted:
    """Return a hypothesis with its best parameters, by the learning trials.

    Parameters
    ----------
    trials : Trials
    hypothesis : SensorHypothesis
        With where its parameters start; one whose neutral value is infinite is held to be near there.
    motions : sequence of (n + 2, n_joint)
        Where the motions start; those of the judging trials are passed on.
    passes : int
        At the most.
    halvings : int
        Of a pass that leads uphill.
    """
    suspects, learn = hypothesis.suspects, range(trials.n_learn)
    mean, std = trials.before(hypothesis)
    theta = np.concatenate([hypothesis.bias.ravel(), *hypothesis.values])
    motions = [c.copy() for c in motions]
    before: tuple[float, Floats, list[Floats], list[Floats], Floats] | None = None
    halved = 0
    covariance = np.diag(std**2)
    for _ in range(passes):
        now = with_theta(hypothesis, theta)
        done = trials.all_eliminated(learn, now, motions, suspects)
        gram = np.sum([g for g, _ in done], axis=0)
        cost = float(gram[-1, -1] + np.sum(((theta - mean) / std) ** 2))
        if before is not None and not cost < before[0] + UNEXPLAINED and halved < halvings:
            halved += 1
            _, theta_was, motions_was, backs, step = before
            step = 0.5 * step
            theta = theta_was + step
            motions = _moved(motions_was, backs, step)
            before = (*before[:4], step)
            continue
        if before is not None and not np.isfinite(cost):  # no step leads on from where it was
            _, theta, motions, *_ = before
            break
        halved = 0
        information = gram[:-1, :-1] + np.diag(1.0 / std**2)
        right = gram[:-1, -1] + (mean - theta) / std**2
        covariance = np.linalg.inv(information)
        step = covariance @ right
        backs = [back for _, back in done]
        before = cost, theta, list(motions), backs, step
        motions = _moved(motions, backs, step)
        theta = theta + step
        if right @ step < UNEXPLAINED and _still(before[2][: trials.n_learn], motions[: trials.n_learn]):
            break
    assert before is not None
    return Fitted(
        with_theta(hypothesis, theta), motions, before[0], covariance, np.full(len(trials.trials), np.nan)
    )


def judge(trials: Trials, fitted: Fitted, passes: int = ITERATIONS) -> Fitted:
    """Return a fit with the squared residual of every judging trial.

    Parameters that the learning trials show poorly are not held against a hypothesis where the judging trials
    show them well: the probability of these is predicted with all that the learning trials leave open. With H
    the information of the learning trials, G that of the judging ones and x by how much the parameters would
    have to move, minus twice its logarithm is ``squares(x) + x^T H x + log det(1 + H^-1 G)``; the latter two
    are the surprise.

    Parameters
    ----------
    trials : Trials
    fitted : Fitted
        By the learning trials.
    passes : int
        At the most.
    """
    motions, squares = list(fitted.motions), fitted.squares.copy()
    going = list(range(trials.n_learn, len(trials.trials)))
    squares[going] = np.inf
    for _ in range(passes):
        done = trials.all_eliminated(going, fitted.hypothesis, motions, ())
        unsettled = []
        for number, (gram, back) in zip(going, done, strict=True):
            now = float(gram[-1, -1])
            if squares[number] - now > UNEXPLAINED:
                unsettled.append(number)
                motions[number] = _gone_back(motions[number], back, np.zeros(len(gram) - 1))
            squares[number] = min(now, squares[number])
        going = unsettled
        if not going:
            break
    suspects, judging = fitted.hypothesis.suspects, range(trials.n_learn, len(trials.trials))
    grams = [gram for gram, _ in trials.all_eliminated(judging, fitted.hypothesis, motions, suspects)]
    gram = np.sum(grams, axis=0)
    open_to = fitted.covariance
    x = open_to @ np.linalg.solve(np.eye(len(open_to)) + gram[:-1, :-1] @ open_to, gram[:-1, -1])
    for number, one in zip(judging, grams, strict=True):
        squares[number] = one[-1, -1] - 2.0 * x @ one[:-1, -1] + x @ one[:-1, :-1] @ x
    _, volume = np.linalg.slogdet(np.eye(len(open_to)) + gram[:-1, :-1] @ open_to)
    surprise = float(x @ np.linalg.solve(open_to, x) + volume)
    return replace(fitted, motions=motions, squares=squares, surprise=surprise)


def _still(before: Sequence[Floats], now: Sequence[Floats]) -> bool:
    return max(float(np.abs(b - a).max()) for a, b in zip(before, now, strict=True)) < _STILL


def _moved(motions: list[Floats], backs: list[Floats], step: Floats) -> list[Floats]:
    moved = [_gone_back(c, back, step) for c, back in zip(motions, backs, strict=False)]
    return moved + motions[len(backs) :]


def _gone_back(c: Floats, back: Floats, step: Floats) -> Floats:
    change, walked = np.zeros_like(c), np.zeros((len(c) - 2, back.shape[1] - c.shape[1]))
    go_back(back, step, c.shape[1], change, walked)
    moved: Floats = c + change
    return moved
