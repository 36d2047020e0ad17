"""The JSON schema of a diagnosis, as `limb/diagnosis` carries it."""

from protocol.schema_parts import Schema, by_name, one

_SIZES: Schema = {
    name: {"type": ["number", "null"], "description": "over all trials; null where the simulation ran away"}
    for name in ("mean", "rms", "max")
}

_ERRORS: Schema = {
    "torque_rms_N_m": {"type": "array", "items": {"type": "number"}, "description": "one a joint [N m or N]"},
    "torque_rms_unfiltered_N_m": {
        "type": ["array", "null"],
        "items": {"type": "number"},
        "description": "the same of the torque as it was measured, noise included; null where none was",
    },
    "angle_error_deg": {
        "type": ["object", "null"],
        "description": "of simulated against measured angles [deg]; null where no joint turns",
        "properties": _SIZES,
    },
    "position_error_m": {
        "type": ["object", "null"],
        "description": "the same of joints that slide [m]; null where none does",
        "properties": _SIZES,
    },
}

_JUDGED: Schema = {
    **one("object", "errors on the trials that had no say in anything"),
    "properties": {
        **_ERRORS,
        **{name: one("object", f"the same, one {name[:-1]} each") for name in ("sets", "trials")},
    },
}

_SUPPORT = one("number", "how much of the belief it has among those that explain as much, 0 to 1")
_EFFECT: Schema = {
    "effect": one("string", "name in the catalogue, as `fitter effects` lists it"),
    "joints": {
        "type": "array",
        "items": {"type": "integer"},
        "description": "where, from 1; empty: the whole arm",
    },
}

#: Fields of `limb/diagnosis` beside those of every message.
DIAGNOSIS_FIELDS: Schema = {
    "verdict": {
        "enum": ["named", "ambiguous", "none", "unexplained"],
        "description": "whether there is anything above noise, and whether its cause is known",
    },
    "complete": one("boolean", "whether no more is left than the sensors' noise"),
    "left": {
        **one("object", "what the final model leaves, evaluating trials"),
        "properties": {
            "torque_rms_N_m": _ERRORS["torque_rms_N_m"],
            "share": one("number", "of what the base model leaves, as rms, 0 to 1"),
            "times_noise": one("number", "of the sensors' noise, as rms, at the joint that has most of it"),
        },
    },
    "causes": {
        "type": "array",
        "description": "what was accepted; in the ambiguous case all that explain as much",
        "items": {
            "type": "object",
            "properties": {
                **_EFFECT,
                "parameters": by_name(
                    "its size, by name of the parameter",
                    {
                        "type": "object",
                        "properties": {
                            "value": {"description": "the estimate, in the unit"},
                            "std": {"type": ["number", "null"], "description": "its standard error"},
                            "unit": one("string", "unit of both"),
                        },
                    },
                ),
                "support": _SUPPORT,
                "takes_away": one("object", "share of the squared residual that it took away, by role"),
            },
        },
    },
    "candidates": {
        "type": "array",
        "description": "all effects that were tried, best first",
        "items": {
            "type": "object",
            "properties": {
                **_EFFECT,
                "gain": one("number", "share of the squared residual that it takes away, evaluating trials"),
                "support": _SUPPORT,
            },
        },
    },
    "confusable": {"type": "array", "description": "pairs of effects that this data cannot tell apart"},
    "next_experiment": one("string", "the motion that would"),
    "before": {**one("object", "errors without the causes, evaluating trials"), "properties": _ERRORS},
    "after": {**one("object", "errors with the causes, evaluating trials"), "properties": _ERRORS},
    "gain": {
        **one("object", "share by which the rms errors fell"),
        "properties": {
            "torque": one("number", "of the torque"),
            "angle": {"type": ["number", "null"], "description": "of the simulated angles"},
            "position": {"type": ["number", "null"], "description": "of the simulated positions"},
            "ci95": {
                "type": ["array", "null"],
                "items": {"type": "number"},
                "description": "interval of the torque's; null where the evaluating trials are too short",
            },
        },
    },
    "polished": one("boolean", "whether numbers moved by simulated motion were kept"),
    "polish": {
        "type": ["object", "null"],
        "description": "errors of the final model, evaluating trials, without and with them; null: not tried",
        "properties": {
            "before": {**one("object", "before they were moved"), "properties": _ERRORS},
            "after": {**one("object", "after"), "properties": _ERRORS},
        },
    },
    "judged": {
        "type": ["object", "null"],
        "description": "errors on trials that had no say in anything; null where there were none",
        "properties": {"before": _JUDGED, "after": _JUDGED},
    },
    "explained": one("object", "share of the power of each joint's torque that is explained, by role"),
    "residual": one("object", "the residual: how much of it is explained by what, and whether it is white"),
    "structure": one("object", "what the base model leaves beyond noise, and how much of it the causes explain"),
    "suspected": {"type": "array", "description": "effect and joints of what explains much, but not enough"},
    "notes": {
        "type": "array",
        "items": {"type": "object"},
        "description": "what a person should know of data and answer",
    },
}
