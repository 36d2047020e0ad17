"""Schemas of the messages that Foxglove knows, against the fields that it publishes."""

from typing import Any

import pytest

from playback.export.foxglove_schemas import (
    COLOUR,
    DURATION,
    FRAME_TRANSFORMS,
    NUMBER,
    POSE,
    QUATERNION,
    SCENE_UPDATE,
    TIME,
    VECTOR,
    joint_motion,
    many,
)

#: As https://docs.foxglove.dev/docs/visualization/message-schemas has them.
FIELDS = {
    "foxglove.Vector3": "x y z",
    "foxglove.Point3": "x y z",
    "foxglove.Quaternion": "x y z w",
    "foxglove.Pose": "position orientation",
    "foxglove.Color": "r g b a",
    "foxglove.FrameTransforms": "transforms",
    "foxglove.FrameTransform": "timestamp parent_frame_id child_frame_id translation rotation",
    "foxglove.SceneUpdate": "deletions entities",
    "foxglove.SceneEntity": "timestamp frame_id id lifetime frame_locked metadata arrows cubes spheres cylinders "
    "lines triangles texts models",
    "foxglove.LinePrimitive": "type pose thickness scale_invariant points color colors indices",
    "foxglove.TriangleListPrimitive": "pose points color colors indices",
}


def objects(schema: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Return every object with a title within a schema."""
    found = {schema["title"]: schema} if "title" in schema else {}
    for part in (*schema.get("properties", {}).values(), *([schema["items"]] if "items" in schema else [])):
        found |= objects(part)
    return found


def test_every_object_has_the_fields_that_foxglove_publishes() -> None:
    found = objects(dict(SCENE_UPDATE)) | objects(dict(FRAME_TRANSFORMS))
    assert {name: list(schema["properties"]) for name, schema in found.items() if name in FIELDS} == {
        name: fields.split() for name, fields in FIELDS.items()
    }
    assert found.keys() - FIELDS.keys() == {"time", "duration"}
    assert all(schema["type"] == "object" for schema in found.values())


def test_fields_are_of_foxgloves_types() -> None:
    scene = SCENE_UPDATE["properties"]["entities"]["items"]["properties"]
    line, triangles = (scene[name]["items"]["properties"] for name in ("lines", "triangles"))
    assert line["type"]["type"] == "integer"
    assert line["thickness"] == {"type": "number"} and line["scale_invariant"] == {"type": "boolean"}
    for primitive in (line, triangles):
        assert primitive["indices"] == {"type": "array", "items": {"type": "integer", "minimum": 0}}
        assert primitive["pose"] is POSE and primitive["color"] is COLOUR
        assert primitive["points"]["items"]["title"] == "foxglove.Point3"
        assert primitive["colors"] == many(COLOUR)
    assert scene["timestamp"] is TIME and scene["lifetime"] is DURATION
    assert scene["id"] == scene["frame_id"] == {"type": "string"}
    assert scene["frame_locked"] == {"type": "boolean"} and scene["texts"]["items"] == {"type": "object"}
    moved = FRAME_TRANSFORMS["properties"]["transforms"]["items"]["properties"]
    assert moved["translation"] is VECTOR and moved["rotation"] is QUATERNION and moved["timestamp"] is TIME
    assert TIME["properties"] == {name: {"type": "integer", "minimum": 0} for name in ("sec", "nsec")}
    assert DURATION["properties"]["sec"] == {"type": "integer"}  # it may be negative


@pytest.mark.parametrize("n_joint", [1, 3])
def test_every_joint_has_a_number_of_its_own(n_joint: int) -> None:
    fields = joint_motion(n_joint)["properties"]
    numbers = [name for name, schema in fields.items() if schema == NUMBER]
    assert numbers == [f"{kind}{j}" for kind in ("q", "dq", "ddq") for j in range(1, n_joint + 1)]
    assert set(fields) - set(numbers) == {"timestamp", "tip"}
    assert fields["tip"]["title"] == "foxglove.Point3"
