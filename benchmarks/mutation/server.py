"""A process that has loaded the libraries, and forks one for each run of tests: that saves seconds each time.

It reads requests from its input, a JSON line each, and answers each by a line. Nothing of the project is loaded
before it forks: each run loads the code as it then is.
"""

import contextlib
import gc
import importlib
import json
import os
import select
import signal
import sys
import time
import traceback
import types
from pathlib import Path

import psutil
import pytest

#: What the tests load first.
LIBRARIES = (
    *("hypothesis", "mcap.reader", "msgpack", "numba", "numpy", "pydantic", "pyarrow.csv", "pyarrow.parquet"),
    *("prometheus_client", "rich.console", "rich.progress", "scipy.interpolate", "scipy.io", "scipy.linalg"),
    *("scipy.optimize", "scipy.signal", "scipy.sparse", "scipy.spatial", "scipy.stats", "serial", "zmq"),
    *("zmq.auth.thread", "multiprocessing.connection", "numba.extending", "numba.core.caching", "zstandard"),
)
#: What a run gets as its exit code when it has taken too long.
TOO_LONG = -1


def serve() -> None:
    """Answer requests until there are no more."""
    for library in LIBRARIES:
        importlib.import_module(library)
    gc.freeze()
    _tell({"ready": True})
    for line in sys.stdin:
        _tell(_answer(json.loads(line)))


def _tell(answer: dict[str, object]) -> None:
    sys.stdout.write(json.dumps(answer) + "\n")
    sys.stdout.flush()


def _answer(request: dict[str, object]) -> dict[str, object]:
    """Run tests in a group of processes of their own, none of which outlives them."""
    log, arguments, limit_s = Path(str(request["log"])), request["arguments"], float(str(request["limit_s"]))
    assert isinstance(arguments, list)
    began = time.monotonic()
    child = os.fork()
    if child == 0:
        _run([str(one) for one in arguments], log)
    in_time = bool(select.select([pidfd := os.pidfd_open(child)], [], [], limit_s)[0])
    os.close(pidfd)
    took_s = time.monotonic() - began
    _end(child)
    status = os.waitpid(child, 0)[1]
    code = os.waitstatus_to_exitcode(status) if in_time else TOO_LONG
    return {"code": code, "seconds": round(took_s, 2)}


def _run(arguments: list[str], log: Path) -> None:
    """Be the process that runs tests; there is no way back."""
    code = 70
    try:
        os.setsid()
        signal.signal(signal.SIGINT, signal.default_int_handler)
        with log.open("wb") as file, open(os.devnull, "rb") as nothing:
            os.dup2(nothing.fileno(), 0)
            os.dup2(file.fileno(), 1)
            os.dup2(file.fileno(), 2)
        sys.argv = ["pytest", *arguments]
        sys.modules["__main__"] = types.ModuleType("__main__")  # which processes that tests start need not load
        code = int(pytest.main(arguments))
    except BaseException:  # whatever it is, it must not lead back to the parent's loop
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


def _end(child: int) -> None:
    """Kill the remaining processes of a run, those that have left its process group included."""
    left = []
    with contextlib.suppress(psutil.NoSuchProcess):
        left = psutil.Process(child).children(recursive=True)
    for process in left:
        with contextlib.suppress(psutil.NoSuchProcess):
            process.kill()
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)


if __name__ == "__main__":
    serve()
