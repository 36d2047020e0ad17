"""One hidden case: drawn, written, diagnosed, and held against its truth."""

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.case_pool import timed
from benchmarks.diagnosed import by_entry_point, said
from benchmarks.diagnosis_score import payload_placed, score
from benchmarks.hidden_arms.cases import draw_case
from benchmarks.hidden_arms.hiding import Bench


@dataclass(frozen=True)
class Job:
    """Which case is drawn: the same job gives the same case."""

    kind: str
    seed: int
    effect: str | None
    bench: Bench = Bench()

    @property
    def key(self) -> str:
        """What a results file calls it."""
        return f"{self.kind}/{self.effect}/{self.seed}"

    @property
    def fields(self) -> dict[str, Any]:
        """What a results file has of it, whatever comes of it."""
        return {"key": self.key, "kind": self.kind, "seed": self.seed, "effect": self.effect}


def run(job: Job) -> dict[str, Any]:
    """Run one case and return its line: what was hidden, what was said, and how that scores."""
    case = draw_case(job.seed, job.kind, job.effect, job.bench)
    hidden = [{"effect": one["effect"], "joints": one["joints"]} for one in case.truth["effects"]]
    with tempfile.TemporaryDirectory() as folder:
        files = case.write(Path(folder))
        found, took = timed(lambda: by_entry_point(*files))
    scored = score(case.truth, found) | {"placed": payload_placed(case.truth, found)}
    return {"hidden": hidden, "said": said(found), "score": scored} | took
