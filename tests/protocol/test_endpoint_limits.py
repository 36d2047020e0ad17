"""The longest names, paths and ports that an endpoint may have, and the first beyond."""

import ipaddress

import pytest

from limbcal.errors import ConfigError
from protocol.endpoint import is_loopback, parse_endpoint, parse_host


@pytest.mark.parametrize(
    ("port", "fits"),
    [
        ("0", True),
        ("65535", True),
        ("65536", False),
        ("99999", False),
        ("100000", False),
        ("*", True),
        ("", False),
        ("-1", False),
    ],
)
def test_a_port_is_of_16_bits(port: str, fits: bool) -> None:
    text = f"tcp://127.0.0.1:{port}"
    if fits:
        assert parse_endpoint(text).text == text
        return
    with pytest.raises(ConfigError, match="endpoint is"):
        parse_endpoint(text)


@pytest.mark.parametrize(("length", "fits"), [(1, True), (107, True), (108, False), (0, False)])
def test_a_path_has_107_bytes_at_most(length: int, fits: bool) -> None:
    path = "/" + "x" * (length - 1) if length else ""
    if fits:
        found = parse_endpoint(f"ipc://{path}")
        assert (str(found.path), found.host, found.is_local, found.is_ipv6) == (path, None, True, False)
        return
    with pytest.raises(ConfigError, match="of at most 107 bytes"):
        parse_endpoint(f"ipc://{path}")


@pytest.mark.parametrize("path", ["@x", "*", "a\nb", "ä" * 54])
def test_a_path_is_that_of_a_file_and_can_be_printed(path: str) -> None:
    with pytest.raises(ConfigError, match="expected the path of a socket"):
        parse_endpoint(f"ipc://{path}")
    assert str(parse_endpoint("ipc://" + "ä" * 53).path) == "ä" * 53


@pytest.mark.parametrize(("length", "fits"), [(1, True), (64, True), (65, False), (0, False)])
def test_a_name_within_the_process_has_64_characters_at_most(length: int, fits: bool) -> None:
    text = "inproc://" + "x" * length
    if fits:
        found = parse_endpoint(text)
        assert found.is_local and not found.is_ipv6 and found.host is None and found.path is None
        return
    with pytest.raises(ConfigError, match="endpoint is"):
        parse_endpoint(text)


LABEL = "a" * 63


@pytest.mark.parametrize(
    ("name", "known"),
    [
        (LABEL, True),
        ("a" * 64, False),
        (f"{LABEL}.{LABEL}.{LABEL}.{'a' * 61}", True),  # 253 characters
        (f"{LABEL}.{LABEL}.{LABEL}.{'a' * 62}", False),
        ("a-b.c", True),
        ("-a", False),
        ("127.1", False),
        ("127", False),
        ("a1", True),
    ],
)
def test_a_name_is_that_of_a_host(name: str, known: bool) -> None:
    found = parse_host(name)
    assert (found is not None) == known
    if found is not None:
        assert (found.text, found.address, found.is_local, found.in_brackets) == (name, None, False, name)


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


@pytest.mark.parametrize("text", ["127.0.0.1%eth0", "::1%", f"::1%{'e' * 16}", "::1%a b"])
def test_a_zone_is_a_short_name_of_an_address_of_ipv6(text: str) -> None:
    assert parse_host(text) is None
    assert parse_host(f"::1%{'e' * 15}") is not None


@pytest.mark.parametrize("text", ["tcp://::1:5", "tcp://[127.0.0.1]:5", "tcp://[a]:5", "tcp://:5", "tcp://a b:5"])
def test_only_an_address_of_ipv6_is_in_brackets(text: str) -> None:
    with pytest.raises(ConfigError, match="endpoint is"):
        parse_endpoint(text)


def test_localhost_is_an_address_and_a_star_is_everybody() -> None:
    found = parse_endpoint("tcp://localhost:7")
    assert (found.text, found.is_local) == ("tcp://127.0.0.1:7", True)
    star = parse_host("*")
    assert star is not None and (star.text, star.address, star.is_local) == ("*", None, False)
