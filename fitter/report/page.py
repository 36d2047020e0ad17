"""The page itself: one HTML file, opens offline."""

import base64
import html
import math
from collections.abc import Sequence
from pathlib import Path

from limbcal.digits import plain
from limbcal.errors import DeviceError

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #1c1c1c; max-width: 62rem; margin: 2rem auto; padding: 0 1rem }
h1 { font-size: 1.6rem; margin-bottom: 0 } h2 { font-size: 1.15rem; margin: 2rem 0 .4rem }
h3 { font-size: 1rem; margin: 1.2rem 0 .2rem } summary { color: #555; cursor: pointer }
p.lead { color: #555; margin-top: .2rem } img { max-width: 100% }
table { border-collapse: collapse; margin: .6rem 0; font-variant-numeric: tabular-nums }
th, td { padding: .25rem .8rem; text-align: right; border-bottom: 1px solid #ddd }
th:first-child, td:first-child { text-align: left } th { border-bottom: 2px solid #888; font-weight: 600 }
td.quiet { color: #999 } p.alarm { color: #a61c3c; font-weight: 600 }
div.wide { overflow-x: auto } td { white-space: nowrap }
table.words td { text-align: left; white-space: normal } table.words td:first-child { white-space: nowrap }
table.words th { text-align: left }
"""

Row = Sequence[str | float | None]


class Page:
    """A page that grows from top to bottom."""

    def __init__(self, title: str, lead: str) -> None:
        self._title = title
        self._parts = [f"<h1>{html.escape(title)}</h1>", f'<p class="lead">{html.escape(lead)}</p>']

    def section(self, title: str, text: str = "") -> None:
        """Begin a section."""
        self._parts.append(f"<h2>{html.escape(title)}</h2>")
        if text:
            self._parts.append(f"<p>{html.escape(text)}</p>")

    def points(self, sentences: Sequence[str]) -> None:
        """Add sentences one below the other."""
        if sentences:
            self._parts.append(f"<ul>{''.join(f'<li>{html.escape(text)}</li>' for text in sentences)}</ul>")

    def alarm(self, sentence: str) -> None:
        """Add a sentence in red, which must not be overlooked."""
        self._parts.append(f'<p class="alarm">{html.escape(sentence)}</p>')

    def note(self, title: str, sentences: Sequence[str]) -> None:
        """Add sentences that are folded away until somebody asks for them."""
        if sentences:
            self._parts.append(f"<details><summary>{html.escape(title)}</summary>")
            self.points(sentences)
            self._parts.append("</details>")

    def table(self, header: Sequence[str], rows: Sequence[Row], title: str = "", *, words: bool = False) -> None:
        """Add a table; numbers have four digits, what is missing is a dash; ``words``: cells are sentences."""
        if title:
            self._parts.append(f"<h3>{html.escape(title)}</h3>")
        kind = ' class="words"' if words else ""
        head = "".join(f"<th>{html.escape(cell)}</th>" for cell in header)
        body = "".join(f"<tr>{''.join(_cell(cell) for cell in row)}</tr>" for row in rows)
        self._parts.append(
            f'<div class="wide"><table{kind}><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'
        )

    def picture(self, png: bytes, caption: str) -> None:
        """Add a picture; it is inside the file."""
        data = base64.b64encode(png).decode("ascii")
        alt = html.escape(caption, quote=True)
        self._parts.append(
            f'<p><img alt="{alt}" src="data:image/png;base64,{data}"><br>{html.escape(caption)}</p>'
        )

    def write(self, path: Path) -> None:
        """Write the page.

        Raises
        ------
        DeviceError
            If the file cannot be written.
        """
        text = (
            '<!doctype html><html lang="en"><meta charset="utf-8">'
            f"<title>{html.escape(self._title)}</title><style>{_STYLE}</style><body>{''.join(self._parts)}</body></html>"
        )
        try:
            path.write_text(text, encoding="utf-8")
        except OSError as error:
            raise DeviceError(f"{path}: cannot be written: {error.strerror}") from error


def _cell(value: str | float | None) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return '<td class="quiet">–</td>'
    if isinstance(value, str):
        return f"<td>{html.escape(value)}</td>"
    return f"<td>{plain(value)}</td>"
