"""What `fitter dynamics` says, sentence by sentence."""

from types import SimpleNamespace

import numpy as np
import pytest

from arm.model import Arm, Joint
from fitter.commands.dynamics_said import say_compared, say_controller, say_fit, say_ratios
from fitter.dynamics.evaluation import Score
from fitter.dynamics.free_swing import FreeSwing
from fitter.search.fitted_parameter import FittedParameter
from limbcal.note import Note

ARM = Arm("bench", (Joint(), Joint()))
MASS = FittedParameter(1.25, 0.1, "kg", True)
GAPS = (Note("gap", "a gap was left out"),)


def said(capsys: pytest.CaptureFixture[str]) -> str:
    out, err = capsys.readouterr()
    return " ".join((out + err).split())


def fit(**fields: object) -> SimpleNamespace:
    known = {"arm": ARM, "samples": 1200, "parameters": {"m1": MASS}, "notes": GAPS}
    return SimpleNamespace(**known, condition_number=12.345, objective="torque", **fields)


def test_a_fit_is_said_with_scores_and_what_is_to_be_known(capsys: pytest.CaptureFixture[str]) -> None:
    learn = Score((0.123456, 2.0), 0.5, 1.25, 0.6, (0.987, -0.2))
    hidden = SimpleNamespace(sentences=lambda: ("m2 is not revealed",))
    other = SimpleNamespace(name="other", parameters={"m1": 1.75})
    say_fit(fit(), [other], learn, None, hidden)
    text = said(capsys)
    assert "bench: 1200 samples, condition 12.3, by torque" in text
    assert (
        "learning: torque rms 0.1235, 2 N·m a joint, 98.7 %, nothing of the power explained; "
        "simulated angle off by 0.5° mean, 1.25° max" in text
    )
    assert "evaluating" not in text and "m1" in text and "other" in text and "1.75" in text
    assert "a gap was left out" in text and "m2 is not revealed" in text


@pytest.mark.parametrize(
    ("off", "words"), [(np.inf, "the simulated motion runs away"), (np.nan, "no joint turns"), (0.0, "0° max")]
)
def test_angles_that_are_no_numbers_are_said_in_words(
    capsys: pytest.CaptureFixture[str], off: float, words: str
) -> None:
    one = Score((1.0,), off, off, off, (0.5,))
    law = fit(
        law="pd",
        gains={"kp1": MASS},
        fixed_by="the torque fixes the scale",
        only_together=("kp1 with m1",),
        law_misfit=SimpleNamespace(sentence="the law is of this form"),
    )
    say_controller(law, {"learn": None, "evaluate": one})
    text = said(capsys)
    assert text.count(words) == 1 and "evaluating: torque rms 1 N·m a joint, 50 %" in text
    assert "learning:" not in text
    for part in ("gains of law 'pd' learnt along", "kp1", "the torque fixes the scale", "kp1 with m1"):
        assert part in text, part
    assert "the law is of this form" in text and "a gap was left out" in text


def ratio(name: str, spring: bool, value: float = 2.0, stiffening: FittedParameter | None = None) -> object:
    sprung, rigid = FittedParameter(value, 0.5, "1/s²", True), FittedParameter(1.0, 0.5, "1/s²", False)
    shown = stiffening or sprung
    significant = abs(shown.value) > shown.half_width
    return SimpleNamespace(
        name=name, rigid=rigid, sprung=sprung, stiffening=stiffening, is_spring=spring, is_significant=significant
    )


def test_a_spring_is_warned_of_where_it_is_significant(capsys: pytest.CaptureFixture[str]) -> None:
    say_ratios(FreeSwing((ratio("k1", True), ratio("k2", True, 0.9), ratio("g1", False)), ()))
    text = said(capsys)
    assert "k1: something elastic turns this joint, too; expected ratios with springs" in text
    assert "k2: something" not in text and "g1: something" not in text
    assert "2 ± 0.98" in text and "stiff ends" not in text
    assert "1 ±" not in text  # what says nothing has a dash


@pytest.mark.parametrize(("side", "way"), [(1.0, "forwards"), (-1.0, "backwards"), (0.0, "backwards")])
def test_an_end_that_stiffens_is_counted_from_one(
    capsys: pytest.CaptureFixture[str], side: float, way: str
) -> None:
    end = SimpleNamespace(joint=1, angle_rad=1.23456, side=side)
    stiff = FittedParameter(3.0, 0.5, "1/s²", True)
    say_ratios(FreeSwing((ratio("k1", True, stiffening=stiff),), (end,)))
    text = said(capsys)
    assert f"joint 2 stiffens {way} towards 1.23 rad" in text and "3 ± 0.98" in text
    assert text.count("expected ratios with springs and stiff ends") == 2


def test_other_arms_are_said_for_the_trials_that_there_are(capsys: pytest.CaptureFixture[str]) -> None:
    say_compared(ARM, {"cad": {"torque_rms_N_m": {"learn": [0.5, 0.25], "evaluate": None}}})
    assert said(capsys) == "cad, learning: torque rms 0.5, 0.25 N·m a joint"


@pytest.mark.parametrize(
    ("types", "words"),
    [
        (("prismatic", "prismatic"), "force rms 0.5, 0.25 N a joint"),
        (("revolute", "prismatic"), "torque rms 0.5 N·m, 0.25 N"),
    ],
)
def test_what_slides_has_forces(capsys: pytest.CaptureFixture[str], types: tuple[str, str], words: str) -> None:
    arm = Arm("slide", tuple(Joint(kind) for kind in types))  # type: ignore[arg-type]
    say_compared(arm, {"cad": {"torque_rms_N_m": {"learn": [0.5, 0.25], "evaluate": None}}})
    assert said(capsys) == f"cad, learning: {words}"
