"""Archives are opened without trust: what NumPy writes is read, to the bit; the rest is refused before it is read."""

import json
import zipfile

import numpy as np
import pytest

from frontal_biped.exceptions import TrajectoryFileError
from frontal_biped.files.npz import Head, open_npz


@pytest.mark.parametrize("write", [np.savez, np.savez_compressed])
def test_what_numpy_writes_is_read(write, tmp_path):
    generator = np.random.default_rng(0)
    arrays = {
        "a": generator.normal(size=(3, 2, 4)), "transposed": generator.normal(size=(3, 2)).T, "none": np.zeros((0, 4)),
        "zero": np.array([0.0, -0.0, 5e-324, 1e308]), "one": np.array(3.0), "bool": np.array([True, False]),
        "big": np.arange(5, dtype=">i4"), "half": np.ones(3, dtype=np.float16), "whole": np.arange(3, dtype=np.uint8),
    }  # fmt: skip
    write(tmp_path / "a.npz", header=np.array(json.dumps({"format": "é"})), **arrays)
    with open_npz(tmp_path / "a.npz") as archive:
        assert archive.header() == {"format": "é"}
        for name, array in arrays.items():
            if name == "one":  # no rows
                continue
            head = archive.head(name)
            assert head.are_numbers and head.shape == array.shape
            back = archive.read(name, head)
            assert back.dtype == np.float64 and back.flags.c_contiguous
            np.testing.assert_array_equal(back, array.astype(float))
            np.testing.assert_array_equal(np.signbit(back), np.signbit(array.astype(float)))


def test_head(tmp_path):
    np.savez(tmp_path / "a.npz", a=np.zeros((2, 3), order="F"))
    with open_npz(tmp_path / "a.npz") as archive:
        assert archive.head("a") == Head("<f8", (2, 3), True, 128)
        with pytest.raises(ValueError, match="b is missing"):
            archive.head("b")
        with pytest.raises(ValueError, match="header is missing"):
            archive.header()


def test_keys_of_a_head_stand_in_any_order(tmp_path):
    """As other programs than NumPy may write them."""
    text = b"{'shape': (2,), 'fortran_order': False, 'descr': '<f8'}".ljust(117) + b"\n"
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("a.npy", b"\x93NUMPY\x01\x00\x76\x00" + text + np.arange(2.0).tobytes())
    with open_npz(tmp_path / "a.npz") as opened:
        np.testing.assert_array_equal(opened.read("a", opened.head("a")), [0.0, 1.0])


def test_what_is_no_file(tmp_path):
    with pytest.raises(FileNotFoundError), open_npz(tmp_path / "a.npz"):
        pass
    with pytest.raises(TrajectoryFileError, match="directory"), open_npz(tmp_path):
        pass
