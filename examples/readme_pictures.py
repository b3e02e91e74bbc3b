"""Make the pictures of the README with the package itself.

    python examples/readme_pictures.py --out pictures [NAME ...]

Names: snapshots, studies (pareto and degrees), humanoids, report, studio; default: all. `humanoids`, `report` and
`studio` are screenshots by Chromium and need the extras `browser` and `viser`; `report` runs the demonstration first.
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
from frontal_biped.design import degree_study, pareto_front
from frontal_biped.figures.design import degree_figure, pareto_figure
from frontal_biped.figures.state import snapshots as snapshots_figure
from frontal_biped.figures.write import write_figure
from frontal_biped.files.atomic import atomic_path, write_text
from frontal_biped.model import models_dir
from frontal_biped.simulation import orbit_trajectory
from frontal_biped.viewer import animation_page

SOFTWARE_GL = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
PATIENCE = 300_000.0  # [ms]; software rendering on a busy machine is slow


@contextlib.contextmanager
def browser_page(width: int, height: int) -> Iterator[Any]:
    """A page of headless Chromium."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=SOFTWARE_GL)
        page = browser.new_page(viewport={"width": width, "height": height})
        page.set_default_timeout(PATIENCE)
        yield page
        browser.close()


def snapshots(out: Path) -> None:
    """Stick figures of two steps."""
    robot = fb.load_robot("frontal_biped")
    gait = fb.design_gait(robot).gait
    assert gait is not None
    write_figure(out, "snapshots", snapshots_figure(robot, orbit_trajectory(robot, gait)))


def studies(out: Path) -> None:
    """Cost over energy margin, and over degree: the figures of 11_design_studies.py."""
    robot, specification = fb.load_robot("frontal_biped"), fb.GaitSpecification()
    front = pareto_front(robot, specification, "min_energy_margin", [0.25 * (i + 1) for i in range(9)])
    label = "energy margin, over the orbit's energy [-]"
    write_figure(out, "pareto", pareto_figure(front, "energy_margin", label, "What an energy margin costs"))
    series = degree_study(robot, specification, range(4, 9), range(1, 4))
    write_figure(out, "degrees", degree_figure(series))


def humanoids(out: Path) -> None:
    """Two humanoids in the exported page, side by side."""
    pairs = [(robot, orbit_trajectory(robot, fb.load_gait(models_dir() / f"{robot.name}.gait.json")))
             for robot in (fb.load_robot("talos_full"), fb.load_robot("g1"))]  # fmt: skip
    with tempfile.TemporaryDirectory() as folder, browser_page(1200, 800) as page:
        path = Path(folder) / "page.html"
        write_text(path, animation_page(*pairs[0], title="talos_full and g1", beside=pairs[1]))
        page.goto(path.as_uri())
        time.sleep(10.0)
        shoot(page, out / "humanoids.png")


def report(out: Path) -> None:
    """The top of the demonstration's report."""
    with tempfile.TemporaryDirectory() as folder, browser_page(1280, 1500) as page:
        assert frontal_biped_command(["demo", "--out", folder]) == 0
        page.goto((Path(folder) / "report.html").as_uri())
        time.sleep(15.0)
        shoot(page, out / "report.png")


def studio(out: Path) -> None:
    """The studio, after the pelvis was bound to 8 degrees and the robot pushed."""
    from frontal_biped.studio.app import Studio

    with tempfile.TemporaryDirectory() as folder, Studio("frontal_biped", folder=Path(folder)) as studio:
        studio.speed(0.0)  # a still picture, which software rendering can keep up with
        workbench = studio.workbench
        wait(lambda: workbench.state.fits and workbench.state.drawing is not None)
        workbench.turn("max_pelvis_roll", 8.0)
        wait(lambda: workbench.state.fits)
        workbench.push(12.0, "just after the impact")
        wait(lambda: workbench.state.push != "" and workbench.state.certificate is not None)
        with browser_page(1000, 760) as page:
            page.goto(studio.url)
            page.wait_for_function("document.body.innerText.includes('certified in closed form')", polling=1000)
            # viser's notice that there is no graphics card covers the robot's head
            page.evaluate("document.querySelectorAll('[class*=Notification] button').forEach(b => b.click())")
            time.sleep(15.0)
            shoot(page, out / "studio.png")


def wait(done: Callable[[], bool]) -> None:
    """Until something is so."""
    while not done():
        time.sleep(0.1)


def shoot(page: Any, path: Path) -> None:
    """A screenshot; the file appears whole or not at all."""
    with atomic_path(path) as temporary:
        temporary.write_bytes(page.screenshot(timeout=PATIENCE))


PICTURES: dict[str, Callable[[Path], None]] = {
    picture.__name__: picture for picture in (snapshots, studies, humanoids, report, studio)
}


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(PICTURES)}")
    parser.add_argument("--out", type=Path, default=Path("pictures"), help="folder; default: pictures")
    arguments = parser.parse_args()
    for name in arguments.names or PICTURES:
        PICTURES[name](arguments.out)
        print(f"{name}: in {arguments.out}", flush=True)
