"""Whom an address lets in, and that IPv6 is as good as IPv4."""

import ipaddress
import os
import socket
import stat
from pathlib import Path

import pytest
import zmq

from limbcal.errors import ConfigError, DeviceError
from protocol.binding import bind, connect
from protocol.endpoint import is_loopback, parse_endpoint, parse_host
from protocol.message import TRIAL
from protocol.publisher import Publisher
from protocol.subscriber import Subscriber
from tests.patience import PATIENCE_MS


@pytest.mark.parametrize(
    ("endpoint", "local"),
    [
        ("tcp://127.0.0.1:5770", True),
        ("tcp://127.0.0.1:*", True),
        ("tcp://127.8.9.1:5770", True),
        ("tcp://localhost:5770", True),
        ("tcp://[::1]:5770", True),
        ("tcp://[0:0:0:0:0:0:0:1]:5770", True),
        ("tcp://[::ffff:127.0.0.1]:5770", True),
        ("ipc:///run/limb", True),
        ("tcp://[::]:5770", False),
        ("tcp://[fe80::1]:5770", False),
        ("tcp://[2001:db8::1]:5770", False),
        ("tcp://*:5770", False),
        ("tcp://0.0.0.0:5770", False),
        ("tcp://192.168.0.3:5770", False),
        ("tcp://127.0.0.1.example.org:5770", False),
        ("tcp://eth0:5770", False),
    ],
)
def test_which_endpoints_others_can_reach(endpoint: str, local: bool) -> None:
    assert parse_endpoint(endpoint).is_local is local


def has_ipv6() -> bool:
    try:
        with socket.socket(socket.AF_INET6) as probe:
            probe.bind(("::1", 0))
    except OSError:
        return False
    return True


@pytest.mark.skipif(not has_ipv6(), reason="this machine has no IPv6")
def test_a_message_goes_over_ipv6() -> None:
    with zmq.Context() as context, Publisher(context, "tcp://[::1]:*", "arm", "run") as sender:
        assert sender.endpoint.startswith("tcp://[::1]:")
        with Subscriber(context, sender.endpoint, [TRIAL]) as hearer:
            assert sender.socket.poll(PATIENCE_MS)
            assert sender.joined()
            sender.publish(TRIAL, {"trial": 3, "t_ns": 1, "state": "begin", "role": "learn"})
            message = hearer.receive(PATIENCE_MS)
            assert message is not None and message[1]["trial"] == 3


def test_all_of_ipv6_needs_keys_as_all_of_ipv4_does() -> None:
    with zmq.Context() as context, context.socket(zmq.PUB) as bound:
        for endpoint in ("tcp://[::]:5770", "tcp://0.0.0.0:5770", "tcp://*:5770"):
            with pytest.raises(ConfigError, match="which other machines can reach"):
                bind(bound, endpoint)


@pytest.mark.parametrize(
    "endpoint",
    [
        "tcp://127.0.0.1\x00.example.org:5770",
        "tcp://0.0.0.0\x00127.0.0.1:5770",
        "tcp://127.0.0.1:5770\x00",
        "tcp://127.0.0.1:5770\n",
        "tcp://127.0.0.1:5770;0.0.0.0:5771",
        "tcp://0.0.0.0:0;127.0.0.1:5770",
        "tcp://user@127.0.0.1:5770",
        "tcp://127.1:5770",
        "tcp://127.0.0.1.:5770",
        "tcp://2130706433:5770",
        "tcp://\u0661\u0662\u0667.0.0.1:5770",
        "tcp://127.0.0.1:\u0665",
        "tcp://127.0.0.1:65536",
        "tcp://127.0.0.1:-1",
        "tcp://127.0.0.1:",
        "tcp://127.0.0.1",
        "tcp://:5770",
        "tcp://::1:5770",
        "tcp://[127.0.0.1]:5770",
        "tcp://[::1",
        "tcp://[::1%a b]:5770",
        "tcp://[[::1]]:5770",
        "TCP://127.0.0.1:5770",
        " tcp://127.0.0.1:5770",
        "tipc://{5560,0,0}",
        "ws://0.0.0.0:5770",
        "udp://127.0.0.1:5770",
        "vmci://*:5770",
        "ipc://",
        "ipc://@limb",
        "ipc://*",
        "ipc:///run/li\x00mb",
        "ipc:///run/" + "x" * 120,
        "inproc://",
        "5770",
        "",
    ],
)
def test_what_has_another_form_is_refused_by_all(endpoint: str) -> None:
    with zmq.Context() as context, context.socket(zmq.PUB) as socket:
        for use in (bind, connect):
            with pytest.raises(ConfigError, match="endpoint is "):
                use(socket, endpoint)
        assert socket.get_string(zmq.LAST_ENDPOINT) == ""


