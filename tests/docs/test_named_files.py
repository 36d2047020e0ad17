"""Files and tests that pages name are there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("arm", "benchmarks", "daemon", "docs", "examples", "fitter", "limbcal", "playback", "protocol")
PACKAGES += ("reproduction", "systemd", "tests", "tracking")
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
CODE_FILE = re.compile(r"`([\w/*]+\.(?:py|c|js))`")
TEST = re.compile(r"`(?:([\w/]+\.py))?::(test_\w+)")


@pytest.fixture(scope="module")
def names():
    """Names of all code files, and their paths."""
    paths = [path for package in PACKAGES for path in (ROOT / package).rglob("*.*")]
    return {path.name for path in paths}, paths


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_file_that_a_page_names_is_there(page, names):
    known, paths = names
    for name in CODE_FILE.findall(page.read_text(encoding="utf-8")):
        if "*" in name:
            assert list(ROOT.glob(name)), name
        elif "/" in name:
            assert (ROOT / name).is_file() or any(str(path).endswith(f"/{name}") for path in paths), name
        else:
            assert name in known, name


def test_a_check_that_the_errata_name_is_there():
    file = None
    for named, test in TEST.findall((ROOT / "docs" / "errata.md").read_text(encoding="utf-8")):
        file = ROOT / "tests" / named if named else file
        assert f"def {test}(" in file.read_text(encoding="utf-8"), f"{file}::{test}"
