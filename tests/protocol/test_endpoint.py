"""Whom an address lets in, and that IPv6 is as good as IPv4."""

import socket

import pytest
import zmq

from limbcal.errors import ConfigError
from protocol.binding import bind
from protocol.endpoint import is_local
from protocol.message import TRIAL
from protocol.publisher import Publisher
from protocol.subscriber import Subscriber

PATIENCE_MS = 20_000


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
        ("tcp://[::1", False),
        ("tcp://*:5770", False),
        ("tcp://0.0.0.0:5770", False),
        ("tcp://192.168.0.3:5770", False),
        ("tcp://127.0.0.1.example.org:5770", False),
        ("tcp://eth0:5770", False),
    ],
)
def test_which_endpoints_others_can_reach(endpoint: str, local: bool) -> None:
    assert is_local(endpoint) is local


def has_ipv6() -> bool:
    try:
        with socket.socket(socket.AF_INET6) as probe:
            probe.bind(("::1", 0))
    except OSError:
        return False
    return True


@pytest.mark.skipif(not has_ipv6(), reason="this machine has no IPv6")
def test_a_message_goes_over_ipv6() -> None:
    with zmq.Context() as context, Publisher(context, "tcp://[::1]:*", "arm", "run", hears_joins=True) as sender:
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
