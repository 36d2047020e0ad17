"""Table 5: other laws, in each of the three ways that can be meant, and what a motion says of its law's form."""

from collections.abc import Mapping, Sequence

from arm.bench import Bench
from arm.model import Arm, Law
from fitter.controller.controller import ControllerFit, fit_controller
from fitter.controller.law_columns import EQUATIONS
from fitter.report.published import ANGLE_ERROR_OTHER_LAW_DEG, PARAMETERS, TABLE5, TRUE
from reproduction.bench_data import bench_trials, noisy_trials, true_arm, under
from reproduction.experiment import Cell, Experiment, Grid, Settings
from reproduction.laws import (
    CASE_A,
    CASE_B,
    CASE_B_TRUE,
    KNOWN,
    NOISE,
    PAPER,
    QUICK_BENCH,
    QUICK_SAMPLES,
    SAMPLES,
    TRUE_KP,
    TRUE_KV,
    Gains,
    Row,
    benches,
    document,
    error_grid,
    fitted_values,
    gain_grid,
    inertial_ratios,
    parameter_grid,
    row,
)

_QUICK_ROWS: list[tuple[float, float | None, float | None]] = [(5.5, None, None)]
#: What an arm is driven by where forms of the law are distinguished.
_DRIVES: dict[Law, tuple[float, float | None, float | None]] = {
    "pd": (TRUE_KP, TRUE_KV, None),
    "pda": (TRUE_KP, TRUE_KV, -1.5),
    "p": (5.5, None, None),
}
_FRICTION = ("D1", "D2")
#: What drove, what was assumed, whether the viscous friction was known.
_FORMS: tuple[tuple[Law, Law, bool], ...] = (
    ("pd", "pd", False),
    ("pd", "p", False),
    ("pd", "p", True),
    ("pda", "pd", False),
    ("pda", "p", True),
    ("p", "pd", True),
)
_QUICK_FORMS = _FORMS[3:4]


def run(settings: Settings) -> Experiment:
    """Repeat Table 5: driven by other laws, other laws assumed, gains unknown; then the forms distinguished."""
    arm = true_arm()
    samples = settings.samples or (QUICK_SAMPLES if settings.quick else SAMPLES)
    chosen = _QUICK_ROWS if settings.quick else list(TABLE5)
    size = QUICK_BENCH if settings.quick else Bench()
    own = benches(arm, samples, settings.seed, size)
    rows = []
    for kp, kv, ka in chosen:
        law: Law = "p" if kv is None else "pda"
        settings.progress(f"table5: law {EQUATIONS[law]}, kp {kp:g}")
        rows.append(row(arm, own, Gains(law, kp, kv, ka, TABLE5[kp, kv, ka]), samples, settings.seed, size))
    settings.progress("table5: forms of the law")
    forms = told_forms(arm, _QUICK_FORMS if settings.quick else _FORMS, samples, settings.seed, size)
    return Experiment(
        name="table5",
        title="Table 5: other laws",
        assumptions=(
            "The paper does not print whether the arm was driven by a row's law or this was only assumed, so "
            "both are done. A: driven by it, and it is known. B: driven by (5) with 9.5 / -9.5, the row's law "
            f"is assumed. C: driven by the row's; its form and {KNOWN} are known, its gains are not, and the "
            f"angles have white noise of {100 * NOISE:g} % of their spread. A and B have no noise.",
            f"{samples} samples of {size.learning} learning motions, as for Table 4.",
            "Errors of angles are those of the evaluating motions, simulated from their first state to their end.",
            f"Forms of the law: driven as named, {KNOWN} known; once with friction unknown, and once with the "
            "viscous frictions D known as well. ± is half of a 95 % interval.",
        ),
        grids=(
            parameter_grid("Dynamic parameters", rows),
            gain_grid(f"C: gains found, {KNOWN} being known", rows),
            error_grid("Simulated against true angles", rows),
            _form_grid(forms),
        ),
        findings=_findings(rows, forms),
        document={
            "samples": samples,
            "known": KNOWN,
            "rows": document(rows),
            "forms": [
                {
                    "driven_by": drive,
                    "assumed": assumed,
                    "viscous_friction_known": known,
                    "torque_share": list(fit.law_misfit.torque_share),
                    "fits": fit.law_misfit.fits,
                    "missing": list(fit.law_misfit.missing),
                    "sentence": fit.law_misfit.sentence,
                }
                for (drive, assumed, known), fit in forms.items()
            ],
        },
    )


