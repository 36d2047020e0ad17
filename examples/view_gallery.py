"""The pictures of docs/view.md: an arm beside its twin, and one that is pulled by its tip, in a real browser.

Needs the extra `view`, playwright and a chromium:

    python examples/view_gallery.py docs
"""

import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
from playwright.sync_api import Browser, Page, sync_playwright

from arm.arm_file import load_arm, save_arm
from arm.bench import Bench, motions
from arm.model import Arm

WINDOW = {"width": 1280, "height": 860}
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader")
QUIET = ("--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run", "--disable-background-networking")
PATIENCE_MS = 300_000
#: How much heavier than the arm its twin is: what a calibration that is not finished has left.
HEAVIER = 1.12


def main() -> None:
    """Write view.png and view-touch.png into the folder that is named."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs")
    chromium = shutil.which("chromium")
    if chromium is None:
        sys.exit("there is no chromium on this machine")
    with tempfile.TemporaryDirectory() as scratch, sync_playwright() as playwright:
        motion, twin = _motion(Path(scratch)), Path(scratch) / "twin.toml"
        save_arm(_twin(load_arm("dd-arm")), twin)
        browser = playwright.chromium.launch(executable_path=chromium, args=[*FLAGS, *QUIET])
        with _view("--touch", "--arm", "dd-arm", "--q0", "0.4,0.9") as url:
            page = _opened(browser, url)
            x, y = page.evaluate(
                "() => { const mutable = window.__viserMutable; const node = mutable.nodeRefFromName['/handle'];"
                " const at = node.getWorldPosition(node.position.clone()).project(mutable.camera);"
                " const box = mutable.canvas.getBoundingClientRect();"
                " return [box.left + box.width * (1 + at.x) / 2, box.top + box.height * (1 - at.y) / 2] }"
            )
            page.mouse.move(x, y)
            page.mouse.down()
            for k in range(1, 9):
                page.mouse.move(x + 14 * k, y + 8 * k)
                page.wait_for_timeout(300)
            _shoot(page, folder / "view-touch.png")
            page.mouse.up()
        with _view(str(motion), "--arm", "dd-arm", "--twin", str(twin), "--reference", str(motion)) as url:
            page = _opened(browser, url)
            _switch(page, "Shadows")
            for place in ("1.1", "1.25", "1.4", "1.55", "1.7", "1.85", "2.0"):  # so that there is a trace
                _type(page, "Time (s)", place)
                page.wait_for_timeout(1500)
            _shoot(page, folder / "view.png")
        browser.close()


def _motion(folder: Path) -> Path:
    """Write one trial of the bench at 500 Hz: angles and targets."""
    bench = Bench(rate_hz=4000.0, learning=1, evaluating=1)
    trial = next(iter(motions(load_arm("dd-arm"), bench, seed=4)))
    columns = {"t": trial.t - trial.t[0]}
    for name in ("q", "dq", "ddq", "ref"):
        columns |= {f"{name}{k + 1}": column for k, column in enumerate(getattr(trial, name).T)}
    path = folder / "trial.npz"
    np.savez(path, **{name: values[::8] for name, values in columns.items()})
    return path


def _twin(arm: Arm) -> Arm:
    first, second = arm.joints
    heavier = [
        replace(joint.link, inertia_kg_m2=tuple(HEAVIER * value for value in joint.link.inertia_kg_m2))
        for joint in (first, second)
    ]
    joints = tuple(replace(joint, link=link) for joint, link in zip((first, second), heavier, strict=True))
    return replace(arm, name="calibrated", joints=joints)


@contextmanager
def _view(*arguments: str) -> Iterator[str]:
    command = [sys.executable, "-m", "playback", "view", *arguments, "--port", "0", "--no-open", "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            lines = []
            for line in process.stdout:
                lines.append(line)
                if line.startswith("}"):
                    break
            yield json.loads("".join(lines))["url"]
        finally:
            process.terminate()


def _opened(browser: Browser, url: str) -> Page:
    page = browser.new_page(viewport=WINDOW)
    page.set_default_timeout(PATIENCE_MS)
    page.goto(f"{url}/?fixedDpr=1")
    page.wait_for_function("window.__viserMutable && window.__viserMutable.nodeRefFromName['/arm/link1']")
    page.add_style_tag(content="[role=alert] { display: none }")  # it says that there is no graphics processor
    page.wait_for_timeout(4000)
    return page


def _type(page: Page, label: str, value: str) -> None:
    field = page.get_by_text(label, exact=True).locator("xpath=following::input[@type='text'][1]")
    field.fill(value)
    field.press("Enter")


def _switch(page: Page, label: str) -> None:
    page.get_by_text(label, exact=True).locator("xpath=following::input[@type='checkbox'][1]").check(force=True)


def _shoot(page: Page, path: Path) -> None:
    page.evaluate("document.querySelector('[role=slider]')?.scrollIntoView({block: 'center'})")
    page.wait_for_timeout(4000)
    page.screenshot(path=path, timeout=PATIENCE_MS)


if __name__ == "__main__":
    main()
