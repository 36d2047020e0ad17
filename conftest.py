"""Tests of endurance: in short, or at length with their figures."""

import pytest

import fitter.single_thread  # noqa: F401 - before all that loads numpy, and for all that the tests start


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let ``make soak`` run the tests of endurance at length."""
    parser.addoption("--long", action="store_true", help="test endurance at length, and show the figures")
    parser.addoption(
        "--minutes",
        type=float,
        default=30.0,
        metavar="M",
        help="with --long: how long half an hour is",
    )


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
