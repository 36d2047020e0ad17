"""Known torque pulses hidden in measured runs: how many `find_pulses` finds, and what it finds besides.

    python -m benchmarks.pulses FOLDER --runs acrobot

FOLDER holds the runs of DFKI's double pendulum with pulses (columns ``tau_pert1``, ``tau_pert2`` of their own).
The pulses are taken out of the measured torque; what is found is compared with them. The arm is
``examples/dfki-pendulum.toml``, its base parameters fitted robustly with viscous and Coulomb friction, a torque
offset at both joints and the elbow's rotor inertia.
"""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from arm.arm_file import load_arm
from arm.model import Arm, Floats
from arm.regressor import regressor
from fitter.data.derivatives import both_derivatives, lowpass, settling_samples
from fitter.diagnosis.torque.pulse import Pulse
from fitter.diagnosis.torque.pulses import find_pulses
from fitter.diagnosis.torque.residual_torque import ResidualTorque

ARM = Path(__file__).parents[1] / "examples" / "dfki-pendulum.toml"
#: Step [s]; speed below which a joint may rest, and for how long about it its equation is not known.
STEP_S, REST_RAD_S, REST_S = 0.002, 0.05, 0.1
#: Noise of the measured torque and of the angles (their resolution), with an inertia of 0.05 kg m^2.
TORQUE_NOISE, ANGLE_NOISE = 0.005, 0.05 * 3.8e-4 / np.sqrt(12.0)
#: Tukey's constant of 95 % efficiency, and reweightings.
TUKEY, N_REWEIGHTED = 4.685, 25
#: A pulse of at least this size [N m] is asked for; found within these of its start [s] and of its size.
LEAST, NEAR_S, NEAR_SIZE = 0.35, 0.05, 0.3


@dataclass(frozen=True)
class Run:
    """A run: its rows of the torque equation, filtered, and the hidden pulses (joint, start, duration, size)."""

    name: str
    t: Floats
    dq: Floats
    columns: Floats
    torque: Floats
    hidden: list[tuple[int, float, float, float]]


def load(path: Path, arm: Arm, band_hz: float) -> Run:
    """Return a run without its pulses, resampled."""
    table = np.genfromtxt(path, delimiter=",", names=True)
    t = np.arange(table["time"][0], table["time"][-1], STEP_S)
    torque, q, hidden = [], [], []
    for j in (1, 2):
        torque.append(np.interp(t, table["time"], table[f"tau_meas{j}"] - table[f"tau_pert{j}"]))
        q.append(np.interp(t, table["time"], table[f"pos_meas{j}"]))
        hidden += [(j - 1, *pulse) for pulse in _bumps(table["time"], table[f"tau_pert{j}"])]
    angles = lowpass(np.stack(q, axis=1), STEP_S, band_hz)
    dq, ddq = both_derivatives(angles, STEP_S)
    columns = regressor(arm, angles, dq, ddq)
    more = np.zeros((len(t), 2, 3))
    for j in (0, 1):
        columns[:, j, 22 + j] = np.tanh(dq[:, j] / REST_RAD_S)
        more[:, j, j] = 1.0
    more[:, 1, 2] = ddq[:, 1]  # the elbow's rotor
    columns = lowpass(np.concatenate([columns, more], axis=2), STEP_S, band_hz)
    return Run(path.stem, t, dq, columns, lowpass(np.stack(torque, axis=1), STEP_S, band_hz), hidden)


