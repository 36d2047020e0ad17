"""From markers to a limb, its motion and its torques: `kinematics --body`, `track` and `torque`."""

from dataclasses import replace

import numpy as np
import pyarrow.csv
import pytest
from scipy.spatial.transform import Rotation

from arm.arm_file import load_arm, save_arm
from arm.effects.payload import with_load
from arm.model import Effect
from arm.moving_base import BaseState
from arm.newton_euler import inverse_dynamics
from benchmarks.simulated_people.person import person
from fitter.commands.torque import needed_torque
from fitter.data.motion_file import write_motion
from protocol.markers.trc_file import read_trc

SET = """schema = 1
name = "simulated"
[segments]
{segments}
[landmarks]
{landmarks}
"""


def written_trc(path, recording):
    n = len(recording.names)
    lines = [
        f"PathFileType\t4\t(X/Y/Z)\t{path.name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"{recording.rate_hz:g}\t{recording.rate_hz:g}\t{len(recording.t)}\t{n}\tm\t50\t1\t{len(recording.t)}",
        "Frame#\tTime\t" + "\t\t\t".join(recording.names) + "\t\t",
        "\t\t" + "\t".join(f"{axis}{k + 1}" for k in range(n) for axis in "XYZ"),
    ]
    for k, (t, row) in enumerate(zip(recording.t, recording.positions, strict=True)):
        fields = ["" if np.isnan(x) else f"{x:.6f}" for x in row.ravel()]
        lines.append("\t".join([str(k + 1), f"{t:.3f}", *fields]))
    path.write_text("\n".join(lines) + "\n")
    return path


def written_set(path, marker_set):
    segments = "\n".join(
        f"{name} = {list(markers)}".replace("'", '"') for name, markers in marker_set.segments.items()
    )
    landmarks = "\n".join(f'{name} = "{marker}"' for name, marker in marker_set.landmarks.items())
    path.write_text(SET.format(segments=segments, landmarks=landmarks))
    return path


@pytest.fixture
def recorded(tmp_path):
    truth = person(n=300, seed=2)
    trial = written_trc(tmp_path / "move.trc", truth.recordings[0])
    return truth, trial, written_set(tmp_path / "set.toml", truth.marker_set)


def test_from_markers_to_torques(fitter, tmp_path, recorded):
    truth, trial, marker_set = recorded
    out, motion, needed = (tmp_path / name for name in ("arm.toml", "motion.csv", "torque.csv"))
    person_is = ("--mass", 70, "--height", 1.75, "--sex", "f")
    preset = ("--body", "human-arm-right", "--marker-set", marker_set)
    learnt = fitter("kinematics", trial, *preset, *person_is, "--evaluate", trial, "--out", out)
    assert learnt.code == 0, learnt.errors
    document = learnt.document
    assert document["marker_rms_mm"]["evaluate"]["rms"] < 3.0
    assert 0.98 < document["explained"]["evaluate"] == document["explained"]["learn"] < 1.0
    assert (
        document["tip_error_mm"] == {"learn": None, "evaluate": None} and document["angle_noise_deg"] == [None] * 7
    )
    assert document["lengths_m"]["upper_arm"]["value"] == pytest.approx(abs(truth.arm.joints[2].d_m), abs=4e-3)
    centre = document["centres"]["shoulder_right"]
    assert set(centre) >= {"segment", "position_m", "std_mm", "apart_mm", "markers_m"}
    assert set(document["axes"]["elbow_right"]) >= {"std_deg", "apart_deg"}
    assert set(document["parameters"]["d3"]) == {"value", "std", "unit", "identifiable"}
    arm = load_arm(out)
    assert (
        arm.base.segment == "scapula_right"
        and arm.body.sex == "f"
        and len(arm.markers) == len(truth.recordings[0].names)
    )
    assert arm.joints[2].link.mass_kg == pytest.approx(0.0255 * 70.0)

    tracked = fitter("track", trial, "--arm", out, "--out", motion)
    assert tracked.code == 0, tracked.errors
    assert tracked.document["marker_rms_mm"]["rms"] < 3.0
    columns = pyarrow.csv.read_csv(motion).column_names
    assert columns[:8] == ["t", *(f"q{k + 1}" for k in range(7))] and "base_qz" in columns
    assert columns[-1].startswith("isb_") and tracked.document["isb"]["angles"][-1] == columns[-1]

    torques = fitter("torque", motion, "--arm", out, "--out", needed)
    assert torques.code == 0, torques.errors
    assert torques.document["samples"] == 300
    assert not [note for note in torques.document["notes"] if note["kind"] == "unused"]


