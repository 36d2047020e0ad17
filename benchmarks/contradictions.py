"""Data that contradict themselves, given to the real commands: silent, a traceback, or right.

    python -m benchmarks.contradictions [--only KIND] [--seeds 3] [--first 0]

Every input is made here: an arm, a motion with the torque that it takes (or its tip, or its accelerations), and
one fault in it. Right is an answer that holds all the same, or a sentence that names the cause. Faultless data
must raise no question at all.
"""

import argparse
import io
import json
import re
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet
from numpy.typing import NDArray

from arm.accelerometer import specific_force
from arm.arm_file import load_arm, save_arm
from arm.kinematics import tip_position
from arm.model import Arm, Control, Friction, Joint, Link
from arm.newton_euler import inverse_dynamics
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.__main__ import main as fitter
from limbcal import command

Floats = NDArray[np.float64]
Columns = dict[str, Floats]

RATE_HZ, SECONDS, NOISE = 250.0, 6.0, 0.01
#: Standard errors within which a parameter is right: chance takes one in 1.7 million further (normal).
STD_OFF = 5.0
QUESTIONS = re.compile(
    r"\?|unwrapped|do not count|left out|repeat the row|ms late|impossible|next to nothing", re.I
)


@dataclass
class Ran:
    """What a command did: exit code, document, words, traceback."""

    code: int
    document: dict
    said: str
    crashed: bool


@dataclass
class Case:
    """One input: how to run it, and what is right."""

    kind: str
    name: str
    run: Callable[[Path], Ran]
    right: Callable[[Ran], bool]
    result: str = field(default="")


def arms() -> list[Arm]:
    """Return arms of one, two and three joints with gravity, torque measured."""
    rng = np.random.default_rng(7)
    two = replace(load_arm("dd-arm-vertical"), control=Control(), name="two")
    joint = Joint("revolute", 0.0, 0.4, 0.0, 0.0, 0.0, friction=Friction(0.2, 0.1, 0.0), link=_rod(2.0, 0.4))
    one = Arm("one", (joint,), (0.0, -9.80665, 0.0), control=Control())
    three = Arm(
        "three",
        tuple(
            Joint(
                "revolute",
                alpha,
                a,
                d,
                0.0,
                0.0,
                friction=Friction(*rng.uniform(0.05, 0.3, 2).tolist(), 0.0),
                link=_rod(m, 0.3),
            )
            for alpha, a, d, m in ((0.0, 0.0, 0.2, 3.0), (np.pi / 2, 0.3, 0.0, 2.0), (0.0, 0.25, 0.0, 1.0))
        ),
        (0.0, 0.0, -9.80665),
        control=Control(),
    )
    return [one, two, three]


def _rod(mass: float, length: float) -> Link:
    slim, long = 0.002 * mass, mass * length**2 / 3 + 0.001 * mass
    return Link(mass, (length / 2, 0.01, 0.005), (slim, long, long, 0.0, 0.0, 0.0))


def motion(arm: Arm, seed: int, size: float = 1.0) -> Columns:
    """Return a motion of three sines a joint with tip and torque, and 1 % of noise in the torque."""
    rng, n = np.random.default_rng(seed), arm.n_joint
    t = np.arange(0.0, SECONDS, 1.0 / RATE_HZ)
    amplitude, pulse, phase = (rng.uniform(*span, (3, 1, n)) for span in ((0.2, 0.6), (1.0, 7.0), (0.0, 6.28)))
    angle = pulse * t[:, None] + phase
    q = size * (amplitude * np.sin(angle)).sum(0)
    dq = size * (amplitude * pulse * np.cos(angle)).sum(0)
    ddq = -size * (amplitude * pulse**2 * np.sin(angle)).sum(0)
    tau = inverse_dynamics(arm, q, dq, ddq)
    tip = tip_position(replace(arm, tip=None), q)
    return {
        "t": t,
        "q": q + 1e-5 * rng.normal(size=q.shape),
        "dq": dq,
        "ddq": ddq,
        "tau": tau + NOISE * np.std(tau, axis=0) * rng.normal(size=tau.shape),
        "tip": tip + 2e-4 * rng.normal(size=tip.shape),
    }


