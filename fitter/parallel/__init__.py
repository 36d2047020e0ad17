"""Work shared among processors, in one of three ways that follow from the work.

- `spawned.in_order`: minutes each, on files. Jobs and results are pickled; a new process knows nothing but its
  job.
- `forked.side_by_side`: seconds each, on what is in memory already and too large to be sent. Never while another
  thread of the interpreter runs: a fork copies the locks that it holds, and nobody who could release them.
- A `ThreadPoolExecutor` of `processors.processors` threads: milliseconds each, in kernels and solvers that run
  without the interpreter's lock.
"""