def test_the_genetic_algorithm_says_how_far_it_is_from_the_bundle_fit(fitter, tmp_path):
    truth = person(n=90, seed=2)
    trial = written_trc(tmp_path / "move.trc", truth.recordings[0])
    marker_set = written_set(tmp_path / "set.toml", truth.marker_set)
    out, page = tmp_path / "arm.toml", tmp_path / "page.html"
    preset = ("--body", "human-arm-right", "--marker-set", marker_set)
    few = ("--method", "ga", "--population", 10, "--generations", 2, "--report", page)
    learnt = fitter("kinematics", trial, *preset, *few, "--out", out)
    assert learnt.code == 0, learnt.errors
    document = learnt.document
    assert (document["method"], document["generations"], document["population"]) == ("ga", 2, 10)
    assert document["samples"] == 32 and not document["converged"]
    compared = document["compared"]
    assert list(compared) == ["bundle", "ga", "ga+bundle"]
    assert compared["bundle"]["cost"] == 0.0 < compared["ga"]["cost"]  # two generations are no optimum
    assert compared["ga+bundle"]["cost"] < compared["ga"]["cost"]
    assert compared["bundle"]["marker_rms_mm"] < compared["ga"]["marker_rms_mm"]
    limb = document["marker_rms_mm"]["learn"]["limb"]
    assert (
        limb > compared["bundle"]["marker_rms_mm"]
    )  # the arm that is written is the search's, not the polished one
    assert load_arm(out).joints[2].d_m == document["parameters"]["d3"]["value"]
    assert "not_converged" in {note["kind"] for note in document["notes"]}
    assert "genetic algorithm alone (this answer)" in learnt.said
    assert "Genetic algorithm and bundle fit" in page.read_text()


def test_torque_at_rest_on_a_standing_base_is_that_of_the_arm(fitter, tmp_path):
    arm = load_arm("human-arm-right")
    save_arm(arm, tmp_path / "arm.toml")
    t = np.arange(200) / 100.0
    q = 0.3 * np.sin(2.0 * t)[:, None] * np.linspace(0.5, 1.0, arm.n_joint)
    dq, ddq = (
        0.3 * f[:, None] * np.linspace(0.5, 1.0, arm.n_joint) for f in (2 * np.cos(2 * t), -4 * np.sin(2 * t))
    )
    write_motion(tmp_path / "m.npz", {"t": t, "q": q, "dq": dq, "ddq": ddq})
    outcome = fitter("torque", tmp_path / "m.npz", "--arm", tmp_path / "arm.toml", "--out", tmp_path / "t.npz")
    assert outcome.code == 0, outcome.errors
    found = np.load(tmp_path / "t.npz")
    tau = np.column_stack([found[f"tau{k + 1}"] for k in range(arm.n_joint)])
    np.testing.assert_allclose(tau, inverse_dynamics(arm, q, dq, ddq), atol=1e-9)


