"""Whom the list names is let in; nobody else hears a word."""

import stat
from collections.abc import Iterator
from pathlib import Path
from unittest.mock import Mock

import pytest
import zmq
import zmq.auth

from limbcal.errors import ConfigError, DeviceError
from protocol.curve import Gate, gate_of, load_client_key, new_client
from protocol.message import TRIAL
from protocol.publisher import Publisher
from protocol.subscriber import Subscriber
from tests.patience import PATIENCE_MS


@pytest.fixture
def context() -> Iterator[zmq.Context]:
    with zmq.Context() as made:
        yield made


def test_only_who_is_listed_hears(tmp_path: Path, context: zmq.Context) -> None:
    keys = tmp_path / "keys"
    friend = load_client_key(new_client(keys, "friend", tmp_path / "friend.limbkey"))
    stranger = load_client_key(new_client(tmp_path / "other", "stranger", tmp_path / "stranger.limbkey"))
    stranger = type(stranger)(stranger.public, stranger.secret, friend.server)
    gate = Gate(context, keys)
    try:
        with Publisher(context, "tcp://127.0.0.1:*", "arm", "run", gate) as publisher:
            subscribers = [
                Subscriber(context, publisher.endpoint, [TRIAL], key) for key in (friend, stranger, None)
            ]
            while subscribers[0].receive(20) is None:
                publisher.publish(TRIAL, {"trial": 1})
            for _ in range(50):
                publisher.publish(TRIAL, {"trial": 2})
                assert subscribers[0].receive(PATIENCE_MS) is not None
            assert [subscriber.receive(100) for subscriber in subscribers[1:]] == [None, None]
            for subscriber in subscribers:
                subscriber.close()
    finally:
        gate.close()


def test_an_endpoint_for_all_needs_a_gate(context: zmq.Context) -> None:
    with pytest.raises(ConfigError, match="which other machines can reach; expected"):
        Publisher(context, "tcp://*:*", "arm", "run")


def test_keys_are_their_owners_alone(tmp_path: Path) -> None:
    keys = tmp_path / "keys"
    first = new_client(keys, "a", tmp_path / "a.limbkey")
    server = (keys / "server.key_secret").read_bytes()
    new_client(keys, "b", tmp_path / "b.limbkey")
    assert (keys / "server.key_secret").read_bytes() == server
    assert sorted(path.name for path in (keys / "clients").iterdir()) == ["a.key", "b.key"]
    assert "secret-key" not in (keys / "clients" / "a.key").read_text()
    for path in (first, keys / "server.key_secret"):
        assert stat.S_IMODE(path.stat().st_mode) & 0o077 == 0


@pytest.mark.parametrize("known", [False, True])
def test_nothing_is_left_of_a_key_that_could_not_be_made(tmp_path: Path, known: bool) -> None:
    keys = tmp_path / "keys"
    if known:
        new_client(keys, "friend", tmp_path / "friend.limbkey")
    before = sorted(path for path in keys.rglob("*") if path.is_file())
    with pytest.raises(DeviceError, match="nowhere/lab.limbkey: No such file or directory"):
        new_client(keys, "lab", tmp_path / "nowhere" / "lab.limbkey")
    assert sorted(path for path in keys.rglob("*") if path.is_file()) == before
    assert not [path for path in keys.iterdir() if path.name.startswith(".")]
    load_client_key(new_client(keys, "lab", tmp_path / "lab.limbkey"))


def test_a_client_that_cannot_be_listed_gets_no_key(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Path, "rename", Mock(side_effect=OSError(28, "No space left on device", "lab.key")))
    with pytest.raises(DeviceError, match="lab.key: No space left on device"):
        new_client(tmp_path / "keys", "lab", tmp_path / "lab.limbkey")
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


def test_a_client_may_be_called_server(tmp_path: Path) -> None:
    key = load_client_key(new_client(tmp_path, "server", tmp_path / "out.limbkey"))
    assert key.public != key.server and key.public.decode() in (tmp_path / "clients" / "server.key").read_text()


