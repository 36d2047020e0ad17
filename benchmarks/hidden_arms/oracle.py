"""What a model that knows the truth leaves of the torque.

It is evaluated from the definitions of the effects and the noisy measurements of the evaluating trials: angles are
smoothed and differentiated, the torque goes through the effect's drive, and in the band of the motion both sides
are compared. Nothing of the fitter is used: it checks that cases are hidden as they are defined.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.ndimage
import scipy.signal
from numpy.typing import NDArray

from benchmarks.hidden_arms.unexplained import columns, fit, lowpass, rms

Floats = NDArray[np.float64]
Entry = Mapping[str, Any]

#: Corner of the angles before they are differentiated, and of both sides of the equation after that.
ANGLE_HZ, BAND_HZ = 20.0, 5.0
#: This much of a trial's ends is where filters guess [s].
ENDS_S = 0.15
#: Below this share of its top speed a joint may be stuck, where any torque may hold it.
SLOW = 0.01
#: … and so near to that the filter mixes it in [s].
NEAR_S = 0.05
#: Torque noises, above which a motor pushes and is not within its play.
CROSSING = 3.0


@dataclass(frozen=True)
class Set:
    """Trials as they were measured: (n_sample,) and (n_sample, n)."""

    t: Floats
    trial: NDArray[np.int64]
    q: Floats
    tau: Floats
    ref: Floats
    rate_hz: float

    def of_trial(self, number: int) -> "Set":
        """Return one trial of the set."""
        rows = self.trial == number
        parts = (column[rows] for column in (self.t, self.trial, self.q, self.tau, self.ref))
        return Set(*parts, rate_hz=self.rate_hz)

    @property
    def jumps(self) -> NDArray[np.bool_]:
        """Where the target has just jumped, and the torque with it (n_sample,)."""
        return np.any(np.diff(self.ref, axis=0, prepend=self.ref[:1]) != 0.0, axis=1)


@dataclass(frozen=True)
class Known:
    """What is given: lengths (n,), gravity in the arm's plane (2,), and the torque's noise (n,)."""

    lengths: Floats
    gravity: Floats
    noise_N_m: Floats


def equations(known: Known, data: Set, effects: Sequence[Entry]) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Return regressor, torque and which equations count, filtered, for a model with these effects.

    Returns
    -------
    (n_sample, n, 6 n), (n_sample, n), (n_sample, n)
    """
    parts = []
    for number in np.unique(data.trial):
        Y, tau, moving = _of_trial(known, data.of_trial(number), int(number), effects)
        ends = slice(round(ENDS_S * data.rate_hz), len(Y) - round(ENDS_S * data.rate_hz))
        parts.append((Y[ends], tau[ends], moving[ends]))
    Y, tau, moving = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    return Y, tau, moving


