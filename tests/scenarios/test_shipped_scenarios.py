"""The shipped scenarios and the README's table of them."""

import re
from pathlib import Path

import pytest

from frontal_biped.scenarios import load_scenario, run_trials

ROOT = Path(__file__).resolve().parents[2]
SHIPPED = sorted((ROOT / "examples" / "scenarios").glob("*.toml"))
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_plugin_collects_them_all():
    assert len(SHIPPED) >= 9
    assert all(path.name.endswith(".scenario.toml") for path in SHIPPED)


def test_readme_table_is_about_them():
    table = re.search(r"<!-- robustness-table -->\n(.*?)<!-- end -->", README, re.DOTALL)[1]
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in table.splitlines()[2:] if line]
    scenarios = [load_scenario(path) for path in SHIPPED]
    assert [row[:2] for row in rows] == [[scenario.name, scenario.about] for scenario in scenarios]
    for row, scenario in zip(rows, scenarios, strict=True):
        assert row[2].startswith(scenario.simulator)
        passed, trials = map(int, re.match(r"(\d+) of (\d+)", row[3]).groups())
        assert trials == scenario.repeat
        assert passed >= trials * scenario.expect.survival


@pytest.mark.slow
def test_readme_example_is_as_expected(tmp_path):
    block = next(text for text in re.findall(r"```toml\n(.*?)```", README, re.DOTALL) if "[[push]]" in text)
    path = tmp_path / "push.scenario.toml"
    path.write_text(block, encoding="utf-8")
    (result,) = run_trials([load_scenario(path)])
    assert result.passed, str(result.results)
