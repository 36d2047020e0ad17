"""Where an answer comes from."""

import re
from pathlib import Path

from fitter.report.provenance import Provenance, provenance
from limbcal.arguments import Parser, common_options, version
from limbcal.command import run_command


def test_the_command_that_is_carried_out_is_told_as_it_was_typed():
    kept = []
    parser = Parser(prog="limbtest", parents=[common_options()])
    parser.add_argument("file")
    parser.set_defaults(action=lambda namespace: kept.append(provenance([Path(namespace.file)])))
    assert run_command(parser, ["a b.csv"]) == 0
    (found,) = kept
    assert found.command == "limbtest 'a b.csv'" and found.files == ("a b.csv",) and found.version == version()
    assert re.fullmatch(r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d[+-]\d\d:\d\d", found.date)
    assert provenance().command == ""


def test_only_what_is_known_has_a_row():
    assert Provenance("", "today", "1.0", ("a", "b")).rows() == [
        ("date", "today"),
        ("limbcal", "1.0"),
        ("files", "a"),
        ("", "b"),
    ]
