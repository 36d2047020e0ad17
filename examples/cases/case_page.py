"""The page of a case, as Markdown with one picture."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from arm.effects.catalogue import catalogue
from examples.cases.search import WORTH, Found
from fitter.diagnosis.judgement import smooth, torque_left
from fitter.report.diagnosis_figures import places_figure
from fitter.report.diagnosis_traces import Trace
from fitter.report.diagnosis_words import candidate_name, measured

ROOT = Path(__file__).parent.parent.parent
DATA = Path(os.environ.get("LIMBCAL_DATA", ROOT.parent / "shared" / "data"))
DOCS = ROOT / "docs" / "cases"
#: More than so many times the noise is no noise.
_NOISE = 2.0


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


@dataclass(frozen=True)
class Story:
    """What was found, told: lines on the causes, a paragraph on what is left, a picture (PNG) and its caption."""

    causes: Sequence[str]
    left: str
    picture: bytes
    caption: str


def story_of(found: Found, unit: str = "N m") -> Story:
    """Tell what a search by equations has found; unit is that of the drive."""
    return Story(
        _causes(found, unit),
        _left(found),
        places_figure(found, _traces(found)),  # type: ignore[arg-type]
        "The torque that is left on the evaluating trials, before (orange) and after (green): means over bins and "
        "the middle half of the samples; in the last column every trial's rms.",
    )


def write_page(page: Page, story: Story, folder: Path) -> None:
    """Write a case's page and its picture.

    Parameters
    ----------
    page : Page
    story : Story
    folder : Path
        It is made.
    """
    folder.mkdir(parents=True, exist_ok=True)
    command = f"OMP_NUM_THREADS=1 .venv/bin/python -m examples.cases.{page.module}"
    lines = [f"# {page.title}", "", page.lead, "", "This command makes the page again:", ""]
    lines += ["```sh", command, "```", "", "## What is missing, in the order found", ""]
    lines += story.causes
    lines += ["", "## What was asked, and measured", ""]
    lines += [line for table in page.tables for line in table.lines()]
    lines += ["## What stays unexplained", "", story.left, ""]
    lines += [line for paragraph in page.left for line in (paragraph, "")]
    picture = folder / f"{page.name}.png"
    picture.write_bytes(story.picture)
    lines += [f"![{page.title}]({picture.name})", "", story.caption, ""]
    (folder / f"{page.name}.md").write_text("\n".join(lines), encoding="utf-8")


def _traces(found: Found) -> list[Trace]:
    seen_hz = found.regression.weighting.seen_hz
    models = [found.steps[0].model, found.steps[-1].model]
    return [
        Trace(
            motion,
            [smooth(torque_left(found.regression, one, motion), motion.dt_s, seen_hz) for one in models],
            [],
        )
        for motion in found.motions
    ]


def _causes(found: Found, unit: str) -> list[str]:
    left = [float(step.model.squares.sum()) / found.told for step in found.steps]
    lines = []
    for number, step in enumerate(found.steps[1:], 1):
        hypothesis = step.hypothesis
        assert hypothesis is not None
        sizes = [f"`{name}` {' '.join(measured(p))} {p.unit}" for name, p in step.numbers.items()]
        line = (
            f"{number}. **{candidate_name(hypothesis)}**: {catalogue()[hypothesis.kind.name].sentence}. "
            f"{'; '.join(sizes).replace('N m', unit)}. It takes away "
            f"{100.0 * (1.0 - left[number] / left[number - 1]):.0f} % of the squared residual."
        )
        if step.runner_up is not None:
            line += f" Next best, with {100.0 * step.reaches:.0f} % of that: {candidate_name(step.runner_up)}."
        lines.append(line)
    return [
        *lines,
        "",
        "Sizes are those in the model with all causes, ± half of their 95 % interval, which allows for what is "
        "left. "
        "The search goes forwards only, sets pushes and loads aside, learns from the learning trials alone, and "
        "takes "
        f"a cause if it lowers the squares of the learning and of the evaluating trials by {100 * WORTH:.0f} % "
        "each, or, for what need not show in all trials, does the latter no harm "
        "(`examples/cases/search.py`).",
    ]


def _left(found: Found) -> str:
    first, last = (step.model.squares.sum() / found.told for step in (found.steps[0], found.steps[-1]))
    left = found.remainder
    said = (
        f"Squared, the starting model leaves {first:.3g} times what the sensors' noise alone would, and "
        f"{last:.3g} "
        "times with all that was found."
    )
    if last > _NOISE:
        said += " So the model is not complete."
    if left.depends_on:
        said += (
            f" It depends on {', '.join(left.depends_on)} (joint {left.joint}): a smooth function of that would "
            f"explain {100 * left.explained:.0f} % of it on motions that it has not seen."
        )
    return said + (f" As a formula: {left.formula}." if left.formula else "")
