"""The link to the port comes and goes, and never takes anything of somebody else's place."""

import os
from pathlib import Path

import pytest

from daemon.virtual_device.virtual_port import VirtualPort
from limbcal.errors import ConfigError


def test_bytes_cross_unchanged_both_ways(tmp_path: Path) -> None:
    every = bytes(range(256))
    with VirtualPort(tmp_path / "link") as port:
        host = os.open(tmp_path / "link", os.O_RDWR | os.O_NOCTTY)
        assert port.read() == b""
        assert port.write(every) == 256
        assert os.read(host, 1000) == every
        os.write(host, every)
        assert port.read() == every
        os.close(host)
        assert port.read() == b""
        while port.write(every * 16):  # nobody reads: at some time there is no room left
            pass
    assert not (tmp_path / "link").is_symlink()


def test_a_link_that_leads_nowhere_is_replaced(tmp_path: Path) -> None:
    link = tmp_path / "link"
    link.symlink_to("/dev/pts/999999")
    with VirtualPort(link) as port:
        assert os.readlink(link) == port.path


def test_a_link_that_another_took_is_left(tmp_path: Path) -> None:
    link = tmp_path / "link"
    with VirtualPort(link):
        link.unlink()
        link.symlink_to("/dev/null")
    assert link.is_symlink()


@pytest.mark.parametrize(("path", "said"), [("taken", "exists already"), ("no/where", "No such file")])
def test_a_link_that_cannot_be_made(tmp_path: Path, path: str, said: str) -> None:
    (tmp_path / "taken").write_text("")
    with pytest.raises(ConfigError, match=f"--link {tmp_path / path}.*{said}"):
        VirtualPort(tmp_path / path)
