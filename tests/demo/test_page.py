"""The report holds what it is given, as text, and asks no network."""

import re

from offline import assert_offline

from frontal_biped.demo.page import report_page
from frontal_biped.figures.style import DARK


def test_report_escapes_text_and_asks_no_network(biped, orbit):
    report = report_page(
        biped,
        orbit,
        [("torques", "<svg id='a'></svg>"), ("own <caption>", "<svg id='b'></svg>")],
        numbers=[
            ("multiplier <m>", 0.7553, "-"),
            ("residual", 1.5e-13, "rad"),
            ("steps", 4, ""),
            ("bad", float("nan"), ""),
        ],
        constraints=[
            ("C01", "a & b", 1.0, 2.0, 1.0, "-"),
            ("C02", "short", 0.1, 0.2, -0.1, "rad"),
            ("C03", "unknown", "nan", "1", "nan", "-"),
        ],
        statements=[("0 < m < 1", "certified", "proved")],
        notes=["<script>alert(1)</script>"],
        title="A <title>",
    )
    links = assert_offline(report)
    assert len(links.frames) == 1
    assert_offline(links.frames[0])
    for text in ("multiplier &lt;m&gt;", "a &amp; b", "&lt;script&gt;alert(1)", "<title>A &lt;title&gt;</title>"):
        assert text in report
    assert "<td>certified</td><td>proved</td>" in report and "0 &lt; m &lt; 1" in report
    assert "Joint torques over two steps." in report
    assert "own &lt;caption&gt;" in report
    assert "1.5 × 10<sup>−13</sup>" in report
    assert report.count('class="violated"') == 2
    assert report.count('class="kept"') == 1


def test_report_without_tables(biped, orbit):
    report = report_page(biped, orbit, [])
    assert "<table" not in report.split("</iframe>")[1]


def test_colours_of_figures_follow_the_browser(biped, orbit):
    """A colour that has a dark one is a variable of the page; the page's own style gives the variable a value."""
    report = report_page(biped, orbit, [("torques", "<svg><path style='fill: #ffffff; stroke: #e69f00'/></svg>")])
    assert "fill: var(--figure-ffffff, #ffffff); stroke: #e69f00" in report
    dark = report.split("@media (prefers-color-scheme: dark)")[-1].split("}")[0]
    assert f"--figure-ffffff: {DARK['#ffffff']};" in dark
    assert '<meta name="color-scheme" content="light dark">' in report


def test_steps_are_counted_once(biped, orbit):
    """What the report says above the picture is what the page in it says."""
    report = report_page(biped, orbit, [])
    (inner,) = re.findall(r"&quot;steps&quot;: (\d+)", report)
    assert int(inner) == orbit.steps_completed
    assert f"<p>{orbit.steps_completed} steps, completed</p>" in report
