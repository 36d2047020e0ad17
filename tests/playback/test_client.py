"""One request and its reply, or a sentence in time."""

import threading
from pathlib import Path

import pytest
import zmq

from limbcal.errors import ConfigError, DeviceError, ProtocolError
from playback.client import ask
from playback.control_message import Request, decode_request, encode_reply
from playback.control_socket import ControlSocket
from protocol.curve import gate_of, load_client_key, new_client
from tests.patience import PATIENCE_MS
from tests.playback.served import served

ENDPOINT = "inproc://control"


@pytest.mark.parametrize("reply", [encode_reply({"playing": True}), b"nonsense"], ids=["good", "bad"])
def test_a_reply_is_what_was_answered(reply: bytes) -> None:
    with zmq.Context() as context, context.socket(zmq.REP) as server:
        server.set(zmq.LINGER, 0)
        server.bind(ENDPOINT)
        asked: list[Request] = []

        def answer() -> None:
            asked.append(decode_request(server.recv_multipart()))
            server.send(reply)

        thread = threading.Thread(target=answer)
        thread.start()
        try:
            if reply == b"nonsense":
                with pytest.raises(ProtocolError):
                    ask(context, ENDPOINT, Request("seek", 1.5), PATIENCE_MS)
            else:
                found = ask(context, ENDPOINT, Request("seek", 1.5), PATIENCE_MS)
                assert (found["ok"], found["state"]) == (True, {"playing": True})
        finally:
            thread.join()
        assert asked == [Request("seek", 1.5)]


def test_nobody_is_waited_for_longer_than_was_said() -> None:
    with zmq.Context() as context:
        with pytest.raises(DeviceError, match=f"^control endpoint {ENDPOINT}: no answer within 0.005 s, expected"):
            ask(context, ENDPOINT, Request("play", None), 5)
        with pytest.raises(ConfigError):
            ask(context, "nowhere", Request("play", None), 5)


def test_who_has_a_key_is_let_in_and_nobody_else(tmp_path: Path) -> None:
    file = new_client(tmp_path / "keys", "desk", tmp_path / "desk.limbkey")
    with zmq.Context() as context, gate_of(context, tmp_path / "keys") as gate:
        socket = ControlSocket(context, "tcp://127.0.0.1:*", lambda _: encode_reply({}), gate)
        with served(socket):
            with pytest.raises(DeviceError, match="expected a `limbplay serve` there, and --key"):
                ask(context, socket.endpoint, Request("state"), 50)
            assert ask(context, socket.endpoint, Request("state"), PATIENCE_MS, load_client_key(file))["ok"]
