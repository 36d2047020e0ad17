"""Prometheus reads the daemon's health, from this machine only and only where it was asked for."""

import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from prometheus_client.parser import text_string_to_metric_families

from daemon.config.config import load_setup
from daemon.monitoring.metrics import Metrics
from limbcal.errors import ConfigError, DeviceError
from tests.patience import PATIENCE_S

Limbd = Callable[..., Any]


def scrape(port: int) -> dict[str, float]:
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics", timeout=PATIENCE_S) as answer:
        text = answer.read().decode()
    return {
        sample.name + "".join(f" {value}" for value in sample.labels.values()): sample.value
        for family in text_string_to_metric_families(text)
        for sample in family.samples
    }


def test_gaps_and_alarms_have_labels() -> None:
    health: dict[str, Any] = {
        **dict.fromkeys(("samples", "lost_samples", "crc_errors", "resyncs", "reconnects", "recording_lost"), 3),
        **dict.fromkeys(("rate_hz", "clock_ppm", "disk_free_bytes", "recording")),
        **{"uptime_s": 1.5, "connected": False},
        "latency_ms": {"p50": None, "p99": None},
        "gaps": {"causes": {"unplugged": 2}},
        "alarms": [{"name": "flat", "subject": "s1x"}],
    }
    with Metrics("127.0.0.1:0") as metrics:
        assert metrics.port is not None
        assert scrape(metrics.port) == {}
        metrics.tell(health)
        found = scrape(metrics.port)
        assert found["limbcal_gaps_total unplugged"] == 2.0
        assert found["limbcal_alarm flat s1x"] == 1.0
        assert found["limbcal_connected"] == found["limbcal_recording"] == 0.0
        assert "limbcal_clock_fast_ppm" not in found
        with pytest.raises(DeviceError, match="cannot be listened on: Address already in use"):
            Metrics(f"127.0.0.1:{metrics.port}")


@pytest.mark.parametrize("address", ["0.0.0.0:9100", "lab-pc:9100", "127.0.0.1", "192.168.1.4:9100"])
def test_nobody_else_is_answered(tmp_path: Path, address: str) -> None:
    config = tmp_path / "limbd.toml"
    config.write_text(f'[device]\nport = "x"\n[arm]\nfile = "dd-arm"\n[metrics]\naddress = "{address}"\n')
    with pytest.raises(ConfigError, match="metrics.address"):
        load_setup(config, {})
