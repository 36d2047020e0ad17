"""Names of the segments that a marker set follows, and that may carry an arm's base."""

SIDES = ("right", "left")
#: Segments in the middle of the body, and those of either side.
MIDDLE_SEGMENTS = ("pelvis", "thorax")
_SIDED = ("scapula", "upper_arm", "forearm", "hand", "thigh", "shank", "foot")

#: Names of all segments.
TRACKED_SEGMENTS = (*MIDDLE_SEGMENTS, *(f"{segment}_{side}" for segment in _SIDED for side in SIDES))
