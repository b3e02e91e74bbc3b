"""A command as a user to whom something is forbidden, also where root runs the tests."""

import os
import shutil

import pytest


def as_ordinary_user() -> list[str]:
    """What to put before a command; root gives up what only root may, for nothing is forbidden to it before."""
    if os.geteuid() != 0:
        return []
    if not shutil.which("setpriv"):
        pytest.skip("root cannot be made an ordinary user here")
    return ["setpriv", "--bounding-set=-all", "--inh-caps=-all"]
