"""The arrays of a touched arm: each number has a place of its own, and all are there."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.chain import chain_of
from arm.effects.effect_table import effect_table
from arm.model import Effect
from playback.touch.memory import Memory, laid_out


def arrays_in(parts: object) -> list[np.ndarray]:
    if isinstance(parts, np.ndarray):
        return [parts]
    return [array for part in parts for array in arrays_in(part)] if isinstance(parts, tuple) else []


@pytest.mark.parametrize("name", ["dd-arm", "spatial-arm", "human-arm-right"])
@pytest.mark.parametrize("n_past", [0, 1, 5])
def test_each_number_has_a_place_of_its_own(name: str, n_past: int) -> None:
    chain = chain_of(load_arm(name))
    memory = Memory(chain, effect_table(load_arm(name)), n_past, 1e-3)
    for whole in memory.arrays[:3]:
        mine = [one for one in arrays_in(memory.parts) if one.base is whole or np.shares_memory(one, whole)]
        before = whole.copy()
        whole[:] = 0
        for one in mine:
            assert not one.any()  # nobody wrote there before
            one[...] = 1
        assert sum(one.size for one in mine) + 2 * (whole.dtype == np.bool_) == whole.size  # two flags stand alone
        assert np.count_nonzero(whole) == sum(one.size for one in mine)
        whole[:] = before


@pytest.mark.parametrize("name", ["dd-arm-vertical", "spatial-arm"])
def test_an_arm_s_numbers_are_filled_in(name: str) -> None:
    arm = load_arm(name)
    chain, effects = chain_of(arm), effect_table(arm)
    memory = Memory(chain, effects, 3, 2e-4)
    parts = memory.parts
    for ours, theirs in ((parts.chain, chain), (parts.effects, effects)):
        for field in theirs._fields:
            np.testing.assert_array_equal(getattr(ours, field), getattr(theirs, field), err_msg=field)
    assert parts.clock.tolist() == [0.0, 2e-4]
    commands = laid_out.py_func(*memory.arrays).commands  # as each run of a kernel sees them
    assert commands.dt == 2e-4 and commands.drive.shape == (3, arm.n_joint)
    assert commands.t0 == pytest.approx(-2 * 2e-4)  # three commands, the last of which is now's
    assert parts.touch.joint[0] == -1 and not commands.given
    assert parts.touch.frame.tolist() == parts.touch.axes.tolist() == np.eye(3).tolist()


def test_effects_are_filled_in() -> None:
    named = {
        "cogging": ((2,), {"amplitude_N_m": 0.3, "periods_per_turn": 7, "phase_rad": 0.1}),
        "payload": ((), {"mass_kg": 0.5, "from_trial": 1}),
    }
    effects = effect_table(
        replace(
            load_arm("dd-arm"), effects=tuple(Effect(name, values, at) for name, (at, values) in named.items())
        )
    )
    parts = Memory(chain_of(load_arm("dd-arm")), effects, 0, 1e-3).parts
    assert len(effects.joint) == 1 and len(effects.payload) == 1
    for field in effects._fields:
        np.testing.assert_array_equal(getattr(parts.effects, field), getattr(effects, field), err_msg=field)
