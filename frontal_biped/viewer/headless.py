"""Pictures and animations of a page, taken by Chromium without a window."""

import base64
import contextlib
import io
import logging
import math
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any

from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.files.atomic import atomic_path
from frontal_biped.files.extras import missing_extra
from frontal_biped.files.signals import serve_signals, signals_wait
from frontal_biped.viewer.markers import COLOURS

CHROMIUM_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
CHROMIUM_OPTIONS = (
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",  # draws without a graphics card
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-quic",
    "--no-first-run",
)
PICTURE_OPTIONS = (
    *CHROMIUM_OPTIONS,
    "--disable-gpu-compositing",  # what stands around the scene is put together faster without that renderer
    "--disable-lcd-text",  # which would let text have coloured rims
)
"""For pictures, not for a page that somebody watches: its scene is then copied out of the renderer at every frame."""

_PATIENCE = 120.0  # [s] for a software renderer and the meshes of a humanoid
_DRAWN = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done())))"
"""Two frames of a page: the first tells the scene, the second draws it."""

_KEPT = 2**26  # [bytes] of scenes that are kept decoded, for a walk that comes back to them

_SLICE = 500  # [ms] of it, between two looks at signals


@contextmanager
def opened_page(html: str, size: tuple[int, int]) -> Iterator[Any]:
    """An exported page in Chromium, its animation loaded and stopped at the start.

    Args:
        html: text of the page.
        size: of the window, width and height [px].

    Yields:
        Playwright's page.

    Raises:
        MissingExtraError: Playwright is not installed.
        FrontalBipedError: there is no Chromium, or it cannot show the page.
    """
    try:
        from playwright.sync_api import Error, sync_playwright
    except ImportError:
        raise missing_extra("pictures need Playwright", "browser") from None
    with tempfile.TemporaryDirectory(prefix="frontal-biped-") as folder, _driver(sync_playwright) as playwright:
        path = Path(folder) / "page.html"
        path.write_text(html, encoding="utf-8")
        executable = next((found for name in CHROMIUM_NAMES if (found := shutil.which(name))), None)
        try:
            chromium = playwright.chromium.launch(
                executable_path=executable,
                args=list(PICTURE_OPTIONS),
                handle_sigint=False,  # it is closed below
                handle_sigterm=False,
                handle_sighup=False,
            )
        except Error as error:
            reason = "" if executable is None else f": {_first_line(error)}"
            found = "no Chromium was found" if executable is None else f"{executable} does not start"
            raise FrontalBipedError(
                f"pictures need Chromium, and {found}{reason}; `apt install chromium` or `playwright install chromium`"
            ) from None
        try:
            page = chromium.new_page(viewport={"width": size[0], "height": size[1]})
            page.goto(path.as_uri(), wait_until="commit")
            _wait(page, "window.page && viewer.animator.duration > 0")
            page.evaluate("page.seek(0)")
            yield page
        except Error as error:
            raise FrontalBipedError(f"Chromium could not show the page: {_first_line(error)}") from None
        finally:
            with contextlib.suppress(Error):  # it may have ended by itself
                chromium.close()


@contextmanager
def _driver(start: Any) -> Iterator[Any]:
    """Playwright's driver; a signal is served between two of its answers, never within: it would be left in pieces."""
    logging.getLogger("asyncio").addFilter(_is_news)
    with signals_wait():
        manager = start()
        try:
            playwright = manager.__enter__()
        except Exception as error:  # whatever keeps its process from starting
            raise FrontalBipedError(f"pictures need Playwright, which does not start: {_first_line(error)}") from None
        try:
            yield playwright
        finally:
            manager.__exit__(None, None, None)


def _is_news(record: logging.LogRecord) -> bool:
    """Not that the driver has gone: a signal to the whole process group ends it too, and Playwright leaves a future."""
    return record.exc_info is None or "reading from the driver" not in str(record.exc_info[1])


def _wait(page: Any, condition: str) -> None:
    """Wait until a condition of a page holds; Ctrl+C need not wait as long."""
    from playwright.sync_api import TimeoutError as NotYet

    deadline = time.monotonic() + _PATIENCE
    while True:
        serve_signals()
        try:
            page.wait_for_function(condition, timeout=_SLICE)
            return
        except NotYet:
            if time.monotonic() > deadline:
                raise


def picture(page: Any, t: float, selector: str = "body") -> bytes:
    """PNG of a page at a time t of its run [s], once it has been drawn."""
    serve_signals()
    page.evaluate("(t) => page.seek(t)", t)
    page.evaluate(_DRAWN)
    shot: bytes = page.locator(selector).first.screenshot()
    return shot


