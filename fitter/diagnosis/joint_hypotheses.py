"""Hypotheses of a joint's resistance: the catalogue's torque is all that is needed.

Parameters in which the torque is linear become columns. So does one more, without being linear, if all the
torques that it can make lie in one plane: the phase of a ripple (sine and cosine), the rest angle of a spring
(angle and constant). The rest are psi, searched on a grid that the motion suggests.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_torque import DIRECTION, DQ, N_STATE, TAU, torque_along, torques_along
from arm.model import Floats
from fitter.diagnosis.least_squares import ROUNDED, TINY
from fitter.diagnosis.model import N_START, Hypothesis
from fitter.diagnosis.motion import HypotheticalMotion, Motion


class JointHypothesis(Hypothesis):
    """An effect that resists the motion of one joint.

    Parameters
    ----------
    kind : EffectKind
    joint : int
        From 0.
    choice : mapping from name to float
        Parameters that are given, such as the side of a stop, or the angle at which a moment is stated.
    periods : (n,), optional
        Ripples a turn that are tried (`periods_tried`), of a joint that goes round unless given.
    """

    is_inertial = False

    def __init__(
        self,
        kind: EffectKind,
        joint: int,
        choice: dict[str, float] | None = None,
        periods: Floats | None = None,
    ) -> None:
        super().__init__(kind, (joint,))
        self.periods = periods_tried(2.0 * np.pi) if periods is None else periods
        self.depends_on_torque = depends_on(kind, TAU)
        self._joint = joint
        self.choice = choice or {}
        names = [parameter.name for parameter in kind.parameters]
        free = [k for k, name in enumerate(names) if name not in self.choice]
        self._linear = [k for k in free if kind.parameters[k].linear]
        self._folded = self._plane([k for k in free if k not in self._linear])
        self._psi = [k for k in free if k not in self._linear and k not in self._folded]
        self.n_column = max(1, len(self._linear)) + len(self._folded)
        self._asked: tuple[Floats, bool] = np.array([np.nan]), False  # whether it bends with this psi

    @property
    def psi_names(self) -> tuple[str, ...]:
        """Names of what is in psi."""
        return tuple(self.kind.parameters[k].name for k in self._psi)

    @cached_property
    def low(self) -> Floats:
        """Least values of psi, (n_psi,)."""
        parameters = [self.kind.parameters[k] for k in self._psi]
        return np.array(
            [max(p.low, self.periods[0]) if p.name.startswith("periods") else p.low for p in parameters]
        )

    @cached_property
    def high(self) -> Floats:
        """Greatest values of psi, (n_psi,)."""
        return np.array([self.kind.parameters[k].high for k in self._psi])

    def log_places(self, motions: Sequence[Motion]) -> float:
        """Return the logarithm of the number of places; a frequency is sought among all that the run resolves."""
        if "frequency_hz" not in self.psi_names:
            return super().log_places(motions)
        return float(np.log(sum(motion.trial.cutoff_hz * len(motion.t) * motion.dt_s for motion in motions)))

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return values of psi to try first, (n_start, n_psi)."""
        if not self._psi:
            return np.zeros((1, 0))
        axes = [self._grid(self.kind.parameters[k], motions) for k in self._psi]
        mesh = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        return np.asarray(mesh.reshape(-1, len(axes)), dtype=np.float64)

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion with this effect's columns."""
        columns = np.zeros((*hypothetical.q.shape, self.n_column))
        columns[:, self._joint, :] = self.torque(hypothetical, psi)
        return replace(hypothetical, columns=(*hypothetical.columns, columns))

    def torque(self, hypothetical: HypotheticalMotion, psi: Floats) -> Floats:
        """Return its columns at its own joint, (n_sample, n_column).

        At rest it is anything between what it is either way, and the mean of these stands for it.
        """
        states, noise = hypothetical.states(self._joint), hypothetical.speed_noise(self._joint)
        seen = self._columns(psi, states)
        rests = states[:, DIRECTION] == 0.0
        if np.any(rests):
            ahead, behind = (_moving(states[rests], way) for way in (1.0, -1.0))
            seen[rests] = 0.5 * (self._columns(psi, ahead) + self._columns(psi, behind))
        if np.any(noise > 0.0) and self._bends(psi):
            seen = seen - self._bent(psi, states, noise, seen)
        return seen

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the effect's own parameters from psi and the columns' factors."""
        values = self._values(psi)
        if not self._folded:
            for k, factor in zip(self._linear, factors, strict=True):
                values[k] = factor
            return values
        (k,), (linear,), parameter = self._folded, self._linear, self.kind.parameters[self._folded[0]]
        first, second = (float(one) for one in factors)
        if parameter.is_phase:
            values[linear], values[k] = np.hypot(first, second), np.arctan2(second, first)
            return values
        values[linear] = size = first + second
        values[k] = np.clip(second / (size if size else TINY), parameter.low, parameter.high)
        if values[k] * size != second:  # it may not be so large
            values[linear] = 1.0
            shape, wanted = torque_along(self.kind, values, _probe()), self._columns(psi, _probe()) @ factors
            values[linear] = float(shape @ wanted) / max(float(shape @ shape), TINY)
        return values

    def _columns(self, psi: Floats, states: Floats) -> Floats:
        return torques_along(self.kind, self._sets(psi), states)

    def _sets(self, psi: Floats) -> Floats:
        """Return the effect's parameters of which each column is made, (n_column, n_parameter)."""
        values = self._values(psi)
        if not self._linear:
            return values[None]
        sets = np.repeat(values[None], self.n_column, axis=0)
        sets[:, self._linear] = 0.0
        each = len(sets) // len(self._linear)
        for i, k in enumerate(self._linear):
            sets[i * each : (i + 1) * each, k] = 1.0
        if self._folded:
            sets[:, self._folded[0]] = self._two_values(self._folded[0])
        return sets

    def _bent(self, psi: Floats, states: Floats, noise: Floats, seen: Floats) -> Floats:
        """Return by how much the columns that are seen are too large in the mean because the velocity is noisy.

        Noise n in v makes of f(v) ``f + n f' + n^2 f'' / 2``: a steep function of the velocity seems flatter than
        it is, and a hump of friction wider (the corrected score, Stefanski 1989).
        """
        ahead, behind = states.copy(), states.copy()
        ahead[:, DQ] += noise
        behind[:, DQ] -= noise
        return (self._columns(psi, ahead) + self._columns(psi, behind)) / 2.0 - seen

    def _bends(self, psi: Floats) -> bool:
        """Return whether the columns depend on the velocity otherwise than straight."""
        if not np.array_equal(psi, self._asked[0]):  # motion after motion is asked about with the same
            states = _probe()
            bent = self._bent(psi, states, np.full(len(states), 0.1), self._columns(psi, states))
            self._asked = psi.copy(), bool(np.any(np.abs(bent) > np.sqrt(ROUNDED)))
        return self._asked[1]

    def _values(self, psi: Floats) -> Floats:
        values = np.zeros(len(self.kind.parameters))
        for k, parameter in enumerate(self.kind.parameters):
            if parameter.name in self.choice:
                values[k] = self.choice[parameter.name]
        values[self._psi] = psi
        return values

    def _two_values(self, k: int) -> tuple[float, float]:
        return (0.0, np.pi / 2.0 if self.kind.parameters[k].is_phase else 1.0)

    def _plane(self, others: list[int]) -> list[int]:
        """Return the one parameter, if any, whose torques are made of those at two of its values."""
        if len(self._linear) != 1:
            return []
        values = np.array([self.choice.get(p.name, min(max(1.0, p.low), p.high)) for p in self.kind.parameters])
        for k in others:
            if self.kind.parameters[k].low > 0.0:
                continue
            at = 0.5 * sum(self._two_values(k))
            parts = (np.cos(at), np.sin(at)) if self.kind.parameters[k].is_phase else (1.0 - at, at)
            sets = np.repeat(values[None], 3, axis=0)
            sets[:, k] = *self._two_values(k), at
            first, second, between = torques_along(self.kind, sets, _probe()).T
            least = np.sqrt(ROUNDED) * np.abs(between).max()
            if np.abs(first - second).max() > least > np.abs(between - parts[0] * first - parts[1] * second).max():
                return [k]
        return []

    def _grid(self, parameter: Parameter, motions: Sequence[Motion]) -> Floats:
        q = np.concatenate([motion.q[:, self._joint] for motion in motions])
        dq = np.concatenate([motion.dq[:, self._joint] for motion in motions])
        name = parameter.name
        if name.endswith("_rad_s"):
            top = float(np.abs(dq).max())
            grid = np.geomspace(0.01 * top, 1.0 * top, N_START)
        elif name.startswith("periods"):
            grid = self.periods
        elif name.endswith("angle_rad"):
            grid = np.linspace(q.min(), q.max(), 2 * N_START + 2)[1:-1]  # within the range, for it may be a stop
        elif np.isfinite(parameter.low) and parameter.low > 0.0:
            grid = np.geomspace(parameter.low, parameter.high, N_START)
        else:
            grid = np.linspace(parameter.low, parameter.high, N_START)
        inside = (grid >= parameter.low) & (grid <= parameter.high)
        return np.asarray(grid[inside] if np.any(inside) else grid, dtype=np.float64)


