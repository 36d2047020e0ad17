"""Who gets the page, and who may speak to it: real requests to the real server."""

import http.client
from collections.abc import Iterator
from urllib.parse import urlsplit

import msgspec
import pytest
import viser
from websockets.exceptions import InvalidStatus
from websockets.frames import CloseCode
from websockets.sync.client import connect

from limbcal.errors import ConfigError
from playback.view.server import web_server
from playback.view.visitors import Visitors
from tests.patience import PATIENCE_S

PROTOCOL = f"viser-v{viser.__version__}"
FOREIGN_ORIGINS = (
    "http://evil.example",
    "http://127.0.0.1",
    "http://127.0.0.1:1",
    "https://127.0.0.1:{port}",
    "http://localhost:{port}",
    "http://127.0.0.1:{port}.evil.example",
    "http://127.0.0.1:{port}/",
    "null",
    "",
)
FOREIGN_HOSTS = (
    "evil.example:{port}",
    "evil.example",
    "127.0.0.1.evil.example:{port}",
    "localhost.evil.example:{port}",
    "127.1:{port}",
    "2130706433:{port}",
    "192.0.2.1:{port}",
    "0.0.0.0:{port}",
    "*:{port}",
    "127.0.0.1:{port}@evil.example",
    "127.0.0.1:",
    "[127.0.0.1]:{port}",
    "",
)
#: What a page says as its view is turned.
CAMERA = msgspec.msgpack.encode(
    {"type": "ViewerCameraMessage", "wxyz": (1.0, 0.0, 0.0, 0.0), "fov": 1.0, "near": 0.1, "far": 10.0}
    | {"image_height": 300, "image_width": 400}
    | dict.fromkeys(("position", "look_at", "up_direction"), (0.0, 0.0, 1.0))
)
OWN_HOSTS = ("127.0.0.1:{port}", "localhost:{port}", "[::1]:{port}", "127.0.0.1:9000", "localhost")


@pytest.fixture(scope="module")
def port() -> Iterator[int]:
    """Return the port of a page for this machine."""
    with web_server(Visitors("127.0.0.1"), 0, "test") as server:
        yield server.get_port()


@pytest.fixture(scope="module")
def open_page() -> Iterator[tuple[int, Visitors]]:
    """Return a page for other machines too."""
    visitors = Visitors("0.0.0.0")
    with web_server(visitors, 0, "test") as server:
        yield server.get_port(), visitors


def get(port: int, path: str = "/", **headers: str) -> http.client.HTTPResponse:
    line = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
    try:
        line.putrequest("GET", path, skip_host=True)
        for name, value in {"Host": f"127.0.0.1:{port}", **headers}.items():
            line.putheader(name, value)
        line.endheaders()
        response = line.getresponse()
        response.text = response.read().decode(errors="replace")  # type: ignore[attr-defined]
        return response
    finally:
        line.close()


def speak(port: int, path: str = "/", **headers: str) -> int:
    """Return the status that a websocket was opened or refused with."""
    host, origin = headers.pop("Host", None), headers.pop("Origin", None)
    given = dict(headers)
    if host is not None:
        given["Host"] = host
    if origin is not None:
        given["Origin"] = origin
    try:
        with connect(
            f"ws://127.0.0.1:{port}{path}", subprotocols=[PROTOCOL], additional_headers=given, max_size=None
        ) as line:
            line.recv(30.0)
            return 101
    except InvalidStatus as error:
        return error.response.status_code


def test_the_page_is_for_pages_of_its_own(port: int) -> None:
    assert get(port).status == 200
    assert get(port, Origin=f"http://127.0.0.1:{port}").status == 200
    assert speak(port, Origin=f"http://127.0.0.1:{port}") == 101
    assert speak(port) == 101  # no browser, but a program on this machine


