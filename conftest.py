"""How the tests are shared out between processes (`make test` runs two)."""

from pathlib import Path

import pytest

#: Tests that look at what a machine has but one of: processes, ports, shared memory.
ALONE = ("daemon", "playback", "examples", "protocol", "soak")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let ``make soak`` run the tests of endurance at length."""
    parser.addoption("--long", action="store_true", help="test endurance at length, and show the figures")


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Show the figures that tests of endurance have measured."""
    figures = [
        text
        for report in terminalreporter.getreports("passed") + terminalreporter.getreports("failed")
        for name, text in report.user_properties
        if name == "figure"
    ]
    if figures and terminalreporter.config.getoption("--long"):
        terminalreporter.section("figures")
        for text in dict.fromkeys(map(str, figures)):
            terminalreporter.line(text)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Keep tests of a file together, for they share fixtures, and all that look at the machine in one process."""
    for item in items:
        inside = Path(item.path).relative_to(item.config.rootpath / "tests").parts
        item.add_marker(pytest.mark.xdist_group("machine" if inside[0] in ALONE else "/".join(inside)))
