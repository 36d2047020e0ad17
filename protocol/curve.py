"""Who may connect from another machine: CURVE (RFC 26), with a list of the keys that are let in.

A folder of keys holds ``server.key_secret``, the service's own, and ``clients/NAME.key``, the public keys that
are let in; taking a file away shuts its owner out at the next start. A client needs one file, ``NAME.limbkey``.
"""

import os
import re
import struct
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import zmq
import zmq.auth
from zmq.auth.thread import ThreadAuthenticator
from zmq.utils import z85

from limbcal.errors import ConfigError, DeviceError
from limbcal.toml import parse_toml, read_toml_text

Context = zmq.Context[zmq.Socket[bytes]]

_SERVER, _CLIENTS = "server", "clients"
_NAME = re.compile(r"[A-Za-z0-9._-]{1,64}")
#: A key of Curve25519, and its text in Z85 (ZeroMQ RFC 32).
_KEY_CHARACTERS, _KEY_BYTES = 40, 32


@dataclass(frozen=True)
class ClientKey:
    """A client's key pair and the service's public key, each 40 characters of Z85."""

    public: bytes
    secret: bytes
    server: bytes

    def apply(self, socket: zmq.Socket[bytes]) -> None:
        """Make a socket connect with it."""
        socket.curve_publickey, socket.curve_secretkey, socket.curve_serverkey = (
            self.public,
            self.secret,
            self.server,
        )


def needs_keys(endpoint: str) -> str:
    """Return the sentence for an endpoint that others can reach and that lets anybody in."""
    return (
        f"endpoint is {endpoint!r}, which other machines can reach; "
        "expected tcp://127.0.0.1:…, tcp://[::1]:…, ipc://…, or keys (`limbd keys new NAME` makes them)"
    )


class Gate:
    """Lets in only clients with a listed key.

    Parameters
    ----------
    context : zmq.Context
        Of the sockets that are to be guarded.
    folder : Path

    Raises
    ------
    ConfigError
        If the folder has no key of the service's own, lists nobody, or has a file that is no key.
    """

    def __init__(self, context: Context, folder: Path) -> None:
        self._public, self._secret = _load(folder / f"{_SERVER}.key_secret")
        _check_clients(folder / _CLIENTS)  # where pyzmq cannot read one, it lets nobody in
        self._authenticator = ThreadAuthenticator(context)
        self._authenticator.start()
        self._authenticator.configure_curve(domain="*", location=str(folder / _CLIENTS))

    def guard(self, socket: zmq.Socket[bytes]) -> None:
        """Guard a socket that is about to be bound."""
        socket.curve_publickey, socket.curve_secretkey, socket.curve_server = self._public, self._secret, True

    def close(self) -> None:
        """End; sockets that were guarded must be closed already."""
        self._authenticator.stop()


@contextmanager
def gate_of(context: Context, folder: Path | None) -> Iterator[Gate | None]:
    """Give the gate of a folder of keys, or none where there is no folder, and end it."""
    if folder is None:
        yield None
        return
    gate = Gate(context, folder)
    try:
        yield gate
    finally:
        gate.close()