def periods_tried(reach: float, slides: bool = False, count: int = 80) -> Floats:
    """Return the ripples a turn that are tried: whole ones of a turn, or of what a joint that slides reaches.

    A ripple comes round within what the joint reaches: with less of it, it would be a spring or an offset. A turn
    of a joint that slides is 2 pi m.

    Parameters
    ----------
    reach : float [rad or m]
        How far the joint's lowest and highest position are apart.
    slides : bool
    count : int
        How many are tried: as many as teeth or magnets of usual drives have.
    """
    once = 2.0 * np.pi / max(reach, ROUNDED)
    step = once if slides else 1.0
    return np.asarray(step * (np.ceil(max(once / step, 1.0)) + np.arange(count)), dtype=np.float64)


def _moving(states: Floats, way: float) -> Floats:
    moved = states.copy()
    moved[:, DIRECTION] = way
    return moved


def _probe() -> Floats:
    """Return states, (64, 7), at which an effect is asked what it depends on."""
    rng = np.random.default_rng(0)
    states = rng.normal(size=(64, N_STATE))
    states[:, DIRECTION] = np.sign(states[:, DQ])
    return states


def depends_on(kind: EffectKind, state: int) -> bool:
    """Say whether the torque of an effect, if it is one against a joint's motion, depends on one of its states."""
    if kind.torque is None:
        return False
    values = np.array([min(max(0.7, p.low), p.high) for p in kind.parameters])
    states = _probe()
    other = states.copy()
    other[:, state] *= 2.0
    return not np.array_equal(torque_along(kind, values, states), torque_along(kind, values, other))
