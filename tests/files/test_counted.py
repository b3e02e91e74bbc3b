"""One is one."""

import pytest

from frontal_biped.files.counted import counted


@pytest.mark.parametrize(("number", "words"), [(0, "0 steps"), (1, "1 step"), (2, "2 steps"), (1000, "1000 steps")])
def test_one_is_one(number, words):
    assert counted(number, "step") == words
