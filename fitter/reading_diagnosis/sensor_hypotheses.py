"""What sensors are suspected of: an effect of one of them, several with their numbers, and these fitted.

Every sensor has a small bias of its own besides, as every real one has, held to be no larger than is usual.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.reading_diagnosis.linearisation import Instruments, Linearisation, added
from fitter.reading_diagnosis.sensor_frames import TrialFrames

#: Biases up to about this are usual (DESIGN section 5) and no finding [m/s^2].
USUAL_BIAS_M_S2 = 0.02


Change = Callable[[Instruments, int, Floats], Instruments]
Columns = Callable[[Linearisation, int], Floats]
First = Callable[[Sequence[TrialFrames], Instruments, int], Floats | None]


@dataclass(frozen=True)
class SensorEffect:
    """How an effect is fitted.

    Attributes
    ----------
    name : str
    parameters : tuple of (name, unit)
    neutral : tuple of float
        Parameters without effect, from which a fit starts; infinite for one that has to be found beforehand.
    spread : tuple of float
        How far from there they may be: standard deviation of what is held before.
    change : callable
        ``change(instruments, sensor, parameters)``.
    columns : callable
        ``columns(linearisation, sensor)`` is (n, n_channel, n_parameter).
    whole : bool
        It is the whole arm's, and no sensor's own.
    first : callable, optional
        ``first(trials, nominal, sensor)`` is where a fit starts that cannot start as neutral; None if the
        sensor cannot have it.
    least : float
        A parameter below this is nothing in the time of a trial.
    is_bias, is_level : bool
        It is what every sensor has a little of; readings stop at it.
    is_blinding : bool
        It keeps readings from being looked at.
    frees_base : bool
        The base may accelerate in any way; what it does stands in no parameter.
    grain : {"", "step", "interval"}
        What a converter leaves unknown of it: its step, or the time from sample to sample.
    """

    name: str
    parameters: tuple[tuple[str, str], ...]
    neutral: tuple[float, ...]
    spread: tuple[float, ...]
    change: Change
    columns: Columns
    whole: bool = False
    first: First | None = None
    least: float = 0.0
    is_bias: bool = False
    is_level: bool = False
    is_blinding: bool = False
    frees_base: bool = False
    grain: Literal["", "step", "interval"] = ""

    @property
    def begins_neutral(self) -> bool:
        """Whether a fit may start from what is neutral."""
        return self.first is None and bool(np.all(np.isfinite(self.neutral)))


@dataclass(frozen=True)
class Suspect:
    """An effect of one sensor, or of the whole arm where ``sensor`` is None."""

    kind: SensorEffect
    sensor: int | None = None

    @property
    def effect(self) -> str:
        """What it is called in the catalogue."""
        return self.kind.name

    def changed(self, instruments: Instruments, value: Floats) -> Instruments:
        """Return the sensors with it."""
        return self.kind.change(instruments, -1 if self.sensor is None else self.sensor, value)

    def columns(self, at: Linearisation) -> Floats:
        """Return its columns, (n, n_channel, n_parameter)."""
        return self.kind.columns(at, -1 if self.sensor is None else self.sensor)


def bias_columns(at: Linearisation, sensor: int) -> Floats:
    """Return the slopes by what a sensor reads too much; one that forgets makes a ramp of it when undone."""
    columns = np.zeros((*at.expected.shape, 3))
    corner = 2.0 * np.pi * at.instruments.corner_hz[sensor]
    ramp = 1.0 + corner * (at.trial.t - at.trial.t[0] + 0.5 * at.trial.dt_s)
    for axis in range(3):
        columns[:, 3 * sensor + axis, axis] = ramp
    columns[at.clipped != 0.0] = 0.0
    return columns


@dataclass(frozen=True)
class SensorHypothesis:
    """What the sensors may be.

    Attributes
    ----------
    suspects : tuple of Suspect
    values : tuple of (n_parameter,)
    bias : (n_sensor, 3) [m/s^2]
        The small one that every sensor has.
    without : (n_sensor,) bool
        Sensors that are not looked at.
    free_base : bool
        The base may accelerate in any way.
    """

    suspects: tuple[Suspect, ...]
    values: tuple[Floats, ...]
    bias: Floats
    without: NDArray[np.bool_]
    free_base: bool = False

    def instruments(self, nominal: Instruments) -> Instruments:
        """Return the sensors as it has them."""
        found = nominal
        for s, bias in enumerate(self.bias):
            found = found.with_sensor(s, bias_m_s2=added(found.arm.sensors[s].bias_m_s2, bias))
        for suspect, value in zip(self.suspects, self.values, strict=True):
            found = suspect.changed(found, value)
        return found


@dataclass(frozen=True)
class Fitted:
    """A hypothesis with its best parameters.

    Attributes
    ----------
    hypothesis : SensorHypothesis
    motions : list of (n + 2, n_joint)
        Spline coefficients of every trial.
    cost : float
        Squared residual of the learning trials that contradicts rigidity, in units of the noise, with what is
        held of the parameters before.
    covariance : (n_theta, n_theta)
        Of the biases, then of the suspects' parameters; for noise of unit variance.
    squares : (n_trial,)
        Each trial's squared residual; NaN where it was not judged.
    surprise : float
        What it takes beyond that for the judging trials to be as the learning trials predict, see `Trials.judge`.
    """

    hypothesis: SensorHypothesis
    motions: list[Floats]
    cost: float
    covariance: Floats
    squares: Floats
    surprise: float = 0.0

    @property
    def usual(self) -> float:
        """What the small biases cost by being larger than none, squared and in units of what is usual."""
        return float(np.sum((self.hypothesis.bias / USUAL_BIAS_M_S2) ** 2))

    def std(self, place: int) -> Floats:
        """Return the standard errors of one suspect's parameters."""
        begin = self.hypothesis.bias.size + sum(value.size for value in self.hypothesis.values[:place])
        diagonal = np.diag(self.covariance)[begin : begin + self.hypothesis.values[place].size]
        std: Floats = np.sqrt(diagonal)
        return std


def with_theta(hypothesis: SensorHypothesis, theta: Floats) -> SensorHypothesis:
    """Return a hypothesis with other parameters."""
    n = hypothesis.bias.size
    ends = np.cumsum([n, *(value.size for value in hypothesis.values)])
    values = tuple(theta[begin:end].copy() for begin, end in zip(ends[:-1], ends[1:], strict=True))
    return SensorHypothesis(
        hypothesis.suspects, values, theta[:n].reshape(-1, 3).copy(), hypothesis.without, hypothesis.free_base
    )


def with_suspect(hypothesis: SensorHypothesis, suspect: Suspect, value: Floats) -> SensorHypothesis:
    """Return a hypothesis with one suspect more."""
    return replace(
        hypothesis,
        suspects=(*hypothesis.suspects, suspect),
        values=(*hypothesis.values, np.asarray(value)),
        free_base=hypothesis.free_base or suspect.kind.frees_base,
    )


def without_suspect(hypothesis: SensorHypothesis, suspect: Suspect) -> SensorHypothesis:
    """Return a hypothesis without one of its suspects."""
    kept = [k for k, one in enumerate(hypothesis.suspects) if one != suspect]
    suspects = tuple(hypothesis.suspects[k] for k in kept)
    return replace(
        hypothesis,
        suspects=suspects,
        values=tuple(hypothesis.values[k] for k in kept),
        free_base=any(one.kind.frees_base for one in suspects),
    )