def write(
    path: Path, columns: Columns, roles: Sequence[str] = ("q", "tau"), names: dict[str, str] | None = None
) -> Path:
    """Write columns as CSV, Parquet by the suffix."""
    flat: dict[str, Floats] = {(names or {}).get("t", "t"): columns["t"]}
    for role in roles:
        ends = "xyz" if role == "tip" else [str(j + 1) for j in range(columns[role].shape[1])]
        flat |= {
            (names or {}).get(role, "{}").format(f"{role}{end}"): columns[role][:, k] for k, end in enumerate(ends)
        }
    if path.suffix == ".parquet":
        pyarrow.parquet.write_table(pa.table(flat), path)
    else:
        np.savetxt(
            path,
            np.column_stack(list(flat.values())),
            delimiter=",",
            header=",".join(flat),
            comments="",
            fmt="%.12g",
        )
    return path


def run(*arguments: object) -> Ran:
    """Run the real command in this process."""
    out, err = io.StringIO(), io.StringIO()
    crashed, code = False, 1
    with redirect_stdout(out), redirect_stderr(err), warnings.catch_warnings():
        warnings.simplefilter("always")
        command.console.file = err
        try:
            code = fitter([*map(str, arguments), "--json"])
        except BaseException:  # noqa: BLE001 - that is what is looked for
            crashed = True
            traceback.print_exc(file=err)
    said = " ".join(err.getvalue().split())
    crashed = crashed or "Traceback" in said or "Warning:" in said
    try:
        document = json.loads(out.getvalue())
    except ValueError:
        document = {}
    return Ran(code, document, said, crashed)


def dynamics(
    arm: Arm, columns: Columns, roles: Sequence[str] = ("q", "tau"), held: Columns | None = None, **names: str
):
    """Return what runs `fitter dynamics` on columns in a folder."""

    def go(folder: Path) -> Ran:
        save_arm(arm, folder / "arm.toml")
        learn = write(folder / "learn.csv", columns, roles, names)
        evaluate = ["--evaluate", write(folder / "eval.csv", held, roles, names)] if held is not None else []
        return run(
            "dynamics",
            learn,
            *evaluate,
            "--arm",
            folder / "arm.toml",
            "--method",
            "least-squares",
            "--out",
            folder / "o.toml",
        )

    return go


def kinematics(arm: Arm, columns: Columns, **names: str):
    """Return what runs `fitter kinematics`."""

    def go(folder: Path) -> Ran:
        save_arm(arm, folder / "arm.toml")
        data = write(folder / "tip.csv", columns, ("q", "tip"), names)
        return run(
            "kinematics", data, "--arm", folder / "arm.toml", "--generations", "300", "--out", folder / "o.toml"
        )

    return go


def track(arm: Arm, t: Floats, a: Floats):
    """Return what runs `fitter track`."""

    def go(folder: Path) -> Ran:
        save_arm(arm, folder / "arm.toml")
        names = [f"{sensor.name}{axis}" for sensor in arm.sensors for axis in "xyz"]
        table = np.column_stack([t, a])
        np.savetxt(
            folder / "raw.csv", table, delimiter=",", header=",".join(["t", *names]), comments="", fmt="%.9g"
        )
        return run(
            "track",
            folder / "raw.csv",
            "--arm",
            folder / "arm.toml",
            "--method",
            "filter",
            "--out",
            folder / "o.csv",
        )

    return go


def diagnose(arm: Arm, learn: Columns, held: Columns):
    """Return what runs `fitter diagnose`."""

    def go(folder: Path) -> Ran:
        save_arm(arm, folder / "arm.toml")
        files = [write(folder / f"{name}.csv", data) for name, data in (("learn", learn), ("held", held))]
        return run(
            "diagnose", files[0], "--evaluate", files[1], "--arm", folder / "arm.toml", "--out", folder / "d"
        )

    return go


