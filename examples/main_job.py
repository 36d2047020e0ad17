"""The main job, with no hardware: measure the virtual arm, calibrate it, simulate it, play it back.

Starts the commands that a lab would start, each a process of its own: a virtual device, the daemon, the fitter
that follows it, and then the playback server with the calibrated arm. The arm file that they are given knows
neither the arm's lengths nor its dynamics.
"""

import argparse
import json
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import zmq
from numpy.typing import NDArray
from rich.text import Text

from arm.arm_file import load_arm
from arm.simulation import simulate
from limbcal.command import say, show
from limbcal.digits import to_the_place_of, with_half_width
from limbcal.errors import DeviceError, LimbcalError, Unusable
from protocol.message import PLAY
from protocol.recording_reader import read_recording
from protocol.subscriber import Subscriber

LAB_ARM = Path(__file__).with_name("lab-arm.toml")
TRUE_ARM = "dd-arm"
RESULTS = ("calibrated.toml", "kinematics.json", "dynamics.json", "motions.npz", "report.html", "truth.npz")
#: An arm that has rested for so long, by the stream's own clock, moves no more: a motion takes 6.75 s.
REST_S = 20.0
PAPER_DEG = {"learn": (0.73, 3.51), "evaluate": (1.91, 12.7)}


class Job:
    """Processes that all end when the job does, however it ends."""

    def __init__(self, stack: ExitStack) -> None:
        self._stack = stack

    def start(self, command: Sequence[str], **options: Any) -> "subprocess.Popen[str]":
        """Start a command of ours in a session of its own, so that an interrupt reaches it through us alone."""
        process = subprocess.Popen([sys.executable, "-m", *command], text=True, start_new_session=True, **options)
        self._stack.callback(self.stop, process)
        return process

    def stop(self, process: "subprocess.Popen[str]") -> None:
        """Ask a process to stop, and insist if it does not."""
        if process.poll() is None:
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(15)
            except subprocess.TimeoutExpired:
                process.kill()
        process.wait()
        for pipe in (process.stdin, process.stdout, process.stderr):
            if pipe is not None:
                pipe.close()


