"""The shipped scenarios and the table of them that lies beside them."""

import re
from pathlib import Path

from frontal_biped.scenarios import load_scenario

ROOT = Path(__file__).resolve().parents[2]
SHIPPED = sorted((ROOT / "examples" / "scenarios").glob("*.toml"))
TABLE = (ROOT / "examples" / "scenarios" / "README.md").read_text(encoding="utf-8")


def test_the_plugin_collects_them_all():
    assert len(SHIPPED) >= 9
    assert all(path.name.endswith(".scenario.toml") for path in SHIPPED)


def test_table_is_about_them():
    lines = [line for line in TABLE.splitlines() if line.startswith("|")][2:]
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines]
    scenarios = [load_scenario(path) for path in SHIPPED]
    assert [row[:2] for row in rows] == [[scenario.name, scenario.about] for scenario in scenarios]
    for row, scenario in zip(rows, scenarios, strict=True):
        assert row[2].startswith(scenario.simulator)
        passed, trials = map(int, re.match(r"(\d+) of (\d+)", row[3]).groups())
        assert trials == scenario.repeat
        assert passed >= trials * scenario.expect.survival
