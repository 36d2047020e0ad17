"""The process of the haptic loop, from within.

It ends when it is asked to and when the pipe to its parent ends: so none is left behind however its parent dies.
"""

import gc
import json
import signal
import traceback
from multiprocessing.connection import Connection

import numpy as np
import zmq

from arm.possible import why_it_runs_away
from limbcal.compilation import said_when_compiling
from limbcal.errors import DataError, LimbcalError
from limbcal.real_time import TOUCH, ask_for_real_time
from playback.touch.grip import Hand
from playback.touch.loop import Setup, TouchLoop
from playback.touch.pace import Pace
from playback.touch.touched_arm import TouchedArm
from protocol.curve import gate_of

#: How often the loop looks at the pipe [s].
_LOOK_S = 0.02


def warmed_up(setup: Setup) -> TouchedArm:
    """Return an arm that has been held, turned and let go: every kernel is compiled.

    Raises
    ------
    DataError
        If it does not get through one step, as an arm without masses.
    """
    with said_when_compiling("limbplay touch"):
        touched = TouchedArm(setup.arm, np.array(setup.q0), 1.0 / setup.rate_hz, setup.coupling)
        hand = Hand(touched.touched_point(touched.tip), None, np.eye(3))
        touched.step(1)
        if not np.isfinite(touched.state).all():
            raise DataError(f"arm {setup.arm.name!r} runs away to infinity at once: {why_it_runs_away(setup.arm)}")
        touched.take(touched.tip, hand)
        for _ in range(3):
            touched.step(2, hand)
    touched.reset(np.array(setup.q0))
    return touched


def be_loop(line: Connection, setup: Setup) -> None:
    """Run the loop and tell how it goes, until asked to stop."""
    # Ctrl-C and systemd signal the whole group; the parent acts on it and ends this process.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    try:
        _run(line, setup)
    except (EOFError, OSError) as error:
        if isinstance(error, ConnectionError | EOFError):
            return  # nobody listens any more
        _say(line, failed="DeviceError", sentence=f"the haptic loop failed: {error}", trace=traceback.format_exc())
    except LimbcalError as error:
        _say(line, failed=type(error).__name__, sentence=str(error), trace="")
    except Exception as error:  # the parent says what happened
        sentence = f"the haptic loop failed: {type(error).__name__}: {error}"
        _say(line, failed="DeviceError", sentence=sentence, trace=traceback.format_exc())
    finally:
        line.close()


def _run(line: Connection, setup: Setup) -> None:
    touched = warmed_up(setup)
    with zmq.Context() as context:
        real_time = ask_for_real_time(TOUCH, context)
        with gate_of(context, setup.keys) as gate:
            pace = Pace(1.0 / setup.rate_hz)
            loop = TouchLoop(context, setup, touched, pace, gate, real_time)
            try:
                loop.first_frames()
                gc.collect()
                gc.freeze()
                gc.disable()
                pace.start()
                _say(line, endpoint=loop.endpoint, haptic=loop.haptic, health=loop.health())
                _loop(line, loop, max(1, round(_LOOK_S * setup.rate_hz)))
                _say(line, health=loop.health())
            finally:
                gc.enable()
                loop.close()


def _loop(line: Connection, loop: TouchLoop, look_every: int) -> None:
    """Tick until asked to stop."""
    pace, k = loop.pace, 0
    pace.start()
    while True:
        loop.tick(pace.wait())
        k += 1
        if k % look_every == 0:
            if k % (50 * look_every) == 0:
                gc.collect(0)  # what little has come since: the rest is frozen
            if line.poll():
                if line.recv_bytes() == b"stop":
                    return
                _say(line, health=loop.health())


def _say(line: Connection, **fields: object) -> None:
    line.send_bytes(json.dumps(fields, default=_plain).encode())


def _plain(value: object) -> object:
    """Turn what numpy made into what JSON has."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"found a {type(value).__name__}, expected plain values")
