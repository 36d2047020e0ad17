"""Functional calibration from optical markers: segments, their poses, and the centres and axes of joints.

It works on arrays, positions ``(n_frame, n_marker, 3)`` [m] with NaN where a marker was not seen, and knows no
file but those of marker sets. Begin to read at `functional_centre.py`.
"""
