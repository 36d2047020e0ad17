"""A cluster that cannot be had is said."""

import socket
import sys
from operator import neg

import pytest

from fitter.parallel.spawned import in_order
from limbcal.errors import ConfigError, DeviceError


def test_a_cluster_that_is_not_there_is_said():
    pytest.importorskip("distributed", reason="the extra 'cluster' is not installed")
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    with pytest.raises(DeviceError, match="no Dask scheduler answers"):
        list(in_order(neg, [1], dask=f"tcp://127.0.0.1:{port}"))
    for address in ("nonsense", "tcp://127.0.0.1", "tcp://127.0.0.1:nonsense"):
        with pytest.raises(ConfigError, match="expected a scheduler's address"):
            list(in_order(neg, [1], dask=address))


def test_a_missing_extra_is_said(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ConfigError, match=r"pip install 'limbcal\[cluster\]'"):
        list(in_order(neg, [1], dask="tcp://127.0.0.1:8786"))
