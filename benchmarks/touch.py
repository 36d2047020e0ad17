"""What a tick of the touched arm costs, with two joints and with seven; how well the haptic loop keeps its rate.

``python -m benchmarks.touch --seconds 60`` measures steps in this process, and then the loop in its own, touched
by the virtual hand.
"""

import argparse
import sys
import time

import numpy as np

from arm.arm_file import load_arm
from arm.model import Arm, Joint, Link
from limbcal.arguments import Parser
from limbcal.command import run_command, say
from limbcal.real_time import TOUCH, ask_for_real_time
from playback.touch.grip import Hand
from playback.touch.hand import VirtualHand
from playback.touch.limit import Coupling
from playback.touch.pace import Pace
from playback.touch.process import TouchProcess
from playback.touch.tick import tick
from playback.touch.touched_arm import TouchedArm


def seven_links() -> Arm:
    """Return a chain of seven, bent every way like a human arm, with friction in every joint."""
    bends = (0.0, np.pi / 2, -np.pi / 2, np.pi / 2, -np.pi / 2, np.pi / 2, -np.pi / 2)
    friction = load_arm("spatial-arm").joints[0].friction
    link = Link(1.5, (0.08, 0.0, 0.0), (0.004, 0.02, 0.02, 0.0, 0.0, 0.0))
    return Arm("seven-links", tuple(Joint(alpha_rad=a, a_m=0.15, friction=friction, link=link) for a in bends))


def steps(arm: Arm, n: int) -> dict[str, object]:
    """Return what a tick of 1 ms takes, of the compiled kernel alone and with all that Python does for it [us]."""
    touched = TouchedArm(arm, np.full(arm.n_joint, 0.3), 1e-3, Coupling())
    touched.hold()
    tip = touched.touched_point(touched.tip)
    touched.take(touched.tip, Hand(tip))
    took: dict[str, list[float]] = {"kernel": [], "tick": [], "kernel in a row": []}
    for k in range(n):
        swing = 0.05 * np.sin(2.0 * np.pi * k * 1e-3)
        hand = Hand(tip + [swing, -swing, 0.0])
        begin = time.perf_counter()
        touched.step(1, hand)
        middle = time.perf_counter()
        tick(*touched.memory.arrays, 1, False)
        took["tick"].append(middle - begin)
        took["kernel"].append(time.perf_counter() - middle)
        time.sleep(2e-4)  # as in the loop, where others run in between
    for _ in range(n):
        begin = time.perf_counter()
        tick(*touched.memory.arrays, 1, False)
        took["kernel in a row"].append(time.perf_counter() - begin)
    return {
        name: dict(zip(("p50", "p99"), (1e6 * np.percentile(times[10:], (50, 99))).round(1).tolist(), strict=True))
        for name, times in took.items()
    }


def bare(seconds: float) -> dict[str, object]:
    """Return how a loop of 1 kHz that does nothing keeps its rate here: what the machine allows at all."""
    pace = Pace(1e-3)
    while pace.now_s - pace.start_s < seconds:
        pace.wait()
    return {
        "held_rate_hz": pace.held_rate_hz,
        "overruns": pace.overruns,
        "lateness_ms": pace.lateness.summary(1e-3),
    }


def measure(arguments: argparse.Namespace) -> dict[str, object]:
    """Measure steps and loop."""
    arms = [load_arm("dd-arm"), seven_links()]
    for arm in arms:
        steps(arm, 20)  # compiled, and asked to be served first only then
    found: dict[str, object] = {"real_time": ask_for_real_time(TOUCH)}
    for arm in arms:
        found[f"step_us {arm.name}"] = steps(arm, arguments.steps)
        say(f"step of {arm.name} [us]: {found[f'step_us {arm.name}']}")
    found["loop that does nothing"] = bare(arguments.seconds)
    say(f"loop that does nothing, {arguments.seconds:g} s: {found['loop that does nothing']}")
    for arm in arms[: 2 if arguments.both else 1]:
        with TouchProcess(arm, np.full(arm.n_joint, 0.3)) as process, VirtualHand(process.haptic) as hand:
            hand.start()
            time.sleep(arguments.seconds)
            health = process.wait_health()
            health["hand"] = hand.close()
        found[f"loop {arm.name}"] = health
        say(
            f"loop with {arm.name}, {arguments.seconds:g} s: {health['held_rate_hz']:.3f} Hz, late "
            f"{health['lateness_ms']}, step {health['step_us']}, {health['overruns']} overruns, "
            f"passive: {health['energy_J']['passive']}"
        )
    return found


def main() -> int:
    """Run the benchmark."""
    parser = Parser(prog="python -m benchmarks.touch", description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0, metavar="S", help="how long the loop runs (60)")
    parser.add_argument("--steps", type=int, default=5000, metavar="N", help="ticks that are timed (5000)")
    parser.add_argument("--both", action="store_true", help="run the loop with seven joints too")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    parser.set_defaults(action=measure)
    return run_command(parser, None)


if __name__ == "__main__":
    sys.exit(main())
