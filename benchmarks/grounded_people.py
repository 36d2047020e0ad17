"""What `fitter dynamics --ground` claims of simulated people on force plates, and when it refuses.

Each person has masses, centres and inertias off the table's by the spread of its literature, some 20 % of a mass.
Four markers on each segment ride on skin that goes 5 mm with the posture, alike each time; `fitter track` makes
motion of them. From squats with arms that swing the bodies are learnt, and judged on other squats: intervals of
the learnt combinations by the truth, the ground that was not learnt from, and the total mass. Then a hand leans on
a rail, or one of two plates is missing.

    python -m benchmarks.grounded_people --people 50

Results are those of one commit: ``benchmarks/results/grounded_people-<commit>.jsonl``, a line a person, and
``….md``.
"""

import argparse
import contextlib
import io
import json
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from arm.arm_file import load_arm, save_arm
from arm.body.segments import Sex
from arm.body.tracked_segments import TRACKED_SEGMENTS
from arm.body.whole_body import body_map, human_body
from arm.kinematics import axis_frames
from arm.model import Arm, Body, Floats, Marker
from arm.moving_base import standing_base
from arm.physical_links import is_possible
from benchmarks.case_pool import Line, timed
from benchmarks.case_results import add_pool_options, run_kept, show_page
from benchmarks.diagnosis_page import table
from benchmarks.mountings import said
from benchmarks.record import commit
from benchmarks.simulated_people.body import squatting
from benchmarks.simulated_people.ground import other_masses, weighing
from fitter.__main__ import main as fitter
from fitter.data.derivatives import both_derivatives
from fitter.export.motion_tables import markers_trc
from fitter.ground.floating_base import FloatingBase, base_regressor, floating_base
from fitter.ground.link_motion import link_motions
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, run_command
from limbcal.errors import Unusable

#: Length of a motion [s], and rate of cameras and plates [Hz].
SECONDS, RATE_HZ = 12.0, 50.0
DT = 1.0 / RATE_HZ
#: How far skin takes a marker from the bone, rms in space, and the cameras' noise along an axis [m].
SKIN_M, CAMERA_M = 0.005, 0.0005
#: Distance of a marker from its segment's middle, along each axis [m].
SPREAD_M, N_MARKER = 0.07, 4
#: How far amplitudes of a motion differ from squats of the textbook, as a share.
AMPLITUDES = 0.3
#: Noise of plates: force [N], moment [N m].
PLATE_NOISE = (1.0,) * 3 + (0.3,) * 3
#: What a hand gives a rail, as a share of the weight, and at most so far from the vertical [rad].
RAIL, RAIL_RAD = (0.1, 0.2), np.pi / 4.0
#: Mean and standard deviation of stature by sex: NHANES 2015 to 2018, rounded [m].
STATURE_M = {"f": (1.62, 0.07), "m": (1.75, 0.07)}
#: Half of a 95 % interval, in standard errors.
REACH = 1.96
AXES = tuple(f"ground_force_1_{kind}{axis}" for kind in "vpm" for axis in "xyz")


@dataclass(frozen=True)
class Job:
    """One person."""

    seed: int

    @property
    def key(self) -> str:
        """What the results file calls it."""
        return f"person/{self.seed}"


@dataclass(frozen=True)
class Person:
    """A person as they are, and as the table has them.

    Attributes
    ----------
    arm : Arm
        By the table, with the mass that a scale shows.
    base : FloatingBase
    theta : (10 n_body,)
        True standard parameters.
    """

    arm: Arm
    base: FloatingBase
    theta: Floats


def drawn(rng: np.random.Generator) -> Person:
    """Draw a person."""
    sex: Sex = "f" if rng.random() < 0.5 else "m"
    height_m = rng.normal(*STATURE_M[sex])
    mass_kg = rng.uniform(20.0, 28.0) * height_m**2
    table = human_body(Body("human-body", float(mass_kg), float(height_m), sex))
    base = floating_base(table)
    theta = other_masses(base, rng)
    return Person(marked(weighing(table, theta), rng), base, theta)


def marked(arm: Arm, rng: np.random.Generator) -> Arm:
    """Return the person with markers on all segments that are followed."""
    markers = []
    for segment, part in body_map().parts.items():
        if segment not in TRACKED_SEGMENTS:
            continue
        link = arm.joints[part.link].link
        for k in range(N_MARKER):
            x, y, z = np.array(link.com_m) + SPREAD_M * rng.normal(size=3)
            markers.append(Marker(f"{segment}{k}", part.link + 1, (x, y, z), SKIN_M / np.sqrt(3.0)))
    return replace(arm, markers=tuple(markers))


def squats(rng: np.random.Generator) -> Floats:
    """Return joint positions of somebody who squats and swings their arms, (n_sample, n_joint)."""
    q = squatting(round(SECONDS * RATE_HZ))
    return q * (1.0 + AMPLITUDES * rng.uniform(-1.0, 1.0, q.shape[1]))