def told_forms(
    arm: Arm, asked: Sequence[tuple[Law, Law, bool]], samples: int, seed: int, size: Bench
) -> dict[tuple[Law, Law, bool], ControllerFit]:
    """Return fits by what drove the arm, what was assumed, and whether the viscous friction was known."""
    true = dict(zip(PARAMETERS, TRUE, strict=True))
    found = {}
    for drive, assumed, known in asked:
        exact = bench_trials(under(arm, drive, *_DRIVES[drive]), samples, seed, size.learning)
        trials = noisy_trials(exact, NOISE, seed)
        fixed = {name: true[name] for name in (KNOWN, *(_FRICTION if known else ()))}
        kv, ka = (-1.0 if assumed in laws else None for laws in (("pd", "pda"), ("pda",)))
        found[drive, assumed, known] = fit_controller(under(arm, assumed, 1.0, kv, ka), trials, fixed=fixed)
    return found


def _form_grid(forms: Mapping[tuple[Law, Law, bool], ControllerFit]) -> Grid:
    cells: list[tuple[Cell, ...]] = []
    for (drive, assumed, known), fit in forms.items():
        unexplained = ", ".join(f"{100 * share:.3g} %" for share in fit.law_misfit.torque_share)
        cells.append(
            (
                EQUATIONS[drive],
                EQUATIONS[assumed],
                "known" if known else "sought",
                unexplained,
                ", ".join(fit.law_misfit.missing) or "nothing",
                fit.law_misfit.sentence,
            )
        )
    header = ("driven by", "assumed", "D", "torque unexplained (mean square)", "missing", "said")
    return Grid("What the motion says of its law's form", header, tuple(cells))


def _findings(rows: Sequence[Row], forms: Mapping[tuple[Law, Law, bool], ControllerFit]) -> tuple[str, ...]:
    right = max(abs(x - 1.0) for r in rows for x in inertial_ratios(fitted_values(r.driven.parameters)))
    wrong = [x for r in rows for x in inertial_ratios(fitted_values(r.assumed.parameters))]
    paper = [x for r in rows for x in inertial_ratios(r.gains.paper)]
    largest = {case: max(r.errors[case].worst for r in rows) for case in (CASE_A, PAPER)}
    said = [
        f"A, driven by the law that is assumed: every inertial parameter is within {100 * right:.2g} % of the "
        f"truth; the simulation is off by {largest[CASE_A]:.2g}° at most, law (7) included, which leaves the "
        "arm swinging.",
        f"B, driven by (5) and another law assumed: inertial parameters are {min(wrong):.3g} to "
        f"{max(wrong):.3g} times the true ones. The paper's are {min(paper):.3g} to {max(paper):.3g} times: it "
        "drove the arm by the row's law (A), or fenced the search in.",
    ]
    for r in rows:
        if r.gains.law == "p":
            friction = [r.assumed.parameters[name].value for name in _FRICTION]
            said.append(
                f"B, law (7) with kp {r.gains.kp:g} assumed: viscous friction comes out as {friction[0]:.3g} "
                f"and {friction[1]:.3g} N m s/rad and does what kv did; under (7) the simulation is off by "
                f"{r.errors[CASE_B].worst:.2g}° at most, with these parameters under (5) by "
                f"{_degrees(r.errors[CASE_B_TRUE].worst)}."
            )
    mean, worst = ANGLE_ERROR_OTHER_LAW_DEG["evaluate"]
    swinging = [r.errors[PAPER] for r in rows if r.gains.law == "p"]
    if swinging:
        said.append(
            f"The paper's largest error under law (7), {worst}° ({mean}° mean), is put down to the "
            "integration. Its rows as printed, simulated by Runge-Kutta on the full state under (7) against "
            f"an arm that was driven so, are off by up to {_degrees(max(error.worst for error in swinging))}: "
            "nothing damps the swinging, so a small error of any parameter grows into a delay."
        )
    said += [
        f"Driven by {EQUATIONS[drive]}, {EQUATIONS[assumed]} assumed, D {'known' if known else 'sought'}: "
        f"{fit.law_misfit.sentence}."
        for (drive, assumed, known), fit in forms.items()
        if drive != assumed and not fit.law_misfit.fits
    ]
    return tuple(said)


def _degrees(value: float) -> str:
    return "infinity (it runs away)" if value == float("inf") else f"{value:.3g}°"
