"""What the terminal shows while a stream is followed."""

from rich.console import Console

from fitter.live.calibration import Calibration
from fitter.live.live_table import live_table
from fitter.live.stream import MotionAssembler
from limbcal.digits import with_half_width


def shown(calibration, assembler=None, missed=0):
    console = Console(width=200, record=True, force_terminal=False, file=None, quiet=False)
    with console.capture() as capture:
        console.print(live_table(calibration, assembler or MotionAssembler(), missed))
    return capture.get()


def test_before_anything_is_known(short_run):
    text = shown(Calibration(short_run.arm))
    assert "0 frames, 0 messages missed, at rest; 0 learnt from, 0 for evaluation" in text
    assert "geometry: nothing is identified yet" in text


def test_while_the_arm_moves(short_run):
    assembler = MotionAssembler()
    for message in short_run.messages:
        assembler.feed(*message)
        if assembler.moving and assembler.trial == 3:
            break
    assert "7 messages missed, motion 3 (evaluate); 0 learnt" in shown(Calibration(short_run.arm), assembler, 7)


def test_what_was_learnt_is_shown_and_what_was_not_is_left_out(calibration):
    text = shown(calibration)
    assert "at rest; 2 learnt from, 1 for evaluation" in text
    assert f"geometry: generation {calibration.geometry.generations}, tip off by" in text
    a1 = calibration.kinematics().parameters["a1"]
    assert all(cell in text for cell in ("a1", *with_half_width(a1.value, a1.half_width)))
    assert "I1+m2*L1^2" in text and "kg m^2" in text
    assert "beta1" not in text and "F1" not in text
