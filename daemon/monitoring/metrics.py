"""The health of a run as Prometheus reads it: on this machine, and only where the config asks for it."""

from collections.abc import Iterator, Mapping
from types import TracebackType
from typing import Any

from prometheus_client import CollectorRegistry, start_http_server
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from limbcal.errors import DeviceError

#: Counters of `limb/health`: field, name without ``limbcal_``, what it is.
_COUNTERS = (
    ("samples", "samples", "samples received"),
    ("lost_samples", "samples_lost", "samples that the device sent and that never came"),
    ("crc_errors", "checksum_errors", "serial frames with a wrong checksum"),
    ("resyncs", "resyncs", "how often the start of a serial frame had to be searched for"),
    ("reconnects", "reconnects", "how often the device came back"),
    ("recording_lost", "messages_not_recorded", "messages that could not be recorded"),
)
#: Its gauges; what is unknown is left out.
_GAUGES = (
    ("uptime_s", "uptime_seconds", "since tracking began"),
    ("connected", "connected", "1 where there is a device"),
    ("rate_hz", "rate_hertz", "samples a second as measured"),
    ("clock_ppm", "clock_fast_ppm", "by how much the device's clock is fast"),
    ("disk_free_bytes", "disk_free_bytes", "room where is recorded"),
)


class Metrics(Collector):
    """Serves the last health that it was given.

    Parameters
    ----------
    address : str or None
        ``host:port``, a free port with 0; None serves nothing.

    Attributes
    ----------
    port : int or None
        Where it listens.

    Raises
    ------
    DeviceError
        If the address is taken or cannot be listened on.
    """

    def __init__(self, address: str | None) -> None:
        self.port: int | None = None
        self._health: Mapping[str, Any] | None = None
        self._server = self._thread = None
        if address is None:
            return
        registry = CollectorRegistry()
        registry.register(self)
        host, _, port = address.rpartition(":")
        try:
            self._server, self._thread = start_http_server(int(port), host.strip("[]"), registry)
        except OSError as error:
            raise DeviceError(f"metrics.address {address} cannot be listened on: {error.strerror}") from error
        self.port = self._server.server_port

    def tell(self, health: Mapping[str, Any]) -> None:
        """Take the newest health."""
        self._health = health

    def collect(self) -> Iterator[Metric]:
        """Yield what Prometheus scrapes."""
        health = self._health
        if health is None:
            return
        for field, name, what in _COUNTERS:
            yield CounterMetricFamily(f"limbcal_{name}", what, health[field])
        for field, name, what in _GAUGES:
            if health[field] is not None:
                yield GaugeMetricFamily(f"limbcal_{name}", what, float(health[field]))
        yield GaugeMetricFamily("limbcal_recording", "1 while recording", float(health["recording"] is not None))
        latency = GaugeMetricFamily(
            "limbcal_latency_seconds", "from the last byte of a block to its frame", labels=["quantile"]
        )
        for name, quantile in (("p50", "0.5"), ("p99", "0.99")):
            if health["latency_ms"][name] is not None:
                latency.add_metric([quantile], 1e-3 * health["latency_ms"][name])
        yield latency
        gaps = CounterMetricFamily("limbcal_gaps", "gaps by cause", labels=["why"])
        for why, count in health["gaps"]["causes"].items():
            gaps.add_metric([why], count)
        yield gaps
        alarms = GaugeMetricFamily("limbcal_alarm", "1 for each alarm that is raised", labels=["name", "subject"])
        for alarm in health["alarms"]:
            alarms.add_metric([alarm["name"], alarm["subject"]], 1.0)
        yield alarms

    def __enter__(self) -> "Metrics":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._server is not None and self._thread is not None:
            self._server.shutdown()
            self._server.server_close()
            self._thread.join()