def test_a_force_of_a_table_acts_on_its_link(fitter, tmp_path):
    arm = load_arm("human-leg-right")
    t = np.arange(50) / 100.0
    still = np.zeros((50, arm.n_joint))
    write_motion(tmp_path / "m.csv", {"t": t, "q": still, "dq": still, "ddq": still})
    rows = "\n".join(f"{x:.2f}\t0\t0\t700\t0.1\t0\t-0.9\t0\t0\t0" for x in t)
    names = "\t".join(
        ["time", *(f"ground_force_{k}{a}" for k in "vp" for a in "xyz"), *(f"ground_torque_{a}" for a in "xyz")]
    )
    (tmp_path / "f.mot").write_text(f"forces\nversion=1\nnRows=50\nnColumns=10\nendheader\n{names}\n{rows}\n")
    plain = fitter("torque", tmp_path / "m.csv", "--arm", "human-leg-right", "--out", tmp_path / "a.npz")
    ground = ("--ground", tmp_path / "f.mot")
    loaded = fitter("torque", tmp_path / "m.csv", "--arm", "human-leg-right", *ground, "--out", tmp_path / "b.npz")
    assert (plain.code, loaded.code) == (0, 0)
    assert loaded.document["contacts"][0]["joint"] == arm.n_joint
    # a force of 700 N upwards, 0.1 m ahead of the hip, takes 70 N m off what bends it about the axis to the right
    difference = np.load(tmp_path / "b.npz")["tau1"] - np.load(tmp_path / "a.npz")["tau1"]
    np.testing.assert_allclose(difference, -70.0, atol=1e-9)
    assert "contact_far" not in [note["kind"] for note in loaded.document["notes"]]
    (tmp_path / "far.mot").write_text((tmp_path / "f.mot").read_text().replace("\t700\t0.1", "\t700\t0.9"))
    motion = ("torque", tmp_path / "m.csv", "--arm", "human-leg-right")
    other_foot = fitter(*motion, "--ground", tmp_path / "far.mot", "--out", tmp_path / "d.npz")
    assert "contact_far" in [note["kind"] for note in other_foot.document["notes"]]
    wrong = fitter(
        "torque",
        tmp_path / "m.csv",
        "--arm",
        "human-leg-right",
        *ground,
        "--contact",
        "x=6",
        "--out",
        tmp_path / "c.npz",
    )
    assert wrong.code == 2 and "no such plate" in wrong.errors[0]


def test_mistakes_are_sentences(fitter, tmp_path, recorded):
    _, trial, marker_set = recorded
    out = tmp_path / "arm.toml"
    assert "--marker-set is missing" in fitter("kinematics", trial, "--body", "human-arm-right", "--out", out).said
    assert "--arm is missing" in fitter("kinematics", trial, "--out", out).said
    partly = fitter(
        "kinematics", trial, "--body", "human-arm-right", "--marker-set", marker_set, "--mass", 70, "--out", out
    )
    assert partly.code == 2 and "--height and --sex" in partly.errors[0]
    for option, number in (("--height", 170), ("--mass", 70_000)):
        wrong = fitter("kinematics", trial, "--body", "human-arm-right", option, number, "--out", out)
        assert wrong.code == 2 and f"'{number}' is no person's" in wrong.errors[0]
    without = fitter("track", trial, "--arm", "human-arm-right", "--out", tmp_path / "m.csv")
    assert without.code == 2 and "[[marker]]" in without.errors[0]


