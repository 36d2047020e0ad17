"""Numbers of options, and flags as the config's tables."""

import argparse
from pathlib import Path

import pytest

from daemon.commands.options import add_device_options, given, not_negative, positive, whole
from daemon.commands.virtual import add_arguments as add_virtual_arguments
from daemon.commands.zero import _seconds as zero_seconds
from daemon.virtual_device.virtual_loop import VirtualOptions


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


@pytest.mark.parametrize("value", ["0.5", "60", "2"])
def test_biases_are_measured_for_half_a_second_to_a_minute(value: str) -> None:
    assert zero_seconds(value) == float(value)
    for other in ("0.49", "60.1", "-1", "x"):
        with pytest.raises(argparse.ArgumentTypeError, match=f"'{other}' is not a number"):
            zero_seconds(other)


def virtual_options(*texts: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser(exit_on_error=False)
    add_virtual_arguments(parser)
    return parser.parse_args(list(texts))


@pytest.mark.parametrize(("option", "name"), [("--clock-ppm", "clock_ppm"), ("--frame-samples", "frame_samples")])
@pytest.mark.parametrize("end", [0, 1])
def test_a_virtual_clock_and_frame_end_somewhere(option: str, name: str, end: int) -> None:
    ends, beyond = {
        "clock_ppm": (("-500000", "500000"), ("-500001", "500001", "nan", "x")),
        "frame_samples": (("1", "1024"), ("0", "1025", "x", "1.5")),
    }[name]
    assert getattr(virtual_options(f"{option}={ends[end]}"), name) == float(ends[end])
    for text in beyond:
        with pytest.raises(argparse.ArgumentError):
            virtual_options(f"{option}={text}")


def test_a_virtual_device_is_the_bench_s_unless_said_otherwise() -> None:
    found = vars(virtual_options())
    found.pop("action")
    assert found == {
        **{"link": None, "arm": "dd-arm", "seed": 0, "rate_hz": 32000.0, "sampled_hz": None, "clock_ppm": 0.0},
        **{"wraps_s": None, "frame_samples": 32, "speed": 1.0, "trials": 22, "noise": 1.0, "highpass_hz": None},
        **{"imperfect_mounting": False, "fault": "", "patient": False, "truth": None},
    }
    assert virtual_options("--quiet-sensors").noise == 0.0
    assert virtual_options("--patient", "--imperfect-mounting").patient


@pytest.mark.parametrize(
    ("texts", "sampled_hz", "clock"),
    [
        ((), 32000.0, 1.0),
        (("--clock-ppm", "1000"), 32032.0, 1.001),
        (("--sampled-hz", "30000"), 30000.0, 1.0),
        (("--sampled-hz", "30000", "--clock-ppm=-1000", "--rate-hz", "8000"), 29970.0, 0.999),
    ],
)
def test_a_fast_clock_samples_fast(
    monkeypatch: pytest.MonkeyPatch, texts: tuple[str, ...], sampled_hz: float, clock: float
) -> None:
    served: list[VirtualOptions] = []
    monkeypatch.setattr("daemon.virtual_device.virtual_loop.serve", served.append)
    more = ("--frame-samples", "16", "--wraps-s", "3", "--seed", "4", "--trials", "5", "--highpass-hz", "0.5")
    options = virtual_options(*texts, *more)
    options.json = False
    options.action(options)
    (one,) = served
    assert one.plan.rate_hz == one.timing.sampled_hz == pytest.approx(sampled_hz)
    assert (one.timing.clock, one.timing.wraps_s, one.timing.frame_samples) == (pytest.approx(clock), 3.0, 16)
    assert one.claimed_hz == (8000.0 if "8000" in texts else 32000.0)
    assert (one.plan.seed, one.plan.trials, one.plan.highpass_hz) == (4, 5, 0.5)
    assert (one.speed, one.faults, one.patient) == (1.0, (), False)
