"""The virtual arm beside the real one."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from arm.arm_file import load_arm, save_arm
from arm.kinematics import tip_position
from arm.model import Arm, Effect
from arm.simulation import simulate
from limbcal.errors import ConfigError, DataError
from playback.file_source import file_source
from playback.player import Player
from playback.source import Source
from playback.twin import with_twin

DT_S = 1e-3


def heavier(arm: Arm) -> Arm:
    last = arm.joints[-1]
    link = replace(last.link, mass_kg=1.3 * last.link.mass_kg)
    return replace(arm, name="heavier", joints=(*arm.joints[:-1], replace(last, link=link)))


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write two trials of the built-in arm with their targets."""
    arm = load_arm("dd-arm")
    rows = []
    for trial, target in ((1, (0.4, -0.2)), (2, (-0.3, 0.5))):
        motion = simulate(arm, np.tile(target, (800, 1)), DT_S, np.array([0.1, 0.05 * trial]))
        number = np.full(len(motion.t), trial)
        rows.append(np.column_stack([motion.t, motion.q, motion.dq, motion.ddq, motion.ref, number]))
    names = ["t", "q1", "q2", "dq1", "dq2", "ddq1", "ddq2", "ref1", "ref2", "trial"]
    path = tmp_path_factory.mktemp("twin") / "measured.npz"
    np.savez(path, **dict(zip(names, np.concatenate(rows).T, strict=True)))
    return path


@pytest.fixture(scope="module")
def real(measured: Path) -> Source:
    return file_source(measured, load_arm("dd-arm"))


def test_the_arm_itself_moves_as_it_was_measured(real: Source, measured: Path) -> None:
    both = with_twin(real, "dd-arm", measured, print)
    t = np.linspace(0.0, 0.7, 50)
    for trial in (1, 2):
        np.testing.assert_allclose(both.twin.load(trial).at(t)[0], real.load(trial).at(t)[0], atol=1e-9)


def test_another_arm_starts_there_and_goes_its_own_way(
    real: Source, measured: Path, tmp_path: Path, fake_time
) -> None:
    arm = heavier(load_arm("dd-arm"))
    save_arm(arm, tmp_path / "heavier.toml")
    both = with_twin(real, str(tmp_path / "heavier.toml"), measured, print)
    player = Player(both, 100.0, fake_time.clocks, 2)
    player.play()
    fake_time.now_s += 0.6
    frames = []
    while (frame := player.take_due()) is not None:
        frames.append(frame)
    assert player.state()["twin"] is True
    np.testing.assert_array_equal(frames[0]["twin"]["q"], frames[0]["q"])
    assert np.abs(frames[-1]["twin"]["q"] - frames[-1]["q"]).max() > 1e-3
    for frame in frames:
        np.testing.assert_array_equal(frame["twin"]["tip"], tip_position(arm, frame["twin"]["q"]))


def test_a_motion_may_be_the_twin(real: Source, measured: Path) -> None:
    said: list[str] = []
    both = with_twin(real, str(measured), None, said.append)
    assert both.twin.name == "measured.npz"
    assert not said


def test_trials_that_only_one_has_are_left_out_and_said(real: Source, tmp_path: Path) -> None:
    t = np.arange(10) * 0.1
    np.savez(tmp_path / "second.npz", t=t, q1=t, q2=t, trial=np.full(10, 2))
    said: list[str] = []
    both = with_twin(real, str(tmp_path / "second.npz"), None, said.append)
    assert both.trials == (2,)
    assert any("it has no trial 1; left out" in sentence for sentence in said)
    np.savez(tmp_path / "other.npz", t=t, q1=t, q2=t, trial=np.full(10, 7))
    with pytest.raises(DataError, match=r"none of the trials of measured.npz"):
        with_twin(real, str(tmp_path / "other.npz"), None, print)


@pytest.mark.parametrize("order", ["ab", "ba", "b", "cb"])
def test_trials_are_paired_by_their_names(tmp_path: Path, order: str) -> None:
    t = np.arange(50) * 0.01

    def named(file: str, names: str) -> Path:
        q = np.concatenate([(ord(name) - 96) * t for name in names])
        path = tmp_path / file
        np.savez(path, t=np.tile(t, len(names)), q1=q, q2=q, ref1=q, ref2=q, trial=np.repeat([*names], len(t)))
        return path

    real = file_source(named("real.npz", "ab"), load_arm("dd-arm"))
    other = named("twin.npz", order)
    stored, simulated = with_twin(real, str(other), None, print), with_twin(real, "dd-arm", other, print)
    assert stored.trials == simulated.trials == ((1, 2) if "a" in order else (2,))
    for trial in stored.trials:
        np.testing.assert_array_equal(stored.twin.load(trial).q, real.load(trial).q)
    assert f"2 is 'b' from row {1 + 50 * order.index('b')}" in stored.twin.notes[0].text


def test_what_cannot_be_a_twin_is_refused(real: Source, measured: Path) -> None:
    with pytest.raises(ConfigError, match="has no targets; expected --reference FILE with ref1"):
        with_twin(real, "dd-arm", None, print)
    with pytest.raises(ConfigError, match=r"it has \d+ joint\(s\), but what moves in measured.npz has 2"):
        with_twin(real, "spatial-arm", measured, print)