def test_mistakes_are_named(tmp_path: Path, context: zmq.Context) -> None:
    new_client(tmp_path, "a", tmp_path / "a.limbkey")
    with pytest.raises(ConfigError, match="a is let in already"):
        new_client(tmp_path, "a", tmp_path / "again.limbkey")
    with pytest.raises(ConfigError, match="name is '../a'"):
        new_client(tmp_path, "../a")
    (tmp_path / "bad").write_text("public = 3")
    with pytest.raises(ConfigError, match="expected public, secret and server"):
        load_client_key(tmp_path / "bad")
    with pytest.raises(ConfigError, match=r"server.key_secret: .*; `limbd keys new NAME` makes it"):
        Gate(context, tmp_path / "nowhere")


BROKEN = {
    "empty": b"",
    "no key": b"nothing of the kind",
    "no value": b"public-key\n",
    "short": b'public-key = "abc"\n',
    "long": b'public-key = "' + b"0" * 41 + b'"\n',
    "not Z85": b'public-key = "' + b"~" * 40 + b'"\n',
    "beyond four bytes": b'public-key = "' + b"#" * 40 + b'"\n',
    "NUL": b"\x00" * 200,
}


@pytest.mark.parametrize("kind", [*BROKEN, "a folder", "a link to nothing"])
def test_one_broken_key_is_said_at_the_start(tmp_path: Path, context: zmq.Context, kind: str) -> None:
    new_client(tmp_path, "friend", tmp_path / "friend.limbkey")
    broken = tmp_path / "clients" / "broken.key"
    match kind:
        case "a folder":
            broken.mkdir()
        case "a link to nothing":
            broken.symlink_to(tmp_path / "nothing")
        case _:
            broken.write_bytes(BROKEN[kind])
    with pytest.raises(ConfigError, match=r"clients/broken\.key: ") as error:
        Gate(context, tmp_path)
    assert len(error.value.mistakes) == 1


def test_every_broken_key_is_named(tmp_path: Path, context: zmq.Context) -> None:
    new_client(tmp_path, "friend", tmp_path / "friend.limbkey")
    for name in ("one", "two"):
        (tmp_path / "clients" / f"{name}.key").write_text("")
    with pytest.raises(ConfigError) as error:
        Gate(context, tmp_path)
    assert [Path(mistake.partition(": ")[0]).stem for mistake in error.value.mistakes] == ["one", "two"]


def test_a_list_of_nobody_is_said(tmp_path: Path, context: zmq.Context) -> None:
    new_client(tmp_path, "friend", tmp_path / "friend.limbkey")
    (tmp_path / "clients" / "friend.key").unlink()
    with pytest.raises(ConfigError, match="nobody is let in; `limbd keys new NAME` lists a client"):
        Gate(context, tmp_path)
    (tmp_path / "clients").rmdir()
    with pytest.raises(ConfigError, match="clients: No such file"):
        Gate(context, tmp_path)


def test_a_service_whose_keys_do_not_belong_together_is_said(tmp_path: Path, context: zmq.Context) -> None:
    for name in ("one", "two"):
        new_client(tmp_path / name, "friend", tmp_path / f"{name}.limbkey")
    own, other = (tmp_path / name / "server.key_secret" for name in ("one", "two"))
    public = other.read_text().partition("public-key = ")[2].splitlines()[0]
    text = own.read_text()
    own.write_text(text.replace(text.partition("public-key = ")[2].splitlines()[0], public))
    with pytest.raises(ConfigError, match="does not belong to its secret key"):
        Gate(context, tmp_path / "one")


@pytest.mark.parametrize("name", ["a", "A.b_c-9", "x" * 64])
def test_names_are_of_letters_digits_and_three_signs(tmp_path: Path, name: str) -> None:
    assert new_client(tmp_path, name, tmp_path / "out.limbkey") == tmp_path / "out.limbkey"
    assert (tmp_path / "clients" / f"{name}.key").is_file()


