"""The exported page in narrow and wide windows, light and dark: no scrolling sideways, nothing over the feet."""

from dataclasses import replace

import numpy as np
import pytest

from frontal_biped.viewer import animation_page

pytestmark = pytest.mark.browser

NARROW = 400  # [px]


@pytest.fixture(scope="module")
def spiked(orbit):
    """A run whose stance ankle jumps for one sample after each impact, as contacts make it do."""
    dq = orbit.dq.copy()
    first = [int(np.argmax(orbit.step == step)) for step in np.unique(orbit.step)]
    dq[first, 0] += 40.0 * np.abs(orbit.dq[:, 0]).max()
    return replace(orbit, dq=dq)


SIZES = [
    (NARROW, "dark"),
    pytest.param((NARROW, "light"), marks=pytest.mark.slow),
    pytest.param((1280, "dark"), marks=pytest.mark.slow),
]


@pytest.fixture(scope="module", params=SIZES, ids=str)
def shown(request, browser, biped, spiked, tmp_path_factory):
    width, scheme = request.param
    path = tmp_path_factory.mktemp("page") / "page.html"
    path.write_text(animation_page(biped, spiked), encoding="utf-8")
    page = browser.new_page(viewport={"width": width, "height": 800}, color_scheme=scheme)
    page.goto(path.as_uri(), timeout=90_000)
    page.wait_for_function("window.page && viewer.animator.duration > 0", timeout=90_000)
    yield page, width, scheme
    page.close()


def lightness(page, selector, what):
    """Mean of red, green and blue of a computed colour."""
    colour = page.evaluate("([s, w]) => getComputedStyle(document.querySelector(s))[w]", [selector, what])
    return np.mean([float(part) for part in colour[colour.index("(") + 1 : -1].split(",")[:3]])


def test_nothing_is_scrolled_sideways(shown):
    page, width, _ = shown
    widest = page.evaluate("Math.max(document.documentElement.scrollWidth, document.body.scrollWidth)")
    assert widest <= width == page.evaluate("innerWidth")


def test_nothing_lies_over_the_picture_of_a_narrow_page(shown):
    """The legend is below the picture at every width; the caption is above it where there is no room beside."""
    page, width, _ = shown
    scene, legend, caption = (page.locator(part).bounding_box() for part in ("#scene", "#toggles", "#caption"))
    assert legend["y"] >= scene["y"] + scene["height"] - 1.0
    if width == NARROW:
        assert caption["y"] + caption["height"] <= scene["y"] + 1.0


def test_colours_are_those_the_browser_wishes_down_to_the_plots(shown):
    page, _, scheme = shown
    dark = scheme == "dark"
    assert (lightness(page, "body", "backgroundColor") < 80.0) == dark
    assert (lightness(page, ".plot", "backgroundColor") < 80.0) == dark
    assert (lightness(page, ".field text", "fill") > 128.0) == dark
    sky = page.evaluate("viewer.scene_tree.find(['Background']).object.top_color")
    assert (np.mean(sky) < 128.0) == dark


def test_spikes_are_clipped_in_the_phase_portrait_and_it_says_so(shown, spiked):
    page, _, _ = shown
    portrait = page.locator(".plot").nth(3)
    ticks = [
        float(text.replace("−", "-")) for text in portrait.locator(".field text[text-anchor=end]").all_text_contents()
    ]
    most = 2.0 * float(np.quantile(np.abs(spiked.dq[:, 0]), 0.98))
    assert max(abs(tick) for tick in ticks) < most < 0.2 * float(np.abs(spiked.dq[:, 0]).max())
    assert "clipped" in portrait.locator(".note").inner_text()
    assert "clipped" not in page.locator(".plot").nth(0).locator(".note").inner_text()
