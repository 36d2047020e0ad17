"""The page of a case, as Markdown with one picture."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from arm.effects.catalogue import catalogue
from examples.cases.steps import Step
from fitter.diagnosis.diagnosis import Diagnosis
from fitter.report.diagnosis_figures import places_figure
from fitter.report.diagnosis_traces import traces
from fitter.report.diagnosis_words import candidate_name, measured

ROOT = Path(__file__).parent.parent.parent
DATA = Path(os.environ.get("LIMBCAL_DATA", ROOT.parent / "shared" / "data"))
DOCS = ROOT / "docs" / "cases"


@dataclass(frozen=True)
class FigureTable:
    """Figures that were measured: a caption, a header, and rows of a name with numbers."""

    caption: str
    header: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]

    def lines(self) -> list[str]:
        """Return it as Markdown."""
        listed = [f"| {' | '.join(row)} |" for row in (self.header, *self.rows)]
        return [*listed[:1], "|---" * len(self.header) + "|", *listed[1:], "", self.caption, ""]


@dataclass(frozen=True)
class Page:
    """What a case's page says beside what the diagnosis says itself.

    Attributes
    ----------
    name : str
        Of the file, without its ending.
    title, lead, module : str
        The module's command makes the page again.
    unit : str
        Of what is called N m in a diagnosis, where the drive is told in other units.
    tables : sequence of FigureTable
    left : sequence of str
        Paragraphs on what stays unexplained.
    """

    name: str
    title: str
    lead: str
    module: str
    tables: Sequence[FigureTable]
    left: Sequence[str]
    unit: str = "N m"


def write_page(page: Page, found: Diagnosis, steps: Sequence[Step], folder: Path) -> None:
    """Write a case's page and its picture.

    Parameters
    ----------
    page : Page
    found : Diagnosis
    steps : sequence of Step
        As `examples.cases.steps.steps` has them.
    folder : Path
        It is made.
    """
    folder.mkdir(parents=True, exist_ok=True)
    command = f"OMP_NUM_THREADS=1 .venv/bin/python -m examples.cases.{page.module}"
    lines = [f"# {page.title}", "", page.lead, "", "This command makes the page again:", ""]
    lines += ["```sh", command, "```", "", "## What is missing, in the order found", ""]
    lines += _causes(found, steps, page.unit)
    lines += ["", "## What was asked, and measured", ""]
    lines += [line for table in page.tables for line in table.lines()]
    lines += ["## What stays unexplained", "", _left(found), ""]
    lines += [line for paragraph in page.left for line in (paragraph, "")]
    picture = folder / f"{page.name}.png"
    picture.write_bytes(places_figure(found, traces(found)))
    lines += [
        f"![Where the error lives]({picture.name})",
        "",
        "The torque that is left on the evaluating trials, before (orange) and, where causes were accepted, after "
        "(green): means over bins and the middle half of the samples; in the last column every trial's rms.",
        "",
    ]
    (folder / f"{page.name}.md").write_text("\n".join(lines), encoding="utf-8")


def _causes(found: Diagnosis, steps: Sequence[Step], unit: str) -> list[str]:
    finding, lines = found.finding, [f"The verdict is `{found.finding.verdict}`.", ""]
    if finding.verdict == "unexplained" and len(steps) > 1:
        lines = [
            "The verdict is `unexplained`: the causes below were found and help on motions that they were not fitted "
            "to, but more of what they should explain is left, and hangs on the motion, than `fitter diagnose` lets "
            "pass for a name. They are told here with that reserve.",
            "",
        ]
    for number, (step, cause) in enumerate(zip(steps[1:], found.search.causes, strict=True), 1):
        told = [f"`{name}` {' '.join(measured(p))} {p.unit}" for name, p in step.numbers.items()]
        hypothesis = step.hypothesis
        assert hypothesis is not None
        sentence = catalogue()[hypothesis.kind.name].sentence
        line = f"{number}. **{candidate_name(hypothesis)}**: {sentence}. {'; '.join(told).replace('N m', unit)}."
        if cause.rivals:
            line += f" As well: {', '.join(candidate_name(rival.hypothesis) for rival in cause.rivals)}."
        lines.append(line)
    held = [cause for cause in finding.causes if cause.effect == "stiction"]
    for cause in held:
        told = [f"`{name}` {' '.join(measured(p))} {p.unit}" for name, p in cause.parameters.items()]
        lines.append(f"- **stiction, joint {cause.joints[0]}**: {catalogue()['stiction'].sentence}. {'; '.join(told)}.")
    return [*lines, "", "After ± is half of the 95 % interval."]


def _left(found: Diagnosis) -> str:
    search, left = found.search, found.finding.remainder
    noise = search.told.sum()
    said = (
        f"Squared, the starting model leaves {search.base.squares.sum() / noise:.3g} times what the sensors' noise "
        f"alone would, and {search.final.squares.sum() / noise:.3g} times with all that was found: "
        f"{100 * search.explained:.0f} % of what is beyond noise is explained."
    )
    if left.depends_on:
        of = "the starting model" if found.final is search.base else "the extended model"
        said += (
            f" What {of} leaves depends on {', '.join(left.depends_on)} (joint {left.joint}): a smooth function of that "
            f"would explain {100 * left.explained:.0f} % of it on motions that it has not seen."
        )
    return said + (f" As a formula: {left.formula}." if left.formula else "")