@pytest.mark.parametrize(
    ("message", "code"),
    [(CAMERA, CloseCode.NORMAL_CLOSURE), (bytes((1 << 20) + 1), CloseCode.MESSAGE_TOO_BIG)],
)
def test_a_message_from_a_page_has_a_mebibyte_at_the_most(port: int, message: bytes, code: CloseCode) -> None:
    line = connect(f"ws://127.0.0.1:{port}/", subprotocols=[PROTOCOL], max_size=None)
    line.recv(PATIENCE_S)
    line.send(message)
    line.close()
    assert line.close_code == code


@pytest.mark.parametrize("origin", FOREIGN_ORIGINS)
def test_a_foreign_page_is_not_spoken_to(port: int, origin: str) -> None:
    origin = origin.format(port=port)
    response = get(port, Origin=origin)
    assert response.status == 403
    assert "Origin is " in response.text
    assert speak(port, Origin=origin) == 403


@pytest.mark.parametrize("host", FOREIGN_HOSTS)
def test_a_name_that_was_made_to_lead_here_is_none_of_ours(port: int, host: str) -> None:
    host = host.format(port=port)
    response = get(port, Host=host, Origin=f"http://{host}")
    assert response.status == 403
    assert "Host is " in response.text


@pytest.mark.parametrize("host", OWN_HOSTS)
def test_names_of_this_machine_are_ours_also_through_a_tunnel(port: int, host: str) -> None:
    host = host.format(port=port)
    assert get(port, Host=host, Origin=f"http://{host}").status == 200


def test_a_header_that_is_there_twice_is_refused(port: int) -> None:
    line = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
    try:
        line.putrequest("GET", "/", skip_host=True)
        for host in (f"127.0.0.1:{port}", "evil.example"):
            line.putheader("Host", host)
        line.endheaders()
        assert line.getresponse().status == 403
    finally:
        line.close()


def test_the_page_is_in_no_other_page(port: int) -> None:
    response = get(port)
    assert response.headers["X-Frame-Options"] == "DENY"
    assert response.headers["Content-Security-Policy"] == "frame-ancestors 'none'"


def test_other_machines_need_the_token(open_page: tuple[int, Visitors]) -> None:
    port, visitors = open_page
    assert visitors.token is not None
    wrong = visitors.token[:-1] + ("A" if visitors.token[-1] != "A" else "B")
    for path in ("/", "/?token=", f"/?token={wrong}", "/?token=%00", "/assets/../index.html"):
        assert get(port, path).status == 403
        assert speak(port, path) == 403
    for cookie in (f"limbplay-{port}={wrong}", f"limbplay-1={visitors.token}", f"token={visitors.token}"):
        assert get(port, Cookie=cookie).status == 403
    whole = urlsplit(visitors.url(port))
    first = get(port, f"{whole.path}?{whole.query}")
    assert first.status == 200
    cookie = first.headers["Set-Cookie"]
    assert cookie.endswith("; Path=/; HttpOnly; SameSite=Strict")
    kept = cookie.partition(";")[0]
    assert get(port, Cookie=kept).status == 200
    assert get(port, Cookie=f"a=b; {kept}; c", Host="lab-pc.local:80").status == 200
    assert speak(port, Cookie=kept, Origin=f"http://127.0.0.1:{port}") == 101
    assert speak(port, Cookie=kept, Origin="http://evil.example") == 403


@pytest.mark.parametrize(
    ("host", "local"),
    [("127.0.0.1", True), ("localhost", True), ("::1", True), ("[::1]", True), ("127.8.0.1", True)]
    + [("0.0.0.0", False), ("::", False), ("192.0.2.1", False), ("lab-pc.local", False)],
)
def test_what_only_this_machine_reaches_needs_no_token(host: str, local: bool) -> None:
    assert (Visitors(host).token is None) is local


@pytest.mark.parametrize("host", ["", "*", "127.0.0.1\x00", "0.0.0.0\x00127.0.0.1", "a b", "127.1", "[::1", "a:1"])
def test_what_is_no_host_is_said(host: str) -> None:
    with pytest.raises(ConfigError, match="--host is "):
        Visitors(host)
