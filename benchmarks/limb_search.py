"""From how many starts the paper's genetic algorithm gets to a person's limb (Fig. 6 on a person).

    python -m benchmarks.limb_search [DATA] [--starts 50] [--simulated 2] [--half-range 30] [--frames 32]

The objective is the bundle fit's. Each start is a seed: a population drawn evenly from a box that knows nothing
of the person, marker places drawn within 30 cm of their links' origins, angles at the middle of their ranges.
Said is, of the search alone and of the bundle fit that begins where it ended, how many end within 1 mm of the
bundle fit: in the rms of markers, in the places of the modelled markers, in the joint centres; and how many in
no worse a minimum.
"""

import argparse
import json
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.simulated_people.person import person
from fitter.functional.marker_set import MarkerSet, load_marker_set
from fitter.limb.limb_calibration import FIRST_STD_M, calibrate
from fitter.limb.limb_fit import LimbFit
from fitter.limb.limb_search import Found, Search, polished, search_limb
from fitter.limb.search_comparison import SAME_MINIMUM, comparison
from fitter.limb.warm_up import warm_up
from protocol.markers.marker_files import read_markers
from protocol.markers.recording import MarkerRecording

#: Of the issue: within so much of the bundle fit [mm].
_WITHIN_MM = 1.0
_MEASURED = "kineticstoolkit/racing_full.c3d"
Case = tuple[str, MarkerRecording, MarkerSet, str]


def cases(data: Path | None, simulated: int) -> Iterator[Case]:
    """Return simulated persons, whose markers wander by 3 mm, and a measured one."""
    for k in range(simulated):
        preset = ("human-arm-right", "human-leg-right")[k % 2]
        truth = person(preset, seed=100 + k, noise_m=3e-3)
        yield f"simulated {preset}", truth.recordings[0], truth.marker_set, preset
    if data is not None:
        (looked,) = read_markers([data / _MEASURED])
        yield Path(_MEASURED).stem, looked.recording, load_marker_set("kineticstoolkit"), "human-arm-right"


def runs(fit: LimbFit, cpu_s: float, starts: int, search: Search) -> Iterator[dict[str, dict[str, float]]]:
    """Return the comparison's document of every start; ``cpu_s`` is what the calibration took."""
    first = replace(fit.bundle.markers, std=np.full(len(fit.bundle.markers.names), FIRST_STD_M))
    plain = Found(fit.bundle, cpu_s, len(fit.task.frames.t))
    for seed in range(starts):
        ga = search_limb(fit.task, first, seed, search)
        found = {"bundle": plain, "ga": ga, "ga+bundle": polished(fit.task, ga)}
        yield comparison(fit.where, fit.task, found).document()  # type: ignore[misc]


def summary(documents: Sequence[dict[str, dict[str, float]]], method: str) -> dict[str, float]:
    """Return shares of starts, and medians over them."""
    mine = [one[method] for one in documents]
    goal = [one["bundle"]["marker_rms_mm"] for one in documents]
    rms = np.array([one["marker_rms_mm"] for one in mine])
    cost, apart, centres, cpu = (
        np.array([one[k] for one in mine]) for k in ("cost", "apart_mm", "centres_apart_mm", "cpu_s")
    )
    no_worse = cost < SAME_MINIMUM
    return {
        "share_rms": float(np.mean(np.abs(rms - goal) < _WITHIN_MM)),
        "share_apart": float(np.mean(apart < _WITHIN_MM)),
        "share_centres": float(np.mean(centres < _WITHIN_MM)),
        "share_no_worse": float(np.mean(no_worse)),
        "rms_mm": float(np.median(rms)),
        "apart_mm": float(np.median(apart)),
        "centres_apart_mm": float(np.median(centres)),
        "cost": float(np.median(cost)),
        "cpu_s": float(np.median(cpu)),
        "generations": float(np.median([one["generations"] for one in mine])),
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Run all starts of all cases, and say the shares."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path, nargs="?", help="folder of measured data; none: simulated persons only")
    parser.add_argument("--starts", type=int, default=50)
    parser.add_argument("--simulated", type=int, default=2, help="persons (2)")
    parser.add_argument("--half-range", type=float, default=30.0, help="of angles in the box [°] (30)")
    parser.add_argument("--frames", type=int, default=Search().frames, help="that the search takes")
    parser.add_argument("--out", type=Path, help="write every start as JSON")
    given = parser.parse_args(arguments)
    search = Search(frames=given.frames, half_range_rad=float(np.radians(given.half_range)))
    warm_up()
    every: dict[str, list[dict[str, dict[str, float]]]] = {}
    for name, recording, marker_set, preset in cases(given.data, given.simulated):
        began = time.process_time()
        fit = calibrate([recording], marker_set, preset)
        cpu_s = time.process_time() - began
        every[name] = []
        for seed, one in enumerate(runs(fit, cpu_s, given.starts, search)):
            every[name].append(one)
            if given.out is not None:
                given.out.write_text(json.dumps(every, indent=1))
            ga, after = one["ga"], one["ga+bundle"]
            sys.stderr.write(
                f"{name} {seed}: cost {ga['cost']:+.1f}, {after['cost']:+.1f}; rms {ga['marker_rms_mm']:.2f}, "
                f"{after['marker_rms_mm']:.2f} of {one['bundle']['marker_rms_mm']:.2f} mm; centres "
                f"{ga['centres_apart_mm']:.1f}, {after['centres_apart_mm']:.1f} mm; {ga['cpu_s']:.0f} s\n"
            )
        for method in ("bundle", "ga", "ga+bundle"):
            row = summary(every[name], method)
            sys.stdout.write(f"{name}, {method}: " + ", ".join(f"{k} {x:.3g}" for k, x in row.items()) + "\n")
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