def main(argv: list[str] | None = None) -> int:
    """Run the main job; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path("out"), help="where the results go (out)")
    parser.add_argument("--seed", type=int, default=0, help="draws motions and sensor errors (0)")
    parser.add_argument("--speed", type=float, default=3.0, help="times faster than real time (3)")
    parser.add_argument("--rate-hz", type=float, default=32000.0, help="of the sensors (32000)")
    parser.add_argument(
        "--trials", type=int, default=22, help="motions, of which the first 5 are learnt from (22)"
    )
    parser.add_argument(
        "--method", choices=["filter", "integrate"], help="of the daemon's tracker (the daemon's default)"
    )
    parser.add_argument("--quiet-sensors", action="store_true", help="no noise and no bias, but 16 bits")
    arguments = parser.parse_args(argv)
    signal.signal(signal.SIGTERM, _interrupt)
    try:
        with ExitStack() as stack:
            code = calibrate(Job(stack), stack, arguments)
            play(Job(stack), stack, arguments.out)
        summarize(arguments.out)
    except KeyboardInterrupt:
        say("stopped")
        return 130
    except LimbcalError as error:
        say(f"error: {error}")
        return error.exit_code
    return code


def calibrate(job: Job, stack: ExitStack, arguments: argparse.Namespace) -> int:
    """Stream the virtual arm's motions through the daemon into the fitter until all have been seen.

    Returns
    -------
    int
        The exit code: 0, or 4 where the answer is one, but rests on fewer motions than were made.
    """
    out: Path = arguments.out
    out.mkdir(parents=True, exist_ok=True)
    recordings = out / "recordings"
    shutil.rmtree(recordings, ignore_errors=True)
    for name in RESULTS:  # of an earlier run
        (out / name).unlink(missing_ok=True)
    directory = Path(stack.enter_context(tempfile.TemporaryDirectory()))
    frames, fits = f"ipc://{directory}/frames", f"ipc://{directory}/fits"
    seed, trials = str(arguments.seed), str(arguments.trials)
    # Both compile their kernels first, where this machine has none yet: side by side.
    device = job.start(
        ["daemon", "virtual", "--arm", TRUE_ARM, "--seed", seed, "--speed", str(arguments.speed)]
        + ["--rate-hz", str(arguments.rate_hz), "--trials", trials, "--truth", str(out / "truth.npz")]
        + ["--json", "--patient"]
        + ["--quiet-sensors"] * arguments.quiet_sensors,
        stdout=subprocess.PIPE,
    )
    fitter = job.start(
        ["fitter", "subscribe", "--arm", str(LAB_ARM), "--connect", frames, "--endpoint", fits, "--seed", seed]
        + ["--trials", trials, "--idle", str(REST_S), "--compare", TRUE_ARM, "--out", str(out)]
    )
    assert device.stdout is not None
    line = device.stdout.readline()
    if not line:
        raise DeviceError("the virtual device did not start; see above")
    port = json.loads(line)["port"]
    # The fitter need not be there first: what the daemon sends before is in its recording.
    daemon = job.start(
        ["daemon", "run", "--port", port, "--arm", str(LAB_ARM), "--endpoint", frames, "--record", str(recordings)]
        + (["--method", arguments.method] if arguments.method else [])
    )
    while fitter.poll() is None:
        for name, process in (("limbd virtual", device), ("limbd run", daemon)):
            if process.poll() is not None:
                raise DeviceError(
                    f"{name} ended with exit code {process.returncode} before the fitter did; see above"
                )
        try:
            fitter.wait(0.2)
        except subprocess.TimeoutExpired:
            continue
    job.stop(daemon)
    job.stop(device)
    if fitter.returncode == Unusable.exit_code and all((out / name).exists() for name in RESULTS):
        return fitter.returncode  # it said why, and wrote what there is
    if fitter.returncode != 0:
        raise DeviceError(f"fitter subscribe ended with exit code {fitter.returncode}; see above")
    return 0


def play(job: Job, stack: ExitStack, out: Path) -> None:
    """Stream one evaluating motion of the calibrated arm, and receive it as any other program would."""
    directory = Path(stack.enter_context(tempfile.TemporaryDirectory()))
    stream, control = f"ipc://{directory}/play", f"ipc://{directory}/control"
    with zmq.Context() as context, Subscriber(context, stream, (PLAY,)) as subscriber:
        trials = np.load(out / "motions.npz")["trial"]
        server = job.start(
            ["playback", "serve", "--arm", str(out / "calibrated.toml"), "--reference", str(out / "motions.npz")]
            + ["--trial", str(int(trials.max())), "--endpoint", stream, "--control", control, "--once"]
        )
        sender = job.start(["playback", "send", "play", "--control", control, "--json"], stdout=subprocess.DEVNULL)
        received, q = 0, np.zeros(0)
        while server.poll() is None or received == 0:
            message = subscriber.receive(200)
            if message is not None:
                received, q = received + int(message[1]["n"]), message[1]["q"][-1]
            elif server.poll() is not None:
                break
        if sender.wait() != 0 or server.returncode != 0 or not received:
            raise DeviceError("limbplay did not play; see above")
    show(f"limbplay streamed {received} frames of the calibrated arm; it ends at {np.rad2deg(q).round(1)} deg")


def summarize(out: Path) -> None:
    """Print what was found, the truth beside it where the virtual arm knows it."""
    dynamics = json.loads((out / "dynamics.json").read_text())
    kinematics = json.loads((out / "kinematics.json").read_text())
    show("")
    trials = dynamics["trials"]
    motions = trials["learn"] + trials["evaluate"]
    counted = (
        f"{motions} of {trials['expected']} motions: {trials['learn']} learnt from, {trials['evaluate']} held "
        f"back; {trials['lost_s']:.3g} s of frames lost"
    )
    show(Text(counted, style="bold red" if motions < trials["expected"] else ""))
    method, mean, worst = tracking_error(out)
    said = {"integrate": "the paper's method", "filter": "the Kalman filter"}.get(method, method)
    show(f"tracking by {said}, against the true angles: {mean:.2f}° mean, {worst:.1f}° max")
    a = {name: kinematics["parameters"][name]["value"] for name in ("a1", "a2")}
    show(f"lengths found: a1 {1e3 * a['a1']:.1f} mm (true 250), a2 {1e3 * a['a2']:.1f} mm (true 300)")
    p, ci95 = dynamics["parameters"], dynamics["ci95"]
    for name, true in (("I1+m2*L1^2", 1.986076), ("m2*sx2", 1.718632), ("m2*sy2", 0.181763), ("I2", 0.471209)):
        value, half_width = p[name]["value"], np.nan if ci95[name] is None else 0.5 * np.ptp(ci95[name])
        found, around = with_half_width(value, half_width)
        said = to_the_place_of(true, half_width)
        show(f"{name:>11}: {found} ± {around} (true {said}, off by {100 * (value / true - 1):+.1f} %)")
    for role, title in (("learn", "learning"), ("evaluate", "evaluating")):
        found, paper = dynamics["angle_error_deg"][role], PAPER_DEG[role]
        if found is not None:
            show(
                f"simulated against measured angles, {title}: {found['mean']:.2f}° mean, {found['max']:.2f}° max "
                f"(the paper: {paper[0]:.2f}°, {paper[1]:.1f}°)"
            )
    for title, (mean, worst) in true_error(out).items():
        show(f"simulated against the true angles, true targets given, {title}: {mean:.2f}° mean, {worst:.2f}° max")
    show(f"report: {out / 'report.html'}")


def true_error(out: Path, learning: int = 5) -> dict[str, tuple[float, float]]:
    """Return mean and largest error of the calibrated arm that is given the virtual arm's own targets [deg]."""
    truth, arm = np.load(out / "truth.npz"), load_arm(out / "calibrated.toml")
    q, dq, ref = (
        np.column_stack([truth[f"{name}{j + 1}"] for j in range(arm.n_joint)]) for name in ("q", "dq", "ref")
    )
    errors: dict[str, list[NDArray[np.float64]]] = {"learning": [], "evaluating": []}
    for number in np.unique(truth["trial"]):
        rows = truth["trial"] == number
        motion = simulate(arm, ref[rows], float(truth["t"][1] - truth["t"][0]), q[rows][0], dq[rows][0])
        errors["learning" if number <= learning else "evaluating"].append(np.abs(motion.q - q[rows]))
    return {
        title: (float(np.rad2deg(np.concatenate(found).mean())), float(np.rad2deg(np.concatenate(found).max())))
        for title, found in errors.items()
        if found
    }


def tracking_error(out: Path) -> tuple[str, float, float]:
    """Return the daemon's method, and mean and largest error of its angles [deg].

    Both it and the truth count time from the first sample on.
    """
    truth = np.load(out / "truth.npz")
    (recording,) = sorted((out / "recordings").glob("*.mcap"))
    blocks = [fields for _, fields, _ in read_recording(recording, ("limb/frames",))]
    method = str(blocks[0]["method"])
    t = np.concatenate([block["dt_s"] * (block["frame0"] + np.arange(block["n"])) for block in blocks])
    q = np.concatenate([block["q"] for block in blocks])
    seen = t < truth["t"][-1]
    error = [np.abs(q[seen, j] - np.interp(t[seen], truth["t"], truth[f"q{j + 1}"])) for j in range(q.shape[1])]
    return method, float(np.rad2deg(np.mean(error))), float(np.rad2deg(np.max(error)))


def _interrupt(_signum: int, _frame: FrameType | None) -> None:
    raise KeyboardInterrupt


if __name__ == "__main__":
    sys.exit(main())
