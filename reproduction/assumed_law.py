"""Fig. 8 under law (7): its gains unknown, or the law itself another one.

Law (7) has no damping, and the arm's friction is next to none: driven by it the arm never comes to rest. Each
motion therefore begins with the arm held still at the target before.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from arm.bench import Bench
from arm.model import Arm, Control
from fitter.controller.controller import ControllerFit, document, fit_controller
from fitter.data.trial import Trial
from fitter.dynamics.fit import fit_dynamics
from fitter.report.published import ANGLE_ERROR_OTHER_LAW_DEG
from limbcal.digits import NORMAL_95
from reproduction.bench_data import bench_trials, true_arm
from reproduction.experiment import Document, Grid, Settings
from reproduction.motion_pair import (
    AngleErrors,
    angle_errors,
    motion_by_motion,
    under_the_same_control,
)
from reproduction.sensed_bench import sensed_one_by_one
from reproduction.table2 import QUICK_BENCH, bench_of

#: The real arm's gains, and what somebody takes them for: both too large or too small, and not alike.
_REAL, _TAKEN = Control("p", (9.5, 9.5)), Control("p", (11.5, 7.5))
_KNOWN = "law (7), gains known"
_BLIND = "law (7), gains taken for 11.5 and 7.5"
_FOUND = "law (7), kp1 taken for 11.5, kp2 found"
_ALIKE = "driven by (5), (7) assumed"
_FRICTION = ("D1", "D2")


@dataclass(frozen=True)
class AssumedLaw:
    """What Fig. 8 says of law (7)."""

    assumptions: tuple[str, ...]
    grid: Grid
    findings: tuple[str, ...]
    document: Document


def assumed_law(settings: Settings, geometry: Arm, real_pd: Sequence[Trial]) -> AssumedLaw:
    """Calibrate under law (7) with gains known, wrong and found, and take law (5) for it.

    Parameters
    ----------
    settings : Settings
    geometry : Arm
        With the lengths as they were calibrated.
    real_pd : sequence of Trial
        The real arm's motions under law (5).
    """
    bench = QUICK_BENCH if settings.quick else Bench()
    learn = list(sensed_one_by_one(_REAL, settings.seed, bench.learning, bench.rate_hz).sensed)
    each = len(real_pd[0].t)
    driven = replace(true_arm(), control=_REAL)
    real = bench_trials(driven, bench.learning * each, settings.seed, bench.learning, bench.evaluating, held=True)
    known, taken = (replace(geometry, control=control) for control in (_REAL, _TAKEN))
    settings.progress(f"fig8: {_KNOWN}")
    with_gains = fit_dynamics(known, learn, objective="torque", seed=settings.seed)
    settings.progress(f"fig8: {_BLIND}")
    blind = fit_dynamics(taken, learn, objective="torque", seed=settings.seed)
    settings.progress(f"fig8: {_FOUND}")
    found = fit_controller(taken, learn)
    errors = {
        name: angle_errors(real, under_the_same_control(arm, real, settings.seed, held=True))
        for name, arm in ((_KNOWN, with_gains.arm), (_BLIND, blind.arm), (_FOUND, found.arm))
    }
    settings.progress(f"fig8: {_ALIKE}")
    mistaken = [trial for trial in bench_of(settings).sensed if trial.role == "learn"]
    alike = fit_dynamics(known, mistaken, objective="torque", seed=settings.seed)
    errors[_ALIKE] = angle_errors(real_pd, under_the_same_control(alike.arm, real_pd, settings.seed))
    own = {name: with_gains.parameters[name].value for name in _FRICTION}
    known_friction = fit_controller(known, mistaken, fixed={"kp1": _REAL.kp[0], **own})
    never_held = bench_trials(driven, bench.learning * each, settings.seed, bench.learning, bench.evaluating)
    swinging = angle_errors(never_held, motion_by_motion(found.arm, never_held))
    paper = AngleErrors(ANGLE_ERROR_OTHER_LAW_DEG["learn"], ANGLE_ERROR_OTHER_LAW_DEG["evaluate"])
    rows = [("paper, “law (7)”, its gains", *paper.cells()), *((n, *e.cells()) for n, e in errors.items())]
    header = ("calibration", "learning, mean", "learning, max", "evaluating, mean", "evaluating, max")
    return AssumedLaw(
        assumptions=(
            "Law (7) damps nothing and the arm goes on swinging, so each motion begins with the arm held still at "
            "the target before, and is a recording of its own. The lengths are those of Table 2.",
        ),
        grid=Grid("Law (7): virtual against true angles [deg]", header, tuple(rows)),
        findings=(
            _of_gains(found, errors),
            "Law (7), never held still: the swing grows with every new target. The arm that was calibrated with "
            f"kp2 found, begun anew with each motion, is off by {swinging.learn[0]:.2f}° mean and "
            f"{swinging.learn[1]:.1f}° max learning, by {swinging.evaluate[0]:.2f}° and "
            f"{swinging.evaluate[1]:.0f}° evaluating: once the arm turns over, a motion's end hangs on the last "
            "digit of its beginning. An error like the paper's 102.7° needs no delay of the integration.",
            "Driven by (5) with (7) assumed, no residual betrays the law: a damping of the controller and one of "
            f"the joint are the same term, and the fit finds D = {alike.parameters['D1'].value:.2f} and "
            f"{alike.parameters['D2'].value:.2f} N m s/rad, which is -kv. The motion comes out as well as with "
            "(5).",
            "With the joints' own friction held, as it shows under law (7) "
            f"({', '.join(f'{name} = {value:.4f}' for name, value in own.items())}): "
            f"{known_friction.law_misfit.sentence}.",
        ),
        document={
            "angle_error_deg": {name: e.document() for name, e in errors.items()},
            "never_held_angle_error_deg": swinging.document(),
            "gains_found": document(found),
            "wrong_law": {
                "friction_free": {name: p.document() for name, p in alike.parameters.items()},
                "friction_held": document(known_friction),
            },
        },
    )


def _of_gains(found: ControllerFit, errors: dict[str, AngleErrors]) -> str:
    kp2 = found.gains["kp2"]
    blind, best = errors[_BLIND].evaluate, errors[_FOUND].evaluate
    return (
        f"Law (7) with gains taken for 11.5 and 7.5 (truly 9.5 and 9.5): plain eq. (9) is off by {blind[0]:.1f}° "
        f"mean and {blind[1]:.0f}° max evaluating. With the gains found up to their common factor, kp2 = "
        f"{kp2.value:.3f} ± {NORMAL_95 * kp2.std:.1g} where kp1 counts as 11.5, it is {best[0]:.2f}° and "
        f"{best[1]:.2f}° (goal: 5° max): {found.fixed_by}."
    )
