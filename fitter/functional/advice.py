"""Which motion would reveal what a functional trial does not determine, in words for the person who moves."""

#: For a centre: two planes of swing at the least; of the hip star and arc, which Camomilla et al. (2006) found
#: best; the shoulder below 90°, because above it the scapula must follow.
_CENTRE = {
    "hip": "swing the leg forward and back, sideways and halfway between, 30° to each side, then in a circle",
    "knee": "bend the knee over 60° and turn the shank inward and outward with the knee bent",
    "ankle": "move the foot up and down, in and out, and in a circle",
    "shoulder": "swing the arm forward, sideways and halfway between, not above the shoulder, then in a circle",
    "elbow": "bend the elbow over 90° and turn the palm up and down with the elbow bent",
    "wrist": "bend the hand up and down, to the sides, and in a circle",
}
#: For an axis: one turn, as large as it goes, and nothing else.
_AXIS = {
    "knee": "bend the knee over 60° several times, foot pointing forward, and turn nothing else",
    "ankle": "move the foot up and down over 30° several times without turning it in or out",
    "elbow": "bend the elbow over 90° several times with the palm kept up",
    "forearm": "hold the elbow at 90° and turn the palm up and down as far as it goes, several times",
    "wrist": "bend the hand up and down over 60° several times without moving it sideways",
}
_ANY_CENTRE = "swing the child segment in two planes at right angles, 30° to each side, then in a circle"
_ANY_AXIS = "turn the joint about its axis alone, over 40° or more, several times"


def motion_for_centre(joint: str) -> str:
    """Return the motion that reveals the centre of a joint, such as ``hip_right``."""
    return _CENTRE.get(joint.rpartition("_")[0] or joint, _ANY_CENTRE)


def motion_for_axis(joint: str) -> str:
    """Return the motion that reveals the axis of a joint, such as ``elbow_left``."""
    return _AXIS.get(joint.rpartition("_")[0] or joint, _ANY_AXIS)
