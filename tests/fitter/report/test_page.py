"""The page of a report."""

import base64
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fitter.report.page import Page
from limbcal.errors import DeviceError

PNG = b"\x89PNG\r\n\x1a\n" + bytes(range(256))


def text_of(page, folder):
    page.write(folder / "page.html")
    return (folder / "page.html").read_text(encoding="utf-8")


def test_a_page_is_one_file_from_top_to_bottom(tmp_path):
    page = Page("Of an arm", "What it is")
    page.section("First", "some words")
    page.table(("name", "value"), [("a1", 0.25)])
    page.picture(PNG, 'joint "1"')
    page.section("Last")
    text = text_of(page, tmp_path)
    assert text.startswith("<!doctype html>") and text.count("<h1>") == 1
    order = [text.index(part) for part in ("Of an arm</h1>", "What it is", "First", "a1", "data:image", "Last")]
    assert order == sorted(order)
    assert base64.b64decode(re.search(r"base64,([^\"]+)", text)[1]) == PNG
    assert '<meta charset="utf-8">' in text and "joint &quot;1&quot;" in text


@given(st.text(st.characters(codec="utf-8", exclude_categories=["Cs", "Cc"])))
def test_no_name_becomes_markup(tmp_path_factory, name):
    page = Page("x", "y")
    page.table(("name",), [(f"<b>{name}",)])
    page.section(f"<script>{name}")
    text = text_of(page, tmp_path_factory.getbasetemp())
    assert "<b>" not in text and "<script>" not in text


@pytest.mark.parametrize(
    ("cell", "shown"),
    [
        (0.25, "<td>0.2500</td>"),
        (-1e-9, "<td>-1.000e-09</td>"),
        (123456.789, "<td>123500</td>"),
        (None, '<td class="quiet">–</td>'),
        (float("nan"), '<td class="quiet">–</td>'),
        (float("inf"), "<td>–</td>"),
        ("not revealed", "<td>not revealed</td>"),
    ],
)
def test_cells(tmp_path, cell, shown):
    page = Page("x", "y")
    page.table(("value",), [(cell,)])
    assert shown in text_of(page, tmp_path)


def test_an_alarm_is_red_and_a_table_of_words_is_not_of_numbers(tmp_path):
    page = Page("x", "y")
    page.alarm("1 of 22 <motions>")
    page.table(("symbol",), [("a_j",)], words=True)
    text = text_of(page, tmp_path)
    assert '<p class="alarm">1 of 22 &lt;motions&gt;</p>' in text and "p.alarm { color: #a61c3c" in text
    assert '<table class="words">' in text


def test_a_place_that_cannot_be_written_to(tmp_path):
    with pytest.raises(DeviceError, match="nowhere/page.html: cannot be written: No such file"):
        Page("x", "y").write(tmp_path / "nowhere" / "page.html")


def test_sentences_notes_and_titled_tables_are_escaped(tmp_path):
    page = Page("x", "y")
    page.points(["1 < 2", "3 & 4"])
    page.points([])
    page.note("How <it>", ["by & by"])
    page.note("Nothing", [])
    page.table(("a",), [("b",)], "Of <c>")
    text = text_of(page, tmp_path)
    assert "<ul><li>1 &lt; 2</li><li>3 &amp; 4</li></ul>" in text
    assert "<details><summary>How &lt;it&gt;</summary><ul><li>by &amp; by</li></ul></details>" in text
    assert "<h3>Of &lt;c&gt;</h3>" in text
    assert "Nothing" not in text and text.count("<ul>") == 2