def _bumps(t: Floats, torque: Floats) -> list[tuple[float, float, float]]:
    """Return each pulse's start and duration at half its height, and its height."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], np.abs(torque) > 0.02, [0]]).astype(int)))
    found = []
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        part = torque[first:last]
        size = float(part[np.argmax(np.abs(part))])
        above = first + np.flatnonzero(np.abs(part) >= abs(size) / 2.0)
        found.append((float(t[above[0]]), float(t[above[-1]] - t[above[0]]), size))
    return found


def residuals(runs: list[Run], band_hz: float) -> list[ResidualTorque]:
    """Return what a robust fit (Tukey's biweight) over all runs misses.

    Nothing is known of a run's ends: accelerations of an arm that still moves lean there on what lies beyond,
    which the filter guesses.
    """
    ends = settling_samples(STEP_S, band_hz)
    W = np.concatenate([run.columns.reshape(-1, run.columns.shape[2]) for run in runs])
    torque = np.concatenate([run.torque.ravel() for run in runs])
    moves = np.concatenate([_inner(np.abs(run.dq) > REST_RAD_S, ends).ravel() for run in runs])
    joint = np.arange(len(torque)) % 2
    size = np.linalg.norm(W, axis=0)
    W = W / np.where(size > 0.0, size, 1.0)
    weight = moves.astype(float)
    for _ in range(N_REWEIGHTED):
        root = np.sqrt(weight)
        p = np.linalg.lstsq(W * root[:, None], torque * root, rcond=1e-6)[0]
        r = W @ p - torque
        scale = np.array([np.median(np.abs(r[moves & (joint == j)])) / 0.6745 for j in (0, 1)])
        weight = moves * np.clip(1.0 - (r / (TUKEY * scale[joint])) ** 2, 0.0, None) ** 2
    missed = np.split(r.reshape(-1, 2), np.cumsum([len(run.t) for run in runs])[:-1])
    noise = np.full(2, TORQUE_NOISE), np.full(2, ANGLE_NOISE)
    near = 1 + 2 * round(REST_S / STEP_S)
    known = [_inner(maximum_filter1d(np.abs(run.dq), near, axis=0) > REST_RAD_S, ends) for run in runs]
    trials = []
    for run, part, moving in zip(runs, missed, known, strict=True):
        no_friction = *np.zeros((2, *part.shape)), np.zeros_like(moving)
        trials.append(ResidualTorque(run.t, part, moving, run.torque, band_hz, *noise, *no_friction))
    return trials


def _inner(usable: NDArray[np.bool_], ends: int) -> NDArray[np.bool_]:
    """Return the same rows, (n, n_joint), without the first and last `ends`."""
    inner = np.zeros_like(usable)
    inner[ends : len(usable) - ends] = usable[ends : len(usable) - ends]
    return inner


def report(runs: list[Run], found: list[Pulse]) -> str:
    """Return the hidden pulses with what was found there, and what was found elsewhere."""
    lines = []
    n_asked, n_found, n_near, there = 0, 0, 0, set[Pulse]()
    for k, run in enumerate(runs):
        for joint, start_s, lasting, size in run.hidden:
            at = [p for p in found if (p.trial, p.joint) == (k, joint)]
            near = [p for p in at if start_s - p.duration_s < p.start_s < start_s + lasting]
            there |= set(near)
            if abs(size) < LEAST:
                continue
            right = any(
                abs(p.start_s - start_s) <= NEAR_S and abs(p.torque_N_m / size - 1.0) <= NEAR_SIZE for p in near
            )
            n_asked, n_found, n_near = n_asked + 1, n_found + right, n_near + bool(near)
            said = "found" if right else "missed"
            lines.append(f"{said:6s} {run.name} joint {joint + 1}  {_said(start_s, lasting, size)}")
            lines += [f"  {p.form:12s} {_said(p.start_s, p.duration_s, p.torque_N_m)}" for p in near]
    false = [p for p in found if p not in there]
    for p in false:
        name = runs[p.trial].name
        lines.append(f"false  {name} joint {p.joint + 1}  {_said(p.start_s, p.duration_s, p.torque_N_m)}")
    seconds = sum(2.0 * float(run.t[-1] - run.t[0]) for run in runs)
    within = f"{n_found} of {n_asked} within {NEAR_S} s and {NEAR_SIZE:.0%}, {n_near} overlap"
    return "\n".join([*lines, f"{within}; {len(false)} false in {seconds:.0f} s of a joint\n"])


def _said(start_s: float, duration_s: float, size: float) -> str:
    return f"{start_s:.2f} s for {duration_s:.2f} s, {size:+.2f} N m"


def main() -> None:
    """Judge the pulses found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--runs", default="", help="beginning of the runs' names, as acrobot")
    parser.add_argument("--band", type=float, default=10.0, help="corner of the filter [Hz]")
    arguments = parser.parse_args()
    arm = load_arm(str(ARM))
    runs = [load(path, arm, arguments.band) for path in sorted(arguments.folder.glob(f"{arguments.runs}*.csv"))]
    if not runs:
        parser.error(f"{arguments.folder}: no run {arguments.runs}*.csv")
    sys.stdout.write(report(runs, find_pulses(residuals(runs, arguments.band))))


if __name__ == "__main__":
    main()