@pytest.mark.parametrize("endpoint", ["tcp://*:5770", "tcp://127.0.0.1:*", "tcp://127.0.0.1:0"])
def test_nobody_in_particular_is_not_connected_to(endpoint: str) -> None:
    with zmq.Context() as context, context.socket(zmq.SUB) as socket:
        with pytest.raises(ConfigError, match="expected a host and a port"):
            connect(socket, endpoint)


def test_what_is_bound_is_what_was_understood() -> None:
    with zmq.Context() as context, context.socket(zmq.PUB) as socket:
        assert bind(socket, "tcp://localhost:*").startswith("tcp://127.0.0.1:")


@pytest.mark.parametrize("kind", ["file", "empty file", "folder", "pipe", "link", "link to nothing"])
def test_what_is_no_socket_stays_where_it_is(tmp_path: Path, kind: str) -> None:
    place, other = tmp_path / "place", tmp_path / "other"
    other.write_text("kept")
    match kind:
        case "file":
            place.write_text("kept")
        case "empty file":
            place.touch()
        case "folder":
            place.mkdir()
        case "pipe":
            os.mkfifo(place)
        case "link":
            place.symlink_to(other)
        case "link to nothing":
            place.symlink_to(tmp_path / "nothing")
    before = place.lstat()
    with zmq.Context() as context, context.socket(zmq.PUB) as socket:
        with pytest.raises(ConfigError, match="is a file that is no socket; expected a path that is free"):
            bind(socket, f"ipc://{place}")
    assert (place.lstat().st_ino, place.lstat().st_mode) == (before.st_ino, before.st_mode)
    assert other.read_text() == "kept"


@pytest.mark.parametrize("mask", [0o000, 0o002, 0o022, 0o077])
def test_a_socket_in_a_folder_is_its_owners_alone_whatever_the_mask(tmp_path: Path, mask: int) -> None:
    before = os.umask(mask)
    try:
        with zmq.Context() as context, context.socket(zmq.XPUB) as socket:
            bind(socket, f"ipc://{tmp_path}/frames")
            assert stat.S_IMODE((tmp_path / "frames").stat().st_mode) == 0o600
            (tmp_path / "other").touch()
            assert stat.S_IMODE((tmp_path / "other").stat().st_mode) == 0o666 & ~mask
    finally:
        os.umask(before)


def test_the_mask_is_as_it_was_where_nothing_could_be_bound(tmp_path: Path) -> None:
    with zmq.Context() as context, context.socket(zmq.XPUB) as socket:
        with pytest.raises(DeviceError, match="cannot be bound"):
            bind(socket, f"ipc://{tmp_path}/nowhere/frames")
    mask = os.umask(0o022)
    os.umask(mask)
    (tmp_path / "other").touch()
    assert stat.S_IMODE((tmp_path / "other").stat().st_mode) == 0o666 & ~mask