def write_png(html: str, target: Path, time: float, size: tuple[int, int] = (1280, 800)) -> None:
    """Write a picture of a page as PNG.

    Args:
        html: text of the page.
        target: file.
        time: of the run [s].
        size: of the picture, width and height [px].
    """
    with opened_page(html, size) as page, atomic_path(target) as temporary:
        temporary.write_bytes(picture(page, time))


def write_gif(
    html: str,
    target: Path,
    times: Sequence[float],
    fps: float,
    size: tuple[int, int] = (640, 480),
    on_picture: Callable[[int], None] | None = None,
) -> None:
    """Write an animation of a page's robot as GIF that repeats for ever.

    Args:
        html: text of the page.
        target: file.
        times: of the frames [s].
        fps: frames per second of the GIF; GIFs count in hundredths of a second.
        size: width and height [px].
        on_picture: called with the number of frames taken so far.
    """
    from PIL import Image

    with opened_page(html, size) as page:
        film = Film(page)
        palette = _palette(film.frame(times[len(times) // 2]))
        small = []
        for time in times:
            small.append(film.frame(time).quantize(palette=palette, dither=Image.Dither.NONE))
            if on_picture is not None:
                on_picture(len(small))
    with atomic_path(target) as temporary:
        small[0].save(
            temporary, save_all=True, append_images=small[1:], duration=round(1000.0 / fps), loop=0, format="GIF"
        )


class Film:
    """Pictures of a page's scene with what stands around it.

    A software renderer takes a tenth of a second and more to draw the scene, and as long again to show it. So the scene
    is drawn once, if at all, and never shown: a walk whose steps take a whole number of frames comes back to what has
    been drawn. What stands around it, mostly text, is taken only where it has changed.

    Args:
        page: Playwright's page.
    """

    def __init__(self, page: Any) -> None:
        from PIL import ImageColor

        page.evaluate("document.body.classList.add('still')")
        page.evaluate(_DRAWN)
        self._page = page
        self._around: Any = None  # an image of Pillow
        self._scenes: list[bytes] = []
        window = page.viewport_size
        self._decoded = lru_cache(max(1, _KEPT // (3 * window["width"] * window["height"])))(self._decode)
        x, y, width, height, colour = page.evaluate(
            """() => {
                const { x, y, width, height } = document.querySelector("main").getBoundingClientRect();
                return [x, y, width, height, getComputedStyle(document.body).backgroundColor];
            }"""
        )
        page.evaluate("document.body.classList.add('film')")
        # what is below the window costs a picture of the scene at every look at it
        page.set_viewport_size({**window, "height": max(window["height"], math.ceil(y + height))})
        page.evaluate(_DRAWN)
        clip = {"x": x, "y": y, "width": math.ceil(width), "height": math.ceil(height), "scale": 1}
        self._shot = {"clip": clip, "optimizeForSpeed": True}
        # Chromium's own words: Playwright's screenshots wait for fonts and frames that are long there
        self._session = page.context.new_cdp_session(page)
        transparent = {"color": {"r": 0, "g": 0, "b": 0, "a": 0}}
        self._session.send("Emulation.setDefaultBackgroundColorOverride", transparent)
        self._colour = ImageColor.getrgb(colour)

    @property
    def drawn(self) -> int:
        """Scenes drawn so far; fewer than frames where the walk has come back to one."""
        return len(self._scenes)

    def frame(self, time: float) -> Any:
        """The picture at a time [s]."""
        from PIL import Image

        serve_signals()
        taken = self._page.evaluate("(time) => page.picture(time)", time)
        if taken["scene"] is not None:
            self._scenes.append(base64.b64decode(taken["scene"].partition(",")[2]))
        if taken["changed"] or self._around is None:
            shot = self._session.send("Page.captureScreenshot", self._shot)
            self._around = Image.open(io.BytesIO(base64.b64decode(shot["data"]))).convert("RGBA")
        frame = Image.new("RGB", self._around.size, self._colour)
        frame.paste(self._decoded(taken["number"]), tuple(taken["place"]))
        frame.paste(self._around, mask=self._around)
        return frame

    def _decode(self, number: int) -> Any:
        from PIL import Image

        return Image.open(io.BytesIO(self._scenes[number])).convert("RGB")


def _palette(middle: Any) -> Any:
    """One palette for all frames, lest colours flicker, that keeps the few pixels of the markers."""
    from PIL import Image

    side = 64
    sample = Image.new("RGB", (middle.width, middle.height + side), "white")
    sample.paste(middle, (0, 0))
    for k, colour in enumerate(COLOURS.values()):
        rgb = (colour >> 16, (colour >> 8) & 255, colour & 255)
        sample.paste(rgb, (k * side, middle.height, (k + 1) * side, middle.height + side))
    return sample.quantize(colors=256)


def _first_line(error: Exception) -> str:
    return next((line.strip() for line in str(error).splitlines() if line.strip()), type(error).__name__)
