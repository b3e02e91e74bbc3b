"""The controls beside the robot: sliders, status, push, save."""

from typing import Any

from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.studio.jobs import LARGEST_PUSH, PUSH_MOMENTS
from frontal_biped.studio.knobs import Knob
from frontal_biped.studio.status import headline, margins, notice_text, push_text
from frontal_biped.studio.workbench import State, Workbench

WIDTH = 400.0  # [px]


class Panel:
    """The controls, and what they ask of the workbench.

    Args:
        server: a ``viser.ViserServer``.
        workbench: what they act on.
    """

    def __init__(self, server: Any, workbench: Workbench) -> None:
        self._server, self._workbench = server, workbench
        self._shown: dict[str, Any] = {}
        self._sliders: dict[str, Any] = {}
        self._robot = ""
        self._specification: GaitSpecification | None = None
        gui = server.gui
        gui.configure_theme(show_logo=False, show_share_button=False, brand_color=(0, 114, 178))
        gui.main_panel.dock_right()
        gui.main_panel.set_width(WIDTH)
        gui.set_panel_label("frontal_biped studio")
        self._robots = gui.add_dropdown("robot", workbench.robots, initial_value=workbench.state.robot, order=0)
        self._headline = gui.add_html("", order=1)
        self._folder: Any = None
        with gui.add_folder("gait in curves", order=2.5):
            self._curves = gui.add_html("")
        with gui.add_folder("push at the pelvis", order=3):
            size = gui.add_slider(
                "impulse [N s]", -LARGEST_PUSH, LARGEST_PUSH, 1.0, 10.0,
                hint="positive: outwards, away from the swing foot; negative: inwards",
            )  # fmt: skip
            moment = gui.add_dropdown("when", list(PUSH_MOMENTS), initial_value="at the reversal")
            button = gui.add_button("Push", color="red")
            self._push = gui.add_html("")
        with gui.add_folder("constraints", order=4):
            self._margins = gui.add_html("")
        with gui.add_folder("show and save", order=5):
            self.speed = gui.add_slider("speed", 0.0, 1.0, 0.05, 1.0, hint="1: real time; 0: still")
            self._phase = gui.add_html("")
            save = gui.add_button("Save gait and page", hint="into the folder that the command line names")
            self._notice = gui.add_html("")
        button.on_click(lambda _: workbench.push(float(size.value), str(moment.value)))
        save.on_click(lambda _: workbench.save())
        self._robots.on_update(self._on_robot)

    def show(self, state: State) -> None:
        """Bring the screen up to date."""
        if state.robot != self._robot:
            self._robot = state.robot
            self._make_sliders(state.knobs, state)
        elif state.specification != self._specification:
            self._place_sliders(state)
        self._specification = state.specification
        if self._robots.value != state.robot:
            self._robots.value = state.robot
        self._put(self._headline, headline(state))
        self._put(self._margins, margins(state.report))
        self._put(self._curves, state.curves)
        self._put(self._push, push_text(state))
        self._put(self._notice, notice_text(state))

    def show_phase(self, text: str) -> None:
        """Time, step and phase of the picture."""
        self._put(self._phase, f'<div style="font-size:.85em;padding:0 .9em">{text}</div>')

    def _make_sliders(self, knobs: tuple[Knob, ...], state: State) -> None:
        gui = self._server.gui
        if self._folder is not None:
            self._folder.remove()
        self._sliders = {}
        self._folder = gui.add_folder("specification", order=2)
        with self._folder:
            for knob in knobs:
                value = knob.shown(state.specification)
                make = gui.add_multi_slider if isinstance(value, tuple) else gui.add_slider
                slider = make(knob.text(value), knob.low, knob.high, knob.step, value, hint=knob.hint)
                slider.on_update(lambda event, key=knob.key: self._on_slider(event, key))
                self._sliders[knob.key] = slider
            reset = gui.add_button("Reset", color="gray", hint="the specification that suits the robot")
            reset.on_click(lambda _: self._workbench.reset())

    def _place_sliders(self, state: State) -> None:
        """Sliders follow a reset; the one under the user's hand already stands where it should."""
        for knob in state.knobs:
            value = knob.shown(state.specification)
            slider, label = self._sliders[knob.key], knob.text(value)
            if slider.value != value:
                slider.value = value
            if slider.label != label:
                slider.label = label

    def _on_slider(self, event: Any, key: str) -> None:
        if event.client is not None:  # not our own doing
            value = event.target.value
            moved = (float(value[0]), float(value[1])) if isinstance(value, tuple) else float(value)
            if not self._workbench.turn(key, moved):
                self._place_sliders(self._workbench.state)

    def _on_robot(self, event: Any) -> None:
        if event.client is not None and event.target.value != self._workbench.state.robot:
            self._workbench.choose_robot(str(event.target.value))

    def _put(self, handle: Any, content: str) -> None:
        if handle.content != content:
            handle.content = content
