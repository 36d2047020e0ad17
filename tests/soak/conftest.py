"""The programs of the daemon's tests, for longer."""

from tests.daemon.conftest import limbd, virtual_arm

__all__ = ["limbd", "virtual_arm"]
