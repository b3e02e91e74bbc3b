"""Make the pictures of the README with the package itself.

    python examples/readme_pictures.py --out pictures [NAME ...]

Names: walking, walking_in_space, page, studio; default: all. They are taken by Chromium and need the extras `browser`,
`mujoco` and `viser`.
"""

import argparse
import contextlib
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import frontal_biped as fb
from frontal_biped.cli import main as frontal_biped_command
from frontal_biped.files.atomic import atomic_path
from frontal_biped.gait import load_specification
from frontal_biped.model import models_dir
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.pushes import Push
from frontal_biped.viewer import animation_page
from frontal_biped.viewer.headless import write_png

SOFTWARE_GL = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
PATIENCE = 300_000.0  # [ms]; software rendering on a busy machine is slow


@contextlib.contextmanager
def browser_page(width: int, height: int) -> Iterator[Any]:
    """A page of headless Chromium."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=SOFTWARE_GL)
        shown = browser.new_page(viewport={"width": width, "height": height})
        shown.set_default_timeout(PATIENCE)
        yield shown
        browser.close()


def walking(out: Path) -> None:
    """Two steps of TALOS, as `frontal-biped export` makes them."""
    gait = models_dir() / "talos_full.gait.json"
    target = ["-o", str(out / "walking.gif"), "--steps", "2", "--size", "640x480", "--fps", "15"]
    assert frontal_biped_command(["export", str(gait), *target]) == 0


def walking_in_space(out: Path) -> None:
    """The first steps of TALOS with every joint free, from standing still to 0.25 m/s."""
    with tempfile.TemporaryDirectory() as folder:
        run = str(Path(folder) / "run.npz")
        assert frontal_biped_command(["walk", "talos_full", "--speed", "0.25", "--steps", "8", "-o", run]) == 0
        target = ["-o", str(out / "walking_in_space.gif"), "--steps", "4", "--size", "640x480", "--fps", "10"]
        assert frontal_biped_command(["export", run, *target]) == 0


def page(out: Path) -> None:
    """A run with a push, on the exported page, where the push ends."""
    robot = fb.load_robot("frontal_biped")
    gait = fb.design_gait(robot, load_specification("robust"), quick=True).gait
    assert gait is not None
    reversal = gait.orbit.step_duration + gait.step(robot).rising.duration  # of the second step
    push = Push(start=reversal, duration=0.05, impulse=12.0)
    run = fb.simulate(robot, gait, steps=5, period=1e-3, stabiliser="ankle", disturbances=Disturbances(pushes=(push,)))
    write_png(animation_page(robot, run, title="frontal_biped"), out / "page.png", reversal + 0.06)


def studio(out: Path) -> None:
    """The studio, after the pelvis was bound to 8 degrees and the robot pushed."""
    from frontal_biped.studio.app import Studio

    with tempfile.TemporaryDirectory() as folder, Studio("frontal_biped", folder=Path(folder)) as studio:
        studio.speed(0.0)  # a still picture, which software rendering can keep up with
        workbench = studio.workbench
        wait(lambda: workbench.state.fits and workbench.state.drawing is not None)
        workbench.turn("max_pelvis_roll", 8.0)
        wait(lambda: workbench.state.fits)
        workbench.push(10.0, "at the reversal")  # what the panel shows
        wait(lambda: workbench.state.push != "" and workbench.state.certificate is not None)
        with browser_page(1000, 760) as shown:
            shown.goto(studio.url)
            shown.wait_for_function("document.body.innerText.includes('certified in closed form')", polling=1000)
            # viser's notice that there is no graphics card covers the robot's head
            shown.evaluate("document.querySelectorAll('[class*=Notification] button').forEach(b => b.click())")
            time.sleep(15.0)
            shoot(shown, out / "studio.png")


def wait(done: Callable[[], bool]) -> None:
    """Until something is so."""
    while not done():
        time.sleep(0.1)


def shoot(shown: Any, path: Path) -> None:
    """A screenshot; the file appears whole or not at all."""
    with atomic_path(path) as temporary:
        temporary.write_bytes(shown.screenshot(timeout=PATIENCE))


PICTURES: dict[str, Callable[[Path], None]] = {
    picture.__name__: picture for picture in (walking, walking_in_space, page, studio)
}


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(PICTURES)}")
    parser.add_argument("--out", type=Path, default=Path("pictures"), help="folder; default: pictures")
    arguments = parser.parse_args()
    for name in arguments.names or PICTURES:
        PICTURES[name](arguments.out)
        print(f"{name}: in {arguments.out}", flush=True)
