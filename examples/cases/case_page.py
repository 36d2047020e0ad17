"""The page of a case: `fitter diagnose` on measured recordings, and its answer as Markdown with one picture."""

import json
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from arm.effects.catalogue import catalogue
from fitter.report.diagnosis_words import place
from limbcal.arguments import Parser, common_options
from limbcal.digits import NORMAL_95, plain, with_half_width

ROOT = Path(__file__).parent.parent.parent
ARMS = ROOT / "examples"
DATA = Path(os.environ.get("LIMBCAL_DATA", ROOT.parent / "shared" / "data"))
DOCS = ROOT / "docs" / "cases"
_VERDICTS = {
    "named": "`named`: these causes are there.",
    "ambiguous": "`ambiguous`: something is there, and several effects explain it equally well.",
    "none": "`none`: nothing rises above the noise.",
    "unexplained": "`unexplained`: something is there, and no effect of the catalogue is believed.",
}
_TRIALS = {"learn": "learning", "evaluate": "evaluating"}

Document = Mapping[str, Any]


@dataclass(frozen=True)
class Case:
    """A case: what is diagnosed, and what its page says of it.

    Attributes
    ----------
    name : str
        Of the page, without its ending.
    title, lead : str
    folder : str
        Of the recordings, in the folder of all data.
    command : sequence of str
        What stands behind ``fitter diagnose``; ``{data}`` and ``{arms}`` are folders.
    picture, caption : str
        One of the pictures that ``fitter diagnose`` writes, without ``diagnosis-``.
    unit : str
        Of the drive.
    remarks : sequence of str
        Paragraphs on what these recordings cannot tell.
    """

    name: str
    title: str
    lead: str
    folder: str
    command: Sequence[str]
    picture: str
    caption: str
    unit: str = "N m"
    remarks: Sequence[str] = ()

    def words(self, data: str, arms: str) -> list[str]:
        """Return the words behind ``fitter diagnose``."""
        return [word.replace("{data}", data).replace("{arms}", arms) for word in self.command]


def run_case(
    case: Case, argv: Sequence[str] | None, more: Callable[[Path, Path], Sequence[str]] | None = None
) -> int:
    """Diagnose, write the page, and return the exit code.

    Parameters
    ----------
    case : Case
    argv : sequence of str, optional
    more : callable, optional
        Further lines of the page, from the folders of the diagnosis and of all data.
    """
    parser = Parser(prog=case.name, description=case.title, parents=[common_options()])
    parser.add_argument("--data", type=Path, default=DATA, metavar="DIR", help="folder of all recordings")
    parser.add_argument("--out", type=Path, default=DOCS, metavar="DIR", help="where the page goes (docs/cases)")
    parser.add_argument("--diagnosis", type=Path, metavar="DIR", help="an answer that is there already")
    options = parser.parse_args(argv)
    with TemporaryDirectory() as scratch:
        folder = options.diagnosis or Path(scratch)
        if options.diagnosis is None:
            words = case.words(str(options.data / case.folder), str(ARMS))
            command = [sys.executable, "-m", "fitter", "diagnose", *words, "--out", str(folder)]
            done = subprocess.run(command, stdout=sys.stderr, check=False)
            if done.returncode:
                return done.returncode
        document = json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))
        lines = page(case, document) + list(more(folder, options.data) if more else ())
        options.out.mkdir(parents=True, exist_ok=True)
        (options.out / f"{case.name}.md").write_text("\n".join(lines), encoding="utf-8")
        shutil.copyfile(folder / f"diagnosis-{case.picture}.png", options.out / f"{case.name}.png")
    return 0


def page(case: Case, document: Document) -> list[str]:
    """Return the lines of a case's page.

    Parameters
    ----------
    case : Case
    document : mapping
        The JSON document of ``fitter diagnose``.
    """
    words = ["fitter", "diagnose", *case.words("DATA/" + case.folder, "examples"), "--out", "DIR"]
    command = shlex.join(words).replace(" --", " \\\n  --")
    lines = [f"# {case.title}", "", case.lead, "", "```sh", command, "```", ""]
    lines += ["## What is missing", "", f"The verdict is {_VERDICTS[document['verdict']]}", ""]
    lines += [f"{k}. {_cause(one, case.unit)}" for k, one in enumerate(document["causes"], 1)]
    if document["causes"]:
        lines += ["", "Sizes are given ± half of their 95 % interval, beside all other causes.", ""]
    lines += [f"Doubtful: {note['text']}.\n" for note in document["notes"] if note["kind"] == "doubt"]
    lines += ["## On the trials held back", "", *_errors(document, case.unit), _left(document, case.unit), ""]
    lines += [line for remark in case.remarks for line in (remark, "")]
    lines += [f"![{case.title}]({case.name}.png)", "", case.caption, ""]
    lines += [f"Next experiment: {document['next_experiment']}", ""]
    name = case.name.replace("-", "_")
    return [*lines, f"`python -m examples.cases.{name}` makes this page.", ""]


def _cause(cause: Document, unit: str) -> str:
    sizes = []
    for name, number in cause["parameters"].items():
        value, std = number["value"], number["std"]
        if not isinstance(value, float):  # such as the trial that a push is in
            sizes.append(f"`{name}` {value}")
            continue
        size = plain(value) if std is None else " ± ".join(with_half_width(value, NORMAL_95 * std))
        sizes.append(f"`{name}` {size} {number['unit'].replace('N m', unit)}")
    said = (
        f"**{cause['effect']}, {place(cause['joints'])}**: {catalogue()[cause['effect']].sentence}. "
        f"{'; '.join(sizes)}."
    )
    taken = cause["takes_away"].items()
    shares = [f"{100.0 * share:.0f} % on the {_TRIALS[role]} trials" for role, share in taken]
    if shares:
        said += f" Of the squared residual it takes away {' and '.join(shares)}."
    if cause["support"] < 1.0:
        said += f" It is one of several that do as well, with {100.0 * cause['support']:.0f} % of the support."
    return said


def _errors(document: Document, unit: str) -> list[str]:
    before, after = document["before"], document["after"]
    rows: list[tuple[str, ...]] = [
        (f"torque {j}, rms [{unit}]", f"{was:.4g}", f"{became:.4g}")
        for j, (was, became) in enumerate(
            zip(before["torque_rms_N_m"], after["torque_rms_N_m"], strict=True), start=1
        )
    ]
    for name in ("mean", "max"):
        sizes = (one["angle_error_deg"][name] for one in (before, after))
        rows.append((f"simulated angle, {name} [deg]", *("runs away" if a is None else f"{a:.3g}" for a in sizes)))
    head = ["| | base model | with the causes |", "|---|---|---|"]
    return [*head, *(f"| {' | '.join(row)} |" for row in rows), ""]


def _left(document: Document, unit: str) -> str:
    left, residual = document["left"], document["residual"]
    if document["complete"]:
        return "The model is complete: no more than the sensors' noise is left."
    torques = " and ".join(f"{rms:.3g}" for rms in left["torque_rms_N_m"])
    said = (
        f"The model is not complete. It leaves {torques} {unit}, {100.0 * left['share']:.0f} % of what the base "
        f"model leaves and {left['times_noise']:.3g} times what the sensors' noise makes."
    )
    if residual["depends_on"]:
        said += (
            f" That depends on {', '.join(residual['depends_on'])} at joint {residual['joint']}: a smooth "
            f"function explains {100.0 * residual['explained']:.0f} % of it where it was not fitted."
        )
    return said