def test_a_recordings_own_clock_is_kept_so_that_forces_match(fitter, tmp_path):
    truth = person("human-leg-right", n=120, seed=4)
    late = replace(truth.recordings[0], t0_s=2.5)
    trial, marker_set = (
        written_trc(tmp_path / "late.trc", late),
        written_set(tmp_path / "s.toml", truth.marker_set),
    )
    preset = ("--body", "human-leg-right", "--marker-set", marker_set, "--mass", 60, "--height", 1.7, "--sex", "f")
    assert fitter("kinematics", trial, *preset, "--out", tmp_path / "leg.toml").code == 0
    assert fitter("track", trial, "--arm", tmp_path / "leg.toml", "--out", tmp_path / "m.csv").code == 0
    t = pyarrow.csv.read_csv(tmp_path / "m.csv")["t"].to_numpy()
    np.testing.assert_allclose(t, late.t, atol=1e-9)
    for name, first in (("same", 2.0), ("other", 100.0)):
        rows = "\n".join(f"{first + k / 100:.2f}\t0\t0\t700\t0\t0\t0" for k in range(400))
        names = "\t".join(["time", *(f"ground_force_{k}{a}" for k in "vp" for a in "xyz")])
        (tmp_path / f"{name}.mot").write_text(f"f\nendheader\n{names}\n{rows}\n")
    needs = ("torque", tmp_path / "m.csv", "--arm", tmp_path / "leg.toml", "--out", tmp_path / "tau.csv")
    by_segment = ("--contact", "ground_force=foot_right")
    assert fitter(*needs, "--ground", tmp_path / "same.mot", *by_segment).document["contacts"][0]["joint"] == 6
    apart = fitter(*needs, "--ground", tmp_path / "other.mot")
    assert apart.code == 2 and "expected one clock" in apart.said


def test_a_payload_is_carried_with_the_base():
    rng = np.random.default_rng(0)
    arm = load_arm("human-arm-right")
    q, dq, ddq = rng.normal(size=(3, 20, arm.n_joint))
    omega, omega_dot, acceleration, p = rng.normal(size=(4, 20, 3))
    base = BaseState(Rotation.random(20, rng).as_matrix(), p, omega, omega_dot, acceleration)
    loaded = replace(arm, effects=(Effect("payload", parameters={"mass_kg": 2.0}),))
    t = np.arange(20) / 100.0
    found = needed_torque(loaded, q, dq, ddq, base, [], t, 1)
    wanted = needed_torque(with_load(arm, 2.0), q, dq, ddq, base, [], t, 1)
    np.testing.assert_allclose(found, wanted, atol=1e-9)


def test_a_limb_and_its_motion_are_handed_on(fitter, tmp_path, recorded):
    _, trial, marker_set = recorded
    out, motion = tmp_path / "arm.toml", tmp_path / "motion.csv"
    preset = ("--body", "human-arm-right", "--marker-set", marker_set)
    models = [tmp_path / name for name in ("arm.osim", "arm.bioMod")]
    learnt = fitter("kinematics", trial, *preset, "--out", out, "--export", *models)
    assert learnt.code == 0, learnt.errors
    assert learnt.document["exported"] == [str(one) for one in models]
    files = [tmp_path / name for name in ("angles.mot", "model.trc")]
    tracked = fitter("track", trial, "--arm", out, "--out", motion, "--export", *files)
    assert tracked.code == 0, tracked.errors
    measured, modelled = read_trc(trial), read_trc(tmp_path / "model.trc")
    order = [measured.labels.index(name) for name in modelled.labels]
    away = np.linalg.norm(measured.points[:, order] - modelled.points, axis=2)
    assert np.sqrt(np.nanmean(away**2)) == pytest.approx(1e-3 * tracked.document["marker_rms_mm"]["rms"], rel=1e-2)
    assert "base_tx" in (tmp_path / "angles.mot").read_text()
    wrong = fitter("track", trial, "--arm", out, "--out", motion, "--export", tmp_path / "x.fbx")
    assert wrong.code == 2 and "expected .osim, .bioMod, .mot, .trc" in wrong.said


def test_too_few_frames_are_said_to_be(fitter, tmp_path, recorded):
    _, trial, marker_set = recorded
    short = tmp_path / "short.trc"
    lines = trial.read_text().splitlines(keepends=True)
    short.write_text("".join(lines[:5] + [line for line in lines[5:] if line.strip()][:3]))
    preset = ("--body", "human-arm-right", "--marker-set", marker_set, "--out", tmp_path / "arm.toml")
    outcome = fitter("kinematics", short, *preset)
    assert outcome.code == 2 and "3 frames in all" in outcome.errors[0]
