"""Every mistake is named, flags win, and what is attached to a recording gives the same config again."""

from pathlib import Path

import numpy as np
import pytest

from arm.arm_file import format_arm, load_arm
from daemon.config.config import format_config, load_setup, replayed_setup
from limbcal.errors import ConfigError, DataError
from protocol.recording import RecordingWriter

EXAMPLE = Path(__file__).parents[3] / "examples" / "limbd.toml"


def mistakes_in(tmp_path: Path, text: str, **flags: dict[str, object]) -> list[str]:
    path = tmp_path / "limbd.toml"
    path.write_text(text)
    with pytest.raises(ConfigError) as caught:
        load_setup(path, flags)
    return caught.value.mistakes


def test_the_example_is_right_and_shows_every_field() -> None:
    setup = load_setup(EXAMPLE, {})
    shown = setup.config.model_dump()
    assert shown["record"] == {
        "directory": "recordings",
        "file_mb": 2000.0,
        "file_minutes": 60.0,
        "free_mb": 100.0,
    }
    text = EXAMPLE.read_text()
    for table, fields in shown.items():
        assert f"[{table}]" in text
        for field, value in (fields or {}).items():  # what would contradict another field is shown as a comment
            assert f"\n{'# ' if value is None else ''}{field} = " in text


def test_what_a_recording_may_take_is_in_bytes_and_seconds(tmp_path: Path) -> None:
    path = tmp_path / "limbd.toml"
    path.write_text(EXAMPLE.read_text())
    record = load_setup(path, {"record": {"file_mb": 1.5, "file_minutes": 2.0, "free_mb": 0.25}}).config.record
    assert record is not None
    assert (record.file_bytes, record.file_s, record.free_bytes) == (1_500_000, 120.0, 250_000)


def test_metrics_are_shown_as_they_would_be(tmp_path: Path) -> None:
    text = EXAMPLE.read_text().replace("# [metrics]", "[metrics]").replace("# address", "address")
    path = tmp_path / "limbd.toml"
    path.write_text(text)
    metrics = load_setup(path, {}).config.metrics
    assert metrics is not None and metrics.address == "127.0.0.1:9464"


def test_flags_alone_are_enough() -> None:
    setup = load_setup(None, {"device": {"port": "/dev/ttyX"}, "arm": {"file": "dd-arm"}})
    assert setup.config.device.baud == 12_000_000
    assert setup.config.publish.endpoint == "tcp://127.0.0.1:5770"
    assert setup.config.record is None
    assert setup.config.tracking.method == "filter"
    assert setup.initial_q_rad is None


def test_angles_that_are_given_reach_the_tracker() -> None:
    np.testing.assert_array_equal(load_setup(EXAMPLE, {}).initial_q_rad, np.zeros(2))


def test_flags_win_over_the_file() -> None:
    setup = load_setup(EXAMPLE, {"device": {"port": "/dev/ttyX"}, "arm": {"file": "dd-arm-vertical"}})
    assert setup.config.device.port == "/dev/ttyX"
    assert setup.config.device.baud == 12_000_000
    assert setup.arm.name == "dd-arm-vertical"


def test_without_a_file_the_flags_that_are_missing_are_named() -> None:
    with pytest.raises(ConfigError) as caught:
        load_setup(None, {})
    assert len(caught.value.mistakes) == 2
    assert "--port" in caught.value.mistakes[0]
    assert "--arm" in caught.value.mistakes[1]


def test_all_mistakes_are_named_with_where(tmp_path: Path) -> None:
    text = """
        [device]
        port = "/dev/ttyX"
        baud = "fast"
        [arm]
        file = "no-such-arm"
        [tracking]
        initial_q_rad = [0.0, nan]
        metod = "integrate"
        [publish]
        endpoint = "127.0.0.1:5770"
    """
    mistakes = mistakes_in(tmp_path, text)
    assert len(mistakes) == 5
    for field, found in (
        ("device.baud", "'fast'"),
        ("tracking.initial_q_rad[1]", "nan"),
        ("tracking.metod", "not a known field"),
        ("publish.endpoint", "'127.0.0.1:5770'"),
        ("no-such-arm", "expected an arm file or one of dd-arm"),
    ):
        (sentence,) = (mistake for mistake in mistakes if field in mistake)
        assert found in sentence
    assert all("limbd.toml" in mistake for mistake in mistakes[:4])


def test_mistakes_in_the_arm_file_are_named_too(tmp_path: Path) -> None:
    arm = tmp_path / "arm.toml"
    arm.write_text('schema = 1\nname = "x"\n[[joint]]\na_m = "long"\ncolour = "red"\n')
    text = f'[device]\nport = "/dev/ttyX"\nbaud = 0\n[arm]\nfile = "{arm}"\n'
    mistakes = mistakes_in(tmp_path, text)
    for named in ("limbd.toml: device.baud is 0", "arm.toml: joint[0].a_m is 'long'", "arm.toml: joint[0].colour"):
        assert any(named in mistake for mistake in mistakes)


