"""A coverage-guided fuzzer (libFuzzer, by atheris) at a door: ``python -m tests.fuzz.fuzz DOOR CORPUS RUNS``.

It ends with 0 if all runs went well, and otherwise says what broke and leaves it beside the corpus.
"""

import sys
from pathlib import Path

import atheris

# Kernels are no bytecode any more when they run.
with atheris.instrument_imports(include=["protocol", "daemon", "arm"], exclude=["protocol.serial_scan"]):
    from tests.fuzz.doors import DOORS

#: A run that takes longer hangs [s]; a process that holds more leaks [MB].
_HANGS_S, _MOST_MB = 20, 1500


def main() -> None:
    """Fuzz a door."""
    door, corpus, runs = sys.argv[1:]
    made = DOORS[door](Path(corpus).parent)
    Path(corpus).mkdir(parents=True, exist_ok=True)
    for k, seed in enumerate(made.seeds()):
        (Path(corpus) / f"seed-{k}").write_bytes(seed)
    longest = 4 * max(map(len, made.seeds()))
    limits = [f"-timeout={_HANGS_S}", f"-rss_limit_mb={_MOST_MB}", f"-max_len={longest}"]
    found = f"-artifact_prefix={Path(corpus).parent}/broken-"
    atheris.Setup([sys.argv[0], f"-runs={runs}", *limits, found, "-print_final_stats=1", corpus], made.knock)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
