"""Numbers of options, and flags as the config's tables."""

import argparse
from pathlib import Path

import pytest

from daemon.commands.options import add_device_options, given, not_negative, positive, whole


@pytest.mark.parametrize(("text", "value"), [("0.5", 0.5), ("1e3", 1000.0), ("7", 7.0)])
def test_numbers_above_zero(text: str, value: float) -> None:
    assert positive(text) == not_negative(text) == value


def test_zero_is_not_negative_and_not_positive() -> None:
    assert not_negative("0") == 0.0
    with pytest.raises(argparse.ArgumentTypeError, match="'0' is not a number above 0"):
        positive("0")


@pytest.mark.parametrize("text", ["-1", "nan", "inf", "-inf", "one", "", "1,5"])
def test_what_is_no_number_is_refused(text: str) -> None:
    for kind in (positive, not_negative):
        with pytest.raises(argparse.ArgumentTypeError, match="at least 0"):
            kind(text)


def test_whole_numbers() -> None:
    assert (whole("0"), whole("17")) == (0, 17)
    for text in ("-1", "1.0", "", "1e3", "x"):
        with pytest.raises(argparse.ArgumentTypeError, match="not a whole number"):
            whole(text)


def test_flags_become_tables_and_those_not_given_do_not() -> None:
    parser = argparse.ArgumentParser()
    add_device_options(parser)
    assert given(parser.parse_args([])) == {}
    arguments = parser.parse_args(
        ["--port", "/dev/x", "--baud", "115200", "--arm", "dd-arm", "--config", "a.toml"]
    )
    assert given(arguments) == {"device": {"port": "/dev/x", "baud": 115200}, "arm": {"file": "dd-arm"}}
    assert arguments.config == Path("a.toml")
    more = argparse.Namespace(method="kalman", endpoint="tcp://127.0.0.1:1", record="there")
    assert given(more) == {
        "tracking": {"method": "kalman"},
        "publish": {"endpoint": "tcp://127.0.0.1:1"},
        "record": {"directory": "there"},
    }
