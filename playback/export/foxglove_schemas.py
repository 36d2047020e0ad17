"""JSON schemas of the messages that Foxglove knows by name, as far as limbcal fills them in.

Names and fields are those of https://docs.foxglove.dev/docs/visualization/message-schemas.
"""

from collections.abc import Mapping

Schema = Mapping[str, object]

NUMBER: Schema = {"type": "number"}
TEXT: Schema = {"type": "string"}
FLAG: Schema = {"type": "boolean"}
COUNT: Schema = {"type": "integer", "minimum": 0}


def thing(title: str, **properties: Schema) -> Schema:
    """Return the schema of an object."""
    return {"title": title, "type": "object", "properties": properties}


def many(item: Schema) -> Schema:
    """Return the schema of an array."""
    return {"type": "array", "items": item}


TIME = thing("time", sec=COUNT, nsec=COUNT)
DURATION = thing("duration", sec={"type": "integer"}, nsec=COUNT)
VECTOR = thing("foxglove.Vector3", x=NUMBER, y=NUMBER, z=NUMBER)
POINT = thing("foxglove.Point3", x=NUMBER, y=NUMBER, z=NUMBER)
QUATERNION = thing("foxglove.Quaternion", x=NUMBER, y=NUMBER, z=NUMBER, w=NUMBER)
POSE = thing("foxglove.Pose", position=VECTOR, orientation=QUATERNION)
COLOUR = thing("foxglove.Color", r=NUMBER, g=NUMBER, b=NUMBER, a=NUMBER)

FRAME_TRANSFORMS = thing(
    "foxglove.FrameTransforms",
    transforms=many(
        thing(
            "foxglove.FrameTransform",
            timestamp=TIME,
            parent_frame_id=TEXT,
            child_frame_id=TEXT,
            translation=VECTOR,
            rotation=QUATERNION,
        )
    ),
)

_TRIANGLES = thing(
    "foxglove.TriangleListPrimitive",
    pose=POSE,
    points=many(POINT),
    color=COLOUR,
    colors=many(COLOUR),
    indices=many(COUNT),
)
_LINE = thing(
    "foxglove.LinePrimitive",
    type={"type": "integer"},
    pose=POSE,
    thickness=NUMBER,
    scale_invariant=FLAG,
    points=many(POINT),
    color=COLOUR,
    colors=many(COLOUR),
    indices=many(COUNT),
)
_EMPTY = many({"type": "object"})

SCENE_UPDATE = thing(
    "foxglove.SceneUpdate",
    deletions=_EMPTY,
    entities=many(
        thing(
            "foxglove.SceneEntity",
            timestamp=TIME,
            frame_id=TEXT,
            id=TEXT,
            lifetime=DURATION,
            frame_locked=FLAG,
            metadata=_EMPTY,
            arrows=_EMPTY,
            cubes=_EMPTY,
            spheres=_EMPTY,
            cylinders=_EMPTY,
            lines=many(_LINE),
            triangles=many(_TRIANGLES),
            texts=_EMPTY,
            models=_EMPTY,
        )
    ),
)


def joint_motion(n_joint: int) -> Schema:
    """Return the schema of the joints' motion, flat, so that every number can be drawn by its name."""
    joints = {f"{name}{j + 1}": NUMBER for name in ("q", "dq", "ddq") for j in range(n_joint)}
    return thing("limbcal.JointMotion", timestamp=TIME, **joints, tip=POINT)
