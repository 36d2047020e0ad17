"""Nothing that somebody else wrote moves a cursor or raises where it is printed."""

import pytest

from limbcal.command import say, show
from limbcal.escaped import escaped


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("Größe 9.81 m/s² ± 2\u202f%", "Größe 9.81 m/s² ± 2\u202f%"),
        ("two\nlines\tand a column", "two\nlines\tand a column"),
        ("\x1b[2Jgone", "\\x1b[2Jgone"),
        ("a\u202eb", "a\\u202eb"),
        ("\ud800", "\\ud800"),
        ("a\x00\r\x9b", "a\\x00\\r\\x9b"),
    ],
)
def test_what_is_no_character_is_written_out(text: str, shown: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert escaped(text) == shown
    show("")  # and with it what another test has left in the console
    capfd.readouterr()
    say(text)
    show(text)
    out, err = capfd.readouterr()
    assert out.rstrip("\n") == err.rstrip("\n") == shown.expandtabs(8)
