"""The page of the arm file has every table and field of the schema, and every built-in arm."""

import re
from pathlib import Path
from typing import get_args

from pydantic import BaseModel

from arm.arm_file import preset_names
from arm.arm_schema import ArmTable

PAGE = (Path(__file__).parents[2] / "docs" / "arm-file.md").read_text(encoding="utf-8")


def models_in(annotation):
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in get_args(annotation):
        yield from models_in(argument)


def fields_of(schema):
    for name, field in schema.model_fields.items():
        yield field.alias or name
        for inner in models_in(field.annotation):
            yield from fields_of(inner)


def test_every_field_of_the_schema_is_on_the_page():
    words = set(re.findall(r"\w+", PAGE))
    assert not [name for name in fields_of(ArmTable) if name not in words]


def test_every_built_in_arm_is_on_the_page():
    assert not [name for name in preset_names() if f"`{name}`" not in PAGE]
