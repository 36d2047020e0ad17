"""Being served before others: real-time scheduling and memory that stays, where they are allowed."""

import ctypes
import os
import resource
from pathlib import Path

import zmq

#: Of the processes that must not be late; the reader's tty holds the least, and a device waits for nobody.
DEVICE, READER, TOUCH, PLAYER, PIPELINE = 25, 20, 15, 12, 10

#: Lock what is mapped and what will be, each page from its first use on (`mlockall(2)`).
_CURRENT, _FUTURE, _ON_FAULT = 1, 2, 4
#: Its owner's memory has no limit (`capabilities(7)`).
_CAP_IPC_LOCK = 14


def ask_for_real_time(priority: int, context: "zmq.Context[zmq.Socket[bytes]] | None" = None) -> bool:
    """Run before all that is not real time; return whether that is allowed.

    It is where the user has a limit of real-time priority (``LimitRTPRIO=`` of the unit) or the capability. The
    kernel leaves others a twentieth of each processor in any case.

    Parameters
    ----------
    priority : int
    context : zmq.Context, optional
        Its threads, if it has none yet, are served alike: what carries messages is not later than what answers.
    """
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(priority))
    except OSError:
        return False
    _keep_memory()
    if context is not None:
        context.set(zmq.THREAD_SCHED_POLICY, os.SCHED_FIFO)
        context.set(zmq.THREAD_PRIORITY, priority)
    return True


def _keep_memory() -> None:
    """Keep every page that is used in memory, where that has no limit: one that was dropped is read from disk.

    With a limit, what is allocated later would fail at it.
    """
    unlimited = resource.getrlimit(resource.RLIMIT_MEMLOCK)[0] == resource.RLIM_INFINITY
    if unlimited or _capable_of(_CAP_IPC_LOCK):
        ctypes.CDLL(None, use_errno=True).mlockall(_CURRENT | _FUTURE | _ON_FAULT)


def _capable_of(capability: int) -> bool:
    status = Path("/proc/self/status").read_bytes()
    held = next((line.split()[1] for line in status.splitlines() if line.startswith(b"CapEff:")), b"0")
    return bool(int(held, 16) >> capability & 1)
