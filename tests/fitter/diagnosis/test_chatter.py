"""A torque that is mostly noise is said to be."""

from types import SimpleNamespace

import numpy as np

from arm.model import Arm, Joint
from fitter.diagnosis.chatter import chatter

ARM = Arm("two", (Joint(a_m=0.3), Joint(type="prismatic")))
T = np.arange(2000) * 0.002


def trial(noise):
    smooth = np.sin(np.outer(T, [3.0, 5.0]))
    white = np.random.default_rng(0).normal(size=smooth.shape)
    return SimpleNamespace(whole={"tau": smooth + noise * white})


def test_every_joint_is_asked_and_has_its_unit():
    (sentence,) = chatter(ARM, [trial(np.array([0.0, 2.0]))])
    assert sentence.startswith("the torque at joint 2 changes from sample to sample like noise")
    assert "N of" in sentence and "N m" not in sentence
    (other,) = chatter(ARM, [trial(np.array([2.0, 0.0]))])
    assert "joint 1" in other and "N m rms" in other


def test_smooth_torques_and_none_are_not():
    assert chatter(ARM, [trial(np.array([0.1, 0.1]))]) == []
    assert chatter(ARM, [SimpleNamespace(whole={})]) == []
