"""The page's web server: on the port that was asked for or not at all, and quiet."""

import http.client
import socket
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from limbcal.errors import DeviceError
from playback.view.server import on_loop, web_server
from playback.view.visitors import Visitors
from tests.free_port import free_port
from tests.patience import PATIENCE_S


def test_it_serves_where_it_was_asked_to_and_says_nothing_of_it(capfd: pytest.CaptureFixture[str]) -> None:
    port = free_port()
    with web_server(Visitors("127.0.0.1"), port, "my page") as server:
        assert server.get_port() == port
        page = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
        page.request("GET", "/")
        answer = page.getresponse()
        assert answer.status == 200
        answer.read()
        page.close()
        assert server.request_share_url() is None  # nobody else is to have its address
    assert capfd.readouterr() == ("", "")
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", port), 30.0)


def test_another_port_is_not_taken_in_place_of_a_taken_one() -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with pytest.raises(DeviceError, match=f"127.0.0.1:{port} cannot be had: Address already in use"):
            with web_server(Visitors("127.0.0.1"), port, "page"):
                pytest.fail("it is served")


def test_a_port_that_was_just_left_is_free() -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with socket.create_connection(("127.0.0.1", port)) as there:
            here, _ = other.accept()
            here.close()  # whoever closes first keeps the port for a while (TIME_WAIT)
            there.recv(1)
    with web_server(Visitors("127.0.0.1"), port, "page") as server:
        assert server.get_port() == port


def test_a_host_that_is_none_of_this_machine_s_is_said() -> None:
    with pytest.raises(DeviceError, match=r"192\.0\.2\.1:0 cannot be had"):
        with web_server(Visitors("192.0.2.1"), 0, "page"):
            pytest.fail("it is served")


def test_what_changes_the_page_is_done_in_the_thread_that_sends_to_it() -> None:
    with web_server(Visitors("127.0.0.1"), 0, "page") as server:
        with ThreadPoolExecutor(1) as pool:
            there = on_loop(server, threading.get_ident)
            assert there == pool.submit(on_loop, server, threading.get_ident).result()
        assert there != threading.get_ident()
        with pytest.raises(ZeroDivisionError):
            on_loop(server, lambda: 1 / 0)
