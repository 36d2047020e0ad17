"""A port is opened for one alone, raw, and what is in the way is said."""

import os
import pty
from collections.abc import Iterator
from pathlib import Path

import pytest

from daemon.acquisition.serial_port import open_port
from limbcal.errors import DeviceError


@pytest.fixture
def ends() -> Iterator[tuple[int, str]]:
    """Return the device's end of a pseudo-terminal, and the name of the host's."""
    device, host = pty.openpty()
    yield device, os.ttyname(host)
    os.close(host)
    os.close(device)


def test_every_byte_comes_through_as_it_is(ends: tuple[int, str]) -> None:
    device, name = ends
    every = bytes(range(256))
    with open_port(name, 115_200) as port:
        assert port.read(1) == b""  # it does not wait
        os.write(device, every)
        assert b"".join(iter(lambda: port.read(64), b"")) == every
        port.write(every)
        assert os.read(device, 1024) == every


def test_a_port_belongs_to_one(ends: tuple[int, str]) -> None:
    with open_port(ends[1], 115_200), pytest.raises(DeviceError, match="already taken by another process"):
        open_port(ends[1], 115_200)
    open_port(ends[1], 115_200).close()  # and is free afterwards


def test_what_is_in_the_way_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no tty")
    for place, said in (
        (tmp_path / "none", "does not exist"),
        (tmp_path / "file", "is not a serial port"),
        (tmp_path, "is not a serial port"),
    ):
        with pytest.raises(DeviceError, match=said):
            open_port(str(place), 115_200)
