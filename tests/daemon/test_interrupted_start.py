"""Ctrl-C goes to all processes of a terminal at once: whatever a start-up has come to, it ends in order."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import psutil
import pytest

from tests.daemon.conftest import Program, device_info, wait_until
from tests.patience import PATIENCE_S


def _children(process: subprocess.Popen[bytes]) -> int:
    return len(psutil.Process(process.pid).children(recursive=True))


def _interrupted(folder: Path, n_children: int, *arguments: str) -> tuple[int, str]:
    """Send Ctrl-C to a program and its children once there are enough; return its exit code and stderr."""
    with (folder / "stderr").open("wb") as stderr:
        process = subprocess.Popen(
            [sys.executable, "-m", *arguments], stdout=subprocess.DEVNULL, stderr=stderr, start_new_session=True
        )
    wait_until(lambda: _children(process) >= n_children, f"there were {n_children} children")
    os.killpg(process.pid, signal.SIGINT)
    return process.wait(PATIENCE_S), (folder / "stderr").read_text()


@pytest.mark.parametrize("n_children", [2, 3, 4])  # the first is multiprocessing's resource tracker
def test_the_daemon(tmp_path: Path, pty_device: Callable[..., Any], n_children: int) -> None:
    options = ("--arm", "dd-arm", "--record", str(tmp_path / "rec"), "--endpoint", f"ipc://{tmp_path}/f")
    port = pty_device(device_info()).path
    code, said = _interrupted(tmp_path, n_children, "daemon", "run", "--port", port, *options)
    assert code == 0 and "Traceback" not in said and "Error" not in said


def test_a_daemon_that_compiles_its_kernels_ends_without_them(
    tmp_path: Path, pty_device: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "no-kernels"))
    options = ("--arm", "dd-arm", "--endpoint", f"ipc://{tmp_path}/f")
    started = Program(tmp_path, "run", "--port", pty_device(device_info()).path, *options)
    try:
        wait_until(lambda: "compiling kernels" in started.said, "it compiled")
        started.family = psutil.Process(started.process.pid).children(recursive=True)
        assert started.stop() == 0
        assert "error:" not in started.said
    finally:
        started.cleanup()


def test_the_virtual_device(tmp_path: Path) -> None:
    code, said = _interrupted(tmp_path, 1, "daemon", "virtual", "--link", str(tmp_path / "link"))
    assert code == 0 and "Traceback" not in said
