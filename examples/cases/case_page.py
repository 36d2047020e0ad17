"""The page of a case, as Markdown with one picture."""

import os
from collections.abc import Sequence
from pathlib import Path

from arm.effects.catalogue import catalogue
from fitter.diagnosis.diagnosis import Diagnosis

#from fitter.report.diagnosis_figures import lives_figure

ROOT = Path(__file__).parent.parent.parent
DATA = Path(os.environ.get("LIMBCAL_DATA", ROOT.parent / "shared" / "data"))
DOCS = ROOT / "docs" / "cases"

Row = tuple[str, float, float]


def write_page(
    path: Path,
    *,
    title: str,
    lead: str,
    command: str,
    found: Diagnosis,
    table: tuple[tuple[str, str, str], Sequence[Row]],
    caption: str,
    more: Sequence[str] = (),
) -> None:
    """Write a case's page and its picture.

    Parameters
    ----------
    path : Path
    title, lead, command : str
        The command makes the page again.
    found : Diagnosis
    table : header and rows
        The figures that the case is about.
    caption : str
        What the table shows.
    more : sequence of str
        Paragraphs to end with.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    finding = found.finding
    header, rows = table
    lines = [f"# {title}", "", lead, "", f"`{command}` makes this page again.", "", caption, ""]
    lines += [f"| {' | '.join(header)} |", "|" + "---|" * len(header)]
    lines += [f"| {name} | {first:.4g} | {second:.4g} |" for name, first, second in rows]
    lines += ["", f"## What was found: {finding.verdict}", ""]
    for number, cause in enumerate(finding.causes, 1):
        where = " and ".join(f"joint {j}" for j in cause.joints) or "the arm"
        sizes = ", ".join(f"{name} {p.value:.4g} ± {1.96 * p.std:.2g} {p.unit}" for name, p in cause.parameters.items())
        lines.append(f"{number}. **{cause.effect}**, {where}: {catalogue()[cause.effect].sentence}. {sizes}.")
    lines += ["", "## What stays unexplained", "", _left(found), "", f"Next: {finding.next_experiment}", ""]
    lines += [f"{paragraph}\n" for paragraph in more]
    picture = path.with_suffix(".png")
    picture.write_bytes(lives_figure(found))
    lines += [f"![Where the error lives, before and after]({picture.name})", ""]
    path.write_text("\n".join(lines), encoding="utf-8")


def _left(found: Diagnosis) -> str:
    finding, left = found.finding, found.finding.remainder
    what = (
        f"The causes explain {100 * finding.explained:.1f} % of what the base model leaves beyond the sensors' noise. "
        f"What is left is {'white' if left.white else 'not white'}."
    )
    if left.depends_on:
        what += (
            f" It depends on {', '.join(left.depends_on)} (joint {left.joint}): a smooth function of these would explain "
            f"{100 * left.explained:.0f} % of it on motions it has not seen."
        )
    return what + (f" As a formula: {left.formula}." if left.formula else "")
