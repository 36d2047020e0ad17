"""Effects drawn for a measured recording, and the torque that they add at its motion."""

import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import scipy.optimize

from arm.arm_file import load_arm
from arm.effects.catalogue import catalogue
from arm.effects.effect import number
from arm.effects.effect_table import changed
from arm.effects.resisting_torque import resisting_torque
from arm.model import Arm, Effect, Friction
from arm.newton_euler import inverse_dynamics
from benchmarks.hidden_arms.hiding import Rng, either_way, log_uniform
from benchmarks.hidden_arms.unexplained import columns, fit, lowpass
from benchmarks.injection.runs import ARM, RATE_HZ, Floats, Run, read_set, rms

#: Effects that act at one joint: each is hidden at both. Viscous and Coulomb friction are in the base model.
AT_JOINT = (
    "coulomb_asymmetry",
    "stribeck",
    "load_friction",
    "quadratic_drag",
    "joint_spring",
    "end_stop",
    "cogging",
    "torque_offset",
    "thermal_drift",
    "periodic_disturbance",
    "external_push",
)
#: The 22 pairs of effect and joint.
PAIRS = tuple((name, joint) for name in AT_JOINT for joint in (1, 2))
#: Further ones. At joint 1 a rotor is part of the first link's inertia, and air drag is quadratic drag; a payload
#: (joint 0: the whole arm) is there in half of the learning runs and shows most at joint 1.
MORE = (("air_drag", 2), ("rotor_inertia", 2), ("gain_error", 1), ("gain_error", 2), ("payload", 0))

#: Largest load coefficient and gain change: at 1 the torque would be infinite.
_MOST_SHARE = 0.95
#: Largest of other sizes, in the parameter's unit; thermal drift ends at the catalogue's bound.
_MOST, _MOST_RATE_1_S = 1e3, 0.1
#: A torque that friction makes of itself has settled when it changes by less than this [N m].
_SETTLED_N_M = 1e-9


