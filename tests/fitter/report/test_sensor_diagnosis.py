"""The page of a diagnosis of the sensors."""

import base64
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from arm.arm_file import load_arm
from fitter.reading_diagnosis.sensor_residual import SensorResidual
from fitter.reading_diagnosis.sensor_verdict import Course, SensorCandidate, SensorFinding
from fitter.report.sensor_diagnosis import course_figure, write_sensor_report
from limbcal.errors import DeviceError

N = 10_000


def finding(**changes: object) -> SensorFinding:
    """Return what was found of two sensors, the second with twenty rivals."""
    t = np.linspace(0.0, 100.0, N)
    before = np.zeros((N, 2, 3))
    before[:, 0], before[:, 1] = [3.0, 0.0, 4.0], [0.0, 1.0, 0.0]
    plain = SensorFinding(
        "named",
        (),
        tuple(SensorCandidate("sensor_scale", (f"s{k}",), 0.9 - 0.01 * k, 0.5) for k in range(20)),
        (),
        "turn it over",
        {"s1": 0.512, "s2": 0.127},
        {"s1": 0.0213, "s2": 0.0124},
        0.9,
        7.0,
        5.0,
        1.02,
        SensorResidual(0.4, True, ()),
        load_arm("dd-arm"),
        Course(t, before, 0.1 * before, before),
    )
    return replace(plain, **changes)


def words(folder: Path) -> str:
    text = (folder / "report.html").read_text(encoding="utf-8")
    return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", re.sub(r"data:[^\"]+", "", text)))


def test_causes_gains_and_a_dozen_rivals_are_said(tmp_path: Path) -> None:
    write_sensor_report(finding(), ["s1 reads too much"], "They contradict it.", tmp_path)
    said = words(tmp_path)
    for part in ("They contradict it.", "Why", "s1 reads too much", "0.512", "0.0213", "turn it over"):
        assert part in said, part
    assert "s11" in said and "s12" not in said  # twelve, from s0
    assert "No more than noise." in said and "depends" not in said


def test_what_is_left_says_what_it_depends_on(tmp_path: Path) -> None:
    found = finding(residual=SensorResidual(0.4, False, ("q1", "dq2")))
    write_sensor_report(found, [], "Nothing explains it.", tmp_path)
    said = words(tmp_path)
    assert "More than noise. It depends on q1, dq2." in said and "No more" not in said and "Why" not in said


def test_the_picture_lies_beside_the_page_and_in_it(tmp_path: Path) -> None:
    write_sensor_report(finding(), [], "", tmp_path)
    picture = (tmp_path / "diagnosis-sensors.png").read_bytes()
    (inside,) = re.findall(r"base64,([^\"]+)", (tmp_path / "report.html").read_text(encoding="utf-8"))
    assert base64.b64decode(inside) == picture and picture.startswith(b"\x89PNG")


def test_a_folder_that_is_none_is_said(tmp_path: Path) -> None:
    with pytest.raises(DeviceError, match=r"diagnosis-sensors.png: cannot be written: No such file"):
        write_sensor_report(finding(), [], "", tmp_path / "nowhere")


def test_each_sensor_has_a_row_with_the_size_of_what_contradicts(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    course_figure(finding())
    for axes, name, size in zip(drawn[0].axes, ("s1", "s2"), (5.0, 1.0), strict=True):
        before, after = axes.lines
        assert axes.get_ylabel() == f"{name} [m/s²]"
        np.testing.assert_allclose(before.get_ydata(), size)
        np.testing.assert_allclose(after.get_ydata(), 0.1 * size)
        assert len(before.get_xdata()) == N // 2  # no more than some 4000 points would be seen
        assert before.get_xdata()[1] == pytest.approx(200.0 / (N - 1))
    assert drawn[0].axes[-1].get_xlabel() == "run's time [s]"
