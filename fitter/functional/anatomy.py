"""Bony landmarks that a marker set may name, and which segment each is part of."""

from arm.body.tracked_segments import MIDDLE_SEGMENTS, SIDES

#: Landmarks in the middle of the body, with their segment.
_MIDDLE = {"suprasternal_notch": "thorax", "xiphoid": "thorax", "c7": "thorax", "t8": "thorax", "t10": "thorax"}
#: Landmarks of either side, by their segment, by their ISB definitions (Wu et al. 2002, 2005).
_SIDED = {
    "acromion": "scapula",
    "lateral_epicondyle": "upper_arm",
    "medial_epicondyle": "upper_arm",
    "radial_styloid": "forearm",
    "ulnar_styloid": "forearm",
    "second_metacarpal": "hand",
    "fifth_metacarpal": "hand",
    "asis": "pelvis",
    "psis": "pelvis",
    "greater_trochanter": "thigh",
    "lateral_femoral_epicondyle": "thigh",
    "medial_femoral_epicondyle": "thigh",
    "lateral_malleolus": "shank",
    "medial_malleolus": "shank",
    "calcaneus": "foot",
    "first_metatarsal": "foot",
    "second_metatarsal": "foot",
    "fifth_metatarsal": "foot",
}
#: Name of each landmark, with the segment it is part of.
LANDMARKS = _MIDDLE | {
    f"{landmark}_{side}": segment if segment in MIDDLE_SEGMENTS else f"{segment}_{side}"
    for landmark, segment in _SIDED.items()
    for side in SIDES
}
