"""What the config says where, what flags may do, and the setup of a run that is replayed."""

from pathlib import Path

import numpy as np
import pytest

from arm.arm_file import format_arm, load_arm
from daemon.config.config import format_config, load_setup, replayed_setup
from limbcal.errors import ConfigError, DataError
from protocol.recording import RecordingWriter

DEVICE = {"device": {"port": "/dev/ttyX"}}
FLAGS = {**DEVICE, "arm": {"file": "dd-arm"}}


def mistakes(flags: dict, path: Path | None = None) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        load_setup(path, flags)
    return caught.value.mistakes


@pytest.mark.parametrize("endpoint", ["tcp://127.0.0.1:1", "tcp://[::1]:5770", "ipc:///tmp/frames"])
def test_an_endpoint_of_this_machine_needs_no_keys(endpoint: str) -> None:
    setup = load_setup(None, {**FLAGS, "publish": {"endpoint": endpoint}})
    assert (setup.config.publish.endpoint, setup.config.publish.keys) == (endpoint, None)


@pytest.mark.parametrize(
    ("publish", "said"),
    [
        ({"endpoint": "inproc://x"}, "arguments: publish.endpoint is 'inproc://x', expected tcp:// or ipc://"),
        (
            {"endpoint": "tcp://0.0.0.0:1"},
            "arguments: publish.endpoint is 'tcp://0.0.0.0:1', which other machines",
        ),
        ({"endpoint": "nonsense"}, "arguments: publish.endpoint is 'nonsense'"),
        ({"endpoint": 5770}, "publish.endpoint is 5770"),
        ({"keys": ""}, "publish.keys is ''"),
    ],
)
def test_an_endpoint_that_will_not_do_is_one_mistake(publish: dict, said: str) -> None:
    (mistake,) = mistakes({**FLAGS, "publish": publish})
    assert said in mistake


def test_where_a_mistake_is_depends_on_what_was_given(tmp_path: Path) -> None:
    path = tmp_path / "limbd.toml"
    path.write_text('[device]\nport = "/dev/x"\nbaud = -1\n[arm]\nfile = "dd-arm"\n')
    assert mistakes({}, path)[0].startswith(f"{path}: device.baud is -1")
    assert mistakes(DEVICE, path)[0].startswith(f"{path} with its flags: device.baud is -1")
    assert mistakes({**FLAGS, "device": {"port": "x", "baud": 0}})[0].startswith("arguments: device.baud is 0")


def test_what_is_missing_is_said_with_its_flag() -> None:
    (mistake,) = mistakes(DEVICE)
    assert mistake == "arguments: arm.file is missing; expected in the config file or as --arm"
    (mistake,) = mistakes({"arm": {"file": "dd-arm"}})
    assert mistake == "arguments: device.port is missing; expected in the config file or as --port"
    (mistake,) = mistakes({**FLAGS, "record": {"file_mb": 5.0}})
    assert mistake == "arguments: record.directory is missing"


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ({"arm": {"file": ""}}, "arm.file is ''"),
        ({"arm": {"file": 5}}, "arm.file is 5"),
        ({"tracking": {"initial_q_rad": [0.0, 0.0, 0.0]}}, "initial_q_rad has 3 numbers, expected one a joint"),
        ({"tracking": {"initial_q_rad": []}}, "initial_q_rad has 0 numbers, expected one a joint of 'dd-arm' (2)"),
        ({"tracking": {"frame_rate_hz": 0}}, "tracking.frame_rate_hz is 0"),
        ({"tracking": {"frame_rate_hz": 1e-300}}, "tracking.frame_rate_hz is 1e-300"),
        ({"trials": {"learning": -1}}, "trials.learning is -1"),
        ({"record": {"directory": ""}}, "record.directory is ''"),
        ({"record": {"directory": "x", "file_mb": 0.9}}, "record.file_mb is 0.9"),
        ({"record": {"directory": "x", "file_minutes": 0}}, "record.file_minutes is 0"),
        ({"record": {"directory": "x", "free_mb": -1}}, "record.free_mb is -1"),
        ({"metrics": {"address": "0.0.0.0:9464"}}, "metrics.address is '0.0.0.0:9464'"),
        (
            {"metrics": {"address": "127.0.0.1:99999"}},
            "metrics.address is '127.0.0.1:99999'; expected 127.0.0.1:PORT, localhost:PORT or [::1]:PORT, "
            "with a port up to 65535",
        ),
        ({"device": {"port": "x", "baud": 2**31}}, "device.baud is 2147483648"),
        ({"device": {"port": "x", "real_time": 1}}, "device.real_time is 1"),
    ],
)
def test_each_field_has_its_bounds(tables: dict, said: str) -> None:
    (mistake,) = mistakes({**FLAGS, **tables})
    assert said in mistake


