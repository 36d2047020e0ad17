"""Whether the intervals of a torque fit hold: simulated arms of 2, 3 and 6 joints that the fit has not seen.

Each arm is drawn by seed, moved, measured with noise, written to files, and learnt from these by what `fitter
dynamics` calls. The truth is the arm's own base parameters. z is (found - true) / std.
"""

import argparse
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from rich.table import Table

from arm.model import Friction, Link
from arm.regressor import standard_parameters
from benchmarks.coverage_case import GIVEN, Case, draw_case, write_case
from fitter.data.trials import load_trials
from fitter.dynamics.dynamics_fit import Objective
from fitter.dynamics.fit import fit_dynamics
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, console, run_command
from limbcal.errors import LimbcalError

JOINTS = (2, 3, 6)


@dataclass(frozen=True)
class Found:
    """One parameter of one case."""

    case: Case
    name: str
    kind: str
    value: float
    std: float
    truth: float
    inside: bool
    objective: Objective

    @property
    def z(self) -> float:
        """Its error in units of its standard error."""
        return (self.value - self.truth) / self.std


def learn(case: Case, objective: Objective | None) -> list[Found]:
    """Learn a case from its files, and return every parameter that was given a standard error."""
    blank = replace(
        case.arm, joints=tuple(replace(joint, link=Link(), friction=Friction()) for joint in case.arm.joints)
    )
    with tempfile.TemporaryDirectory() as folder:
        trials = load_trials(write_case(case, Path(folder)), case.arm.n_joint)
    fit = fit_dynamics(blank, trials, objective=objective, method="least-squares")
    truth = dict(zip(fit.base.names, fit.base.combination @ standard_parameters(case.arm), strict=True))
    if case.moved == "driven":  # the others never stick
        truth |= {f"F{i + 1}": joint.friction.static_N_m for i, joint in enumerate(case.arm.joints)}
    found = []
    for name, parameter in fit.parameters.items():
        if name in truth and parameter.ci95 is not None and parameter.identifiable:
            kind = {"D": "viscous", "f": "Coulomb", "F": "static"}.get(name[0], "inertial")
            low, high = parameter.ci95
            inside = low <= truth[name] <= high
            found.append(
                Found(case, name, kind, parameter.value, parameter.std, truth[name], inside, fit.objective)
            )
    return found


def summary(found: Sequence[Found]) -> dict[str, float]:
    """Return how many there are, how many intervals hold [%], rms and largest z."""
    z = np.array([one.z for one in found])
    holds = np.mean([one.inside for one in found]) if found else np.nan
    return {
        "parameters": len(found),
        "holds_percent": 100.0 * float(holds),
        "rms_z": float(np.sqrt(np.mean(z**2))) if len(z) else np.nan,
        "worst_z": float(np.abs(z).max()) if len(z) else np.nan,
    }


def measure(options: argparse.Namespace) -> Document:
    """Learn all cases, show the table and return its numbers."""
    found: list[Found] = []
    refused: list[str] = []
    n_case = 0
    for number in range(options.arms):
        seed, n_joint = options.seed + number, JOINTS[number % len(JOINTS)]
        for given in options.given or [GIVEN[number // len(JOINTS) % len(GIVEN)]]:
            n_case += 1
            case = draw_case(seed, n_joint, given)
            try:
                found += (one := learn(case, None if options.objective == "auto" else options.objective))
            except LimbcalError as error:
                refused.append(f"{seed}: {n_joint} joints, {given}: {error}")
                continue
            if options.each:
                s = summary(one)
                console.print(
                    f"{seed} {n_joint} {given} {case.moved} {case.encoder} {case.angle_rad:.1e} {case.torque} "
                    f"{case.torque_share:.1e} {case.derived} {case.rate_hz:.0f} Hz x{len(case.trials)} "
                    f"{', '.join({each.objective for each in one})}: "
                    f"{s['parameters']} {s['holds_percent']:.0f} %, rms {s['rms_z']:.2f}, worst {s['worst_z']:.2f}"
                )
    groups = {"all": found}
    groups |= {f"{n} joints": [one for one in found if one.case.arm.n_joint == n] for n in JOINTS}
    for field in ("given", "moved", "encoder", "torque"):
        for value in sorted({getattr(one.case, field) for one in found}):
            groups[f"{field}: {value}"] = [one for one in found if getattr(one.case, field) == value]
    for derived in ("tracked", "differences"):
        some = [one for one in found if one.case.given != "q" and one.case.derived == derived]
        groups[f"dq,ddq: {derived}"] = some
    for used in sorted({one.objective for one in found}):
        groups[f"by {used}"] = [one for one in found if one.objective == used]
    kinds = ("inertial", "viscous", "Coulomb", "static")
    groups |= {kind: [one for one in found if one.kind == kind] for kind in kinds}
    sums = {name: summary(group) for name, group in groups.items()}
    table = Table(title=f"Intervals of {n_case} fits, {options.objective}, seeds from {options.seed}")
    for heading in ("", "parameters", "95 % holds", "rms z", "worst z"):
        table.add_column(heading)
    for name, s in sums.items():
        table.add_row(
            name, str(s["parameters"]), f"{s['holds_percent']:.1f} %", f"{s['rms_z']:.2f}", f"{s['worst_z']:.1f}"
        )
    console.print(table)
    for line in refused:
        console.print(line)
    return {"fits": n_case, "refused": refused, "groups": sums}


def main(argv: list[str] | None = None) -> int:
    """Run the benchmark."""
    parser = Parser(prog="python -m benchmarks.coverage", description=__doc__, parents=[common_options()])
    parser.add_argument("--arms", type=int, default=200, metavar="N", help="how many arms (200)")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="seed of the first arm (0)")
    parser.add_argument("--given", choices=GIVEN, action="append", help="this kind of file (alternating)")
    parser.add_argument(
        "--objective",
        choices=["auto", "likelihood", "torque", "weighted", "robust", "motion"],
        default="auto",
        help="what is made small, as `fitter dynamics` has it (auto)",
    )
    parser.add_argument("--each", action="store_true", help="print a line a case, too")
    parser.set_defaults(action=measure)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
