"""A diagnosis in plain words: what is wrong, how much, where, and what every verdict means."""

import math
from collections.abc import Sequence

import numpy as np

from arm.effects.catalogue import catalogue
from arm.model import Arm
from fitter.diagnosis.diagnosis import Diagnosis
from fitter.diagnosis.finding import NamedCause
from fitter.diagnosis.held_out_error import Errors
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.model import Hypothesis
from fitter.diagnosis.payload import Payload
from fitter.search.fitted_parameter import FittedParameter


def headline(found: Diagnosis) -> str:
    """Return the one sentence that says what is wrong, and how much."""
    finding = found.finding
    if finding.verdict == "none":
        return f"Nothing is wrong that this data could show: {_sizes(found, finding.before)}, and that is noise."
    why = "and no effect of the catalogue explains it"
    if finding.verdict != "unexplained":
        why = f"because {_and([_reason(group) for group in groups(found)])}"
    return f"The simulation is wrong, {why}: {_sizes(found, finding.before)}."


def groups(found: Diagnosis) -> list[list[NamedCause]]:
    """Return the causes, each with those that explain as much in its stead."""
    listed: list[list[NamedCause]] = []
    for cause in found.finding.causes:
        if cause.in_stead:
            listed[-1].append(cause)
        else:
            listed.append([cause])
    return listed


def place(joints: Sequence[int], bearer: str = "the whole arm") -> str:
    """Return where an effect is: joints from 1."""
    if not joints:
        return bearer
    return f"joint {joints[0]}" if len(joints) == 1 else f"joints {_and([str(j) for j in joints])}"


def when(cause: NamedCause) -> str:
    """Return the trials or the time of a cause that is not always there, or nothing."""
    if "since_s" in cause.parameters:
        return f"from {cause.parameters['since_s'].value:.1f} s of {cause.where['trial']} on"
    trials = cause.where.get("trials")
    if isinstance(trials, list):
        return f"in trial{'s' if len(trials) > 1 else ''} {_and([str(trial) for trial in trials])}"
    if "start_s" in cause.parameters:
        return f"at {cause.parameters['start_s'].value:.2f} s of {cause.where['trial']}"
    return ""


def candidate_name(hypothesis: Hypothesis) -> str:
    """Return what a candidate is called: effect and place, and when, where that is part of it."""
    name = f"{hypothesis.kind.name}, {place([j + 1 for j in hypothesis.joints])}"
    if isinstance(hypothesis, JointHypothesis) and "side" in hypothesis.choice:
        return f"{name}, {'upper' if hypothesis.choice['side'] > 0.0 else 'lower'}"
    if isinstance(hypothesis, Payload):
        late = hypothesis.since_s
        return f"{name}, in some trials" if late is None else f"{name}, from some time on"
    return name


def sentence(effect: str) -> str:
    """Return the catalogue's sentence on an effect, beginning with a capital."""
    text = catalogue()[effect].sentence
    return text[0].upper() + text[1:]


def measured(parameter: FittedParameter) -> tuple[str, str]:
    """Return a value and half of its 95 % interval, with its significant digits; angles also in degrees."""
    interval = parameter.ci95
    half = math.nan if interval is None else (interval[1] - interval[0]) / 2.0
    value, around = rounded(parameter.value, half), "not known"
    if interval is not None:
        around = f"± {half:.2g}"
    if parameter.unit == "rad":
        value += f" ({math.degrees(parameter.value):.3g}°)"
    return value, around


def rounded(value: float, half: float) -> str:
    """Return a value to the second digit of its uncertainty."""
    if not math.isfinite(value):
        return "–"
    if not (math.isfinite(half) and half > 0.0) or abs(value) >= 1e6:
        return f"{value:.4g}"
    digits = 1 - math.floor(math.log10(half))
    return f"{value:.{min(max(digits, 0), 9)}f}"


def percent(share: float) -> str:
    """Return a share in percent, or a dash."""
    return f"{100.0 * share:.3g} %" if math.isfinite(share) else "–"


def fell(share: float) -> str:
    """Return by how much an error fell, or grew, after "the error …"."""
    if not math.isfinite(share):
        return "cannot be compared, for a simulation ran away"
    if share >= 0.0:
        return f"falls by {percent(share)}"
    return f"grows by {percent(-share)}" if share > -1.0 else f"grows to {1.0 - share:.3g} times what it was"


def angle(error_deg: float) -> str:
    """Return an error of simulated angles [deg]."""
    return f"{error_deg:.3g}" if math.isfinite(error_deg) else "ran away"


