"""Readings of accelerometers that contradict the arm: units, gravity, clocks."""

from dataclasses import replace

from arm.arm_file import load_arm
from arm.model import STANDARD_GRAVITY_M_S2
from benchmarks.contradictions.commands import track
from benchmarks.contradictions.drawn import Case, Cases, Drawn
from benchmarks.contradictions.motions import readings
from benchmarks.contradictions.verdicts import says


def accelerations(drawn: Drawn) -> Cases:
    """Yield readings in g, without gravity, with its sign reversed, and with times in milliseconds."""
    seed = drawn.seed
    arm, flat = load_arm("dd-arm" if seed % 2 else "dd-arm-vertical"), load_arm("dd-arm")
    t, a = readings(arm, seed)
    silent = track(arm, t, a)
    yield Case("readings", f"{arm.name} faultless", silent, lambda ran: ran.code == 0 and "?" not in ran.said)
    yield Case("readings", f"{arm.name} in g", track(arm, t, a / STANDARD_GRAVITY_M_S2), says("in g"))
    still = readings(replace(arm, gravity_m_s2=(0.0, 0.0, 0.0)), seed)[1]
    yield Case("readings", f"{arm.name} no gravity", track(arm, t, still), says("without gravity"))
    t, a = readings(flat, seed + 5)
    down = a.copy()
    down[:, 2::3] *= -1.0
    yield Case("readings", f"gravity's sign {seed}", track(flat, t, down), says("gravity"))
    yield Case("readings", f"{flat.name} ms {seed}", track(flat, t * 1e3, a), says("is t in"))
