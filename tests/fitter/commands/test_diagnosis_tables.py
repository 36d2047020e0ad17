"""Names of markers, and units, stand in a table as they are."""

import io
from types import SimpleNamespace

from rich.console import Console

from fitter.commands.diagnose_markers import _distances


def shown(table):
    text = io.StringIO()
    Console(file=text, width=120).print(table)
    return text.getvalue()


def test_a_marker_is_called_what_the_recording_calls_it():
    names = ["arm[1]", "arm[/1]", "a\x1b[2J"]
    finding = SimpleNamespace(
        rms_mm=(3.0, 2.0),
        causes=[SimpleNamespace(markers=names)],
        before=dict.fromkeys(names, 5.0),
        after=dict.fromkeys(names, 4.0),
    )
    said = shown(_distances(finding))
    assert all(name in said for name in ("arm[1]", "arm[/1]", "a\\x1b[2J", "[mm]"))
