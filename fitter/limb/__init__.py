"""A person's arm or leg from optical markers: geometry, marker places and joint angles in one fit; then tracking.

It joins what `fitter.markers` reads and `fitter.functional` finds with the chain of eq. (1). Begin to read at
`calibration.py`.
"""