def seen(arm: Arm, q: Floats, skin: Floats, rng: np.random.Generator) -> Floats:
    """Return where the cameras see the markers, (n_sample, n_marker, 3).

    Parameters
    ----------
    arm : Arm
    q : (n_sample, n_joint)
    skin : (n_marker, 3, n_joint)
        Which way skin goes with the joints between a segment and its neighbours.
    rng : numpy.random.Generator
    """
    frames, posture = axis_frames(arm, q), q - q.mean(axis=0)
    shift = np.einsum("mxj,nj->nmx", skin, posture)
    shift *= SKIN_M / np.maximum(np.sqrt(np.mean(np.sum(shift**2, axis=2), axis=0)), 1e-9)[None, :, None]
    at = np.array([one.position_m for one in arm.markers]) + shift
    on = frames[:, [one.joint - 1 for one in arm.markers]]
    place = np.einsum("nmxy,nmy->nmx", on[..., :3, :3], at) + on[..., :3, 3]
    return np.asarray(place + CAMERA_M * rng.normal(size=place.shape))


def skin_of(arm: Arm, rng: np.random.Generator) -> Floats:
    """Draw which way the skin under each marker goes, (n_marker, 3, n_joint)."""
    near = np.zeros((len(arm.markers), arm.n_joint))
    for k, marker in enumerate(arm.markers):
        way = arm.way_to(marker.joint - 1)
        near[k, [j for j in way if arm.joints[j].type == "revolute"][-3:]] = 1.0
    return rng.normal(size=(len(arm.markers), 3, arm.n_joint)) * near[:, None, :]


def ground(person: Person, q: Floats, rng: np.random.Generator) -> Floats:
    """Return the ground's force and moment about the world's origin, (n_sample, 6)."""
    motions = link_motions(person.arm, q, *both_derivatives(q, DT), standing_base(len(q)))
    wrench = base_regressor([motions[i] for i in person.base.bodies]) @ person.theta
    wrench[:, 3:] += np.cross(motions[person.base.bodies[0]].o, wrench[:, :3])
    return np.asarray(wrench + rng.normal(0.0, PLATE_NOISE, wrench.shape))


def leant(person: Person, q: Floats, wrench: Floats, rng: np.random.Generator) -> Floats:
    """Return what the ground still carries if a hand leans on a rail from some time on."""
    weight = 9.80665 * person.theta[9::10].sum()
    polar, azimuth = RAIL_RAD * rng.random(), rng.uniform(-np.pi, np.pi)
    direction = np.array([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)])
    t = np.arange(len(q)) * DT
    share = rng.uniform(*RAIL) * np.clip(t - rng.uniform(2.0, SECONDS / 2.0), 0.0, 1.0)
    force = weight * share[:, None] * direction
    hand = link_motions(person.arm, q, *both_derivatives(q, DT), standing_base(len(q)))[person.base.bodies[-1]].o
    return wrench - np.hstack([force, np.cross(hand, force)])


def one_plate(wrench: Floats, rng: np.random.Generator) -> Floats:
    """Return what the plate under one foot carries."""
    t = np.arange(len(wrench)) * DT
    return wrench * (0.5 + 0.2 * np.sin(rng.uniform(1.0, 3.0) * t + rng.uniform(0.0, 6.0)))[:, None]


def write_forces(path: Path, wrench: Floats) -> None:
    """Write a force file of one plate whose moment is about the world's origin."""
    t = np.arange(len(wrench)) * DT
    rows = np.column_stack([t, wrench[:, :3], np.zeros((len(t), 3)), wrench[:, 3:]])
    lines = [" ".join(f"{x:.6f}" for x in row) for row in rows]
    path.write_text("\n".join(["endheader", " ".join(["time", *AXES]), *lines]), encoding="utf-8")


def run(job: Job) -> Line:
    """Learn one person and judge what is said."""
    rng = np.random.default_rng([job.seed, 30])
    person = drawn(rng)
    skin = skin_of(person.arm, rng)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        save_arm(person.arm, folder / "person.toml")
        for role in ("learn", "judge"):
            q = squats(rng)
            wrench, t = ground(person, q, rng), np.arange(len(q)) * DT
            markers = seen(person.arm, q, skin, rng)
            names = [one.name for one in person.arm.markers]
            (folder / f"{role}.trc").write_text(markers_trc(role, names, t, markers, RATE_HZ), encoding="utf-8")
            said("track", folder / f"{role}.trc", "--arm", folder / "person.toml", "--out", folder / f"{role}.csv")
            write_forces(folder / f"{role}.mot", wrench)
            if role == "learn":
                write_forces(folder / "rail.mot", leant(person, q, wrench, rng))
                write_forces(folder / "half.mot", one_plate(wrench, rng))
        (code, found), took = timed(lambda: _dynamics(folder, "learn.mot"))
        refused = {kind: _dynamics(folder, f"{kind}.mot")[0] == Unusable.exit_code for kind in ("rail", "half")}
        learnt = load_arm(folder / "out.toml") if code == 0 else None
    return judged(person, code, found, learnt) | {"refused": refused} | took


