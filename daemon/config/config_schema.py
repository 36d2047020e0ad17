"""The tables of `limbd.toml` and their fields."""

import re
from ipaddress import IPv4Address
from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, Strict

from protocol.device_info import RATE_HZ

#: The highest rate that Linux takes of a line: `c_ospeed` of termios2, as pyserial fills it in.
_MOST_BAUD = 2**31 - 1
#: The highest port of TCP (RFC 9293): 16 bits.
_MOST_PORT = 2**16 - 1

Number = Annotated[float, Field(allow_inf_nan=False)]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class DeviceTable(_Table):
    """`[device]`: where the accelerometers' samples come from.

    ``real_time`` asks the kernel to serve the reader and the pipeline before others; where that is not allowed
    they run as they are.
    """

    port: Annotated[str, Field(min_length=1)]
    baud: Annotated[int, Field(gt=0, le=_MOST_BAUD)] = 12_000_000
    real_time: bool = True


class ArmFileTable(_Table):
    """`[arm]`: the arm that the sensors ride on, a file or the name of a built-in one."""

    file: Annotated[str, Field(min_length=1)]


class TrackingTable(_Table):
    """`[tracking]`: how accelerations become joint motion.

    Without ``initial_q_rad`` the filter asks gravity where the arm rests, and the integrator takes zero. ``zero``
    concerns the integrator only, which takes "each-rest" where it is left out. Frames are no rarer than a device's
    samples may be.
    """

    method: Literal["filter", "integrate"] = "filter"
    initial_q_rad: Annotated[tuple[Number, ...], Strict(strict=False)] | None = None
    frame_rate_hz: Annotated[Number, Field(ge=RATE_HZ[0])] = 1000.0
    zero: Literal["each-rest", "first-rest"] | None = None


class PublishTable(_Table):
    """`[publish]`: where subscribers connect, and whether raw accelerations are sent to them.

    ``keys`` is the folder of those that are let in (`limbd keys new`); an endpoint that other machines can reach
    must have it.
    """

    endpoint: str = "tcp://127.0.0.1:5770"
    raw: bool = False
    keys: Annotated[str, Field(min_length=1)] | None = None


class RecordTable(_Table):
    """`[record]`: absent, nothing is recorded.

    A file that has grown to ``file_mb``, or was begun ``file_minutes`` ago, is closed and the next one begun;
    while less than ``free_mb`` is free on the disk nothing is recorded.
    """

    directory: Annotated[str, Field(min_length=1)]
    file_mb: Annotated[Number, Field(ge=1)] = 2000.0
    file_minutes: Annotated[Number, Field(gt=0)] = 60.0
    free_mb: Annotated[Number, Field(ge=0)] = 100.0

    @property
    def file_bytes(self) -> float:
        """How large a file grows."""
        return 1e6 * self.file_mb

    @property
    def file_s(self) -> float:
        """For how long a file is written."""
        return 60.0 * self.file_minutes

    @property
    def free_bytes(self) -> float:
        """What must be free on the disk."""
        return 1e6 * self.free_mb


class TrialsTable(_Table):
    """`[trials]`: the first `learning` motions are for learning, the rest for evaluating."""

    learning: Annotated[int, Field(ge=0)] = 5


def _of_this_machine(address: str) -> str:
    host, _, port = address.rpartition(":")
    if not (_is_loopback(host) and re.fullmatch("[0-9]{1,5}", port) and int(port) <= _MOST_PORT):
        raise ValueError(f"expected 127.0.0.1:PORT, localhost:PORT or [::1]:PORT, with a port up to {_MOST_PORT}")
    return address


def _is_loopback(host: str) -> bool:
    try:
        return host in ("localhost", "[::1]") or IPv4Address(host).is_loopback
    except ValueError:
        return False


class MetricsTable(_Table):
    """`[metrics]`: absent, there is no endpoint for Prometheus. It answers this machine only."""

    address: Annotated[str, AfterValidator(_of_this_machine)]


class Config(_Table):
    """The whole file."""

    device: DeviceTable
    arm: ArmFileTable
    tracking: TrackingTable = TrackingTable()
    publish: PublishTable = PublishTable()
    record: RecordTable | None = None
    trials: TrialsTable = TrialsTable()
    metrics: MetricsTable | None = None
