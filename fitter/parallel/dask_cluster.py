"""Jobs that the workers of a Dask cluster do."""

import socket
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import CancelledError
from importlib import import_module
from typing import TypeVar
from urllib.parse import urlsplit

from limbcal.errors import ConfigError, DeviceError

Job = TypeVar("Job")
Result = TypeVar("Result")

#: How long a scheduler may take to answer [s]; a convention.
_CONNECT_S = 10.0


def on_cluster(work: Callable[[Job], Result], jobs: Sequence[Job], address: str) -> Generator[Result, None, None]:
    """Yield the results of jobs in order; for errors see `fitter.parallel.spawned.in_order`."""
    try:
        distributed = import_module("distributed")
    except ImportError as error:
        raise ConfigError(
            "--dask needs the packages dask and distributed, which are not installed; "
            "pip install 'limbcal[cluster]' adds them"
        ) from error
    _require_somebody(address)
    with distributed.Client(address, timeout=_CONNECT_S, set_as_default=False) as client:
        futures = client.map(work, jobs, pure=False)
        try:
            for future in futures:
                yield future.result()
        except (OSError, ImportError, CancelledError, distributed.KilledWorker) as error:
            raise DeviceError(f"--dask {address}: the cluster could not do it ({error})") from error
        finally:
            client.cancel(futures)


def _require_somebody(address: str) -> None:
    """Look whether anybody listens at all; the client would try for long, and go on trying behind our back."""
    parts = urlsplit(address)
    try:
        host, port = parts.hostname, parts.port
    except ValueError:
        host, port = None, None
    if host is None or port is None:
        raise ConfigError(f"--dask is {address!r}, expected a scheduler's address such as tcp://127.0.0.1:8786")
    try:
        socket.create_connection((host, port), timeout=_CONNECT_S).close()
    except OSError as error:
        raise DeviceError(f"--dask {address}: no Dask scheduler answers there ({error})") from error
