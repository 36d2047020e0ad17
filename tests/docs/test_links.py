"""Every relative link of a page leads to a file and a heading that exist, and the index leads to every page."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", ROOT / "systemd" / "README.md", *sorted(DOCS.rglob("*.md"))]
LINK = re.compile(r"\]\(([^()\s]+)\)")
FENCED = re.compile(r"^ *```.*?^ *```", re.MULTILINE | re.DOTALL)


def text_of(page):
    return FENCED.sub("", page.read_text(encoding="utf-8"))


def links_of(page):
    """Yield path and heading of every link that leads to a file of the project."""
    for target in LINK.findall(text_of(page)):
        if "://" not in target and not target.startswith("mailto:"):
            path, _, heading = target.partition("#")
            yield (page.parent / path).resolve() if path else page, heading


def anchor(heading):
    """Return how GitHub names a heading: small letters, digits, hyphens for blanks, nothing else."""
    words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    return re.sub(r"[^\w\- ]", "", words.lower()).replace(" ", "-")


def anchors_of(page):
    return {anchor(heading) for heading in re.findall(r"^#+ (.+)$", text_of(page), re.MULTILINE)}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_of_a_page_lead_somewhere(page):
    for target, heading in links_of(page):
        assert target.exists(), f"{page.name} names {target}"
        if heading:
            assert heading in anchors_of(target), f"{page.name} names #{heading} of {target.name}"


def test_a_heading_is_named_as_on_github():
    assert anchor("`limbplay export [SOURCE] --out FILE`") == "limbplay-export-source---out-file"
    assert anchor("20. A person's joints from markers") == "20-a-persons-joints-from-markers"


def test_the_index_leads_to_every_page():
    index = {target for target, _ in links_of(DOCS / "README.md")}
    folders = {target for target in index if target.is_dir()}
    for page in PAGES:
        if DOCS in page.parents and page != DOCS / "README.md":
            assert page in index or page.parent in folders, page