def test_bounds_themselves_are_allowed() -> None:
    tables = {
        "device": {"port": "x", "baud": 1, "real_time": False},
        "record": {"directory": "x", "file_mb": 1, "file_minutes": 1e-9, "free_mb": 0},
        "trials": {"learning": 0},
        "metrics": {"address": "localhost:1"},
        "tracking": {"frame_rate_hz": 0.1, "initial_q_rad": (0.1, 0.2)},
    }
    setup = load_setup(None, {**FLAGS, **tables})
    config = setup.config
    assert config.record is not None
    assert (config.record.file_bytes, config.record.free_bytes, config.trials.learning) == (10**6, 0, 0)
    assert config.device.real_time is False
    np.testing.assert_array_equal(setup.initial_q_rad, [0.1, 0.2])


def test_defaults_are_those_of_the_manual() -> None:
    config = load_setup(None, {**FLAGS, "record": {"directory": "x"}}).config
    assert config.model_dump() == {
        "device": {"port": "/dev/ttyX", "baud": 12_000_000, "real_time": True},
        "arm": {"file": "dd-arm"},
        "tracking": {"method": "filter", "initial_q_rad": None, "frame_rate_hz": 1000.0, "zero": None},
        "publish": {"endpoint": "tcp://127.0.0.1:5770", "raw": False, "keys": None},
        "record": {"directory": "x", "file_mb": 2000.0, "file_minutes": 60.0, "free_mb": 100.0},
        "trials": {"learning": 5},
        "metrics": None,
    }
    text = format_config(load_setup(None, {**FLAGS, "publish": {"raw": True}}).config)
    assert text.startswith(
        '[device]\nport = "/dev/ttyX"\nbaud = 12000000\nreal_time = true\n\n[arm]\nfile = "dd-arm"\n'
    )
    assert "raw = true" in text and "[record]" not in text and "zero" not in text


def test_the_highest_rate_is_what_a_line_takes() -> None:
    assert load_setup(None, {**FLAGS, "device": {"port": "x", "baud": 2**31 - 1}}).config.device.baud == 2**31 - 1


CONFIG = (
    '[device]\nport = "/dev/old"\n[arm]\nfile = "gone.toml"\n[tracking]\nmethod = "integrate"\n'
    '[publish]\nendpoint = "tcp://*:1"\nraw = true\nkeys = "keys"\n[record]\ndirectory = "x"\n'
    '[metrics]\naddress = "127.0.0.1:9464"\n'
)


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    path = tmp_path / "run.mcap"
    RecordingWriter(path, format_arm(load_arm("dd-arm-vertical")), CONFIG).close()
    return path


def test_a_recorded_run_has_its_arm_and_config_and_publishes_here_alone(recording: Path) -> None:
    setup = replayed_setup(recording, {}, 2.5)
    assert (setup.replay, setup.speed) == (recording, 2.5)
    assert setup.arm.name == "dd-arm-vertical"
    assert (setup.config.device.port, setup.config.tracking.method) == ("/dev/old", "integrate")
    assert (setup.config.publish.endpoint, setup.config.publish.raw) == ("tcp://127.0.0.1:5770", True)
    assert setup.config.publish.keys is None and setup.config.record is None
    assert setup.config.metrics is None  # the service that recorded it may be running beside


def test_flags_win_over_a_recorded_run(recording: Path, tmp_path: Path) -> None:
    flags = {"arm": {"file": "dd-arm"}, "publish": {"raw": False}, "record": {"directory": str(tmp_path)}}
    setup = replayed_setup(recording, flags, 1.0)
    assert setup.arm.name == "dd-arm" and setup.config.publish.raw is False
    assert setup.config.record is not None and setup.config.record.directory == str(tmp_path)
    with pytest.raises(ConfigError, match=f"{recording}: trials.learning is -1"):
        replayed_setup(recording, {"trials": {"learning": -1}}, 1.0)


def test_a_config_without_publish_publishes_here(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    RecordingWriter(path, format_arm(load_arm("dd-arm")), CONFIG.partition("[publish]")[0]).close()
    publish = replayed_setup(path, {}, 1.0).config.publish
    assert (publish.endpoint, publish.raw) == ("tcp://127.0.0.1:5770", False)


def test_a_recording_of_something_else_cannot_be_replayed(tmp_path: Path, recording: Path) -> None:
    cut = tmp_path / "cut.mcap"
    data = recording.read_bytes()
    cut.write_bytes(data[: data.index(b"limbd.toml") - 29])
    with pytest.raises(DataError, match=r"cut\.mcap: limbd\.toml are not attached to it"):
        replayed_setup(cut, {}, 1.0)
    cut.write_bytes(data[:20])
    with pytest.raises(DataError, match=r"cut\.mcap: arm\.toml and limbd\.toml are not attached to it"):
        replayed_setup(cut, {}, 1.0)
    RecordingWriter(tmp_path / "bad.mcap", "arm", "device = [").close()
    with pytest.raises(ConfigError, match=r"limbd\.toml in .*bad\.mcap"):
        replayed_setup(tmp_path / "bad.mcap", {}, 1.0)
