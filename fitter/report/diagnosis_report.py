"""The page that a diagnosis leaves behind."""

from pathlib import Path

from fitter.diagnosis.diagnosis import Diagnosis
from fitter.report.page import Page


def write_report(found: Diagnosis, out: Path) -> None:
    """Write ``report.html`` and its pictures.

    Raises
    ------
    DeviceError
        If a file cannot be written.
    """
    page = Page("Diagnosis", found.finding.verdict)
    page.write(out / "report.html")
