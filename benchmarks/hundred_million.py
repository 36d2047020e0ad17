"""A hundred million samples from motion to parameters, made and reduced block by block and never all in memory.

The motion of the two-joint arm is a sum of sinusoids for each joint; the torque is that of eq. (4) with white
noise on it. Each thread makes and reduces a part at a time, as it would a file; the sums are added and fitted.
Time and memory are those of the whole process, the making of the data included.
"""

import argparse
import resource
import sys
import time
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from arm.arm_file import load_arm
from arm.base_parameters import BaseParameters
from arm.chain import chain_of
from arm.model import Arm, Control, Floats
from arm.newton_euler import inverse_dynamics
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.dynamics.torque_search import fit_sums
from fitter.regression_sums.running_sums import RunningSums
from fitter.regression_sums.torque_sums import TorqueSums, add_up, finished
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, run_command, say
from limbcal.compiled import compiled

SAMPLES, PARTS, THREADS = 100_000_000, 4, 2
RATE_HZ = 32_000.0
NOISE_N_M = 0.02
#: Sinusoids of a joint, and the highest of their frequencies.
SINUSOIDS, HIGHEST_HZ = 5, 2.0
#: Samples that are in memory at a time, in each thread.
BLOCK = 32_768


@dataclass(frozen=True)
class Block:
    """Consecutive samples of a motion; all arrays are (n_sample, n_joint)."""

    q: Floats
    dq: Floats
    ddq: Floats
    tau: Floats


def blocks(arm: Arm, samples: int, seed: int) -> Iterator[Block]:
    """Make a motion and its noisy torque, block by block."""
    rng = np.random.default_rng(seed)
    omega = 2.0 * np.pi * rng.uniform(0.1, HIGHEST_HZ, (arm.n_joint, SINUSOIDS))
    phase, amplitude = rng.uniform(0.0, 2.0 * np.pi, omega.shape), rng.uniform(0.1, 0.4, omega.shape)
    for first in range(0, samples, BLOCK):
        q, dq, ddq = np.zeros((3, min(BLOCK, samples - first), arm.n_joint))
        add_sinusoids(amplitude, omega, phase + omega * (first / RATE_HZ), 1.0 / RATE_HZ, q, dq, ddq)
        tau = inverse_dynamics(arm, q, dq, ddq)
        tau += NOISE_N_M * rng.standard_normal(tau.shape)
        yield Block(q, dq, ddq, tau)


@compiled
def add_sinusoids(
    amplitude: Floats, omega: Floats, phase: Floats, dt_s: float, q: Floats, dq: Floats, ddq: Floats
) -> None:
    """Add sinusoids and their derivatives; from sample to sample each is turned on by its angle."""
    for joint in range(q.shape[1]):
        for m in range(omega.shape[1]):
            w, a = omega[joint, m], amplitude[joint, m]
            s, c = np.sin(phase[joint, m]), np.cos(phase[joint, m])
            turn_s, turn_c = np.sin(w * dt_s), np.cos(w * dt_s)
            for k in range(q.shape[0]):
                q[k, joint] += a * s
                dq[k, joint] += a * w * c
                ddq[k, joint] -= a * w * w * s
                s, c = s * turn_c + c * turn_s, c * turn_c - s * turn_s


def reduced(arm: Arm, base: BaseParameters, samples: int, seed: int) -> TorqueSums:
    """Make one part and reduce it, as one trial."""
    chain, columns = chain_of(arm), np.array(base.independent)
    running = RunningSums(arm.n_joint, len(columns), samples)
    for block in blocks(arm, samples, seed):
        running.add_motion(chain, columns, block.q, block.dq, block.ddq, block.tau)
    return finished(running)


def peak_megabytes() -> float:
    """Return the most that this process ever had in memory."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6


def measure(samples: int = SAMPLES) -> Mapping[str, object]:
    """Make, reduce and fit; return how long it took, how much memory, and how far the parameters are off."""
    arm = replace(load_arm("dd-arm"), control=Control())
    base = structural_parameters(arm)
    fit_sums(arm, base, reduced(arm, base, 1000, 0))  # compiles
    begin, used = time.perf_counter(), time.process_time()
    with ThreadPoolExecutor(THREADS) as threads:
        parts = threads.map(partial(reduced, arm, base, samples // PARTS), range(PARTS))
        sums = add_up(list(parts))
    fit = fit_sums(arm, base, sums)
    seconds = time.perf_counter() - begin
    true = base.combination @ standard_parameters(arm)
    off = [
        abs(fit.parameters[name].value - value) / fit.parameters[name].std
        for name, value in zip(base.names, true, strict=True)
    ]
    return {
        "samples": sums.samples,
        "seconds": seconds,
        "cpu_seconds": time.process_time() - used,
        "peak_megabytes": peak_megabytes(),
        "parameters": {name: fit.parameters[name].document() for name in base.names},
        "worst_error_in_std": max(off),
    }


def show(options: argparse.Namespace) -> Document:
    """Measure, and say what was found."""
    found = measure(options.samples)
    say(
        f"{found['samples']:,} samples in {found['seconds']:.1f} s ({found['cpu_seconds']:.1f} s of processor), "
        f"peak memory {found['peak_megabytes']:.0f} MB, no parameter off by more than "
        f"{found['worst_error_in_std']:.1f} of its standard errors"
    )
    return found


def main(argv: list[str] | None = None) -> int:
    """Run the benchmark."""
    parser = Parser(prog="python -m benchmarks.hundred_million", description=__doc__, parents=[common_options()])
    parser.add_argument("--samples", type=int, default=SAMPLES)
    parser.set_defaults(action=show)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
