"""A sample of the campaign of `fuzz_campaign`: every command on spoilt files and with senseless options."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

CAMPAIGN = Path(__file__).parents[1] / "fuzz_campaign.py"


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_a_hundred_cases_behave(seed):
    # a process of its own: cases are forked from it, and forks of one with threads may stand still
    command = [sys.executable, str(CAMPAIGN), "--cases", "100", "--seed", str(seed)]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=1200, env={**os.environ, "CI": "true"})
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert "cases range(0, 100)" in ended.stdout
