"""The commands of `limbd`, one file each.

What a command needs is imported where it runs: every process of `limbd run` loads these modules first, and only
one of them has a use for the tracker's compiler.
"""
