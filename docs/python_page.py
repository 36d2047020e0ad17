"""Write docs/python.md: what another program may import of `arm` and `protocol`, from the docstrings themselves.

    .venv/bin/python docs/python_page.py

Which names are listed is decided here; what is said of them is the first paragraph of their docstrings.
"""

import inspect
import re
from collections.abc import Iterator
from dataclasses import is_dataclass
from importlib import import_module
from pathlib import Path

#: Parts of the page: module, and the names in it that are for others.
PARTS: dict[str, dict[str, tuple[str, ...]]] = {
    "The arm and its file": {
        "arm.model": (
            "Arm", "Joint", "Link", "Friction", "Sensor", "Tip", "Control", "Estimate", "Effect", "Base", "Marker",
            "Body", "SensorCovariance",
        ),
        "arm.arm_file": ("load_arm", "save_arm", "parse_arm", "format_arm", "preset_names"),
        "arm.axis_lines": ("AxisLines",),
        "arm.body.limbs": ("limb",),
    },
    "Kinematics": {
        "arm.kinematics": (
            "link_transforms", "axis_frames", "tip_position", "sensor_positions", "rotation_from_rpy",
            "rpy_from_rotation",
        ),
        "arm.accelerometer": ("specific_force",),
    },
    "Dynamics": {
        "arm.newton_euler": ("inverse_dynamics", "forward_dynamics", "mass_matrix", "bias_torque"),
        "arm.outer_wrench": ("outer_joint_torque", "touched_inverse_dynamics", "touched_forward_dynamics"),
        "arm.moving_base": ("carried_inverse_dynamics", "BaseState", "OuterWrench"),
        "arm.regressor": ("regressor", "standard_parameters", "standard_names"),
        "arm.base_parameters": ("base_parameters", "BaseParameters", "with_base_values"),
        "arm.structural_parameters": ("structural_parameters",),
        "arm.physical_links": ("pseudo_inertia", "is_possible"),
    },
    "Simulation": {
        "arm.simulation": ("simulate", "Motion"),
        "arm.control": ("control_torque",),
        "arm.effects.catalogue": ("catalogue",),
        "arm.effects.effect": ("EffectKind",),
        "arm.bench": ("Bench", "motions", "SensorErrors", "draw_sensor_errors", "Sensors"),
    },
    "Messages": {
        "protocol.message": ("encode", "decode", "encode_array", "decode_array"),
        "protocol.publisher": ("Publisher",),
        "protocol.subscriber": ("Subscriber",),
        "protocol.endpoint": ("parse_endpoint",),
        "protocol.curve": ("load_client_key", "new_client"),
        "protocol.schemas": ("schema_json",),
    },
    "Recordings": {
        "protocol.recording_reader": ("read_recording", "RecordingReader", "recording_attachments"),
        "protocol.recording_follower": ("RecordingFollower",),
        "protocol.recording": ("RecordingWriter",),
    },
    "The serial line": {
        "protocol.device_info": ("DeviceInfo", "Channel"),
        "protocol.serial_frame": ("encode_info", "encode_samples", "InfoFrame", "SamplesFrame"),
        "protocol.serial_parser": ("FrameParser",),
    },
    "Tables": {
        "protocol.tables.reader": ("read_tables", "read_table_blocks"),
        "protocol.tables.table": ("Table",),
        "protocol.tables.columns": ("parse_mapping",),
    },
}  # fmt: skip

HEAD = """\
# Python

What another program may import. `docs/python_page.py` writes this page from the docstrings. Units are SI, angles
in rad; joint values are `(n_sample, n_joint)`. `help(NAME)` says the shapes, the units and the errors of each.

```python
from arm.arm_file import load_arm
from arm.kinematics import tip_position
from arm.newton_euler import forward_dynamics, inverse_dynamics

arm = load_arm("dd-arm")  # or a file, such as calibrated.toml
q, dq, ddq = [[0.3, 0.6]], [[1.0, 0.0]], [[0.0, 2.0]]
tau = inverse_dynamics(arm, q, dq, ddq)
assert abs(forward_dynamics(arm, q, dq, tau) - ddq).max() < 1e-9
print(tip_position(arm, q))
```

Errors are `limbcal.errors.LimbcalError` and its kinds. Whoever only subscribes needs none of this:
[protocol.md](protocol.md#zeromq-messages).
"""


def signature_of(found: object) -> str:
    """Return the arguments of a function or class, defaults where they are short."""
    words: list[str] = []
    keyword_only = False
    for name, parameter in inspect.signature(found).parameters.items():  # type: ignore[arg-type]
        if name == "self":
            continue
        if parameter.kind is parameter.KEYWORD_ONLY and not keyword_only:
            keyword_only = True
            words.append("*")
        star = {parameter.VAR_POSITIONAL: "*", parameter.VAR_KEYWORD: "**"}.get(parameter.kind, "")
        default = parameter.default
        if default is parameter.empty:
            words.append(star + name)
        else:
            is_short = default is None or type(default) in (bool, int, float, str)
            words.append(f"{name}={default!r}" if is_short else f"{name}=…")
    return f"({', '.join(words)})"


def sentence_of(found: object) -> str:
    """Return the first paragraph of a docstring, as Markdown in one line."""
    text = " ".join((inspect.getdoc(found) or "").split("\n\n")[0].split())
    text = re.sub(r"``(.*?)``|`(.*?)`", lambda code: f"`{code.group(1) or code.group(2)}`", text)
    return re.sub(r"\|", r"\\|", text)


def rows_of(name: str, found: object) -> Iterator[str]:
    """Yield the row of a name and, of a class that is more than its fields, those of its methods."""
    yield f"| `{name}{signature_of(found)}` | {sentence_of(found)} |"
    if not inspect.isclass(found) or is_dataclass(found):
        return
    for method, what in vars(found).items():
        if inspect.isfunction(what) and not method.startswith("_"):
            yield f"| `{name}.{method}{signature_of(what)}` | {sentence_of(what)} |"


def page() -> str:
    """Return the text of the page."""
    lines = [HEAD]
    for part, modules in PARTS.items():
        lines += [f"## {part}", ""]
        for module, names in modules.items():
            lines += [f"`{module}`: {sentence_of(import_module(module))}", "", "| | |", "|---|---|"]
            for name in names:
                lines += rows_of(name, getattr(import_module(module), name))
            lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    Path(__file__).with_name("python.md").write_text(page(), encoding="utf-8")