def _dynamics(folder: Path, forces: str) -> tuple[int, Document]:
    """Return the command's exit code and document."""
    command = ("dynamics", "learn.csv", "--evaluate", "judge.csv", "--arm", "person.toml", "--out", "out.toml")
    words = [str(folder / word) if "." in word else word for word in command]
    plates, answer = [str(folder / name) for name in (forces, "judge.mot")], io.StringIO()
    with contextlib.redirect_stdout(answer), contextlib.redirect_stderr(io.StringIO()):
        code = fitter([*words, "--ground", *plates, "--prior", "regression", "--json"])
    return code, json.loads(answer.getvalue() or "{}")


def judged(person: Person, code: int, found: Document, learnt: Arm | None) -> Line:
    """Return what was right of a person."""
    if code != 0 or learnt is None:
        return {"code": code, "notes": [note["text"] for note in found.get("notes", [])]}
    names = list(found["parameters"])
    z = [
        (one["value"] - sum(c * person.theta[names.index(name)] for name, c in one["terms"].items())) / one["std"]
        for one in found["combinations"]
    ]
    total = found["total_mass_kg"]["value"]
    return {
        "code": code,
        "z": z,
        "mass_ratio": total / person.theta[9::10].sum(),
        "possible": all(is_possible(person_link) for person_link in _links(learnt, person.base)),
        "reduction": found["ground_residual"]["evaluate"]["squared_reduction"],
    }


def _links(arm: Arm, base: FloatingBase) -> list[Floats]:
    rows = []
    for i in base.bodies:
        link = arm.joints[i].link
        rows.append(np.concatenate([link.inertia_kg_m2, link.mass_kg * np.array(link.com_m), [link.mass_kg]]))
    return rows


def page(lines: Sequence[Line]) -> str:
    """Return the figures, and the people of whom something was wrong."""
    done = [line for line in lines if line.get("code") == 0]
    z = np.array([value for line in done for value in line["z"]])
    ratio = np.array([line["mass_ratio"] for line in done])
    reductions = {kind: np.array([line["reduction"][kind] for line in done]) for kind in ("moment", "force")}
    tried = [line for line in lines if "refused" in line]
    rows = [
        ("people", len(lines)),
        ("refused although all is measured", sum(line.get("code") != 0 for line in lines)),
        ("learnt combinations", len(z)),
        ("95 % intervals that hold", f"{100.0 * np.mean(np.abs(z) < REACH):.1f} %" if len(z) else ""),
        ("worst total mass", f"{100.0 * np.abs(ratio - 1.0).max():.2f} %" if done else ""),
        ("bodies that cannot exist", sum(not line["possible"] for line in done)),
        *(
            (f"squared {kind} residual of the other motion, median", f"−{100.0 * np.median(values):.0f} %")
            for kind, values in reductions.items()
            if len(values)
        ),
        *(
            (f"{said}: refused", f"{sum(line['refused'][kind] for line in tried)} / {len(tried)}")
            for kind, said in (("rail", "hand on a rail"), ("half", "one plate missing"))
        ),
        ("seconds, median", f"{np.median([line['seconds'] for line in done]):.1f}" if done else ""),
    ]
    wrong = [
        (line["key"], str(line["error"]).strip().splitlines()[-1] if "error" in line else "; ".join(line["notes"]))
        for line in lines
        if line.get("code") != 0
    ]
    wrong += [
        (line["key"], f"{kind} not refused") for line in tried for kind, was in line["refused"].items() if not was
    ]
    return "\n".join(
        [
            f"# Simulated people on force plates, commit {commit()}\n",
            "Made by `python -m benchmarks.grounded_people`.\n",
            table(("what", "figure"), rows),
            "## What went wrong\n",
            table(("person", "how"), wrong),
        ]
    )


def measure(options: argparse.Namespace) -> Document:
    """Run the people and say what came of them."""
    jobs = [Job(options.seed + k) for k in range(options.people)]
    lines = list(run_kept("grounded_people", jobs, run, vars, options).values())
    return show_page("grounded_people", lines, page(lines), options)


def main(argv: list[str] | None = None) -> int:
    """Run the benchmark and return its exit code."""
    parser = Parser(prog="python -m benchmarks.grounded_people", description=__doc__, parents=[common_options()])
    add = parser.add_argument
    add("--people", type=int, default=50, metavar="N", help="(50)")
    add("--seed", type=int, default=0)
    add_pool_options(parser)
    parser.set_defaults(action=measure)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
