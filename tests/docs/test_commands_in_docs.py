"""Commands that README and docs print are commands that exist, with options that exist."""

import re
import shlex
from importlib import import_module
from pathlib import Path

import pytest

from limbcal.arguments import parser_of

ROOT = Path(__file__).parents[2]
PAGES = ["README.md", "systemd/README.md", *sorted(f"docs/{page.name}" for page in (ROOT / "docs").glob("*.md"))]
PROGRAMS = {"limbd": "daemon", "fitter": "fitter", "limbplay": "playback"}
BLOCK = re.compile(r"^```sh\n(.*?)^```", re.MULTILINE | re.DOTALL)
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


@pytest.mark.parametrize("page", ["README.md", "docs/tutorial.md"])
def test_links_of_a_page_lead_somewhere(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text):
        if "://" not in target:
            assert ((ROOT / page).parent / target).exists(), target


def test_the_way_of_the_readme_is_there():
    printed = {(program, arguments[0]) for program, arguments in commands_of("README.md")}
    assert {("limbd", "run"), ("limbd", "status"), ("fitter", "subscribe"), ("fitter", "diagnose")} <= printed
    assert ("limbplay", "view") in printed
    tutorial = {(program, arguments[0]) for program, arguments in commands_of("docs/tutorial.md")}
    assert printed <= tutorial | {("limbd", "check")}
