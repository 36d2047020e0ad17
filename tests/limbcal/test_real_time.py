"""Real-time scheduling is asked for, and done without where it is not allowed."""

import os
import resource
import subprocess
import sys

import pytest

from limbcal.real_time import DEVICE, PIPELINE, PLAYER, READER, TOUCH, ask_for_real_time

ASK = (
    "import os, sys\n"
    "from limbcal.real_time import READER, ask_for_real_time\n"
    "os.setuid(int(sys.argv[1]))\n"
    "print(ask_for_real_time(READER), os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK == os.SCHED_FIFO)"
)


@pytest.mark.skipif(os.getuid() != 0, reason="only root may be anybody")
@pytest.mark.parametrize(("user", "granted"), [(0, "True True"), (65534, "False False")])
def test_who_may_is_served_before_others(user: int, granted: str) -> None:
    ended = subprocess.run([sys.executable, "-c", ASK, str(user)], capture_output=True, text=True, check=True)
    assert ended.stdout.strip() == granted


@pytest.mark.skipif(os.getuid() != 0, reason="another user's memory has a limit")
@pytest.mark.parametrize("user", [0, 65534])
def test_the_pages_that_are_used_stay_in_memory_where_that_has_no_limit(user: int) -> None:
    code = (
        "import os, sys\n"
        "from limbcal.real_time import READER, ask_for_real_time\n"
        "os.sched_setscheduler = lambda *_: None\n"
        "os.setuid(int(sys.argv[1]))\n"
        "ask_for_real_time(READER)\n"
        "block = bytearray(b'.') * 2**26\n"  # more than a limit would let anybody have
        "print(open('/proc/self/status').read())"
    )
    ended = subprocess.run([sys.executable, "-c", code, str(user)], capture_output=True, text=True, check=True)
    status = dict(line.split(":", 1) for line in ended.stdout.splitlines() if ":" in line)
    capable = int(status["CapEff"], 16) >> 14 & 1
    unlimited = resource.getrlimit(resource.RLIMIT_MEMLOCK)[0] == resource.RLIM_INFINITY
    locked_kb = int(status["VmLck"].split()[0])
    assert locked_kb >= 2**16 if capable or unlimited else locked_kb == 0


def test_what_is_not_allowed_is_done_without(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    assert not ask_for_real_time(READER)


def test_what_waits_for_nobody_comes_first() -> None:
    assert 100 > DEVICE > READER > TOUCH > PLAYER > PIPELINE > 0