def units(arm: Arm) -> list[str]:
    """Return the unit of every joint's torque or force."""
    return ["N m" if joint.type == "revolute" else "N" for joint in arm.joints]


def whiteness(found: Diagnosis) -> str:
    """Return the residual in words, and what it depends on."""
    discrepancy = found.finding.discrepancy
    white = (
        "What is left is white noise: neighbouring instants have nothing to do with one another."
        if discrepancy.white
        else "What is left is not white: its spectrum is not that of the noise alone."
    )
    if constant := trial_offsets(discrepancy.trial_offsets_N_m, found.regression.arm):
        white = f"{white} {constant[0].upper()}{constant[1:]}."
    if not discrepancy.depends_on:
        return f"{white} No smooth function of the joints' motion, torque and time explains a notable share."
    known = (
        f"It depends on {_and(list(discrepancy.depends_on))}: a flexible function of that alone would explain "
        f"{percent(discrepancy.explained)} of the residual, on trials that it was not fitted to (at joint "
        f"{discrepancy.joint})."
    )
    hint = f" A formula, as a hint: {discrepancy.formula} (N m, rad, s)." if discrepancy.formula else ""
    return f"{white} {known}{hint}"


def trial_offsets(sizes: Sequence[float], arm: Arm) -> str:
    """Return in words what constant torque each trial lacks, by its standard deviations; empty if none does.

    Parameters
    ----------
    sizes : sequence of float [N m or N]
        One of every joint.
    arm : Arm
    """
    units_of = units(arm)
    parts = [f"{size:.2g} {units_of[j]} rms at joint {j + 1}" for j, size in enumerate(sizes) if size > 0.0]
    if not parts:
        return ""
    why = "an angle that is set to zero anew before each trial does that, or a cable"
    return f"each trial lacks a constant torque of its own, {_and(parts)}: {why}"


def assumptions(found: Diagnosis) -> list[str]:
    """Return what a diagnosis takes for granted."""
    weighting, law = found.regression.weighting, found.regression.arm.control.law
    drive = "measured torque" if law == "measured" else f"the control law ({law}) and its gains in the arm file"
    noise = ", ".join(
        f"{rms:.2g} {unit}" for rms, unit in zip(weighting.torque_noise, units(found.regression.arm), strict=True)
    )
    denied = f" The base model was denied {', '.join(found.regression.denied)}." if found.regression.denied else ""
    return [
        "Geometry and gravity are those of the arm file; masses and friction were learnt anew from the learning "
        f"trials.{denied}",
        f"What drives the arm is {drive}, unless an effect of the drive was named.",
        f"White noise of the torque is {noise} rms a sample, by its own quick changes; the angles' likewise. "
        f"Beyond {weighting.seen_hz:.3g} Hz noise hides the torque, so the pictures end there.",
        "While a joint stands still its friction may hold any torque: nothing is concluded from it.",
        f"Squared, the base model leaves {1.0 + found.finding.structure:.3g} times what noise alone would.",
        *(f"{a} and {b} look alike in this data." for a, b in found.finding.confusable),
    ]


def _sizes(found: Diagnosis, errors: Errors) -> str:
    asked = [np.nan_to_num(motion.u) for motion in found.motions if not motion.learn]
    drive = np.sqrt(np.mean(np.concatenate(asked) ** 2, axis=0))
    worst = int(np.argmax(errors.torque_rms / np.maximum(drive, 1e-12)))
    share = errors.torque_rms[worst] / max(float(drive[worst]), 1e-12)
    unit = units(found.regression.arm)[worst]
    torque = f"joint {worst + 1} needs {errors.torque_rms[worst]:.3g} {unit} rms of torque"
    beside = f" ({percent(share)} of its drive)" if np.any(drive > 1e-9) else ""
    sizes, unit = (errors.angle_deg, "°") if errors.angle_deg is not None else (errors.position_m, " m")
    assert sizes is not None  # every joint turns or slides
    if not np.isfinite(sizes["max"]):
        return f"{torque} that the model does not have{beside}, and the simulation runs away"
    return (
        f"{torque} that the model does not have{beside}, and simulated "
        f"{'angles' if unit == '°' else 'positions'} are off by "
        f"{sizes['mean']:.2g}{unit} on the mean and {sizes['max']:.2g}{unit} at most"
    )


def _reason(group: Sequence[NamedCause]) -> str:
    said = []
    for cause in group:
        where = f" ({place(cause.joints)})" if cause.joints else ""
        said.append(f"{catalogue()[cause.effect].sentence}{where}")
    return said[0] if len(said) == 1 else f"either {' or '.join(said)} (this data cannot tell)"


def _and(words: Sequence[str]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else "".join(words)
