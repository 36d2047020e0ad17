"""How often the sensors' diagnosis names what was hidden in them: hidden cases, one effect each, and none.

Effects are put into the readings here, not by the program's own simulation of them. The motions are the bench's,
lying and hanging; sizes run from a little above what the bench's own imperfections are to gross.
"""

import argparse
import sys
import time
from collections import Counter
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from rich.table import Table

from arm.accelerometer import specific_force
from arm.arm_file import load_arm
from arm.bench import Bench, motions
from arm.counts import COUNT_M_S2, FULL_SCALE_M_S2
from arm.highpass import HighPass
from arm.kinematics import axis_frames, rotation_from_rpy
from arm.model import Arm, Floats, Sensor
from fitter.data.raw import RawRun
from fitter.reading_diagnosis.rigidity import diagnose_sensors
from fitter.reading_diagnosis.sensor_verdict import SensorFinding
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, console, run_command

ARMS = ("dd-arm", "dd-arm-vertical")
EFFECTS = (
    "sensor_bias",
    "sensor_drift",
    "sensor_scale",
    "sensor_misalignment",
    "mounting_radius",
    "sensor_highpass",
    "sensor_clipping",
    "time_skew",
    "base_motion",
    "none",
)
LEARNING, EVALUATING, RATE_HZ = 5, 6, 2000.0
#: Seeds of the cases begin here; those below 1100 were used to build the diagnosis.
FIRST_SEED = 5000
#: Different motions of each arm; a case draws sensor, size and noise of its own.
MOTIONS = 8


@dataclass(frozen=True)
class Hidden:
    """What was hidden: the arm as its file has it, the readings, and the truth."""

    arm: Arm
    runs: list[RawRun]
    effect: str
    sensors: tuple[str, ...]
    values: dict[str, float]


@cache
def _motion(name: str, seed: int) -> tuple[Floats, Floats, Floats]:
    bench = Bench(rate_hz=RATE_HZ, learning=LEARNING, evaluating=EVALUATING)
    found = list(motions(load_arm(name), bench, seed))
    q, dq, ddq = (np.concatenate([getattr(motion, part) for motion in found]) for part in ("q", "dq", "ddq"))
    return q, dq, ddq


def draw(effect: str, rng: np.random.Generator) -> dict[str, float]:
    """Draw an effect's parameters; a clipping level is drawn as a share of what is read."""
    u = rng.uniform(0.3, 1.0, 3) * rng.choice([-1.0, 1.0], 3)
    size = rng.uniform
    drawn: dict[str, tuple[str, Floats]] = {
        "none": ("", np.zeros(0)),
        "sensor_bias": ("x_m_s2 y_m_s2 z_m_s2", u * size(0.15, 0.5)),
        "sensor_drift": ("x_m_s3 y_m_s3 z_m_s3", u * 10.0 ** size(-3.3, -2.0)),
        "sensor_scale": ("x y z", 1.0 + u * size(0.03, 0.15)),
        "sensor_misalignment": ("roll_rad pitch_rad yaw_rad", u * size(0.02, 0.15)),
        "mounting_radius": ("x_m y_m z_m", u * size(0.005, 0.03)),
        "sensor_highpass": ("corner_hz", 10.0 ** size(-1.5, 0.3, 1)),
        "sensor_clipping": ("level_m_s2", size(0.2, 0.7, 1)),
        "time_skew": ("delay_s", 10.0 ** size(-2.5, -1.7, 1)),
        "base_motion": (
            "x_m_s2 y_m_s2 z_m_s2 frequency_hz",
            np.array([*(size(0.3, 1.0, 3) * size(0.03, 0.3)), 10.0 ** size(-0.3, 1.0)]),
        ),
    }
    names, values = drawn[effect]
    return dict(zip(names.split(), values.tolist(), strict=True))


def mounted(sensor: Sensor, effect: str, values: Floats) -> Sensor:
    """Return a sensor with those effects that are other numbers of it."""
    x = tuple(values.tolist())
    if effect == "sensor_bias":
        return replace(sensor, bias_m_s2=x)
    if effect == "sensor_scale":
        return replace(sensor, scale=x)
    if effect == "sensor_misalignment":
        return replace(sensor, rotation_rad=x)
    if effect == "mounting_radius":
        return replace(sensor, position_m=tuple(np.add(sensor.position_m, values).tolist()))
    return replace(sensor, highpass_hz=float(values[0])) if effect == "sensor_highpass" else sensor


def moved_base(arm: Arm, q: Floats, t: Floats, values: Floats) -> Floats:
    """Return what every sensor feels of a base that moves, (n, n_sensor, 3)."""
    base = np.sqrt(2.0) * np.sin(2.0 * np.pi * values[3] * t)[:, None] * values[:3]
    frames = axis_frames(arm, q)
    turned = [frames[:, one.joint - 1, :3, :3] @ rotation_from_rpy(*one.rotation_rad) for one in arm.sensors]
    return np.stack([np.einsum("kxc,kx->kc", one, base) for one in turned], axis=1)


