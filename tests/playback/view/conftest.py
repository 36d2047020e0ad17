"""A page that is really served, and a real browser that looks at it."""

import json
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zmq
from matplotlib.image import imread
from numpy.typing import NDArray
from playwright.sync_api import Browser, Locator, Page, sync_playwright

from arm.arm_file import load_arm
from arm.kinematics import tip_position
from playback.client import ask
from playback.control_message import Request, Value
from tests.patience import PATIENCE_MS, PATIENCE_S

#: Without a graphics processor; and without anything that asks the network.
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
#: The panel takes 390 of these pixels; what is drawn in fewer is drawn sooner.
WINDOW = {"width": 800, "height": 640}


def eventually(found: Callable[[], Any], what: str, patience_s: float = PATIENCE_S) -> Any:
    """Return what is found, as soon as it is neither None nor False."""
    until_s = time.monotonic() + patience_s
    while (answer := found()) is None or answer is False:
        if time.monotonic() > until_s:
            pytest.fail(f"{what} did not happen within {patience_s:g} s")
        time.sleep(0.02)
    return answer


@dataclass(frozen=True)
class Viewing:
    """A `limbplay view` in a process of its own."""

    process: subprocess.Popen[str]
    facts: dict[str, Any]
    context: zmq.Context[zmq.Socket[bytes]]

    def ask(self, cmd: str, value: Value | None = None) -> dict[str, Any]:
        return ask(self.context, self.facts["control"], Request(cmd, value), PATIENCE_MS)

    def state(self) -> dict[str, Any]:
        return self.ask("state")["state"]


@pytest.fixture(scope="session")
def viewing(context: zmq.Context[zmq.Socket[bytes]]) -> Callable[..., AbstractContextManager[Viewing]]:
    """Return what starts `limbplay view` with its arguments, and ends it as Ctrl-C does."""

    @contextmanager
    def started(*arguments: object) -> Iterator[Viewing]:
        command = [sys.executable, "-m", "playback", "view", *map(str, arguments)]
        command += ["--port", "0", "--no-open", "--json"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            try:
                yield Viewing(process, json.loads(_document(process)), context)
                process.terminate()
                assert process.wait(PATIENCE_S) == 0
                assert process.stdout is not None
                assert process.stdout.read() == ""
            finally:
                process.kill()

    return started


def _document(process: subprocess.Popen[str]) -> str:
    lines = []
    assert process.stdout is not None
    for line in process.stdout:
        lines.append(line)
        if line.startswith("}"):
            break
    return "".join(lines)


@pytest.fixture(scope="module")
def launch() -> Iterator[Callable[[], Browser]]:
    """Return what starts a browser, which ends with the file if not before."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        pytest.skip("there is no chromium on this machine")
    with sync_playwright() as playwright:
        browsers: list[Browser] = []

        def launched() -> Browser:
            browsers.append(playwright.chromium.launch(executable_path=chromium, args=list(FLAGS)))
            return browsers[-1]

        yield launched
        for browser in browsers:
            browser.close()


@pytest.fixture(scope="module")
def browser(launch: Callable[[], Browser]) -> Browser:
    return launch()


class Window:
    """One page, as it is drawn and as its scene is."""

    def __init__(self, browser: Browser, url: str) -> None:
        self.page: Page = browser.new_page(viewport=WINDOW)
        self.page.set_default_timeout(1e3 * PATIENCE_S)
        self.page.goto(f"{url}/?fixedDpr=0.4")
        eventually(lambda: self.node("/arm/link1"), "an arm on the page")
        self.page.add_style_tag(content="[role=alert] { display: none }")  # that there is no GPU is known

    def node(self, name: str) -> dict[str, list[float]] | None:
        """Return a node of the page's scene as it is drawn: place, and turn as w x y z."""
        found: dict[str, list[float]] | None = self.page.evaluate(
            "name => { const node = window.__viserMutable?.nodeRefFromName[name]; if (!node) return null;"
            " const q = node.quaternion; return {wxyz: [q.w, q.x, q.y, q.z], position: node.position.toArray()} }",
            name,
        )
        return found

    def beside(self, label: str, kind: str) -> Locator:
        """Return the widget behind a label."""
        return self.page.get_by_text(label, exact=True).locator(f"xpath=following::input[@type='{kind}'][1]")

    def press(self, label: str) -> None:
        """Click a button."""
        self.page.get_by_role("button").filter(has_text=label).click(force=True)

    def joints(self, root: str = "/arm") -> NDArray[np.float64]:
        """Return the joint angles of a planar arm that the page shows [rad]."""
        turns = []
        for link in ("link1", "link2"):
            node = self.node(f"{root}/{link}")
            assert node is not None
            w, _, _, z = node["wxyz"]
            turns.append(2.0 * np.arctan2(z, w))
        q = np.array([turns[0], turns[1] - turns[0]])
        return (q + np.pi) % (2.0 * np.pi) - np.pi

    def tip(self) -> NDArray[np.float64]:
        """Return where the tip of the built-in arm is as the page shows it, (3,) [m]."""
        return tip_position(load_arm("dd-arm"), self.joints()[None])[0]

    def picture(self, path: Path) -> NDArray[np.float64]:
        """Return what is drawn left of the panel, (height, width, 3) from 0 to 1."""
        self.page.screenshot(path=path)
        return imread(path)[:, : WINDOW["width"] - 400, :3]

    def place_of(self, name: str) -> tuple[float, float]:
        """Return where a node is drawn, in pixels of the page."""
        x, y = self.page.evaluate(
            "name => { const mutable = window.__viserMutable; const node = mutable.nodeRefFromName[name];"
            " const at = node.getWorldPosition(node.position.clone()).project(mutable.camera);"
            " const box = mutable.canvas.getBoundingClientRect();"
            " return [box.left + box.width * (1 + at.x) / 2, box.top + box.height * (1 - at.y) / 2] }",
            name,
        )
        return float(x), float(y)

    def close(self) -> None:
        self.page.close()


@pytest.fixture(scope="module")
def window(browser: Browser) -> Iterator[Callable[[str], Window]]:
    """Return what opens a page; of one address it is the same page again, for opening one takes long."""
    windows: dict[str, Window] = {}

    def opened(url: str) -> Window:
        if url not in windows:
            windows[url] = Window(browser, url)
        return windows[url]

    yield opened
    for one in windows.values():
        one.close()
