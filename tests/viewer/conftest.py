"""A browser."""

import os
import shutil
from collections.abc import Iterator

import pytest

from frontal_biped.viewer.headless import CHROMIUM_OPTIONS


@pytest.fixture(scope="session")
def chromium() -> str:
    """Where Chromium is."""
    executable = shutil.which("chromium")
    if executable is None:
        # continuous integration installs it: there its absence is a failure
        assert not os.environ.get("CI"), "no chromium on the PATH"
        pytest.skip("no chromium on the PATH")
    return executable


@pytest.fixture(scope="module")
def browser(chromium: str) -> Iterator[object]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=chromium, args=list(CHROMIUM_OPTIONS))
        yield opened
        opened.close()