def _of_trial(
    known: Known, data: Set, number: int, effects: Sequence[Entry]
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    drive, scale = _drive(data, effects)
    q, dq, ddq = _derivatives(data.q - _lead(known, data, drive, effects), data.rate_hz)
    offset, gravity = np.zeros(q.shape[1]), known.gravity.copy()
    for effect in effects:
        p = effect["parameters"]
        if effect["name"] == "joint_zero":
            offset[effect["joints"][0] - 1] += p["offset_rad"]
        if effect["name"] == "gravity_tilt":
            gravity = gravity + np.array([p["gx_m_s2"], p["gy_m_s2"]])
    Y = columns(known.lengths, gravity, q + offset, dq, ddq)
    tau = drive - _resisting(known, data.t, number, (q, dq, ddq), drive, Y, effects)
    moving = np.abs(dq) > SLOW * np.abs(dq).max(axis=0)
    moving = scipy.ndimage.minimum_filter1d(moving, 2 * round(NEAR_S * data.rate_hz) + 1, axis=0)
    return lowpass(Y, data.rate_hz, BAND_HZ) / scale[:, None], lowpass(tau, data.rate_hz, BAND_HZ) / scale, moving


def _drive(data: Set, effects: Sequence[Entry]) -> tuple[Floats, Floats]:
    """Return the torque that reaches the joints, and how large it is beside what was asked for."""
    n = data.tau.shape[1]
    late, scale = np.zeros(n), np.ones(n)
    for effect in effects:
        own = [joint - 1 for joint in effect["joints"]]
        if effect["name"] == "actuator_delay":
            late[own] += effect["parameters"]["delay_s"]
        elif effect["name"] == "gain_error":
            scale[own] *= effect["parameters"]["factor"]
    drive = np.stack([_around(data, data.tau[:, i], late[i]) for i in range(n)], axis=1)
    for effect in effects:
        if effect["name"] == "actuator_lag":
            for i in (joint - 1 for joint in effect["joints"]):
                asked = drive[:, i] if late[i] > 0.0 else data.tau[:, i]
                drive[:, i] = _following(data, asked, effect["parameters"]["time_constant_s"])
    drive *= scale
    for effect in effects:
        if effect["name"] == "torque_saturation":
            i, limit = effect["joints"][0] - 1, effect["parameters"]["limit_N_m"]
            drive[:, i] = np.clip(drive[:, i], -limit, limit)
    return drive, scale


def _around(data: Set, tau: Floats, late_s: float) -> Floats:
    """Return a torque so much later, each sample the mean over the interval about it; jumps have no width."""
    before = np.flatnonzero(data.jumps)
    before = before[before > 0]
    at = np.insert(data.t, before, data.t[before] - 1e-9)
    values = np.insert(tau, before, tau[before - 1])
    parts = (np.arange(8) - 3.5) / (8.0 * data.rate_hz)
    return np.mean([np.interp(data.t - late_s + part, at, values) for part in parts], axis=0)


def _following(data: Set, tau: Floats, time_constant_s: float) -> Floats:
    """Return what follows a torque with a time constant, exact where that is linear between samples or jumps."""
    step = 1.0 / (data.rate_hz * time_constant_s)
    keep = np.exp(-step)
    part = (1.0 - keep) / step
    previous = np.concatenate([tau[:1], tau[:-1]])
    reached = np.where(data.jumps, previous, tau)
    driving = (1.0 - part) * reached + (part - keep) * previous
    return scipy.signal.lfilter([1.0], [1.0, -keep], driving, zi=[keep * tau[0]])[0]


def _lead(known: Known, data: Set, drive: Floats, effects: Sequence[Entry]) -> Floats:
    """Return by how much the motor's side leads the link."""
    lead = np.zeros_like(drive)
    for effect in effects:
        p = effect["parameters"]
        if effect["name"] == "backlash":
            i = effect["joints"][0] - 1
            touching = np.flatnonzero(np.abs(drive[:, i]) > CROSSING * known.noise_N_m[i])
            if len(touching):  # between it crosses, nobody sees how
                side = 0.5 * p["gap_rad"] * np.sign(drive[touching, i])
                lead[:, i] = np.interp(np.arange(len(drive)), touching, side)
        elif effect["name"] == "joint_elasticity":
            i, k, d = effect["joints"][0] - 1, p["stiffness_N_m_rad"], p["damping_N_m_s"]
            lead[:, i] = (_following(data, drive[:, i], d / k) if d > 0.0 else drive[:, i]) / k
    return lead


def _derivatives(q: Floats, rate_hz: float) -> tuple[Floats, Floats, Floats]:
    smooth = lowpass(q, rate_hz, ANGLE_HZ)
    dq = np.gradient(smooth, 1.0 / rate_hz, axis=0)
    return smooth, dq, np.gradient(dq, 1.0 / rate_hz, axis=0)


def _resisting(
    known: Known,
    t: Floats,
    number: int,
    motion: tuple[Floats, Floats, Floats],
    drive: Floats,
    Y: Floats,
    effects: Sequence[Entry],
) -> Floats:
    """Return the torque that the effects resist with, (n_sample, n)."""
    out, n = np.zeros_like(drive), drive.shape[1]
    for effect in effects:
        name, p = effect["name"], effect["parameters"]
        if name == "payload":
            there = number in p["trials"] if "trials" in p else t >= p.get("since_s", -np.inf)
            L = known.lengths[-1]
            at_tip = Y[:, :, 4 * n - 4] + L * Y[:, :, 4 * n - 3] + L * L * Y[:, :, 4 * n - 1]
            out += p["mass_kg"] * at_tip * np.reshape(there, (-1, 1))
        for i in (joint - 1 for joint in effect["joints"]):
            q, dq, ddq = (column[:, i] for column in motion)
            if name == "rotor_inertia":
                out[:, i] += p["inertia_kg_m2"] * ddq
            elif name == "air_drag":
                turning = motion[1][:, : i + 1].sum(axis=1)
                out[:, : i + 1] += (p["drag_N_m_s2"] * turning * np.abs(turning))[:, None]
            elif name in RESISTING:
                out[:, i] += RESISTING[name](p, t, q, dq, drive[:, i])
    return out


#: What resists at a joint, of its parameters, the time, its angle and velocity, and the torque that drives it.
RESISTING: dict[str, Any] = {
    "viscous": lambda p, t, q, dq, tau: p["viscous_N_m_s"] * dq,
    "coulomb": lambda p, t, q, dq, tau: p["coulomb_N_m"] * np.sign(dq),
    "coulomb_asymmetry": lambda p, t, q, dq, tau: p["difference_N_m"],
    "stribeck": lambda p, t, q, dq, tau: (
        p["amplitude_N_m"] * np.exp(-((dq / p["velocity_rad_s"]) ** 2)) * np.sign(dq)
    ),
    "load_friction": lambda p, t, q, dq, tau: p["coefficient"] * np.abs(tau) * np.sign(dq),
    "quadratic_drag": lambda p, t, q, dq, tau: p["drag_N_m_s2"] * dq * np.abs(dq),
    "joint_spring": lambda p, t, q, dq, tau: p["stiffness_N_m_rad"] * (q - p["rest_angle_rad"]),
    "end_stop": lambda p, t, q, dq, tau: (
        p["stiffness_N_m_rad"] * p["side"] * np.maximum(p["side"] * (q - p["angle_rad"]), 0.0)
    ),
    "cogging": lambda p, t, q, dq, tau: -p["amplitude_N_m"] * np.sin(p["periods_per_turn"] * q + p["phase_rad"]),
    "torque_offset": lambda p, t, q, dq, tau: -p["torque_N_m"],
    "thermal_drift": lambda p, t, q, dq, tau: p["rate_1_s"] * t * (p["D"] * dq + p["fc"] * np.sign(dq)),
    "periodic_disturbance": lambda p, t, q, dq, tau: (
        -p["amplitude_N_m"] * np.sin(2.0 * np.pi * p["frequency_hz"] * t + p["phase_rad"])
    ),
    "external_push": lambda p, t, q, dq, tau: (
        -p["torque_N_m"] * ((t >= p["start_s"]) & (t <= p["start_s"] + p["duration_s"]))
    ),
}


def true_effects(truth: Mapping[str, Any]) -> list[Entry]:
    """Return the hidden effects as an arm file would have them, with the friction that a drift multiplies."""
    entries = [
        {"name": effect["effect"], "joints": entry.get("joints", []), "parameters": entry["parameters"]}
        for effect in truth["effects"]
        for entry in effect["entries"]
    ]
    return [_with_friction(entry, truth["arm"]["friction"]) for entry in entries]


def _with_friction(effect: Entry, friction: Sequence[Sequence[float]]) -> Entry:
    if effect["name"] != "thermal_drift":
        return effect
    i = effect["joints"][0] - 1
    rubbing = {"D": friction[i][0], "fc": friction[i][1]}
    return {**effect, "parameters": {**effect["parameters"], **rubbing}}


def left_by_oracle(known: Known, learn: Set, evaluate: Set, effects: Sequence[Entry]) -> Floats:
    """Return the rms (n,) that is left in the evaluating trials by a base model fitted beside these effects."""
    Y, tau, moving = equations(known, learn, effects)
    parameters = fit(Y, tau, moving)
    Y, tau, moving = equations(known, evaluate, effects)
    return rms(tau - Y @ parameters, moving)