def says(pattern: str, code: int | None = None) -> Callable[[Ran], bool]:
    """Right is a sentence with these words, and an exit code where one is asked for."""
    return lambda ran: bool(re.search(pattern, ran.said)) and (code is None or ran.code == code)


def holds(arm: Arm, *words: str, off: float = STD_OFF) -> Callable[[Ran], bool]:
    """Right is an answer within `STD_OFF` standard errors (or 1 %), with these words."""
    base = structural_parameters(arm)
    true = dict(zip(base.names, (base.combination @ standard_parameters(arm)).tolist(), strict=True))

    def right(ran: Ran) -> bool:
        if ran.code != 0 or not all(re.search(word, ran.said) for word in words):
            return False
        found = ran.document["parameters"]
        return all(
            abs(found[name]["value"] - value) <= off * found[name]["std"] + 0.01 * abs(value)
            for name, value in true.items()
            if found[name]["identifiable"] and found[name]["std"] is not None
        )

    return right


def holds_or_says(arm: Arm, word: str, off: float = STD_OFF) -> Callable[[Ran], bool]:
    """Right is an answer that holds, or none with a sentence that names the cause."""
    return lambda ran: holds(arm, off=off)(ran) or (ran.code == 4 and bool(re.search(word, ran.said)))


def silent_and_right(arm: Arm) -> Callable[[Ran], bool]:
    """Right is an answer that holds, without a question."""
    return lambda ran: holds(arm)(ran) and not QUESTIONS.search(ran.said)


def with_masses_as_printed(arm: Arm, folder_file: str = "o.toml"):
    """Right is a file that gives back what the document says."""

    def right_in(folder: Path, ran: Ran) -> bool:
        base = structural_parameters(arm)
        back = base.combination @ standard_parameters(load_arm(folder / folder_file))
        found = ran.document["parameters"]
        return ran.code == 0 and all(
            abs(found[name]["value"] - value) <= 1e-6 * max(1.0, abs(value))
            for name, value in zip(base.names, back, strict=True)
        )

    return right_in


def changed(columns: Columns, **others: Floats) -> Columns:
    """Return columns with some of them others."""
    return {**columns, **others}


def wrapped(angle: Floats) -> Floats:
    """Return an angle between −π and π."""
    return np.asarray((angle + np.pi) % (2.0 * np.pi) - np.pi)


def frozen(columns: Columns, joint: int, at: int, length: int) -> Columns:
    """Return columns in which an encoder stands still for a while."""
    q = columns["q"].copy()
    q[at : at + length, joint] = q[at, joint]
    return changed(columns, q=q)


def delayed(columns: Columns, samples: int) -> Columns:
    """Return columns whose torque comes some samples late."""
    return changed(columns, tau=np.roll(columns["tau"], samples, axis=0))


