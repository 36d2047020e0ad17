"""What each field of the config is unless it is said, and where its values end."""

from typing import Any

import pytest
from pydantic import ValidationError

from daemon.config.config_schema import Config, MetricsTable

LEAST = {"device": {"port": "/dev/ttyX"}, "arm": {"file": "dd-arm"}}


def config(table: str, **fields: Any) -> Config:
    before: dict[str, Any] = {**LEAST, "record": {"directory": "r"}}
    return Config.model_validate({**before, table: {**before.get(table, {}), **fields}})


def test_what_is_not_said_has_a_value() -> None:
    found = config("record").model_dump()
    assert found == {
        "device": {"port": "/dev/ttyX", "baud": 12_000_000, "real_time": True},
        "arm": {"file": "dd-arm"},
        "tracking": {"method": "filter", "initial_q_rad": None, "frame_rate_hz": 1000.0, "zero": None},
        "publish": {"endpoint": "tcp://127.0.0.1:5770", "raw": False, "keys": None},
        "record": {"directory": "r", "file_mb": 2000.0, "file_minutes": 60.0, "free_mb": 100.0},
        "trials": {"learning": 5},
        "metrics": None,
    }
    assert Config.model_validate(LEAST).record is None


def test_a_file_may_grow_without_end() -> None:
    record = config("record", file_mb=1e305, free_mb=1e305).record
    assert record is not None and record.file_bytes == record.free_bytes == float("inf")


@pytest.mark.parametrize(
    ("table", "field", "right", "wrong"),
    [
        ("device", "port", "x", ""),
        ("device", "baud", 1, 0),
        ("arm", "file", "x", ""),
        ("tracking", "frame_rate_hz", 0.1, 0.0),
        ("tracking", "frame_rate_hz", 1e9, float("inf")),
        ("tracking", "initial_q_rad", [0.0, -1.5], [float("nan")]),
        ("publish", "keys", "k", ""),
        ("record", "directory", "r", ""),
        ("record", "file_mb", 1.0, 0.999),
        ("record", "file_minutes", 0.001, 0.0),
        ("record", "free_mb", 0.0, -0.001),
        ("trials", "learning", 0, -1),
        ("trials", "learning", 1, 1.5),
        ("device", "real_time", False, 1),
        ("publish", "raw", True, "yes"),
        ("device", "port", "x", 3),
    ],
)
def test_values_end_where_they_make_no_sense(table: str, field: str, right: object, wrong: object) -> None:
    found = getattr(getattr(config(table, **{field: right}), table), field)
    assert found == (tuple(right) if isinstance(right, list) else right)
    with pytest.raises(ValidationError):
        config(table, **{field: wrong})


@pytest.mark.parametrize(
    ("address", "local"),
    [("127.0.0.1:0", True), ("localhost:65535", True), ("[::1]:9464", True), ("127.1.2.3:1", True)]
    + [("0.0.0.0:1", False), ("127.0.0.1:", False), ("127.0.0.1:123456", False), ("example.org:1", False)]
    + [("127.0.0.1:65536", False), ("127.0.0.1:99999", False), ("127.0.0.256:1", False), ("127.0.0.1", False)]
    + [("127.0.0.1:-1", False), ("127.0.0.1:٣", False), (":1", False), ("::1:1", False)],
)
def test_metrics_are_for_this_machine_only(address: str, local: bool) -> None:
    if local:
        assert MetricsTable(address=address).address == address
    else:
        with pytest.raises(ValidationError):
            MetricsTable(address=address)
