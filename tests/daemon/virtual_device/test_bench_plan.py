"""A plan without more said is the bench as it stands: its noise, well mounted, the arm file's corners."""

from arm.arm_file import load_arm
from daemon.virtual_device.bench_plan import BenchPlan


def test_a_bench_is_as_it_stands_unless_said_otherwise() -> None:
    plan = BenchPlan(load_arm("dd-arm"), 4, 500.0, trials=2)
    assert (plan.noise, plan.imperfect_mounting, plan.highpass_hz) == (1.0, False, None)
