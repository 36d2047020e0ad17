"""The one place where benchmarks call the diagnosis: by its entry point, or by its command."""

import contextlib
import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from arm.arm_file import load_arm
from fitter.__main__ import main
from fitter.data.motions import read_motions
from fitter.diagnosis.diagnosis import diagnose
from limbcal.command import to_json
from protocol.tables.columns import parse_mapping

Found = dict[str, Any]

#: So many characters of what the command said are kept where it failed.
_KEPT = 4000


def by_entry_point(learn: Path, evaluate: Path, arm: Path) -> Found:
    """Return the document of `fitter.diagnosis.diagnosis.diagnose`, without report or pictures."""
    model = load_arm(arm)
    mapping = parse_mapping(None, model.n_joint)
    learning, evaluating = (
        read_motions(path, model.n_joint, mapping, None, required=("q",)) for path in (learn, evaluate)
    )
    document: Found = json.loads(to_json(diagnose(model, learning, evaluating).finding.document()))
    return document


def by_command(
    learn: Sequence[Path], evaluate: Sequence[Path], arm: Path, out: Path, options: Sequence[str] = ()
) -> Found:
    """Return what ``fitter diagnose --json`` says with some options, called as from a shell, but in this process.

    Raises
    ------
    RuntimeError
        If it ends with another code than 0: with all that it said.
    """
    answer, words = io.StringIO(), io.StringIO()
    sets = [*map(str, learn), "--evaluate", *map(str, evaluate)]
    with contextlib.redirect_stdout(answer), contextlib.redirect_stderr(words):
        code = main(["diagnose", *sets, "--arm", str(arm), "--out", str(out), *options, "--json", "--debug"])
    if code != 0:
        raise RuntimeError(f"fitter diagnose ended with {code}: {words.getvalue()[-_KEPT:]}")
    document: Found = json.loads(answer.getvalue())
    return document


def said(found: Found) -> str:
    """Return verdict and causes in one line."""
    causes = [
        f"{cause['effect']} {','.join(map(str, cause.get('joints') or ()))}".strip()
        + " ("
        + ", ".join(_number(name, part) for name, part in cause["parameters"].items())
        + ")"
        for cause in found["causes"]
    ]
    left = found.get("residual", {}).get("depends_on") or ()
    more = "; ".join(causes) or " ".join(left)
    return f"{found['verdict']}: {more}" if more else str(found["verdict"])


def _number(name: str, part: Found) -> str:
    value, std = part["value"], part.get("std")
    if isinstance(value, int | float):
        return f"{name} {value:.4g}" + (f" ± {std:.2g}" if std else "")
    return f"{name} {value}"
