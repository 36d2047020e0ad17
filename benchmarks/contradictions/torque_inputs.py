"""Torque that contradicts the motion: its sign, order and unit, what is cut off, late or another motion's."""

from dataclasses import replace

import numpy as np

from arm.model import Control
from benchmarks.contradictions.commands import diagnose, dynamics, kinematics, simulate, written
from benchmarks.contradictions.drawn import Case, Cases, Drawn
from benchmarks.contradictions.motions import changed, delayed, motion, reaching, upside_down, with_tip
from benchmarks.contradictions.verdicts import holds, holds_or_says, says


def signs(drawn: Drawn) -> Cases:
    """Yield torque with another sign, in another order, and gravity that points up."""
    where, arm, several = drawn.where, drawn.arm, drawn.several
    m, s, held = drawn.learn, drawn.other, drawn.evaluate
    reversed_, load = changed(m, tau=-m["tau"]), says("load's", 4)
    yield Case("torque sign", where, dynamics(arm, reversed_), load)
    first = np.where(np.arange(several.n_joint) == 0, -1.0, 1.0)
    yield Case("torque sign", f"{where} last", dynamics(several, changed(s, tau=s["tau"] * first)), load)
    both = diagnose(arm, reversed_, changed(held, tau=-held["tau"]))
    yield Case("torque sign", f"{where} diagnose", both, load)
    exchanged = dynamics(several, changed(s, tau=s["tau"][:, ::-1]))
    yield Case("torque columns exchanged", where, exchanged, says("exchanged", 4))
    same = written(drawn.blank, m)
    yield Case("written = printed", where, same, lambda ran: ran.said.endswith("WRITTEN AS PRINTED"))
    up = dynamics(upside_down(several), s)
    yield Case("gravity's sign", f"{several.name}, seed {drawn.seed}", up, says("sign of gravity_m_s2", 4))


def units(drawn: Drawn) -> Cases:
    """Yield torque in another unit, named and not."""
    where, arm = drawn.where, drawn.arm
    large = changed(drawn.learn, tau=drawn.learn["tau"] * 1e3)
    named = dynamics(arm, large, ("q", "tau"), tau="{} [N.mm]")
    yield Case("torque unit", f"{where} [N.mm]", named, holds(arm))
    yield Case("torque unit", f"{where} N.mm, no unit", dynamics(arm, large), says("N·mm", 2))


def others(drawn: Drawn) -> Cases:
    """Yield torque, or a tip, that has nothing to do with the motion."""
    where, arm, several, m = drawn.where, drawn.arm, drawn.several, drawn.learn
    noise, other = np.random.default_rng(drawn.seed + 9), motion(arm, drawn.seed + 77)
    foreign = dynamics(arm, changed(m, tau=other["tau"] - other["tau"].mean(0)))
    yield Case("no fit", f"{where} other torque", foreign, says("next to nothing|impossible|only"))
    garbage = dynamics(arm, changed(m, tau=noise.normal(size=m["tau"].shape)))
    yield Case("no fit", f"{where} noise", garbage, says("next to nothing|impossible", 4))
    tip = with_tip(several, drawn.other)
    walk = np.cumsum(noise.normal(0, 5e-3, tip["tip"].shape), 0)
    elsewhere = kinematics(reaching(several), changed(tip, tip=walk))
    yield Case("no fit", f"{where} tip", elsewhere, says("next to nothing", 4))


def saturated_and_late(drawn: Drawn) -> Cases:
    """Yield torque that is cut off, and torque that comes late."""
    where, arm, m = drawn.where, drawn.arm, drawn.learn
    limit = 0.7 * np.abs(m["tau"]).max(axis=0)
    clipped = dynamics(arm, changed(m, tau=np.clip(m["tau"], -limit, limit)))
    yield Case("cut off", where, clipped, holds_or_says(arm, "cut off", off=6.0))
    for late in (3, 6, 10):
        yield Case("late torque", f"{where} {late}", dynamics(arm, delayed(m, late)), says("late"))


def laws(drawn: Drawn) -> Cases:
    """Yield laws whose gains the motion contradicts, and targets in degrees."""
    where, several, s = drawn.where, drawn.several, drawn.other
    roles = ("q", "dq", "ddq", "ref")

    def under(kp: float, kv: float):
        law = Control("pd", (kp,) * several.n_joint, (kv,) * several.n_joint)
        return replace(several, control=law)

    ref = s["q"] + (s["tau"] + 5.0 * s["dq"]) / 20.0
    driven = changed(s, ref=ref)
    yield Case("kv drives", where, dynamics(under(20.0, 5.0), driven, roles), says("kv1", 4))
    scaled = dynamics(under(42.0, -10.5), driven, roles)
    yield Case("gains scale", where, scaled, says("scales with these gains"))
    in_degrees = simulate(under(20.0, -5.0), np.rad2deg(ref), s["t"])
    yield Case("simulate degrees", where, in_degrees, says("degrees|runs away"))
