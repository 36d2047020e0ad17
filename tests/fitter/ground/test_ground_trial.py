"""Motions and force files put together: clocks, gaps, frames and the links that stand on plates."""

from dataclasses import replace

import numpy as np
import pytest

from arm.body.whole_body import body_map
from arm.model import Base
from arm.moving_base import standing_base
from benchmarks.simulated_people.ground import BASE, DT, PERSON, moving
from fitter.data.derivatives import both_derivatives, lowpass
from fitter.data.trial import Trial
from fitter.ground.floating_base import base_regressor
from fitter.ground.ground_trial import ground_trial
from fitter.ground.link_motion import link_motions
from fitter.ground.link_names import link_names
from fitter.ground.measured_contact import unmeasured
from limbcal.errors import DataError

AXES = [f"ground_force_1_{kind}{axis}" for kind in "vpm" for axis in "xyz"]
FOOT = body_map().parts["foot_right"].link


@pytest.fixture(scope="module")
def person():
    """Return joint positions of a person with quick jerks, and the table's wrench at the world's origin."""
    rng = np.random.default_rng(3)
    q = moving(PERSON, rng, 8.0)
    q = q + 0.01 * lowpass(rng.normal(size=q.shape), DT, 3.0)
    motions = link_motions(PERSON, q, *both_derivatives(q, DT), standing_base(len(q)))
    wrench = base_regressor([motions[i] for i in BASE.bodies]) @ BASE.links.ravel()
    wrench[:, 3:] += np.cross(motions[BASE.bodies[0]].o, wrench[:, :3])
    return q, motions, wrench


def trial_of(q, **changes):
    dq, ddq = both_derivatives(q, DT)
    t = np.arange(len(q)) * DT
    return replace(Trial("moves", t, DT, q, dq, ddq, band_hz=6.0), **changes)


def written(path, t, wrench):
    table = np.column_stack([t, wrench[:, :3], np.zeros((len(t), 3)), wrench[:, 3:]])
    rows = [" ".join(f"{x:.9f}" for x in row) for row in table]
    path.write_text("\n".join(["endheader", " ".join(["time", *AXES]), *rows]), "utf-8")
    return path


def put_together(path, person, t=None, wrench=None, arm=PERSON, contacts=(), **changes):
    q, _, own = person
    t = np.arange(len(q)) * DT if t is None else t
    forces = written(path / "forces.mot", t, own if wrench is None else wrench)
    return ground_trial(arm, BASE, trial_of(q, **changes), forces, contacts, link_names(arm))


def test_the_tables_bodies_leave_nothing(tmp_path, person):
    found = put_together(tmp_path, person)
    np.testing.assert_allclose(found.Y @ BASE.links.ravel(), found.wrench, atol=1e-4)
    assert found.shift.shift_s == 0.0 and found.name == "moves" and len(found.t) == 800
    assert unmeasured(PERSON, BASE, found, link_names(PERSON)) == []


def test_a_base_that_stands_elsewhere_takes_the_wrench_along(tmp_path, person):
    arm = replace(PERSON, base=Base((0.5, -0.2, 0.1), (0.0, 0.0, 0.7)))
    c, s = np.cos(0.7), np.sin(0.7)
    R, p, own = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), np.array([0.5, -0.2, 0.1]), person[2]
    force = own[:, :3] @ R.T
    wrench = np.hstack([force, own[:, 3:] @ R.T + np.cross(p, force)])
    found = put_together(tmp_path, person, wrench=wrench, arm=arm)
    np.testing.assert_allclose(found.Y @ BASE.links.ravel(), found.wrench, atol=1e-4)


def test_a_clock_that_is_late_is_put_right_and_said(tmp_path, person):
    t = np.arange(len(person[0])) * DT
    found = put_together(tmp_path, person, t=t + 0.06)
    assert found.shift.shift_s == pytest.approx(0.06, abs=2e-3)
    (note,) = [note for note in found.notes if note.kind == "clock"]
    assert "later" in note.text
    left = found.Y @ BASE.links.ravel() - found.wrench
    assert np.sqrt(np.mean(left[:, :3] ** 2)) < 2.0


def test_a_motion_that_began_later_stands_on_its_own_clock(tmp_path, person):
    t = np.arange(len(person[0])) * DT + 5.0
    found = put_together(tmp_path, person, t=t, began_s=5.0)
    assert found.t[0] == 5.0 and found.shift.shift_s == 0.0
    np.testing.assert_allclose(found.Y @ BASE.links.ravel(), found.wrench, atol=1e-4)


def test_samples_without_force_are_left_out_and_said(tmp_path, person):
    t = np.arange(len(person[0])) * DT
    found = put_together(tmp_path, person, t=t[200:], wrench=person[2][200:])
    assert found.t[0] == pytest.approx(2.0) and len(found.t) == 600 == len(found.motions[0].o) == len(found.Y)
    (note,) = [note for note in found.notes if note.kind == "nan_forces"]
    assert "200 of 800" in note.text and note.from_s == pytest.approx(2.0)
    with pytest.raises(DataError, match="expected 1 s at least"):
        put_together(tmp_path, person, t=t[-90:], wrench=person[2][-90:])


def test_an_empty_plate_is_refused(tmp_path, person):
    with pytest.raises(DataError, match="no plate carries more than 10 N"):
        put_together(tmp_path, person, wrench=1e-3 * person[2])


@pytest.mark.parametrize("name", ["1", "ground_force_1"])
def test_a_contact_that_is_named_is_taken(tmp_path, person, name):
    assert put_together(tmp_path, person, contacts=[(name, FOOT)]).contacts[0][1] == FOOT
    found = put_together(tmp_path, person, contacts=[("2", FOOT)]).contacts
    assert len(found) == 1 and found[0][1] in BASE.bodies


def test_the_force_passes_the_motions_filter(tmp_path, person):
    found = put_together(tmp_path, person, cutoff_hz=1.0)
    slow = lowpass(person[2][:, :3], DT, 1.0, ends="even")
    np.testing.assert_allclose(found.wrench[:, :3], slow, atol=1e-4)
