"""The commands of `fitter`, one file each.

A page is imported where it is written: its pictures take longer to load than a command that needs none takes.
For the same reason scipy is imported as a whole where a part of it is slow to load; it loads that on first use.
"""
