"""Cases of a benchmark run with a bar, kept a line each as they are done, and shown as a page of tables."""

import argparse
from collections.abc import Callable, Mapping, Sequence

from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from benchmarks.case_pool import Guarded, Line, SomeJob, run_all
from benchmarks.record import append, commit, known_lines, path_of
from limbcal.command import Document, console, emit, say


def add_pool_options(parser: argparse.ArgumentParser) -> None:
    """Say how many processes run the cases, and how long a case may take."""
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument(
        "--limit", type=float, default=600.0, metavar="SECONDS", help="a case that takes longer has failed"
    )


def run_kept(
    name: str,
    jobs: Sequence[SomeJob],
    run: Callable[[SomeJob], Line],
    fields: Callable[[SomeJob], Mapping[str, object]],
    options: argparse.Namespace,
) -> dict[str, Line]:
    """Run the cases that this commit's results have not, and return the lines of all that they have, by key.

    Parameters
    ----------
    name : str
        Of the benchmark.
    jobs : sequence of Job
    run : callable
        Runs one; with `fields` it gives its line.
    fields : callable
        What the line of a case has whatever comes of it.
    options : Namespace
        With what `add_pool_options` adds.
    """
    path = path_of(name, "jsonl")
    lines = known_lines(path)
    todo = [job for job in jobs if job.key not in lines]
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    with Progress(*columns, TimeElapsedColumn(), TimeRemainingColumn(), console=console) as progress:
        task = progress.add_task(name, total=len(todo))
        for job, line in run_all(todo, Guarded(run, options.limit), options.workers):
            lines[job.key] = {**fields(job), "key": job.key, "commit": commit(), **line}
            append(path, lines[job.key])
            progress.update(task, advance=1, description=job.key)
    return lines


def show_page(name: str, lines: Sequence[Line], page: str, options: argparse.Namespace) -> Document:
    """Write a page beside the lines it is made of, show it, and return both's document."""
    path = path_of(name, "md")
    path.write_text(page, encoding="utf-8")
    say(f"{path.with_suffix('.jsonl')}: {len(lines)} cases of this commit; {path}: tables")
    if not options.json:
        emit(page)
    return {"commit": commit(), "cases": list(lines)}