def written(path: Path, t: np.ndarray, *, targets: bool = False) -> Path:
    q = 0.5 * np.sin(3.0 * t)
    columns = {"t": t, "q1": q, "q2": 0.5 * q}
    np.savez(path, **columns, **({"ref1": q, "ref2": 0.5 * q} if targets else {}))
    return path


@pytest.mark.parametrize("late", ["real", "twin"])
def test_files_on_one_clock_are_played_on_it(tmp_path: Path, late: str) -> None:
    t = np.arange(200) * 0.01
    arm = load_arm("dd-arm")
    paths = {name: written(tmp_path / f"{name}.npz", t[50:] if name == late else t) for name in ("real", "twin")}
    both = with_twin(file_source(paths["real"], arm), str(paths["twin"]), None, print)
    places = np.linspace(0.6, 1.4, 30) if late == "twin" else np.linspace(0.0, 1.4, 30)
    np.testing.assert_allclose(both.twin.load(1).at(places)[0], both.load(1).at(places)[0], atol=1e-9)
    assert [note.kind for note in both.notes] == ["clock"]
    assert f"trial 1 begins 0.5 s {'later' if late == 'twin' else 'earlier'}" in both.notes[0].text


def test_dates_are_a_clock(tmp_path: Path) -> None:
    t = np.arange(200) * 0.01
    dates = np.datetime64("2026-03-01T12:00:00", "ns") + np.round(1e9 * t).astype("timedelta64[ns]")
    for name, first in (("real", 0), ("twin", 50)):
        q = 0.5 * np.sin(3.0 * t[first:])
        np.savez(tmp_path / f"{name}.npz", t=dates[first:], q1=q, q2=0.5 * q)
    real = file_source(tmp_path / "real.npz", load_arm("dd-arm"))
    assert real.begins_s[1] == pytest.approx(dates[0].astype(int) * 1e-9, abs=1e-6, rel=0)
    both = with_twin(real, str(tmp_path / "twin.npz"), None, print)
    assert both.twin.load(1).begin_s == pytest.approx(0.5, abs=1e-6)


@pytest.mark.parametrize("first", [0, 50])
def test_targets_are_followed_by_the_clock_of_the_real_arm(tmp_path: Path, first: int) -> None:
    t = np.arange(200) * 0.01
    arm = load_arm("dd-arm")
    real = file_source(written(tmp_path / "real.npz", t[50 - first :]), arm)
    targets = written(tmp_path / "targets.npz", t[first:], targets=True)
    both = with_twin(real, "dd-arm", targets, print)
    found = both.twin.load(1)
    assert found.begin_s == pytest.approx(0.5 if first else 0.0)
    start = np.array([found.begin_s])
    np.testing.assert_allclose(found.at(start)[0], real.load(1).at(start)[0], atol=1e-12)
    assert found.duration_s == pytest.approx(1.49)


def test_files_without_a_common_clock_begin_together_and_a_note_says_so(tmp_path: Path) -> None:
    t = np.arange(200) * 0.01
    real = file_source(written(tmp_path / "real.npz", t), load_arm("dd-arm"))
    both = with_twin(real, str(written(tmp_path / "twin.npz", 100.0 + t)), None, print)
    (note,) = both.notes
    assert note.kind == "clock" and "on no common clock: trials of both are begun together" in note.text
    assert "from 0 to 1.99 s in real.npz and from 100 to 101.99 s" in note.text
    assert both.twin.load(1).begin_s == 0.0
    targets = written(tmp_path / "targets.npz", 100.0 + t, targets=True)
    assert with_twin(real, "dd-arm", targets, print).twin.load(1).begin_s == 0.0


@pytest.mark.parametrize("first", [0, 50])
def test_a_twin_is_pushed_by_the_clock_of_its_targets(tmp_path: Path, first: int) -> None:
    t = 10.0 + np.arange(200) * 0.01
    push = Effect("external_push", {"start_s": 11.0, "duration_s": 0.2, "torque_N_m": 3.0}, (1,))
    save_arm(replace(load_arm("dd-arm"), effects=(push,)), tmp_path / "pushed.toml")
    real = file_source(written(tmp_path / "real.npz", t[first:]), load_arm("dd-arm"))
    targets = written(tmp_path / "targets.npz", t, targets=True)
    still, pushed = (
        with_twin(real, arm, targets, print).twin for arm in ("dd-arm", str(tmp_path / "pushed.toml"))
    )
    places = t[first:] - t[first]
    apart = np.abs(pushed.load(1).at(places)[0] - still.load(1).at(places)[0]).max(axis=1)
    assert t[first:][apart > 1e-6][0] == pytest.approx(11.0, abs=0.011)


def test_a_mapping_with_drives_is_that_of_the_twin(tmp_path: Path) -> None:
    t = np.arange(200) * 0.01
    path = written(tmp_path / "real.npz", t, targets=True)
    columns = {name: np.load(path)[name] for name in ("t", "q1", "q2", "ref1", "ref2")}
    np.savez(path, **columns, enabled1=0.0 * t, enabled2=0.0 * t)
    mapping = "on=enabled{j}"
    real = file_source(path, load_arm("dd-arm"), mapping, beside_twin=True)
    q = with_twin(real, "dd-arm", path, print, mapping).twin.load(1).q
    assert np.abs(q[-1] - q[0]).max() > 0.1  # nothing drives it, so it coasts on
    with pytest.raises(DataError, match="'on' is mapped, but this command does not ask for the drive"):
        file_source(path, load_arm("dd-arm"), mapping)