def hide(number: int, name: str, effect: str) -> Hidden:
    """Return a case, drawn by its number."""
    rng = np.random.default_rng([FIRST_SEED + number, 4])
    arm, truth = load_arm(name), draw(effect, rng)
    k, values = int(rng.integers(len(arm.sensors))), np.array(list(truth.values()))
    q, dq, ddq = _motion(name, FIRST_SEED + number % MOTIONS)
    t = np.arange(len(q)) / RATE_HZ
    sensors = list(arm.sensors)
    sensors[k] = mounted(sensors[k], effect, values)
    true = replace(arm, sensors=tuple(sensors))
    a = specific_force(true, q, dq, ddq)
    if effect == "base_motion":
        a += moved_base(true, q, t, values)
    if effect == "time_skew":
        a[:, k] = np.column_stack([np.interp(t - values[0], t, column) for column in a[:, k].T])
    a = (a * np.array([one.scale for one in sensors])).reshape(len(t), -1)
    HighPass(np.repeat([one.highpass_hz for one in sensors], 3), RATE_HZ).apply(a)
    a += np.ravel([one.bias_m_s2 for one in sensors]) + 0.02 * rng.standard_normal(a.shape[1])
    its = slice(3 * k, 3 * k + 3)
    if effect == "sensor_drift":
        a[:, its] += t[:, None] * values
    a += 0.02 * rng.standard_normal(a.shape)
    if effect == "sensor_clipping":  # so that two axes or more reach it
        level = float(values[0] * np.sort(np.abs(a[:, its]).max(axis=0))[1])
        a[:, its], truth = np.clip(a[:, its], -level, level), {"level_m_s2": level}
    a = np.clip(np.rint(a / COUNT_M_S2) * COUNT_M_S2, -FULL_SCALE_M_S2, FULL_SCALE_M_S2)
    n = len(t) // (LEARNING + EVALUATING)
    runs = [RawRun(f"{at}", RATE_HZ, t[at : at + n], a[at : at + n]) for at in range(0, len(t), n)]
    whose = () if effect in ("none", "base_motion") else (sensors[k].name,)
    return Hidden(arm, runs, effect, whose, truth)


@dataclass(frozen=True)
class Judged:
    """How a case was judged: name, class, sensor right; numbers inside their intervals."""

    effect: str
    verdict: str
    named: str
    right: bool
    sensor_right: bool
    inside: int
    numbers: int
    seconds: float


def judge(hidden: Hidden) -> Judged:
    """Diagnose a case and compare with the truth."""
    start = time.perf_counter()
    found = diagnose_sensors(hidden.arm, hidden.runs[:LEARNING], hidden.runs[LEARNING:])
    seconds = time.perf_counter() - start
    if hidden.effect == "none":
        return Judged("none", found.verdict, _said(found), found.verdict == "none", True, 0, 0, seconds)
    effects = {cause.effect for cause in found.causes}
    right = effects == {hidden.effect} or (found.verdict == "ambiguous" and hidden.effect in effects)
    its = [cause for cause in found.causes if cause.effect == hidden.effect and cause.sensors == hidden.sensors]
    known = [(its[0].parameters[name], value) for name, value in hidden.values.items()] if its else []
    inside = sum(abs(number.value - value) <= 1.96 * number.std for number, value in known)
    return Judged(hidden.effect, found.verdict, _said(found), right, bool(its), inside, len(known), seconds)


def _said(found: SensorFinding) -> str:
    return " or ".join(" ".join((cause.effect, *cause.sensors)) for cause in found.causes) or found.verdict


def measure(arguments: argparse.Namespace) -> Document:
    """Diagnose the cases, show the table and return what was said of each."""
    judged = []
    table = Table("hidden", "cases", "right name", "sensor", "named alone", "inside 95 %", "s", "wrongly said")
    for number in range(arguments.skip, arguments.skip + arguments.cases):
        effect, name = EFFECTS[number % len(EFFECTS)], ARMS[number // len(EFFECTS) % len(ARMS)]
        judged.append(judge(hide(number, name, effect)))
        if not judged[-1].right or not judged[-1].sensor_right:
            console.print(f"case {number}: {name}, {effect}: {judged[-1].named}")
    for effect in (*EFFECTS, "all"):
        cases = [one for one in judged if one.effect == effect or (effect == "all" and one.effect != "none")]
        right = [one for one in cases if one.right]
        if not cases:
            continue
        inside, numbers = sum(one.inside for one in right), sum(one.numbers for one in right)
        table.add_row(
            effect,
            str(len(cases)),
            f"{100 * len(right) / len(cases):.0f} %",
            f"{100 * sum(one.sensor_right for one in right) / max(1, len(right)):.0f} %",
            f"{100 * sum(one.verdict == 'named' for one in right) / len(cases):.0f} %",
            f"{100 * inside / numbers:.0f} %" if numbers else "",
            f"{np.mean([one.seconds for one in cases]):.1f}",
            ", ".join(said for said, _ in Counter(one.named for one in cases if not one.right).most_common()),
        )
    console.print(table)
    return {"cases": [one.__dict__ for one in judged]}


def main(argv: list[str] | None = None) -> int:
    """Run the benchmark."""
    parser = Parser(prog="python -m benchmarks.diagnosis_sensors", description=__doc__, parents=[common_options()])
    parser.add_argument("--cases", type=int, default=60, help="hidden cases (default: 60)")
    parser.add_argument("--skip", type=int, default=0, help="cases to leave out at the beginning (default: 0)")
    parser.set_defaults(action=measure)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