def test_angles_must_be_as_many_as_joints(tmp_path: Path) -> None:
    text = '[device]\nport = "/dev/ttyX"\n[arm]\nfile = "dd-arm"\n[tracking]\ninitial_q_rad = [0.1]\n'
    (mistake,) = mistakes_in(tmp_path, text)
    assert mistake.endswith("tracking.initial_q_rad has 1 numbers, expected one a joint of 'dd-arm' (2)")


TRACKED = '[device]\nport = "/dev/ttyX"\n[arm]\nfile = "dd-arm"\n[tracking]\n'


@pytest.mark.parametrize("method", ["", 'method = "filter"\n'])
def test_the_filter_has_no_zero(tmp_path: Path, method: str) -> None:
    (mistake,) = mistakes_in(tmp_path, f'{TRACKED}{method}zero = "each-rest"\n')
    assert mistake.endswith("tracking.zero is 'each-rest', expected it only with tracking.method = 'integrate'")


def test_the_integrator_has_a_zero(tmp_path: Path) -> None:
    path = tmp_path / "limbd.toml"
    path.write_text(TRACKED + 'zero = "first-rest"\n')
    assert load_setup(path, {"tracking": {"method": "integrate"}}).config.tracking.zero == "first-rest"
    (mistake,) = mistakes_in(tmp_path, TRACKED + 'method = "integrate"\nzero = "never"\n')
    assert "tracking.zero is 'never'; input should be 'each-rest' or 'first-rest'" in mistake


def test_an_unknown_method_is_one_mistake(tmp_path: Path) -> None:
    (mistake,) = mistakes_in(tmp_path, TRACKED + 'method = "magic"\nzero = "each-rest"\n')
    assert "tracking.method is 'magic'; input should be 'filter' or 'integrate'" in mistake


def test_an_arm_without_sensors_cannot_be_tracked(tmp_path: Path) -> None:
    arm = tmp_path / "arm.toml"
    arm.write_text('schema = 1\nname = "x"\n[[joint]]\na_m = 0.3\n')
    (mistake,) = mistakes_in(tmp_path, f'[device]\nport = "/dev/ttyX"\n[arm]\nfile = "{arm}"\n')
    assert "has no [[sensor]]" in mistake


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[device\n", "not TOML"),
        ('device = "tty"\n', "device is 'tty'"),
        ('[device]\nport = ""\n', "device.port is ''"),
    ],
)
def test_broken_files(tmp_path: Path, text: str, said: str) -> None:
    assert any(said in mistake for mistake in mistakes_in(tmp_path, text))


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="nowhere.toml: No such file"):
        load_setup(tmp_path / "nowhere.toml", {})


def test_the_attached_config_gives_the_same_again(tmp_path: Path) -> None:
    flags = {"device": {"port": 'C:\\odd "name" ü'}, "tracking": {"initial_q_rad": [0.1, -1e-9]}}
    setup = load_setup(EXAMPLE, flags)
    again = tmp_path / "again.toml"
    again.write_text(format_config(setup.config), encoding="utf-8")
    assert load_setup(again, {}).config == setup.config


def test_an_endpoint_that_others_can_reach_needs_keys(tmp_path: Path) -> None:
    flags = {"device": {"port": "/dev/x"}, "arm": {"file": "dd-arm"}, "publish": {"endpoint": "tcp://*:5770"}}
    with pytest.raises(ConfigError, match="other machines can reach; .*in publish.keys"):
        load_setup(None, flags)
    flags["publish"]["keys"] = str(tmp_path)
    assert load_setup(None, flags).config.publish.keys == str(tmp_path)


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
        ({"arm": {"file": 5}}, "arm.file is 5"),
        ({"tracking": {"initial_q_rad": []}}, "initial_q_rad has 0 numbers, expected one a joint of 'dd-arm' (2)"),
        ({"tracking": {"frame_rate_hz": 1e-300}}, "tracking.frame_rate_hz is 1e-300"),
        ({"record": {"directory": "x", "file_mb": 0.9}}, "record.file_mb is 0.9"),
        (
            {"metrics": {"address": "127.0.0.1:99999"}},
            "metrics.address is '127.0.0.1:99999'; expected 127.0.0.1:PORT, localhost:PORT or [::1]:PORT, "
            "with a port up to 65535",
        ),
    ],
)
def test_a_value_that_will_not_do_is_said_with_its_field(tables: dict, said: str) -> None:
    (mistake,) = mistakes({**FLAGS, **tables})
    assert said in mistake


def test_an_attached_config_says_every_value() -> None:
    text = format_config(load_setup(None, {**FLAGS, "publish": {"raw": True}}).config)
    assert text.startswith(
        '[device]\nport = "/dev/ttyX"\nbaud = 12000000\nreal_time = true\n\n[arm]\nfile = "dd-arm"\n'
    )
    assert "raw = true" in text and "[record]" not in text and "zero" not in text


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
