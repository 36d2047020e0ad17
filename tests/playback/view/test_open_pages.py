"""Pages open in a real browser, and another browser that has been stopped: it harms none of them.

Where there is no graphics processor, drawing takes all the time that there is. So the pages are kept from it: what
counts is what the server sends and a browser takes in. At length they are let draw too.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import numpy as np
import psutil
from playwright.sync_api import Browser, Page, ViewportSize

from tests.patience import PATIENCE_S
from tests.playback.view.conftest import Viewing, eventually
from tests.soak import Long

MEGABYTE, LONG_S = 1e6, 600.0
WINDOW: ViewportSize = {"width": 480, "height": 240}
#: Counts the pictures of the arm that come to a page, and how often it draws.
COUNTING = """
window.counted = { pictures: 0, drawn: 0 };
window.Worker = class extends window.Worker {
  constructor(...given) {
    super(...given);
    this.addEventListener("message", ({ data }) => {
      const moves = (part) => part.type === "SetOrientationMessage" && part.name === "/arm/link2";
      if (data.type === "message_batch" && data.messages.some(moves)) window.counted.pictures += 1;
    });
  }
};
const drawing = () => { window.counted.drawn += 1; window.requestAnimationFrame(drawing); };
window.requestAnimationFrame(drawing);
"""
NOT_DRAWING = "window.requestAnimationFrame = () => 0;"


class OpenPage:
    """A page in a context, and so in a process, of its own."""

    def __init__(self, browser: Browser, url: str, draws: bool) -> None:
        context = browser.new_context(viewport=WINDOW)
        context.add_init_script(COUNTING if draws else NOT_DRAWING + COUNTING)
        self._page: Page = context.new_page()
        self._page.set_default_timeout(1e3 * PATIENCE_S)
        self._page.goto(f"{url}/?fixedDpr=0.25")
        eventually(lambda: self.counted()[0] > 0, "a picture on a page")

    def counted(self) -> tuple[int, int]:
        """Return how many pictures have come, and how often the page has drawn."""
        pictures, drawn = self._page.evaluate("[window.counted.pictures, window.counted.drawn]")
        return int(pictures), int(drawn)

    def wait(self, pictures: int) -> None:
        """Wait until this many pictures have come in all."""
        come = "wanted => window.counted.pictures >= wanted"
        self._page.wait_for_function(come, arg=pictures, polling=200, timeout=1e3 * LONG_S)


@contextmanager
def stopped(launch: Callable[[], Browser], url: str) -> Iterator[None]:
    """Open a page in a browser of its own and stop that: it keeps its connection and reads nothing any more."""
    before = psutil.Process().children(recursive=True)
    OpenPage(launch(), url, draws=False)
    processes = [child for child in psutil.Process().children(recursive=True) if child not in before]
    try:
        for process in processes:
            process.suspend()
        yield
    finally:
        for process in processes:
            process.resume()


def test_a_stopped_browser_harms_no_open_page(
    viewing: Callable[..., AbstractContextManager[Viewing]],
    launch: Callable[[], Browser],
    motion_file: Path,
    long: Long,
) -> None:
    n_page = long.of(10, 2)
    with viewing(motion_file, "--arm", "dd-arm", "--twin", motion_file, "--trial", 3) as shown:
        url, server = shown.facts["url"], psutil.Process(shown.process.pid)
        shown.ask("loop", True)
        shown.ask("play")
        with stopped(launch, url):
            for draws, wanted in long.of(((False, 3600), (True, 600)), ((False, 200),)):
                browser = launch()
                pages = [OpenPage(browser, url, draws) for _ in range(n_page)]
                begun, used, grown = time.monotonic(), sum(server.cpu_times()[:2]), server.memory_info().rss
                first = np.array([page.counted() for page in pages])
                for page, (before, _) in zip(pages, first.tolist(), strict=True):
                    page.wait(before + wanted)
                seconds, spent = time.monotonic() - begun, sum(server.cpu_times()[:2]) - used
                grown = server.memory_info().rss - grown
                came, drawn = ((np.array([page.counted() for page in pages]) - first) / seconds).T
                browser.close()
                assert grown < 20.0 * MEGABYTE
                long.note(
                    f"{n_page} pages in Chromium and a stopped one, {seconds:.0f} s: {came.min():.1f} to "
                    f"{came.max():.1f} pictures a s came to each, drawn {drawn.min():.1f} to {drawn.max():.1f} "
                    f"times a s; the page's process took {100.0 * spent / seconds:.0f} % of a core and grew by "
                    f"{grown / MEGABYTE:.1f} MB"
                )
