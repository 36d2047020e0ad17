"""Table 4: other gains, in each of the three ways that can be meant."""

from collections.abc import Sequence

from arm.bench import Bench
from fitter.report.published import ANGLE_ERROR_OTHER_GAINS_DEG, TABLE4
from reproduction.bench_data import true_arm
from reproduction.experiment import Experiment, Settings
from reproduction.laws import (
    CASE_A,
    CASE_B,
    CASE_B_TRUE,
    KNOWN,
    NOISE,
    PAPER,
    PAPER_INERTIAL,
    QUICK_BENCH,
    QUICK_SAMPLES,
    SAMPLES,
    TRUE_KP,
    Gains,
    Row,
    benches,
    document,
    error_grid,
    fitted_values,
    gain_grid,
    inertial_ratios,
    nearer_to_truth,
    parameter_grid,
    row,
)

_QUICK_ROWS = [(1.5, -1.5)]
#: The row for which section 8.2 gives errors of the angles.
_PRINTED = (11.5, -11.5)
_CASES = (CASE_A, CASE_B, CASE_B_TRUE, PAPER, PAPER_INERTIAL)


def run(settings: Settings) -> Experiment:
    """Repeat Table 4: driven with other gains, other gains assumed, gains unknown."""
    arm = true_arm()
    samples = settings.samples or (QUICK_SAMPLES if settings.quick else SAMPLES)
    chosen = _QUICK_ROWS if settings.quick else list(TABLE4)
    size = QUICK_BENCH if settings.quick else Bench()
    own = benches(arm, samples, settings.seed, size)
    rows = []
    for kp, kv in chosen:
        settings.progress(f"table4: gains {kp:g} / {kv:g}")
        rows.append(row(arm, own, Gains("pd", kp, kv, None, TABLE4[kp, kv]), samples, settings.seed, size))
    return Experiment(
        name="table4",
        title="Table 4: other gains",
        assumptions=(
            "The paper does not print whether the arm was driven with a row's gains or these were only "
            "assumed, so both are done. A: driven with them, and they are known. B: driven with 9.5 / -9.5, "
            f"the row's are assumed. C: driven with the row's; its gains are unknown, {KNOWN} is known, and "
            f"the angles have white noise of {100 * NOISE:g} % of their spread. A and B have no noise.",
            f"{samples} samples of {size.learning} learning motions: Table 6 has this table's first row for "
            "300 000.",
            "Errors of angles are those of the evaluating motions, simulated from their first state to their end.",
            "± is half of a 95 % interval.",
        ),
        grids=(
            parameter_grid("Dynamic parameters", rows),
            gain_grid(f"C: gains found, {KNOWN} being known", rows),
            error_grid("Simulated against true angles", rows),
        ),
        findings=_findings(rows),
        document={"samples": samples, "known": KNOWN, "rows": document(rows)},
    )


def _findings(rows: Sequence[Row]) -> tuple[str, ...]:
    paper = [ratio for r in rows for ratio in inertial_ratios(r.gains.paper)]
    right = max(abs(x - 1.0) for r in rows for x in inertial_ratios(fitted_values(r.driven.parameters)))
    factor = max(
        abs(x * TRUE_KP / r.gains.kp - 1.0)
        for r in rows
        for x in inertial_ratios(fitted_values(r.assumed.parameters))
    )
    factors = [r.gains.kp / TRUE_KP for r in rows]
    worst = {case: max(r.errors[case].worst for r in rows) for case in _CASES}
    gains = max(
        abs(p.value - r.gains.kp) / r.gains.kp
        for r in rows
        for name, p in r.unknown.gains.items()
        if name.startswith("kp")
    )
    others = [r for r in rows if r.gains.kp != TRUE_KP]
    last = rows[-1]
    said = [
        f"A, driven with the gains that are assumed: every inertial parameter is within {100 * right:.2g} % of "
        f"the truth, whatever the gains; the simulation is off by {worst[CASE_A]:.2g}° at most.",
        "B, driven with 9.5 / -9.5 and others assumed: every parameter is wrong by the factor kp / 9.5 "
        f"({min(factors):.3g} to {max(factors):.3g}), to within {100 * factor:.2g} % of it. Under the same "
        f"wrong gains the simulation still moves the same (off by {worst[CASE_B]:.2g}° at most); under the "
        f"true ones it is off by up to {worst[CASE_B_TRUE]:.3g}°. No motion shows the factor.",
        f"In {sum(nearer_to_truth(r) for r in others)} of the {len(others)} rows with other gains than 9.5 the "
        f"paper's inertial parameters ({min(paper):.2g} to {max(paper):.2g} times the true ones) are nearer to "
        "the truth than to kp / 9.5 times it. Such rows can't come of B with a free search: the arm was "
        "driven with the row's gains (A), or the search was fenced in near the truth. They don't show that "
        "calibration works with misunderstood gains.",
        "The paper's rows as printed, under the row's gains, move off the true arm by up to "
        f"{worst[PAPER]:.3g}°; their inertial parameters with the true friction by up to "
        f"{worst[PAPER_INERTIAL]:.3g}°.",
        f"C, gains unknown and {KNOWN} known: kp comes out within {100 * gains:.2g} %; kv and D only together, "
        "as their difference.",
    ]
    if (last.gains.kp, last.gains.kv) == _PRINTED:
        mean, largest = ANGLE_ERROR_OTHER_GAINS_DEG["evaluate"]
        own = last.errors[PAPER]
        said.append(
            f"For 11.5 / -11.5 the paper prints {mean} / {largest}° (mean / max, evaluating); its row, "
            f"simulated under these gains against an arm driven with them, gives {own.mean:.3g} / "
            f"{own.worst:.3g}°."
        )
    return tuple(said)
