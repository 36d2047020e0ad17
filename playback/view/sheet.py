"""Numbers beside the arm, as a small table."""

from collections.abc import Iterable, Mapping
from html import escape
from typing import Any

import numpy as np

from arm.model import Arm
from playback.view.feed import Picture

_CELL = "padding:1px 0;white-space:nowrap"


def heading(arm: Arm, twin: Arm | None, source: str, badge: str, colour: str) -> str:
    """Return the head of the panel: whose arm it is, what is played, and whether it is live."""
    other = f" and its twin {escape(twin.name)}" if twin is not None and twin.name != arm.name else ""
    other = other or (" and its twin" if twin is not None else "")
    return (
        "<div style='padding:2px 14px 0;line-height:1.35'>"
        f"<span style='float:right;font-size:11px;font-weight:600;color:#fff;background:{colour};"
        f"border-radius:9px;padding:1px 9px'>{escape(badge)}</span>"
        f"<span style='font-size:15px;font-weight:650'>{escape(arm.name)}</span>"
        f"<span style='font-size:13px;opacity:.75'>{other}</span><br>"
        f"<span style='font-size:12px;opacity:.65'>{escape(source)}</span></div>"
    )


def table(rows: Iterable[tuple[str, str]]) -> str:
    """Return names and values, one a line."""
    body = "".join(
        f"<tr><td style='{_CELL};opacity:.65'>{escape(name)}</td>"
        f"<td style='{_CELL};text-align:right;font-variant-numeric:tabular-nums'>{escape(value)}</td></tr>"
        for name, value in rows
    )
    return f"<table style='width:calc(100% - 28px);margin:0 14px;font-size:12.5px;border-spacing:0'>{body}</table>"


def numbers(arm: Arm, picture: Picture, state: Mapping[str, Any] | None) -> list[tuple[str, str]]:
    """Return what is known of the present: joints, tip, error between the two, lateness."""
    row = picture.row
    lines = [(f"q{k + 1}", _joint(arm, k, float(value))) for k, value in enumerate(row.real.q)]
    lines.append(("tip", ", ".join(f"{1e3 * x:.1f}" for x in row.real.tip) + " mm"))
    if row.twin is not None and len(row.twin.q) == len(row.real.q):
        apart = np.abs(row.real.q - row.twin.q)
        worst = int(apart.argmax())
        lines.append(("error of angle", f"{_joint(arm, worst, float(apart[worst]))} (q{worst + 1})"))
        lines.append(("error of tip", f"{1e3 * np.linalg.norm(row.real.tip - row.twin.tip):.2f} mm"))
    if state is not None:
        late = state.get("lateness_ms")
        if isinstance(late, Mapping) and isinstance(late.get("p50"), float):
            lines.append(("lateness p50 / p99", f"{late['p50']:.2f} / {late['p99']:.2f} ms"))
    return lines


def _joint(arm: Arm, index: int, value: float) -> str:
    revolute = arm.joints[index].type == "revolute"
    return f"{np.degrees(value):.2f}°" if revolute else f"{1e3 * value:.2f} mm"
