"""What the daemon's processes load: a compiler takes a second, and most of them have no use for it."""

import subprocess
import sys

import pytest


@pytest.mark.parametrize(
    "modules",
    [
        "daemon.service.supervisor daemon.acquisition.reader daemon.recording.recorder",
        "daemon.virtual_device.virtual_loop",
    ],
)
def test_who_runs_no_kernel_loads_no_compiler(modules: str) -> None:
    seen = f"""
import sys
from importlib import import_module
for name in {modules.split()}:
    import_module(name)
    assert "numba" not in sys.modules and "scipy" not in sys.modules, name
"""
    subprocess.run([sys.executable, "-c", seen], check=True, capture_output=True)
