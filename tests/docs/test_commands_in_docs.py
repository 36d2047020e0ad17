"""Commands and options that the pages print exist, and the reference has every option."""

import argparse
import re
import shlex
from importlib import import_module
from pathlib import Path

import pytest

from limbcal.arguments import parser_of

ROOT = Path(__file__).parents[2]
PAGES = ["README.md", "systemd/README.md"]
PAGES += sorted(str(page.relative_to(ROOT)) for page in (ROOT / "docs").rglob("*.md"))
PROGRAMS = {"limbd": "daemon", "fitter": "fitter", "limbplay": "playback"}
BLOCK = re.compile(r"^ *```sh\n(.*?)^ *```", re.MULTILINE | re.DOTALL)
OPTION = re.compile(r"--[a-z][a-z0-9-]*")
#: Options that every command has.
COMMON = {"--help", "--json", "--debug", "--version"}
#: Commands that need neither data nor a device and end at once.
CHEAP = {"check", "effects"}


def commands_of(page):
    """Return the words of every command of ours in the blocks of a page."""
    found = []
    for block in BLOCK.findall((ROOT / page).read_text(encoding="utf-8")):
        for line in block.replace("\\\n", " ").splitlines():
            for part in re.split(r"&&|\||;|(?<!&)&(?!&)", line):
                try:
                    words = shlex.split(part, comments=True)
                except ValueError:
                    continue  # what a program printed
                words = words[1:] if words[:1] == ["sudo"] else words
                if words and words[0].removeprefix(".venv/bin/") in PROGRAMS and len(words) > 1:
                    found.append((words[0].removeprefix(".venv/bin/"), words[1:]))
    return found


COMMANDS = [
    pytest.param(program, arguments, id=f"{page}: {program} {' '.join(arguments)}"[:90])
    for page in PAGES
    for program, arguments in commands_of(page)
]


def parse(program, arguments):
    package = PROGRAMS[program]
    commands = import_module(f"{package}.__main__").COMMANDS
    return parser_of(program, "", f"{package}.commands", commands).parse_args(arguments)


@pytest.mark.parametrize(("program", "arguments"), COMMANDS)
def test_a_printed_command_parses(program, arguments):
    if {"--version", "--help"} & set(arguments):
        with pytest.raises(SystemExit) as end:
            parse(program, arguments)
        assert end.value.code == 0
    else:
        assert callable(parse(program, arguments).action)


@pytest.mark.parametrize(("program", "arguments"), [case for case in COMMANDS if CHEAP & set(case.values[1][:1])])
def test_a_cheap_command_of_the_docs_works(program, arguments, capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    if any(not (ROOT / word).exists() for word in arguments[1:] if not word.startswith("-")):
        pytest.skip("it is of a file that the reader has")
    main = import_module(f"{PROGRAMS[program]}.__main__").main
    assert main(arguments) == 0
    assert capsys.readouterr().out


def options_of(parser):
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                yield from options_of(command)
        yield from (name for name in action.option_strings if name.startswith("--"))


def command_parser(program, command):
    parser = argparse.ArgumentParser()
    import_module(f"{PROGRAMS[program]}.commands.{command.replace('-', '_')}").add_arguments(parser)
    return parser


EVERY = [
    (program, command)
    for program, package in PROGRAMS.items()
    for command in import_module(f"{package}.__main__").COMMANDS
]


@pytest.mark.parametrize(("program", "command"), EVERY, ids=lambda word: word)
def test_the_reference_has_every_option_of_a_command(program, command):
    page = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    sections = re.split(r"^## ", page, flags=re.MULTILINE)[1:]
    own = "".join(section for section in sections if f"{program} {command}" in section.partition("\n")[0])
    assert own, "no section"
    assert set(options_of(command_parser(program, command))) - COMMON <= set(OPTION.findall(own))


@pytest.mark.parametrize("page", PAGES)
def test_an_option_that_a_sentence_gives_a_command_exists(page):
    for program, command, rest in re.findall(
        r"`(limbd|fitter|limbplay) ([a-z-]+)([^`\n]*)`", (ROOT / page).read_text(encoding="utf-8")
    ):
        if (program, command) in EVERY:
            assert set(OPTION.findall(rest)) <= set(options_of(command_parser(program, command))) | COMMON, command


def test_the_way_of_the_readme_is_there():
    printed = {(program, arguments[0]) for program, arguments in commands_of("README.md")}
    assert {("limbd", "run"), ("limbd", "status"), ("fitter", "subscribe"), ("fitter", "diagnose")} <= printed
    assert ("limbplay", "view") in printed
    tutorial = {(program, arguments[0]) for program, arguments in commands_of("docs/tutorial.md")}
    assert printed <= tutorial | {("limbd", "check")}
