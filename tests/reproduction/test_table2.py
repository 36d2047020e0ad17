"""Table 2."""

from reproduction.experiment import Settings
from reproduction.table2 import run


def test_the_lengths_come_from_the_accelerometers_alone():
    found = run(Settings(quick=True))
    for way in ("plain", "ours"):
        parameters = found.document["methods"][way]["parameters"]
        for name, true in (("a1", 0.25), ("a2", 0.30)):
            assert parameters[name]["identifiable"]
            assert abs(parameters[name]["value"] - true) < 0.015
    assert found.document["methods"]["plain"]["tip_error_mm"]["evaluate"] is None
    assert found.document["methods"]["ours"]["tip_error_mm"]["evaluate"]["mean"] < 30.0
    assert found.document["paper"]["a1"] == 0.245785
