"""Which fields a table of a schema has."""

from collections.abc import Sequence
from typing import get_args

from pydantic import BaseModel


def fields_at(schema: type[BaseModel], path: Sequence[str | int]) -> list[str]:
    """Return the names of the fields that a table may have, as a file writes them.

    Parameters
    ----------
    schema : type
        Of the whole file.
    path : sequence of str or int
        The way to the table: names of fields, and places or keys where there are several.
    """
    for part in path:
        field = next((f for name, f in schema.model_fields.items() if part in (name, f.alias)), None)
        inner = None if field is None else _model_in(field.annotation)
        schema = schema if inner is None else inner
    return [field.alias or name for name, field in schema.model_fields.items()]


def _model_in(annotation: object) -> type[BaseModel] | None:
    """Return the table that an annotation is of, or holds several of."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for inner in get_args(annotation) if (found := _model_in(inner)) is not None), None)
