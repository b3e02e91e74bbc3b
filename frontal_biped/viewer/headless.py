"""Pictures and animations of a page, taken by Chromium without a window."""

import contextlib
import io
import logging
import shutil
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
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
_PATIENCE = 120.0  # [s] for a software renderer and the meshes of a humanoid
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
                args=list(CHROMIUM_OPTIONS),
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
    # two frames: the first tells the scene, the second draws it
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done())))")
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


def write_gif(html: str, target: Path, times: Sequence[float], fps: float, size: tuple[int, int] = (640, 480)) -> None:
    """Write an animation of a page's robot as GIF that repeats for ever.

    Args:
        html: text of the page.
        target: file.
        times: of the frames [s].
        fps: frames per second of the GIF; GIFs count in hundredths of a second.
        size: width and height [px].
    """
    from PIL import Image

    with opened_page(html, size) as page:
        page.evaluate("document.body.classList.add('still')")
        frames = [Image.open(io.BytesIO(picture(page, time, "main"))).convert("RGB") for time in times]
    palette = _palette(frames)
    small = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    with atomic_path(target) as temporary:
        small[0].save(
            temporary, save_all=True, append_images=small[1:], duration=round(1000.0 / fps), loop=0, format="GIF"
        )


def _palette(frames: Sequence[Any]) -> Any:
    """One palette for all frames, lest colours flicker, that keeps the few pixels of the markers."""
    from PIL import Image

    middle, side = frames[len(frames) // 2], 64
    sample = Image.new("RGB", (middle.width, middle.height + side), "white")
    sample.paste(middle, (0, 0))
    for k, colour in enumerate(COLOURS.values()):
        rgb = (colour >> 16, (colour >> 8) & 255, colour & 255)
        sample.paste(rgb, (k * side, middle.height, (k + 1) * side, middle.height + side))
    return sample.quantize(colors=256)


def _first_line(error: Exception) -> str:
    return next((line.strip() for line in str(error).splitlines() if line.strip()), type(error).__name__)