@pytest.mark.parametrize(
    ("endpoint", "understood"),
    [
        ("tcp://127.0.0.1:65535", "tcp://127.0.0.1:65535"),
        ("tcp://127.0.0.1:0", "tcp://127.0.0.1:0"),
        ("tcp://localhost:*", "tcp://127.0.0.1:*"),
        ("tcp://[fe80::1%eth0]:5770", "tcp://[fe80::1%eth0]:5770"),
        (f"tcp://[fe80::1%{'e' * 15}]:1", f"tcp://[fe80::1%{'e' * 15}]:1"),
        (f"tcp://[fe80::1%{'e' * 16}]:1", None),
        ("tcp://127.0.0.1%eth0:1", None),
        (f"tcp://{'a' * 63}:1", f"tcp://{'a' * 63}:1"),
        (f"tcp://{'a' * 64}:1", None),
        (f"tcp://{'.'.join(['a' * 63] * 3 + ['a' * 61])}:1", f"tcp://{'.'.join(['a' * 63] * 3 + ['a' * 61])}:1"),
        (f"tcp://{'.'.join(['a' * 63] * 3 + ['a' * 62])}:1", None),
        (f"inproc://{'n' * 64}", f"inproc://{'n' * 64}"),
        (f"inproc://{'n' * 65}", None),
        (f"ipc:///{'p' * 106}", f"ipc:///{'p' * 106}"),
        (f"ipc:///{'p' * 107}", None),
        (f"ipc://{'ä' * 53}", f"ipc://{'ä' * 53}"),  # 106 bytes
        (f"ipc://{'ä' * 54}", None),
        ("tcp://a-b.c:1", "tcp://a-b.c:1"),
        ("tcp://-a:1", None),
        ("ipc://", None),
        ("ipc://@abstract", None),
        ("ipc://*", None),
    ],
)
def test_how_long_and_high_the_parts_of_an_endpoint_may_be(endpoint: str, understood: str | None) -> None:
    if understood is None:
        with pytest.raises(ConfigError, match="endpoint is"):
            parse_endpoint(endpoint)
    else:
        assert parse_endpoint(endpoint).text == understood


def test_only_addresses_of_ipv6_need_ipv6() -> None:
    assert parse_endpoint("tcp://[::1]:1").is_ipv6 is True
    for other in ("tcp://127.0.0.1:1", "tcp://eth0:1", "tcp://*:1", "ipc:///run/x", "inproc://x"):
        assert parse_endpoint(other).is_ipv6 is False
    assert parse_endpoint("inproc://x").is_local is True
    assert parse_endpoint("ipc:///run/x").path == Path("/run/x") and parse_endpoint("inproc://x").path is None


@pytest.mark.parametrize(
    ("text", "local", "ipv6"),
    [
        ("127.0.0.1", True, False),
        ("127.255.0.9", True, False),
        ("128.0.0.1", False, False),
        ("::1", True, True),
        ("::2", False, True),
        ("::ffff:127.0.0.1", True, True),
        ("::ffff:8.8.8.8", False, True),
        ("fe80::1%eth0", False, True),
        ("0.0.0.0", False, False),
    ],
)
def test_who_can_reach_an_address(text: str, local: bool, ipv6: bool) -> None:
    found = parse_host(text)
    assert found is not None and (found.is_local, found.is_ipv6) == (local, ipv6)
    assert found.in_brackets == (f"[{text}]" if ipv6 else text)
    endpoint = parse_endpoint(f"tcp://{found.in_brackets}:5770")
    assert (endpoint.is_local, endpoint.is_ipv6) == (local, ipv6)
    assert is_loopback(ipaddress.ip_address(text.partition("%")[0])) == local


def test_localhost_is_an_address_and_a_star_is_everybody() -> None:
    found = parse_endpoint("tcp://localhost:7")
    assert (found.text, found.is_local) == ("tcp://127.0.0.1:7", True)
    star = parse_host("*")
    assert star is not None and (star.text, star.address, star.is_local) == ("*", None, False)