def new_client(folder: Path, name: str, out: Path | None = None) -> Path:
    """Let a client in: list its public key and return the file that it needs.

    The service's own key is made where there is none. Nothing is left of what fails.

    Raises
    ------
    ConfigError
        If the name is none, or is listed already.
    DeviceError
        If the folder cannot be written.
    """
    if not _NAME.fullmatch(name):
        raise ConfigError(f"name is {name!r}, expected up to 64 letters, digits, '.', '_' or '-'")
    clients = folder / _CLIENTS
    out = out or Path(f"{name}.limbkey")
    for path, what in ((clients / f"{name}.key", f"{name} is let in already"), (out, f"{out} exists already")):
        if path.exists():
            raise ConfigError(f"{what}; expected a new name")
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        clients.mkdir(mode=0o700, exist_ok=True)
        with TemporaryDirectory(prefix=".new-", dir=folder) as desk, ExitStack() as undo:
            own = _own_key(folder, Path(desk), undo)
            listed, secret_file = map(Path, zmq.auth.create_certificates(desk, name))
            public, secret = _load(secret_file)
            descriptor = os.open(out, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            undo.callback(out.unlink)
            with os.fdopen(descriptor, "w") as file:
                file.write(_client_text(name, ClientKey(public, secret, own)))
            listed.rename(clients / listed.name)  # at last: whoever is let in has a key
            undo.pop_all()
    except OSError as error:
        raise DeviceError(f"{error.filename}: {error.strerror}") from error
    return out


def _own_key(folder: Path, desk: Path, undo: ExitStack) -> bytes:
    """Return the service's public key, made on a desk where there is none; ``undo`` takes it away again."""
    path = folder / f"{_SERVER}.key_secret"
    if not path.exists():
        made = zmq.auth.create_certificates(desk, _SERVER)
        Path(made[1]).chmod(0o600)
        for file in map(Path, made):
            file.rename(folder / file.name)
            undo.callback((folder / file.name).unlink)
    return _load(path)[0]


def _client_text(name: str, key: ClientKey) -> str:
    pairs = (("public", key.public), ("secret", key.secret), ("server", key.server))
    text = "".join(f'{field} = "{value.decode()}"\n' for field, value in pairs)
    return f"# The key of {name}: keep it to yourself.\n{text}"


def load_client_key(path: Path) -> ClientKey:
    """Return a client's key from its file.

    Raises
    ------
    ConfigError
        If it is none.
    """
    try:
        table = parse_toml(read_toml_text(path), str(path))
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}; expected a key of `limbd keys new`") from error
    keys = [table.get(name) for name in ("public", "secret", "server")]
    if not all(isinstance(key, str) and _is_key(key.encode()) for key in keys):
        raise ConfigError(f"{path}: expected public, secret and server, each of {_KEY_CHARACTERS} characters")
    return ClientKey(*(str(key).encode() for key in keys))


def _check_clients(folder: Path) -> None:
    """Read every key that is let in, as pyzmq will; name each file that is none."""
    mistakes, n_key = [], 0
    try:
        listed = sorted(path for path in folder.iterdir() if path.name.endswith(".key"))
    except OSError as error:
        raise ConfigError(f"{folder}: {error.strerror}; `limbd keys new NAME` makes it") from error
    for path in listed:
        try:
            _read(path)
            n_key += 1
        except ConfigError as error:
            mistakes += error.mistakes
    if not n_key and not mistakes:
        mistakes.append(f"{folder}: nobody is let in; `limbd keys new NAME` lists a client")
    if mistakes:
        raise ConfigError(mistakes)


def _load(path: Path) -> tuple[bytes, bytes]:
    """Return a public key and the secret one that belongs to it."""
    public, secret = _read(path)
    if secret is None:
        raise ConfigError(f"{path}: it has no secret key")
    if zmq.curve_public(secret) != public:
        raise ConfigError(f"{path}: its public key does not belong to its secret key")
    return public, secret


def _read(path: Path) -> tuple[bytes, bytes | None]:
    """Return the keys in a file, each checked; the secret one is None where there is none."""
    try:
        public, secret = zmq.auth.load_certificate(path)
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror or 'not there'}; `limbd keys new NAME` makes it") from error
    except (ValueError, IndexError) as error:  # no line of a public key, or one without a `=`
        raise ConfigError(f"{path}: no key of ZeroMQ's; `limbd keys new NAME` makes one") from error
    for what, key in (("public", public), ("secret", secret)):
        if key is not None and not _is_key(key):
            raise ConfigError(f"{path}: its {what} key is none, expected {_KEY_CHARACTERS} characters of Z85")
    return public, secret


def _is_key(key: bytes) -> bool:
    """Say whether these are 32 bytes in Z85 (RFC 32)."""
    if len(key) != _KEY_CHARACTERS or not set(key) <= set(z85.Z85CHARS):
        return False
    try:
        return len(z85.decode(key)) == _KEY_BYTES
    except (ValueError, struct.error):  # five characters may say more than four bytes hold
        return False