def drawn(set_name: str, name: str, joint: int, seed: int) -> Effect:
    """Draw an effect at the greatest strength that it may have; `sized` makes it smaller."""
    rng = np.random.default_rng([seed, zlib.crc32(f"{set_name} {name} {joint}".encode())])
    runs = [run for run in read_set(set_name) if run.learning]
    if name == "payload":
        on = sorted(rng.choice([run.number for run in runs], len(runs) // 2, replace=False).tolist())
        return Effect(name, {"mass_kg": _MOST, "trials": on}, ())
    return Effect(name, _DRAWN[name](rng, runs, joint - 1), (joint,))


def _end_stop(rng: Rng, runs: Sequence[Run], i: int) -> Mapping[str, float]:
    side, share = either_way(rng), rng.uniform(0.75, 0.95)
    angle = np.quantile(np.concatenate([run.q[:, i] for run in runs]), share if side > 0.0 else 1.0 - share)
    return {"angle_rad": float(angle), "stiffness_N_m_rad": _MOST, "side": side}


def _push(rng: Rng, runs: Sequence[Run], i: int) -> Mapping[str, float]:
    """Draw a push in a learning run, about an instant at which the joint moves: at rest friction would hold it."""
    duration = float(rng.uniform(0.1, 0.5))
    middle = float(rng.choice(np.concatenate([run.t[run.moving[:, i]] for run in runs])))
    return {"start_s": middle - duration / 2.0, "duration_s": duration, "torque_N_m": either_way(rng) * _MOST}


def _speed(runs: Sequence[Run], i: int) -> float:
    return rms([run.motion[1][:, i] for run in runs])


_DRAWN: dict[str, Callable[[Rng, Sequence[Run], int], Mapping[str, float]]] = {
    "coulomb_asymmetry": lambda rng, runs, i: {"difference_N_m": either_way(rng) * _MOST},
    "stribeck": lambda rng, runs, i: {
        "amplitude_N_m": _MOST,
        "velocity_rad_s": _speed(runs, i) * log_uniform(rng, 0.1, 0.8),
    },
    "load_friction": lambda rng, runs, i: {"coefficient": _MOST_SHARE},
    "quadratic_drag": lambda rng, runs, i: {"drag_N_m_s2": _MOST},
    "joint_spring": lambda rng, runs, i: {"stiffness_N_m_rad": _MOST, "rest_angle_rad": rng.uniform(-0.8, 0.8)},
    "end_stop": _end_stop,
    "cogging": lambda rng, runs, i: {
        "amplitude_N_m": _MOST,
        "phase_rad": rng.uniform(-np.pi, np.pi),
        "periods_per_turn": float(round(log_uniform(rng, 4.0, 40.0))),
    },
    "torque_offset": lambda rng, runs, i: {"torque_N_m": either_way(rng) * _MOST},
    "thermal_drift": lambda rng, runs, i: {"rate_1_s": _MOST_RATE_1_S},
    "periodic_disturbance": lambda rng, runs, i: {
        "amplitude_N_m": _MOST,
        "frequency_hz": log_uniform(rng, 0.3, 6.0),
        "phase_rad": rng.uniform(-np.pi, np.pi),
    },
    "external_push": _push,
    "air_drag": lambda rng, runs, i: {"drag_N_m_s2": _MOST},
    "rotor_inertia": lambda rng, runs, i: {"inertia_kg_m2": _MOST},
    "gain_error": lambda rng, runs, i: {"factor": 1.0 - _MOST_SHARE},
}


def sized(effect: Effect, share: float, arm: Arm, runs: Sequence[Run]) -> Effect:
    """Return the effect with that share of the torque's rms at its joint, over the learning runs.

    It stays as it was drawn where even that is too little.
    """
    i = (effect.joints or (1,))[0] - 1
    learning = [run for run in runs if run.learning]
    wanted = share * rms([run.tau[:, i] for run in learning])

    def beyond(s: float) -> float:
        weaker = scaled(effect, s)
        return rms([added_torque(arm, weaker, run)[:, i] for run in learning]) - wanted

    return effect if beyond(1.0) <= 0.0 else scaled(effect, float(scipy.optimize.brentq(beyond, 0.0, 1.0)))


def scaled(effect: Effect, s: float) -> Effect:
    """Return the effect with s times its strength: its linear numbers that much nearer to doing nothing."""
    values = dict(effect.parameters)
    for parameter in catalogue()[effect.name].parameters:
        if parameter.linear:
            neutral = parameter.neutral or 0.0
            values[parameter.name] = neutral + s * (number(values, parameter.name) - neutral)
    return replace(effect, parameters=values)


def added_torque(arm: Arm, effect: Effect, run: Run) -> Floats:
    """Return what the measured torque of a run would have been more with this effect, (n_sample, n) [N m].

    The motion is the same, so what the effect resists with is added; where it resists by the load, the load is
    that with it.
    """
    more = np.zeros_like(run.tau)
    while True:
        before, more = more, resistance(arm, effect, run, run.tau + more)
        if np.abs(more - before).max() < _SETTLED_N_M:
            return more


def resistance(arm: Arm, effect: Effect, run: Run, tau: Floats) -> Floats:
    """Return the torque (n_sample, n) [N m] with which an effect resists the motion of a run that tau drives.

    Where a joint gets another share of the torque than was asked for, that is what doesn't reach it.
    """
    if effect.name == "gain_error":
        lost = np.zeros_like(tau)
        for i in (joint - 1 for joint in effect.joints):
            lost[:, i] = (1.0 - number(effect.parameters, "factor")) * tau[:, i]
        return lost
    q, dq, ddq, direction = run.motion
    plain = replace(arm, effects=())
    acting = replace(arm, effects=(effect,))
    resisting = resisting_torque(acting, q, dq, ddq, tau, run.t, run.number, direction)
    if catalogue()[effect.name].change is None:
        return resisting
    return resisting + inverse_dynamics(changed(acting), q, dq, ddq) - inverse_dynamics(plain, q, dq, ddq)


@cache
def rubbing_arm(set_name: str) -> Arm:
    """Return the recordings' arm with the friction that a plain fit finds: thermal drift multiplies it."""
    arm, runs = load_arm(ARM), [run for run in read_set(set_name) if run.learning]
    n, lengths, gravity = (
        arm.n_joint,
        np.array([joint.a_m for joint in arm.joints]),
        np.array(arm.gravity_m_s2[:2]),
    )
    rows = [columns(lengths, gravity, *run.motion[:3]) for run in runs]
    torque = [lowpass(run.tau, RATE_HZ, _BAND_HZ) for run in runs]
    found = fit(
        np.concatenate([lowpass(Y, RATE_HZ, _BAND_HZ) for Y in rows]),
        np.concatenate(torque),
        np.concatenate([run.moving for run in runs]),
    )
    friction = np.maximum(found[4 * n :].reshape(2, n), 0.0)
    joints = (
        replace(joint, friction=Friction(float(viscous), float(coulomb)))
        for joint, viscous, coulomb in zip(arm.joints, *friction, strict=True)
    )
    return replace(arm, joints=tuple(joints))


#: Both sides of that fit are compared below this [Hz].
_BAND_HZ = 5.0
