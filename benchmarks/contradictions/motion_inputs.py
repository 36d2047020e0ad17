"""Motion that contradicts itself: turns, degrees, clocks, encoders that stand still; and faultless motion."""

import numpy as np

from benchmarks.contradictions.commands import dynamics, kinematics
from benchmarks.contradictions.drawn import Case, Cases, Drawn
from benchmarks.contradictions.motions import changed, frozen, motion, reaching, with_tip, wrapped
from benchmarks.contradictions.verdicts import holds, holds_or_says, says, silent, silent_and_right

ACCELERATIONS = ("q", "dq", "ddq", "tau")


def faultless(drawn: Drawn) -> Cases:
    """Yield motion without a fault, of which no question may be asked."""
    where, arm, several = drawn.where, drawn.arm, drawn.several
    for roles in (("q", "tau"), ACCELERATIONS):
        run = dynamics(arm, drawn.learn, roles, drawn.evaluate)
        yield Case("faultless", f"{where} {roles}", run, silent_and_right(arm))
    tip = kinematics(reaching(several), with_tip(several, drawn.other))
    yield Case("faultless", f"{where} kinematics", tip, silent)


def turns(drawn: Drawn) -> Cases:
    """Yield angles that jump by a turn."""
    where, several = drawn.where, drawn.several
    big = motion(several, drawn.seed + 30, size=3.0)
    jumping = changed(big, q=wrapped(big["q"]))
    yield Case("turns", where, dynamics(several, jumping), holds(several, "unwrapped"))
    yield Case("turns", f"{where} dq", dynamics(several, jumping, ACCELERATIONS), holds(several, "unwrapped"))
    tip = kinematics(reaching(several), with_tip(several, jumping, big["q"]))
    yield Case("turns", f"{where} kinematics", tip, lambda ran: ran.code == 0)


def degrees(drawn: Drawn) -> Cases:
    """Yield angles in degrees: all, some, of one joint, and with their unit named."""
    where, arm, several, m, s = drawn.where, drawn.arm, drawn.several, drawn.learn, drawn.other
    deg = {role: np.rad2deg(m[role]) for role in ("q", "dq", "ddq")}
    yield Case("degrees", where, dynamics(arm, changed(m, **deg)), says("degrees"))
    yield Case("degrees", f"{where} dq too", dynamics(arm, changed(m, **deg), ACCELERATIONS), says("degrees"))
    alone = changed(m, q=deg["q"])
    yield Case("degrees", f"{where} q alone", dynamics(arm, alone, ACCELERATIONS), says("degrees"))
    yield Case("degrees", f"{where} named", dynamics(arm, alone, ("q", "tau"), q="{} [deg]"), holds(arm))
    joint = drawn.seed % several.n_joint
    one = np.where(np.arange(several.n_joint) == joint, 180.0 / np.pi, 1.0)
    run = dynamics(several, changed(s, q=s["q"] * one))
    name = f"{several.name}, seed {drawn.seed} one joint"
    yield Case("degrees", name, run, says(f"q{joint + 1} in degrees", 2))


def clocks(drawn: Drawn) -> Cases:
    """Yield times in other units, and a leap of a day."""
    where, arm, m = drawn.where, drawn.arm, drawn.learn
    for unit, factor in (("ms", 1e3), ("us", 1e6), ("ns", 1e9)):
        run = dynamics(arm, changed(m, t=m["t"] * factor))
        yield Case("time", f"{where} {unit}", run, says("milliseconds|microseconds|nanoseconds"))
    named = dynamics(arm, changed(m, t=m["t"] * 1e3), ("q", "tau"), t="t [ms]")
    yield Case("time", f"{where} [ms]", named, holds(arm))
    leap = m["t"].copy()
    leap[len(leap) // 2 :] += 86400.0
    yield Case("leap of a day", where, dynamics(arm, changed(m, t=leap)), says("gap|hole|leap|day|parted"))


def geometry(drawn: Drawn) -> Cases:
    """Yield a tip in millimetres, and lengths that were guessed."""
    several = drawn.several
    tip = with_tip(several, drawn.other)
    run = kinematics(reaching(several), changed(tip, tip=1e3 * tip["tip"]))
    yield Case("tip", f"{drawn.where} mm", run, says("millimetres"))
    guess = several.with_joints(a_m=np.array([0.8 * joint.a_m + 0.05 for joint in several.joints]))
    lengths = says("Lengths are taken from the arm file")
    yield Case("guessed lengths", drawn.where, dynamics(guess, drawn.other), lengths)


def encoders(drawn: Drawn) -> Cases:
    """Yield encoders that stand still for a while, and values that are repeated."""
    where, arm, several, m, s = drawn.where, drawn.arm, drawn.several, drawn.learn, drawn.other
    begin, right = 400 + 50 * (drawn.seed % 14), holds_or_says(arm, "encoder")
    yield Case("frozen encoder", where, dynamics(arm, frozen(m, arm.n_joint - 1, begin, 40)), right)
    yield Case("frozen encoder", f"{where} long", dynamics(arm, frozen(m, 0, 700, 150)), right)
    whole = dynamics(several, frozen(s, 1, 0, len(s["t"])))
    yield Case("frozen encoder", f"{where} all", whole, says("encoder"))
    twice = {role: np.repeat(values[::2], 2, axis=0) for role, values in m.items() if role != "t"}
    yield Case("repeats", where, dynamics(arm, {"t": m["t"], **twice}), says("repeat"))