def cases(seeds: Sequence[int]) -> list[Case]:  # noqa: PLR0915 - a list of inputs, one a line
    """Return all inputs."""
    listed: list[Case] = []

    def add(kind: str, name: str, go: Callable[[Path], Ran], right: Callable[[Ran], bool]) -> None:
        listed.append(Case(kind, name, go, right))

    for seed in seeds:
        arm = arms()[seed % 3]
        n, m, held = arm.n_joint, motion(arm, seed), motion(arm, seed + 50)
        where = f"{arm.name}, seed {seed}"
        several = arms()[1 + seed % 2]
        s = motion(several, seed + 20)
        blank = replace(arm, joints=tuple(replace(j, link=Link(), friction=Friction()) for j in arm.joints))
        for roles in (("q", "tau"), ("q", "dq", "ddq", "tau")):
            add("faultless", f"{where} {roles}", dynamics(arm, m, roles, held), silent_and_right(arm))
        add(
            "faultless",
            f"{where} kinematics",
            kinematics(_reaching(several), _tip(several, s)),
            lambda r: r.code == 0 and not QUESTIONS.search(r.said),
        )
        add("torque sign", where, dynamics(arm, changed(m, tau=-m["tau"])), says("load's", 4))
        add(
            "torque sign",
            f"{where} last",
            dynamics(several, changed(s, tau=s["tau"] * np.where(np.arange(several.n_joint) == 0, -1.0, 1.0))),
            says("load's", 4),
        )
        add(
            "torque sign",
            f"{where} diagnose",
            diagnose(arm, changed(m, tau=-m["tau"]), changed(held, tau=-held["tau"])),
            says("load's", 4),
        )
        add(
            "torque columns exchanged",
            where,
            dynamics(several, changed(s, tau=s["tau"][:, ::-1])),
            says("exchanged", 4),
        )
        add("written = printed", where, _written(blank, m), lambda r: r.said.endswith("WRITTEN AS PRINTED"))
        big = motion(several, seed + 30, size=3.0)
        add("turns", where, dynamics(several, changed(big, q=wrapped(big["q"]))), holds(several, "unwrapped"))
        add(
            "turns",
            f"{where} dq",
            dynamics(several, changed(big, q=wrapped(big["q"])), ("q", "dq", "ddq", "tau")),
            holds(several, "unwrapped"),
        )
        add(
            "turns",
            f"{where} kinematics",
            kinematics(_reaching(several), _tip(several, changed(big, q=wrapped(big["q"])), big["q"])),
            lambda r: r.code == 0,
        )
        deg = {role: np.rad2deg(m[role]) for role in ("q", "dq", "ddq")}
        add("degrees", where, dynamics(arm, changed(m, **deg)), says("degrees"))
        add(
            "degrees",
            f"{where} dq too",
            dynamics(arm, changed(m, **deg), ("q", "dq", "ddq", "tau")),
            says("degrees"),
        )
        add(
            "degrees",
            f"{where} q alone",
            dynamics(arm, changed(m, q=deg["q"]), ("q", "dq", "ddq", "tau")),
            says("degrees"),
        )
        add(
            "degrees",
            f"{where} named",
            dynamics(arm, changed(m, q=deg["q"]), ("q", "tau"), q="{} [deg]"),
            holds(arm),
        )
        one = np.where(np.arange(several.n_joint) == seed % several.n_joint, 180.0 / np.pi, 1.0)
        add(
            "degrees",
            f"{several.name}, seed {seed} one joint",
            dynamics(several, changed(s, q=s["q"] * one)),
            says(f"q{seed % several.n_joint + 1} in degrees", 2),
        )
        for unit, factor in (("ms", 1e3), ("us", 1e6), ("ns", 1e9)):
            add(
                "time",
                f"{where} {unit}",
                dynamics(arm, changed(m, t=m["t"] * factor)),
                says("milliseconds|microseconds|nanoseconds"),
            )
        add(
            "time",
            f"{where} [ms]",
            dynamics(arm, changed(m, t=m["t"] * 1e3), ("q", "tau"), t="t [ms]"),
            holds(arm),
        )
        add(
            "torque unit",
            f"{where} [N.mm]",
            dynamics(arm, changed(m, tau=m["tau"] * 1e3), ("q", "tau"), tau="{} [N.mm]"),
            holds(arm),
        )
        add(
            "torque unit",
            f"{where} N.mm, no unit",
            dynamics(arm, changed(m, tau=m["tau"] * 1e3)),
            says("N·mm", 2),
        )
        add(
            "gravity's sign",
            f"{several.name}, seed {seed}",
            dynamics(_upside_down(several), s),
            says("sign of gravity_m_s2", 4),
        )
        tip = _tip(several, s)
        add(
            "tip",
            f"{where} mm",
            kinematics(_reaching(several), changed(tip, tip=1e3 * tip["tip"])),
            says("millimetres"),
        )
        raw_arm = load_arm("dd-arm") if seed % 2 else load_arm("dd-arm-vertical")
        t, a = _raw(raw_arm, seed)
        g = 9.80665
        add(
            "readings",
            f"{raw_arm.name} faultless",
            track(raw_arm, t, a),
            lambda r: r.code == 0 and "?" not in r.said,
        )
        add("readings", f"{raw_arm.name} in g", track(raw_arm, t, a / g), says("in g"))
        still = _raw(replace(raw_arm, gravity_m_s2=(0.0, 0.0, 0.0)), seed)[1]
        add("readings", f"{raw_arm.name} no gravity", track(raw_arm, t, still), says("without gravity"))
        flat = load_arm("dd-arm")
        t2, a2 = _raw(flat, seed + 5)
        down = a2.copy()
        down[:, 2::3] *= -1.0
        add("readings", f"gravity's sign {seed}", track(flat, t2, down), says("gravity"))
        add("readings", f"{flat.name} ms {seed}", track(flat, t2 * 1e3, a2), says("is t in"))
        noise = np.random.default_rng(seed + 9)
        other = motion(arm, seed + 77)
        add(
            "no fit",
            f"{where} other torque",
            dynamics(arm, changed(m, tau=other["tau"] - other["tau"].mean(0))),
            says("next to nothing|impossible|only"),
        )
        garbage = noise.normal(size=m["tau"].shape)
        add(
            "no fit",
            f"{where} noise",
            dynamics(arm, changed(m, tau=garbage)),
            says("next to nothing|impossible", 4),
        )
        add(
            "no fit",
            f"{where} tip",
            kinematics(
                _reaching(several), changed(tip, tip=np.cumsum(noise.normal(0, 5e-3, tip["tip"].shape), 0))
            ),
            says("next to nothing", 4),
        )
        limit = 0.7 * np.abs(m["tau"]).max(axis=0)
        add(
            "cut off",
            where,
            dynamics(arm, changed(m, tau=np.clip(m["tau"], -limit, limit))),
            holds_or_says(arm, "cut off", off=6.0),
        )
        begin = 400 + 50 * (seed % 14)
        add("frozen encoder", where, dynamics(arm, frozen(m, n - 1, begin, 40)), holds_or_says(arm, "encoder"))
        stuck = frozen(m, 0, 700, 150)
        add("frozen encoder", f"{where} long", dynamics(arm, stuck), holds_or_says(arm, "encoder"))
        add("frozen encoder", f"{where} all", dynamics(several, frozen(s, 1, 0, len(s["t"]))), says("encoder"))
        twice = {role: np.repeat(values[::2], 2, axis=0) for role, values in m.items() if role != "t"}
        add("repeats", where, dynamics(arm, {"t": m["t"], **twice}), says("repeat"))
        for late in (3, 6, 10):
            add("late torque", f"{where} {late}", dynamics(arm, delayed(m, late)), says("late"))
        law = replace(several, control=Control("pd", (20.0,) * several.n_joint, (-5.0,) * several.n_joint))
        ref = s["q"] + (s["tau"] + 5.0 * s["dq"]) / 20.0
        under = changed(s, ref=ref)
        driving = replace(law, control=replace(law.control, kv=(5.0,) * several.n_joint))
        add("kv drives", where, dynamics(driving, under, ("q", "dq", "ddq", "ref")), says("kv1", 4))
        double = replace(
            law, control=replace(law.control, kp=(42.0,) * several.n_joint, kv=(-10.5,) * several.n_joint)
        )
        add(
            "gains scale",
            where,
            dynamics(double, under, ("q", "dq", "ddq", "ref")),
            says("scales with these gains"),
        )
        guess = several.with_joints(a_m=np.array([0.8 * joint.a_m + 0.05 for joint in several.joints]))
        add("guessed lengths", where, dynamics(guess, s), says("Lengths are taken from the arm file"))
        leap = m["t"].copy()
        leap[len(leap) // 2 :] += 86400.0
        add("leap of a day", where, dynamics(arm, changed(m, t=leap)), says("gap|hole|leap|day|parted"))
        add("simulate degrees", where, _simulate(law, np.rad2deg(ref), s["t"]), says("degrees|runs away"))
    return listed


def _upside_down(arm: Arm) -> Arm:
    x, y, z = arm.gravity_m_s2
    return replace(arm, gravity_m_s2=(-x, -y, -z))


def _reaching(arm: Arm) -> Arm:
    return replace(arm, tip=None)


def _tip(arm: Arm, columns: Columns, q: Floats | None = None) -> Columns:
    if q is None:
        return columns
    return changed(columns, tip=tip_position(replace(arm, tip=None), q))


def _raw(arm: Arm, seed: int) -> tuple[Floats, Floats]:
    """Return accelerations of a motion between two rests, at 500 Hz."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 4.0, 2e-3)
    s = np.clip((t - 1.0) / 1.5, 0.0, 1.0)
    shape = 10 * s**3 - 15 * s**4 + 6 * s**5
    speed, bend = np.gradient(shape, t), np.gradient(np.gradient(shape, t), t)
    way = rng.uniform(0.4, 1.0, arm.n_joint)
    force = specific_force(arm, np.outer(shape, way), np.outer(speed, way), np.outer(bend, way))
    a = force.reshape(len(t), -1)
    return t, a + 0.02 * rng.normal(size=a.shape)


def _written(blank: Arm, columns: Columns):
    inner = dynamics(blank, columns)

    def go(folder: Path) -> Ran:
        ran = inner(folder)
        same = bool(ran.document) and with_masses_as_printed(blank)(folder, ran)
        return replace(ran, said=ran.said + (" WRITTEN AS PRINTED" if same else " DIFFERS"))

    return go


def _simulate(arm: Arm, ref: Floats, t: Floats):
    def go(folder: Path) -> Ran:
        save_arm(arm, folder / "arm.toml")
        data = write(folder / "ref.csv", {"t": t, "ref": ref}, ("ref",))
        return run("simulate", "--reference", data, "--arm", folder / "arm.toml", "--out", folder / "o.csv")

    return go


def judge(case: Case) -> str:
    """Run a case and return what it is: right, silent, wrong words, traceback."""
    with tempfile.TemporaryDirectory() as folder:
        ran = case.run(Path(folder))
    if ran.crashed:
        case.result = ran.said[-600:]
        return "traceback"
    if case.right(ran):
        return "right"
    case.result = f"exit {ran.code}: {ran.said[-700:]}"
    return "other words" if ran.code else "silent" if case.kind != "faultless" else "false alarm"


def _listed(counts: dict[str, int]) -> str:
    return ", ".join(f"{name} {count}" for name, count in sorted(counts.items()))


def main() -> int:
    """Score every input and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="")
    parser.add_argument("--seeds", type=int, default=3, help="motions and arms of each kind")
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    parser.add_argument("-v", action="store_true", help="say what was said where it was not right")
    arguments = parser.parse_args()
    score: dict[str, dict[str, int]] = {}
    began = time.monotonic()
    for case in cases(range(arguments.first, arguments.first + arguments.seeds)):
        if arguments.only not in case.kind:
            continue
        result = judge(case)
        score.setdefault(case.kind, {}).setdefault(result, 0)
        score[case.kind][result] += 1
        if result != "right" and arguments.v:
            sys.stderr.write(f"{case.kind} / {case.name}: {result}: {case.result}\n\n")
    total: dict[str, int] = {}
    for kind, results in score.items():
        sys.stdout.write(f"{kind:28s} {_listed(results)}\n")
        for name, count in results.items():
            total[name] = total.get(name, 0) + count
    n = sum(total.values())
    share = 100.0 * total.get("right", 0) / max(n, 1)
    sys.stdout.write(f"{n} inputs: {_listed(total)}; {share:.1f} % right, {time.monotonic() - began:.0f} s\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
