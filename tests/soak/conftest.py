"""The programs of the daemon's tests, for longer."""

from tests.daemon.conftest import limbd

__all__ = ["limbd"]