@pytest.mark.parametrize("name", ["", "x" * 65, "a b", "a/b", "ä"])
def test_what_is_no_name_is_said_and_nothing_is_made(tmp_path: Path, name: str) -> None:
    with pytest.raises(ConfigError, match="expected up to 64 letters, digits, '.', '_' or '-'"):
        new_client(tmp_path / "keys", name, tmp_path / "out.limbkey")
    assert list(tmp_path.iterdir()) == []


def test_a_client_s_file_has_its_pair_and_the_service_s_public_key(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = new_client(Path("deep/keys"), "friend")
    assert path == Path("friend.limbkey")
    assert path.read_text().startswith("# The key of friend: keep it to yourself.\npublic = ")
    key = load_client_key(path)
    assert zmq.curve_public(key.secret) == key.public
    listed, _ = zmq.auth.load_certificate(Path("deep/keys/clients/friend.key"))
    server, secret = zmq.auth.load_certificate(Path("deep/keys/server.key_secret"))
    assert (key.public, key.server) == (listed, server) and zmq.curve_public(secret) == server
    modes = {Path("deep/keys"): 0o700, Path("deep/keys/clients"): 0o700, path: 0o600}
    modes[Path("deep/keys/server.key_secret")] = 0o600
    assert {where: stat.S_IMODE(where.stat().st_mode) for where in modes} == modes
    with pytest.raises(ConfigError, match=r"^friend\.limbkey exists already; expected a new name$"):
        new_client(Path("keys"), "other", path)


def test_a_folder_that_cannot_be_made_is_the_disk_s_fault(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(DeviceError, match="file/keys: Not a directory"):
        new_client(tmp_path / "file" / "keys", "friend", tmp_path / "out.limbkey")


KEY = "0" * 40


@pytest.mark.parametrize("missing", ["public", "secret", "server"])
@pytest.mark.parametrize(
    "value", [None, "3", f'"{KEY}0"', f'"{KEY[1:]}"', '"' + "~" * 40 + '"', '"' + "#" * 40 + '"']
)
def test_a_client_s_file_needs_three_keys_of_40_characters(
    tmp_path: Path, missing: str, value: str | None
) -> None:
    path = tmp_path / "x.limbkey"
    fields = {"public": f'"{KEY}"', "secret": f'"{KEY}"', "server": f'"{KEY}"'}
    path.write_text("".join(f"{name} = {text}\n" for name, text in fields.items()))
    assert load_client_key(path).server == KEY.encode()
    fields[missing] = value or f'"{KEY}"'
    path.write_text("".join(f"{n} = {text}\n" for n, text in fields.items() if value or n != missing))
    with pytest.raises(ConfigError, match="expected public, secret and server, each of 40 characters"):
        load_client_key(path)


def test_a_client_s_file_that_is_not_there_is_said(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="No such file or directory; expected a key of `limbd keys new`"):
        load_client_key(tmp_path / "none.limbkey")


def test_a_service_without_its_secret_is_said(tmp_path: Path, context: zmq.Context) -> None:
    new_client(tmp_path, "friend", tmp_path / "friend.limbkey")
    (tmp_path / "server.key_secret").write_bytes((tmp_path / "server.key").read_bytes())
    with pytest.raises(ConfigError, match=r"server\.key_secret: it has no secret key"):
        Gate(context, tmp_path)


def test_other_files_beside_the_keys_are_passed_over(tmp_path: Path, context: zmq.Context) -> None:
    new_client(tmp_path, "friend", tmp_path / "friend.limbkey")
    (tmp_path / "clients" / "notes.txt").write_text("nothing of the kind")
    with gate_of(context, tmp_path) as gate:
        assert gate is not None
        socket = context.socket(zmq.PUB)
        gate.guard(socket)
        assert socket.get(zmq.CURVE_SERVER) == 1
        socket.close(0)
    with gate_of(context, None) as none:
        assert none is None
