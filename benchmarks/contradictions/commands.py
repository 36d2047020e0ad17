"""Columns written to files, and given to the real commands in this process."""

import io
import json
import traceback
import warnings
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet

from arm.arm_file import load_arm, save_arm
from arm.model import Arm
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from benchmarks.contradictions.motions import Columns, Floats
from fitter.__main__ import main as fitter
from limbcal import command

#: Runs a command in a folder.
Go = Callable[[Path], "Ran"]


@dataclass
class Ran:
    """What a command did: exit code, document, words, traceback."""

    code: int
    document: dict
    said: str
    crashed: bool


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
) -> Go:
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


def kinematics(arm: Arm, columns: Columns, **names: str) -> Go:
    """Return what runs `fitter kinematics`."""

    def go(folder: Path) -> Ran:
        save_arm(arm, folder / "arm.toml")
        data = write(folder / "tip.csv", columns, ("q", "tip"), names)
        return run(
            "kinematics", data, "--arm", folder / "arm.toml", "--generations", "300", "--out", folder / "o.toml"
        )

    return go


def track(arm: Arm, t: Floats, a: Floats) -> Go:
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


def diagnose(arm: Arm, learn: Columns, held: Columns) -> Go:
    """Return what runs `fitter diagnose`."""

    def go(folder: Path) -> Ran:
        save_arm(arm, folder / "arm.toml")
        files = [write(folder / f"{name}.csv", data) for name, data in (("learn", learn), ("held", held))]
        return run(
            "diagnose", files[0], "--evaluate", files[1], "--arm", folder / "arm.toml", "--out", folder / "d"
        )

    return go


def simulate(arm: Arm, ref: Floats, t: Floats) -> Go:
    """Return what runs `fitter simulate` under targets."""

    def go(folder: Path) -> Ran:
        save_arm(arm, folder / "arm.toml")
        data = write(folder / "ref.csv", {"t": t, "ref": ref}, ("ref",))
        return run("simulate", "--reference", data, "--arm", folder / "arm.toml", "--out", folder / "o.csv")

    return go


def written(blank: Arm, columns: Columns) -> Go:
    """Return what runs `fitter dynamics` and says whether the file holds what was printed."""
    inner = dynamics(blank, columns)

    def go(folder: Path) -> Ran:
        ran = inner(folder)
        same = bool(ran.document) and with_masses_as_printed(blank)(folder, ran)
        return replace(ran, said=ran.said + (" WRITTEN AS PRINTED" if same else " DIFFERS"))

    return go


def with_masses_as_printed(arm: Arm, folder_file: str = "o.toml") -> Callable[[Path, Ran], bool]:
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
