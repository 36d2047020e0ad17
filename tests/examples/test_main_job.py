"""The main job as `make run` starts it, with fewer motions and slower sensors."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil

from tests.patience import PATIENCE_S

MAIN_JOB = Path(__file__).parents[2] / "examples" / "main_job.py"


def started(out: Path, *options: str) -> "subprocess.Popen[str]":
    command = [sys.executable, str(MAIN_JOB), "--out", str(out), *options]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def family(process: "subprocess.Popen[str]") -> list[psutil.Process]:
    return psutil.Process(process.pid).children(recursive=True)


def all_gone(processes: list[psutil.Process]) -> bool:
    return not psutil.wait_procs(processes, timeout=PATIENCE_S)[1]


def test_it_calibrates_and_plays(tmp_path):
    with started(tmp_path, "--trials", "6", "--speed", "3", "--seed", "3", "--rate-hz", "4000") as job:
        said = job.communicate(timeout=PATIENCE_S)[0]
    assert job.returncode == 0, said
    assert "trial 6: " in said and "kept for evaluation" in said
    assert "6 of 6 motions: 5 learnt from, 1 held back; 0 s of frames lost" in said
    assert "lengths found: a1 2" in said
    assert "limbplay streamed" in said
    assert "simulated against the true angles" in said
    for name in ("calibrated.toml", "kinematics.json", "dynamics.json", "motions.npz", "report.html", "truth.npz"):
        assert (tmp_path / name).stat().st_size > 0
    assert len(list((tmp_path / "recordings").glob("*.mcap"))) == 1


def test_an_interrupt_leaves_no_process_behind(tmp_path):
    with started(tmp_path, "--trials", "6", "--rate-hz", "4000", "--method", "integrate") as job:
        seen: list[psutil.Process] = []
        deadline = time.monotonic() + PATIENCE_S
        while not list(tmp_path.glob("recordings/*.mcap")):  # by then all of them are at work
            assert time.monotonic() < deadline and job.poll() is None
            time.sleep(0.05)
        seen = family(job)
        assert len(seen) >= 5
        job.send_signal(signal.SIGINT)
        said = job.communicate(timeout=PATIENCE_S)[0]
    assert all_gone(seen)
    assert job.returncode == 130
    assert "Traceback" not in said
