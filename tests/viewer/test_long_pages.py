"""Pages of a thousand steps: as small as they must be, and as quick in the browser as one of four."""

import base64
from dataclasses import replace

import numpy as np
import pytest
from swept_walk import swept_walk

from frontal_biped.gait.file import load_gait
from frontal_biped.model import load_robot, models_dir
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.simulation import orbit_trajectory
from frontal_biped.simulation.space.run import SAMPLED
from frontal_biped.simulation.world import phase_spans
from frontal_biped.viewer import animation_page
from frontal_biped.viewer.page_data import page_data
from frontal_biped.viewer.scene import cast
from frontal_biped.viewer.space_page import space_page

pytestmark = pytest.mark.slow

STEPS = 1000

MOST_BYTES = 10e6

SLOWER = 2.5
"""How much more of the page's own thread a frame may cost than with four steps; both are a few milliseconds."""

LEAST_RATE = 0.4
"""Frames a second with all steps in the plots, over those with four: the same but for what else the machine does."""

FRAMES = 30

RATE = """(frames) => new Promise((done) => {
  const begun = performance.now();
  let left = frames;
  const next = () => (left-- ? requestAnimationFrame(next) : done(1e3 * frames / (performance.now() - begun)));
  next();
})"""


@pytest.mark.parametrize("name", ["frontal_biped", "g1", "talos_full", "romeo"])
def test_a_page_of_a_thousand_steps_is_below_ten_megabytes(name, gait):
    biped = load_robot(name)
    own = gait if name == "frontal_biped" else load_gait(models_dir() / f"{name}.gait.json")
    run = orbit_trajectory(biped, own, STEPS, samples=50)
    assert len(animation_page(biped, run)) < MOST_BYTES
    told = page_data(cast(biped, run))["runs"][0]
    assert told["steps"] == STEPS
    assert len(told["phases"]) == len(phase_spans(run)) == 2 * STEPS
    fri = np.frombuffer(base64.b64decode(told["samples"]["channels"]["fri"]), dtype="<f4")
    np.testing.assert_allclose([fri.min(), fri.max()], [1e3 * run.p_fri.min(), 1e3 * run.p_fri.max()], rtol=1e-6)


def test_a_page_of_a_thousand_steps_in_space_is_below_ten_megabytes():
    biped, gait = load_robot("talos_full"), load_gait(models_dir() / "talos_full.gait.json")
    run = repeated(swept_walk(biped, gait, steps=4, step_length=0.2), STEPS // 4)
    assert run.steps_completed == STEPS
    assert len(space_page(FreeRobot(biped.robot), run, orbit_trajectory(biped, gait, 1))) < MOST_BYTES


def repeated(run, times):
    """A walk over and over, each time from where it ended."""
    size, duration, steps = len(run.t), run.t[-1] - run.t[0] + 1e-3, run.steps_completed
    arrays = {name: np.concatenate([getattr(run, name)] * times) for name in SAMPLED}
    turn, further = np.repeat(np.arange(times), size), run.com[-1, 0] - run.com[0, 0]
    arrays["t"] = arrays["t"] + turn * duration
    arrays["step"] = arrays["step"] + turn * steps
    for name in ("q", "com"):
        arrays[name][:, 0] += turn * further
    arrays["sole_position"][:, :, 0] += (turn * further)[:, None]
    again = np.repeat(np.arange(times), len(run.event_t))
    return replace(
        run,
        **arrays,
        event_t=np.concatenate([run.event_t] * times) + again * duration,
        event_kind=run.event_kind * times,
        event_step=np.concatenate([run.event_step] * times) + again * steps,
        event_frontal=np.concatenate([run.event_frontal] * times),
        steps_completed=times * steps,
    )


@pytest.mark.browser
def test_a_thousand_steps_play_as_well_as_four(browser, biped, gait, tmp_path):
    """The scene is the same; what the page itself does between two frames must not grow with the walk."""
    costs, rates = {}, {}
    for steps in (4, STEPS):
        path = tmp_path / f"{steps}.html"
        path.write_text(animation_page(biped, orbit_trajectory(biped, gait, steps, samples=50)), encoding="utf-8")
        page = browser.new_page(viewport={"width": 700, "height": 500})
        page.set_default_timeout(240_000)
        meter = page.context.new_cdp_session(page)
        meter.send("Performance.enable", {"timeDomain": "threadTicks"})  # processor time: others may be busy
        page.goto(path.as_uri())
        page.wait_for_function("window.page && viewer.animator.duration > 0")
        page.evaluate("page.seek(0.6 * page.duration()); viewer.animator.play()")
        page.evaluate(
            "window.drawn = 0; (function count() { window.drawn++; requestAnimationFrame(count); })(); undefined"
        )
        page.wait_for_function("window.drawn > 3")
        before, first = processor_time(meter), page.evaluate("window.drawn")
        page.wait_for_function(f"window.drawn > {first + FRAMES}")
        costs[steps] = (processor_time(meter) - before) / (page.evaluate("window.drawn") - first)
        # all steps in the plots: nothing of them is painted again while the cursors move
        page.locator("#window").select_option("0")
        page.wait_for_timeout(500)
        rates[steps] = page.evaluate(RATE, FRAMES)
        assert page.locator(".strip .mark").count() <= 240
        page.close()
    assert costs[STEPS] < SLOWER * costs[4]
    assert rates[STEPS] > LEAST_RATE * rates[4]


def processor_time(meter):
    metrics = {metric["name"]: metric["value"] for metric in meter.send("Performance.getMetrics")["metrics"]}
    return metrics["TaskDuration"]
