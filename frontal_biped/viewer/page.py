"""One self-contained page with the animated robot, made without a server: MeshCat's viewer and its commands inlined."""

import base64
import html
import json
from collections.abc import Callable, Sequence
from importlib.resources import files
from string import Template
from typing import Any, NamedTuple

from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.viewer.page_data import page_data
from frontal_biped.viewer.scene import Actor, cast, draw_scene
from frontal_biped.viewer.tracks import start_clock


class SceneRecorder:
    """A MeshCat window that keeps the scene in memory: ``meshcat.Visualizer(window=SceneRecorder())``."""

    def __init__(self) -> None:
        self._commands: dict[tuple[str, ...], dict[str, Any]] = {}

    def send(self, command: Any) -> None:
        """Keep a command; a later one for the same node and purpose replaces it."""
        lowered = command.lower()
        kind, path = lowered["type"], lowered.get("path", "")
        if kind == "delete":
            self._commands = {
                key: kept
                for key, kept in self._commands.items()
                if key[1] != path and not key[1].startswith(path + "/")
            }
            return
        key = (kind, path, lowered["property"]) if kind == "set_property" else (kind, path)
        if kind == "set_object":
            self._commands = {k: c for k, c in self._commands.items() if k[1] != path or k[0] == "set_transform"}
        self._commands.pop(key, None)
        self._commands[key] = lowered

    @property
    def commands(self) -> list[dict[str, Any]]:
        """What a viewer must be told to show the scene; the animation comes last, when its nodes exist."""
        return sorted(self._commands.values(), key=lambda command: command["type"] == "set_animation")

    def packed(self) -> list[bytes]:
        """The commands as the viewer reads them."""
        import umsgpack

        return [umsgpack.packb(command) for command in self.commands]

    def get_scene(self) -> str:
        """The scene as a page of its own; what ``Visualizer.static_html()`` asks for."""
        return viewer_page("MeshCat", self.packed(), {})


def recording() -> tuple[SceneRecorder, Any]:
    """An empty scene in memory, and the ``meshcat.Visualizer`` that draws into it."""
    import meshcat

    recorder = SceneRecorder()
    return recorder, meshcat.Visualizer(window=recorder)


class Show(NamedTuple):
    """What a page shows, whether it is exported or served.

    Attributes:
        title: of the page.
        about: see `page_data`.
        draw: puts scene and clock into an empty ``meshcat.Visualizer``.
    """

    title: str
    about: dict[str, Any]
    draw: Callable[[Any], None]


def planar_show(
    title: str, actors: Sequence[Actor], fps: float = 30.0, plots: bool = True, theme: str = "auto"
) -> Show:
    """The robots of `cast`, seen from the front."""
    about = page_data(actors, plots, theme, fps)

    def draw(visualizer: Any) -> None:
        draw_scene(visualizer, actors)
        start_clock(visualizer, about["duration"])

    return Show(title, about, draw)


def exported_page(show: Show) -> str:
    """The text of a page that needs no network and opens from a file."""
    recorder, visualizer = recording()
    show.draw(visualizer)
    return viewer_page(show.title, recorder.packed(), show.about)


def animation_page(
    biped: FrontalBiped,
    trajectory: Trajectory,
    title: str = "Frontal-plane walking",
    fps: float = 30.0,
    *,
    ghost: bool = False,
    beside: tuple[FrontalBiped, Trajectory] | None = None,
    overlay: bool = False,
    plots: bool = True,
    theme: str = "auto",
) -> str:
    """One HTML page with the animated robot, its time line, and plots that follow it.

    The page needs no network and opens from a file. It shows the run in a loop and in real time.

    Args:
        biped: the robot.
        trajectory: the run, at least one sample.
        title: of the page.
        fps: frames of the motion a second, fewer for a long walk; the page interpolates between them.
        ghost: show the desired posture (beta, h_d(beta)) as well, translucent.
        beside: a second robot and its run, on the right of the first.
        overlay: the second run translucent over the first instead.
        plots: with plots below the robot.
        theme: "auto" (what the browser prefers), "light" or "dark".

    Returns:
        The page's text, about 1 MB; with the meshes of a robot 2 to 4 MB; a walk of 1000 steps adds up to 5 MB.
    """
    actors = cast(biped, trajectory, ghost=ghost, beside=beside, overlay=overlay)
    return exported_page(planar_show(title, actors, fps, plots, theme))


def viewer_page(title: str, packed: list[bytes], about: dict[str, Any], socket: bool = False) -> str:
    """The viewer around a scene.

    Args:
        title: of the page.
        packed: the scene's commands; empty if they come by web socket.
        about: see `page_data`.
        socket: connect back to the server of the page.

    Returns:
        The page's text.
    """
    return scene_page(
        "viewer",
        title,
        packed,
        about,
        ("plots", "timeline", "motion", "room", "viewer"),
        ("viewer",),
        connect="ws:" if socket else "",
        schemes="light dark",
        socket="true" if socket else "false",
    )


def scene_page(
    body: str,
    title: str,
    packed: list[bytes],
    about: dict[str, Any],
    scripts: Sequence[str],
    styles: Sequence[str],
    *,
    schemes: str = "light",
    connect: str = "",
    **more: str,
) -> str:
    """A page around MeshCat's viewer, its parts by their names in the package's ``web`` folder.

    Args:
        body: HTML with places for what follows.
        title: of the page.
        packed: the scene's commands.
        about: what the scripts read.
        scripts: JavaScript, in this order.
        styles: CSS, in this order.
        schemes: see `closed_page`.
        connect: see `closed_page`.
        more: what else the body has places for.
    """
    text = Template(web_text(f"{body}.html")).substitute(
        title=html.escape(title),
        meshcat_licence=_viewer_file("main.min.js.LICENSE.txt").replace("--", "- -"),
        meshcat=_viewer_file("main.min.js"),
        commands=script_json([base64.b64encode(command).decode("ascii") for command in packed]),
        about=script_json(about),
        script="".join(web_text(f"{name}.js") for name in scripts),
        **more,
    )
    style = "".join(web_text(f"{name}.css") for name in styles)
    return closed_page(title, style, text, schemes=schemes, connect=connect)


def closed_page(title: str, style: str, body: str, *, schemes: str = "light", connect: str = "") -> str:
    """A page that loads nothing but what it holds; its content security policy says so to the browser.

    Args:
        title: of the page.
        style: CSS.
        body: HTML.
        schemes: colour schemes that the style knows.
        connect: what else it may connect to; "" is nothing.

    Returns:
        The page's text.
    """
    return Template(web_text("page.html")).substitute(
        title=html.escape(title), style=style, body=body, schemes=schemes, connect=connect
    )


def script_json(value: Any) -> str:
    """JSON that may stand inside a script element."""
    return json.dumps(value, allow_nan=False).replace("<", "\\u003c").replace("\u2028", "\\u2028")


def web_text(name: str, package: str = "frontal_biped.viewer") -> str:
    """A file of a package's ``web`` folder."""
    return (files(package) / "web" / name).read_text(encoding="utf-8")


def _viewer_file(name: str) -> str:
    return (files("meshcat") / "viewer" / "dist" / name).read_text(encoding="utf-8")
