"""What was said, in one line."""

from benchmarks.diagnosed import said


def test_causes_are_said_with_joints_and_sizes() -> None:
    size = {"drag_N_m_s2": {"value": 0.25, "std": 0.01}, "trials": {"value": [2, 3], "std": None}}
    cause = {"effect": "air_drag", "joints": [2], "parameters": size}
    assert (
        said({"verdict": "named", "causes": [cause]})
        == "named: air_drag 2 (drag_N_m_s2 0.25 ± 0.01, trials [2, 3])"
    )


def test_what_is_left_is_said_by_its_variables() -> None:
    assert (
        said({"verdict": "unexplained", "causes": [], "residual": {"depends_on": ["q1", "t"]}})
        == "unexplained: q1 t"
    )
    assert said({"verdict": "none", "causes": []}) == "none"
