"""How commands take their arguments, and what they say where those are wrong."""

import shlex
import subprocess
import sys
import textwrap
from importlib import import_module, metadata

import pytest

from limbcal.arguments import Parser, parser_of
from limbcal.errors import ConfigError

PROGRAMS = {"fitter": "fitter", "limbd": "daemon", "limbplay": "playback"}
COMMANDS = [
    (program, package, name)
    for program, package in PROGRAMS.items()
    for name in import_module(f"{package}.__main__").COMMANDS
]


def parser_for(program):
    """Return the parser of a program as its ``main`` makes it."""
    package = PROGRAMS[program]
    return parser_of(program, "", f"{package}.commands", import_module(f"{package}.__main__").COMMANDS)


@pytest.mark.parametrize("program", ["fitter", "daemon", "playback"])
def test_only_the_command_that_was_chosen_is_loaded(program):
    """What somebody who asks for help waits for is no more than the list of commands."""
    seen = textwrap.dedent(f"""
        import sys
        from {program}.__main__ import COMMANDS, main
        try:
            main(["--help"])
        except SystemExit as end:
            assert end.code == 0
        loaded = [name for name in COMMANDS if f"{program}.commands.{{name}}" in sys.modules]
        assert not loaded and "scipy" not in sys.modules, loaded
        """)
    subprocess.run([sys.executable, "-c", seen], check=True, capture_output=True)


@pytest.mark.parametrize("program", ["fitter", "daemon", "playback"])
def test_every_command_in_the_list_is_there(program):
    module = import_module(f"{program}.__main__")
    for name in module.COMMANDS:
        with pytest.raises(SystemExit) as end:
            module.main([name, "--help"])
        assert end.value.code == 0


@pytest.mark.parametrize(("program", "package", "name"), COMMANDS)
def test_the_example_of_every_command_is_in_its_help_and_parses(capsys, program, package, name):
    example = import_module(f"{package}.commands.{name.replace('-', '_')}").EXAMPLE
    first, second, *arguments = shlex.split(example)
    assert (first, second) == (program, name)
    assert callable(parser_for(program).parse_args([name, *arguments]).action)
    with pytest.raises(SystemExit):
        parser_for(program).parse_args([name, "--help"])
    assert f"\nexample:\n  {example}\n" in capsys.readouterr().out


@pytest.mark.parametrize("program", PROGRAMS)
def test_the_version_is_told_by_programs_and_commands(capsys, program):
    command = next(name for owner, _, name in COMMANDS if owner == program)
    for arguments in (["--version"], [command, "--version"]):
        with pytest.raises(SystemExit) as end:
            parser_for(program).parse_args(arguments)
        assert end.value.code == 0
        assert capsys.readouterr() == (f"{program} {metadata.version('limbcal')}\n", "")


@pytest.mark.parametrize(
    ("program", "arguments", "sentence"),
    [
        ("fitter", ["dynmics", "a.csv"], r"fitter: there is no command 'dynmics', .*; did you mean 'dynamics'\?"),
        ("fitter", ["--verison"], r"fitter: there is no option --verison; did you mean '--version'\?"),
        (
            "fitter",
            ["dynamics", "--amr", "x"],
            r"fitter dynamics: there is no option --amr; did you mean '--arm'\?",
        ),
        ("fitter", ["dynamics", "--ARM=x"], r"fitter dynamics: there is no option --ARM; did you mean '--arm'\?"),
        ("fitter", ["effects", "--zzz"], r"there is no option --zzz; expected one of --help, --json, --debug"),
        ("fitter", ["sums", "ad"], r"fitter sums: there is no command 'ad', expected .*; did you mean 'add'\?"),
        (
            "limbd",
            ["keys", "nwe", "x"],
            r"limbd keys: there is no command 'nwe', expected one of new; did you mean",
        ),
        ("limbd", ["check", "a", "b"], r"limbd check: 'b' is one argument too many"),
        ("limbd", ["virtual", "-x"], r"limbd virtual: '-x' is one argument too many"),
        (
            "limbplay",
            ["touch", "--device", "virtuel"],
            r"--device: there is no value 'virtuel', .*mean 'virtual'\?",
        ),
        ("limbplay", ["export", "a.csv"], r"limbplay export: --out missing; `limbplay export --help`"),
        ("fitter", ["--json", "effects"], r"fitter: --json stands before the command, expected it after"),
        ("limbplay", [], r"limbplay: COMMAND missing"),
    ],
)
def test_a_wrong_argument_is_named_with_what_was_meant(program, arguments, sentence):
    with pytest.raises(ConfigError, match=sentence):
        parser_for(program).parse_args(arguments)


def test_what_follows_two_dashes_or_holds_a_space_is_no_option():
    parser = Parser(prog="limbtest")
    parser.add_argument("words", nargs="*")
    parser.add_argument("--size", type=float)
    assert parser.parse_args(["--", "--sise"]).words == ["--sise"]
    assert parser.parse_args(["--siz", "-3", "a"]).size == -3.0  # shortened, as argparse has it
    assert parser.parse_args(["--no such option"]).words == ["--no such option"]
    for before in ("a", "-3", "--no such option"):
        with pytest.raises(ConfigError, match=r"limbtest: there is no option --sise; did you mean '--size'\?"):
            parser.parse_args([before, "--sise", "3"])
