"""Mutation testing: small faults put into the code one at a time, to see whether the tests notice them.

``make mutate`` does it; `benchmarks.mutation.__main__` says how. The faults are those of cosmic-ray.
"""
