"""`fitter dynamics --ground` from files: what is learnt, what is judged, and what is refused."""

import json

import numpy as np
import pytest

from arm.arm_file import load_arm, save_arm
from arm.moving_base import standing_base
from benchmarks.simulated_people.ground import BASE, DT, PERSON, moving, other_masses, weighing
from fitter.__main__ import main
from fitter.data.derivatives import both_derivatives
from fitter.data.motion_file import write_motion
from fitter.ground.floating_base import base_regressor
from fitter.ground.link_motion import link_motions

AXES = [f"ground_force_1_{kind}{axis}" for kind in "vpm" for axis in "xyz"]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    folder, rng = tmp_path_factory.mktemp("plates"), np.random.default_rng(3)
    theta = other_masses(BASE, rng)
    save_arm(weighing(PERSON, theta), folder / "body.toml")
    for name in ("learn", "judge"):
        q = moving(PERSON, rng, 8.0)
        t = np.arange(len(q)) * DT
        write_motion(folder / f"{name}.csv", {"t": t, "q": q})
        motions = link_motions(PERSON, q, *both_derivatives(q, DT), standing_base(len(q)))
        wrench = base_regressor([motions[i] for i in BASE.bodies]) @ theta
        wrench[:, 3:] += np.cross(motions[BASE.bodies[0]].o, wrench[:, :3])
        chair = np.where((t > 2.0) & (t < 4.0), 0.0, 1.0)[:, None]
        for file, share in ((f"{name}.mot", 1.0), (f"{name}-half.mot", 0.5), (f"{name}-chair.mot", chair)):
            table = np.column_stack(
                [t, share * wrench[:, :3], np.zeros_like(wrench[:, :3]), share * wrench[:, 3:]]
            )
            rows = [" ".join(f"{x:.6f}" for x in row) for row in table]
            (folder / file).write_text("\n".join(["endheader", " ".join(["time", *AXES]), *rows]), "utf-8")
    return folder, theta


def dynamics(folder, forces, *more):
    command = ["dynamics", str(folder / "learn.csv"), "--evaluate", str(folder / "judge.csv")]
    command += ["--arm", str(folder / "body.toml"), "--ground", *(str(folder / force) for force in forces)]
    return main([*command, "--out", str(folder / "out.toml"), "--json", *more])


def test_masses_are_learnt_judged_and_written(recorded, capsys):
    folder, theta = recorded
    assert dynamics(folder, ["learn.mot", "judge.mot"], "--prior", "regression") == 0
    answer = json.loads(capsys.readouterr().out)
    assert all(0.0 <= one["learnt"] <= 1.0 for one in answer["parameters"].values())
    assert answer["ground_residual"]["evaluate"]["squared_reduction"]["moment"] > 0.5  # most of it
    assert answer["angle_error_deg"] == {"learn": None, "evaluate": None}
    explained = answer["explained"]["evaluate"]
    assert len(explained) == PERSON.n_joint and min(explained[:3]) > 0.5 and explained[6] is None
    written = sum(joint.link.mass_kg for joint in load_arm(str(folder / "out.toml")).joints)
    assert abs(written / theta[9::10].sum() - 1.0) < 0.01


def test_half_of_the_ground_is_refused(recorded, capsys):
    folder, _ = recorded
    assert dynamics(folder, ["learn-half.mot", "judge-half.mot"], "--prior", "regression") == 4
    kinds = [note["kind"] for note in json.loads(capsys.readouterr().out)["notes"]]
    assert "unmeasured_contact" in kinds


def test_one_force_file_a_trial_is_wanted(recorded):
    folder, _ = recorded
    assert dynamics(folder, ["learn.mot"]) == 2


def test_a_chair_in_an_evaluating_trial_is_left_out_of_the_judgement(recorded, capsys):
    folder, _ = recorded
    assert dynamics(folder, ["learn.mot", "judge-chair.mot"], "--prior", "regression") == 0
    answer = json.loads(capsys.readouterr().out)
    (note,) = [note for note in answer["notes"] if note["kind"] == "unmeasured_contact"]
    assert note["source"] == "judge" and "of 8.0 s in which all contact is measured" in note["text"]
    assert answer["ground_residual"]["evaluate"]["squared_reduction"]["moment"] > 0.5  # most of it


def test_a_chair_in_a_learning_trial_is_refused(recorded, capsys):
    folder, _ = recorded
    assert dynamics(folder, ["learn-chair.mot", "judge.mot"], "--prior", "regression") == 4
    kinds = [note["kind"] for note in json.loads(capsys.readouterr().out)["notes"]]
    assert "unmeasured_contact" in kinds
