"""Being served before others: real-time scheduling where it is allowed."""

import os

#: Of the processes that must not be late; the reader's tty holds the least, and a device waits for nobody.
DEVICE, READER, PIPELINE, TOUCH = 25, 20, 10, 15


def ask_for_real_time(priority: int) -> bool:
    """Run before all that is not real time; return whether that is allowed.

    It is where the user has a limit of real-time priority (``LimitRTPRIO=`` of the unit) or the capability. The
    kernel leaves others a twentieth of each processor in any case.
    """
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(priority))
    except OSError:
        return False
    return True
