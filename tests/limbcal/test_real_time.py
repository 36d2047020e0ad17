"""Real-time scheduling is asked for, and done without where it is not allowed."""

import os
import subprocess
import sys

import pytest

from limbcal.real_time import READER, ask_for_real_time

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


def test_what_is_not_allowed_is_done_without(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    assert not ask_for_real_time(READER)
