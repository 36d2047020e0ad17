"""What effects do in the small: a joint's resistance, where it lets go, what sensors read, what numbers may be."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from arm.bench import SensorErrors, Sensors
from arm.counts import COUNT_M_S2
from arm.effects.catalogue import catalogue
from arm.effects.check import mistakes_in
from arm.effects.joint_torque import COULOMB, DIRECTION, DQ, N_STATE, TAU, VISCOUS, Q, T, torque_along
from arm.model import Arm, Effect, Floats
from arm.simulation import Motion, simulate

STEP_S = 1e-3
#: A state in which nothing is zero, so that an effect cannot depend on what it should not and go unseen.
STATE = {"t": 2.3, "q": 0.41, "dq": -0.87, "tau": 1.9, "viscous": 0.6, "coulomb": 0.35}
COLUMNS = {"t": T, "q": Q, "dq": DQ, "direction": DIRECTION, "tau": TAU, "viscous": VISCOUS, "coulomb": COULOMB}


def _resists(name: str, numbers: Mapping[str, float], **state: object) -> Floats:
    kind, values = catalogue()[name], {**STATE, **state}
    values.setdefault("direction", np.sign(np.asarray(values["dq"])))
    rows = np.broadcast_arrays(*(np.atleast_1d(np.asarray(values[column], dtype=float)) for column in COLUMNS))
    states = np.zeros((len(rows[0]), N_STATE))
    for column, row in zip(COLUMNS.values(), rows, strict=True):
        states[:, column] = row
    return torque_along(kind, np.array([numbers[p.name] for p in kind.numbers if p.name in numbers]), states)


def _let_go(arm: Arm, rate: float = 1.0, seconds: float = 3.0) -> float:
    torque = rate * np.arange(round(seconds / STEP_S))[:, None] * STEP_S
    motion = simulate(arm, torque, STEP_S, np.zeros(1), torque=torque)
    return float(torque[np.flatnonzero(motion.dq[:, 0])[0], 0]) - rate * STEP_S


def _swung(arm: Arm, n_sample: int = 800, **options: float) -> Motion:
    ref = 0.2 + np.sin(np.arange(n_sample)[:, None] * STEP_S * np.array([4.0, 5.0, 6.0]))
    return simulate(arm, ref, STEP_S, np.full(3, 0.2), **options)


def _read(arm: Arm, parts: Sequence[Motion]) -> Floats:
    shape = (len(arm.sensors), 3)
    perfect = SensorErrors(0.0, np.zeros(shape), np.ones(shape), np.zeros(shape), np.zeros(shape))
    sensors = Sensors(arm, perfect, 1.0 / STEP_S, np.random.default_rng(0))
    counts = np.vstack([sensors.counts(part) for part in parts])
    return counts.reshape(len(counts), -1, 3) * COUNT_M_S2


def _on_sensor(arm: Arm, name: str, **numbers: float) -> Arm:
    return replace(arm, effects=(Effect(name, numbers, (), () if catalogue()[name].whole else ("s3",)),))


def _accepts(name: str, **numbers: object) -> bool:
    kind = catalogue()[name]
    on = {"joints": (1,), "sensors": ("s1",), "markers": ("A", "B")[: kind.exactly or 1], "arm": ()}[kind.acts_on]
    entry = {"name": name, "parameters": numbers, kind.acts_on: on}
    return not list(mistakes_in([entry], 1, ["s1"], ["A", "B"]))


def _ranges(name: str, number: str, low: float, high: float, **others: object) -> None:
    may = partial(_accepts, name, **others)
    for value in (low, np.nextafter(low, high), np.nextafter(high, low), high):
        assert may(**{number: value})
    assert not may(**{number: np.nextafter(low, -np.inf)}) and not may(**{number: np.nextafter(high, np.inf)})


@pytest.fixture(scope="session")
def resists() -> Callable[..., Floats]:
    """Return what tells with how much a joint resists: by effect, its numbers, and states that differ."""
    return _resists


@pytest.fixture(scope="session")
def let_go() -> Callable[..., float]:
    """Return what tells at which torque [N m] a resting wheel moves that is pulled harder and harder."""
    return _let_go


@pytest.fixture(scope="session")
def swung() -> Callable[..., Motion]:
    """Return what moves the arm under its controller, every joint to and fro."""
    return _swung


@pytest.fixture(scope="session")
def read() -> Callable[..., Floats]:
    """Return what perfect sensors read of motions one after the other, (n_sample, n_sensor, 3) [m/s^2]."""
    return _read


@pytest.fixture(scope="session")
def on_sensor() -> Callable[..., Arm]:
    """Return what gives an arm's sensor s3 one effect, or all of them one of the arm as a whole."""
    return _on_sensor


@pytest.fixture(scope="session")
def accepts() -> Callable[..., bool]:
    """Return what tells whether an arm file may have an effect with these numbers."""
    return _accepts


@pytest.fixture(scope="session")
def ranges() -> Callable[..., None]:
    """Return what asserts that a number may go from ``low`` to ``high`` and no further, the others given."""
    return _ranges
