"""What JSON schemas of messages are made of."""

Schema = dict[str, object]


def one(kind: str, description: str, unit: str = "") -> Schema:
    """Return the schema of one value."""
    return {"type": kind, "description": f"{description} [{unit}]" if unit else description}


def array(description: str, shape: str, unit: str = "") -> Schema:
    """Return the schema of an array as it crosses the wire; its elements lie in C order in ``data``."""
    return {
        **one("object", f"{description}, shape {shape}", unit),
        "properties": {
            "dtype": {
                "enum": ["<f8", "<f4", "<i8", "<i4", "<i2", "|b1"],
                "description": "element type, as numpy writes it",
            },
            "shape": {
                "type": "array",
                "items": {"type": "integer"},
                "description": "lengths, outermost first",
            },
            "data": {"type": "string", "contentEncoding": "binary", "description": "the elements, C order"},
        },
        "required": ["dtype", "shape", "data"],
    }


def by_name(description: str, value: Schema) -> Schema:
    """Return the schema of a map from names to values of one kind."""
    return {**one("object", description), "additionalProperties": value}
