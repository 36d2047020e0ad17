"""What a reproduction leaves: a page to read in a browser, the same as text, the figures as JSON, the pictures."""

from collections.abc import Sequence
from pathlib import Path

from fitter.report.page import Page
from limbcal.command import to_json
from limbcal.errors import DeviceError
from reproduction.experiment import Cell, Document, Grid
from reproduction.reproduction import Outcome

_TITLE = "The paper's experiments, repeated"
_LEAD = (
    "Ohtsuki, Shikata and Noborio, A Calibration Method of Human Arm or Leg for Dynamic Animation and Haptic "
    "Rendering. Side by side: what the paper prints, the same setting here, and the best that is to be had here."
)


def document_of(outcomes: Sequence[Outcome], seed: int) -> Document:
    """Return all figures for JSON."""
    return {
        "seed": seed,
        "experiments": {outcome.name: _document(outcome) for outcome in outcomes},
    }


def _document(outcome: Outcome) -> Document:
    if outcome.experiment is None:
        return {"error": str(outcome.error)}
    found = outcome.experiment
    return {
        "title": found.title,
        "assumptions": list(found.assumptions),
        "findings": list(found.findings),
        **found.document,
    }


def write_report(outcomes: Sequence[Outcome], document: Document, command: str, out: Path) -> None:
    """Write ``reproduction.md``, ``.html``, ``.json`` and the pictures.

    Parameters
    ----------
    outcomes : sequence of Outcome
    document : dict
        Of `document_of`.
    command : str
        That makes all this.
    out : Path
        A directory.

    Raises
    ------
    DeviceError
        If it cannot be written.
    """
    lines, page = [f"# {_TITLE}", "", _LEAD, "", f"`{command}` makes this page.", ""], Page(_TITLE, _LEAD)
    try:
        out.mkdir(parents=True, exist_ok=True)
        for outcome in outcomes:
            for name, (png, _) in zip(_names(outcome), outcome.pictures, strict=True):
                (out / name).write_bytes(png)
            lines += _section(outcome)
            _add(page, outcome)
        (out / "reproduction.json").write_text(to_json(document) + "\n", encoding="utf-8")
        (out / "reproduction.md").write_text("\n".join(lines), encoding="utf-8")
    except OSError as error:
        raise DeviceError(f"{out}: cannot be written: {error.strerror}") from error
    page.write(out / "reproduction.html")


def _section(outcome: Outcome) -> list[str]:
    found = outcome.experiment
    if found is None:
        return [f"## {outcome.name}", "", f"Came to nothing: {outcome.error}", ""]
    lines = [f"## {found.title}", ""]
    lines += [f"- **{sentence}**" for sentence in found.findings]
    lines += ["", "How it was done:", "", *(f"- {sentence}" for sentence in found.assumptions), ""]
    for grid in found.grids:
        lines += [f"**{grid.title}**", "", *_table(grid), ""]
    for name, (_, caption) in zip(_names(outcome), outcome.pictures, strict=True):
        lines += [f"![{caption}]({name})", ""]
    return lines


def _table(grid: Grid) -> list[str]:
    rows = [grid.header, ("---", *["--:"] * (len(grid.header) - 1)), *grid.rows]
    return [f"| {' | '.join(_text(cell) for cell in row)} |" for row in rows]


def _text(cell: Cell) -> str:
    if cell is None:
        return "–"
    return cell.replace("|", "\\|") if isinstance(cell, str) else f"{cell:.6g}"


def _add(page: Page, outcome: Outcome) -> None:
    found = outcome.experiment
    if found is None:
        page.section(outcome.name, f"Came to nothing: {outcome.error}")
        return
    page.section(found.title)
    page.points(found.findings)
    page.note("How it was done", found.assumptions)
    for grid in found.grids:
        page.table(grid.header, grid.rows, grid.title)
    for png, caption in outcome.pictures:
        page.picture(png, caption)


def _names(outcome: Outcome) -> list[str]:
    """Return the pictures' file names."""
    if len(outcome.pictures) == 1:
        return [f"{outcome.name}.png"]
    return [f"{outcome.name}-{number}.png" for number in range(1, len(outcome.pictures) + 1)]
