"""Run files with anything wrong: refused in one line that names the file, or loaded as what they were.

Of a small run in the plane and one in space every array, every entry of the header and the archive itself are spoilt in
every way that a file can be; then bytes at random.
"""

import io
import json
import os
import random
import struct
import subprocess
import sys
import time
import tracemalloc
import warnings
import zipfile
from dataclasses import fields

import numpy as np
import pytest
from ordinary_user import as_ordinary_user
from small_runs import planar_run, spatial_run

from frontal_biped.exceptions import TrajectoryFileError
from frontal_biped.files.array_schema import FREELY, LARGEST, MOST_BYTES
from frontal_biped.files.kinds import RUN, SPACE_RUN, archive_format, named_kind
from frontal_biped.files.npz import MOST_PIECE
from frontal_biped.simulation import load_spatial_run, load_trajectory, save_spatial_run, save_trajectory
from frontal_biped.simulation.space.run import _schema as spatial_schema
from frontal_biped.simulation.trajectory import EVENT_SLACK, LONGEST
from frontal_biped.simulation.trajectory import _schema as planar_schema

PATIENCE = 2.0
"""What a small file may take to be refused [s]; a tenth of it on a quiet machine."""

KINDS = {
    "plane": (planar_run, save_trajectory, load_trajectory),
    "space": (spatial_run, save_spatial_run, load_spatial_run),
}
SAVED = {}
SCHEMAS = {"plane": planar_schema(2), "space": spatial_schema(2, 2)}


class Spoilt:
    """A run file taken apart, to be put together wrongly."""

    def __init__(self, kind, folder):
        make, save, self.load = KINDS[kind]
        self.kind, self.run, self.path = kind, make(), folder / "run.npz"
        if kind not in SAVED:
            save(self.run, self.path)
            SAVED[kind] = self.path.read_bytes()
        self.good = SAVED[kind]
        self.path.write_bytes(self.good)
        with zipfile.ZipFile(self.path) as archive:
            self.entries = {name: archive.read(name) for name in archive.namelist()}
        with np.load(self.path) as archive:
            self.arrays = {name: archive[name] for name in archive.files}
        self.header = json.loads(str(self.arrays["header"]))

    def write(self, entries, compression=zipfile.ZIP_STORED):
        """Entries (name, bytes) as an archive."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of entries that are there twice
            with zipfile.ZipFile(self.path, "w", compression) as archive:
                for name, content in entries:
                    archive.writestr(name, content)
        return self.path

    def with_entry(self, name, content):
        return self.write((self.entries | {name: content}).items())

    def with_array(self, name, array, **options):
        return self.with_entry(f"{name}.npy", npy(array, **options))

    def with_header(self, **changes):
        return self.with_text(json.dumps(self.header | changes))

    def with_text(self, text):
        return self.with_array("header", np.array(text))

    def refuse(self, match=None):
        """Loading is refused in one line, soon, and without any other word."""
        began = time.monotonic()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with pytest.raises(TrajectoryFileError, match=match) as error:
                self.load(self.path)
        assert time.monotonic() - began < PATIENCE
        told = str(error.value)
        assert str(self.path) in told and told.isprintable() and len(told) < 1000 and ";" in told

    def same(self):
        back = self.load(self.path)
        return all(
            np.array_equal(a, b, equal_nan=True) if isinstance(a, np.ndarray) else a == b
            for field in fields(back)
            for a, b in [(getattr(self.run, field.name), getattr(back, field.name))]
        )


def npy(array, **options):
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.asanyarray(array), **options)
    return stream.getvalue()


def told_npy(descr, shape, content=b"", order=False):
    """An entry that says of itself what it likes."""
    head = f"{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head) + 1) + head.encode() + b"\n" + content


@pytest.fixture(params=KINDS)
def file(request, tmp_path):
    return Spoilt(request.param, tmp_path)


def test_the_run_itself_loads(file):
    assert file.same()
    assert archive_format(file.path) == {"plane": RUN, "space": SPACE_RUN}[file.kind]


class TestArrays:
    @pytest.mark.parametrize(("kind", "name"), [(kind, name) for kind in KINDS for name in SCHEMAS[kind]])
    def test_every_array_wrong_in_every_way(self, kind, name, tmp_path):
        file = Spoilt(kind, tmp_path)
        array, schema = file.arrays[name], SCHEMAS[kind][name]

        def refused(spoilt):
            file.with_array(name, spoilt)
            file.refuse(name)

        file.write((key, content) for key, content in file.entries.items() if key != f"{name}.npy")
        file.refuse(f"{name} is missing")
        for shape in ((), (0,), (*array.shape, 1), (1, *array.shape), (*array.shape[::-1], 2), (array.size + 1,)):
            refused(np.zeros(shape))
        refused(array[:-1])
        refused(np.concatenate([array, array[-1:]]))
        for dtype in ("U5", "S5", "complex128", "longdouble", "datetime64[s]", [("a", float), ("b", float)]):
            refused(np.zeros(array.shape, dtype=dtype))
        file.with_array(name, np.full(array.shape, None), allow_pickle=True)
        file.refuse(name)
        for value in (np.inf, -np.inf, 1e300, -1e300, 1e31):
            spoilt = array.copy()
            spoilt.reshape(-1)[0] = value
            refused(spoilt)
        full_of_nan = np.full(array.shape, np.nan)
        if not schema.gaps:
            refused(full_of_nan)
        if schema.posture:  # a hole: the robot cannot have diverged and come back
            hole = array.copy()
            hole[1] = np.nan
            refused(hole)
        if schema.among:
            for value in (0.5, 2.0, np.nan):
                refused(np.full(array.shape, value))
        if schema.whole:
            refused(np.full(array.shape, 0.5))
            refused(np.full(array.shape, -2.0))
        if schema.ordered:
            refused(np.linspace(3.0, 1.0, len(array)).round())

    @pytest.mark.parametrize("dtype", ["<f4", ">f8", "<i8", ">i2", "|b1", "<f2"])
    def test_numbers_of_any_size_and_order_are_numbers(self, file, dtype):
        whole = {"phase", "stance", "step", "event_step"} if dtype != "|b1" else {"step", "event_step"}
        for name in whole:
            file.entries[f"{name}.npy"] = npy(file.arrays[name].astype(dtype))
        file.write(file.entries.items())
        assert file.same()

    def test_columns_first_and_deflated(self, file):
        """As `numpy.savez_compressed` writes an array that is transposed."""
        file.entries["q.npy"] = npy(np.asfortranarray(file.arrays["q"]))
        assert b"True" in file.entries["q.npy"]
        file.write(file.entries.items(), zipfile.ZIP_DEFLATED)
        assert file.same()

    def test_what_is_not_known_is_nan(self, file):
        names = [name for name, schema in SCHEMAS[file.kind].items() if schema.gaps]
        for name in names:
            file.entries[f"{name}.npy"] = npy(np.full(file.arrays[name].shape, np.nan))
        signalling = np.full(file.arrays["p_fri"].shape, np.frombuffer(struct.pack("<Q", 0x7FF4000000000000))[0])
        file.entries["p_fri.npy"] = npy(signalling)
        file.write(file.entries.items())
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            back = file.load(file.path)
            assert all(np.isnan(1e3 * getattr(back, name)).all() for name in names)

    def test_a_robot_that_diverges_does_so_to_the_end(self, file):
        for value in (np.nan, np.inf, 1e300):
            array = file.arrays["q"].copy()
            array[-2:] = value
            file.with_array("q", array)
            assert np.array_equal(file.load(file.path).q, array, equal_nan=True)
            array[0] = value
            file.with_array("q", array)
            file.refuse(r"q\[0, 0\]")

    @pytest.mark.parametrize(
        "entry",
        [
            told_npy("'<f8'", "(5,)", b"\0" * 32),
            told_npy("'<f8'", "(5,)", b"\0" * 48),
            told_npy("'<f8'", "(-5,)", b"\0" * 40),
            told_npy("'<f8'", "(10000000,)"),
            told_npy("'<f8'", f"({10**30},)"),
            told_npy("'<f8'", "(5, 0)"),
            told_npy("'<f8'", "5", b"\0" * 40),
            told_npy("'<f8'", "(5L,)", b"\0" * 40),  # of Python 2: NumPy would warn
            told_npy("'<f8'", "(5,)", b"\0" * 40, order="1"),
            told_npy("__import__('os')", "(5,)", b"\0" * 40),
            told_npy("'<f8'", "(" * 2000 + ")" * 2000),
            told_npy("'|a8'", "(5,)", b"\0" * 40),  # NumPy would warn
            told_npy("'O'", "(5,)", b"\x80\x04N."),
            told_npy("'|V8'", "(5,)", b"\0" * 40),
            told_npy("'<f8'", "(5,), 'shape': (5,)", b"\0" * 40),
            b"\x93NUMPY\x02\x00\xff\xff\xff\xff{}",
            b"\x93NUMPY\x09\x00\x10\x00{}",
            b"\x93NUMPY",
            b"\x93NUMPY\x01",
            b"",
            b"\x80\x04N.",
            b"[1, 2, 3, 4, 5]",
        ],
    )
    def test_entries_that_lie(self, file, entry):
        file.with_entry("t.npy", entry)
        file.refuse("t ")


class TestParts:
    """Each right, but not together."""

    @pytest.mark.parametrize(
        ("name", "array"),
        [
            ("t", [0.0, 1.0, 2.0, 3.0, LONGEST + 1.0]),
            ("t", [1e11, 1e11, 1e11, 1e11, 1e11]),
            ("event_t", [0.0, 1.1 + EVENT_SLACK]),
            ("event_t", [-0.1 - EVENT_SLACK, 0.0]),
            ("step", [0.0, 0.0, 1.0, 0.0, 0.0]),
        ],
    )
    def test_times_and_steps(self, file, name, array):
        file.with_array(name, np.array(array))
        file.refuse(name)

    def test_more_steps_than_were_walked(self, file):
        file.with_header(steps_completed=2)
        file.refuse("steps_completed = 2, but the last step has the index 0")

    def test_a_quaternion_is_of_length_one(self, tmp_path):
        file = Spoilt("space", tmp_path)
        q = file.arrays["q"].copy()
        for spoilt in (np.zeros(4), 2.0 * q[3, 3:7]):
            file.with_array("q", np.vstack([q[:3], np.concatenate([q[3, :3], spoilt, q[3, 7:]]), q[4:]]))
            file.refuse(r"q\[3, 3:7\]")

    def test_no_sample_at_all(self, file):
        for name, schema in SCHEMAS[file.kind].items():
            if schema.rows is None:
                file.entries[f"{name}.npy"] = npy(file.arrays[name][:0])
        file.write(file.entries.items())
        file.refuse("not one sample")

    def test_one_sample_and_no_event_are_a_run(self, file):
        for name, schema in SCHEMAS[file.kind].items():
            file.entries[f"{name}.npy"] = npy(file.arrays[name][: schema.rows is None])
        file.entries["header.npy"] = npy(json.dumps(file.header | {"event_kind": []}))
        file.write(file.entries.items())
        assert len(file.load(file.path).t) == 1


ANYTHING = (None, True, 3, -1, 0.5, 10**400, "", "two\nlines", "\x1b[31m", "x" * 10_000, "\ud800", [], [1], ["IMPAKT"],
            ["IMPACT", 3], [["IMPACT"]], {}, {"a": 1})  # fmt: skip


class TestHeader:
    @pytest.mark.parametrize("key", ["event_kind", "robot", "outcome", "steps_completed", "joint_names", "locked"])
    @pytest.mark.parametrize("value", ANYTHING, ids=lambda value: repr(value)[:20])
    def test_every_entry_of_every_other_type(self, file, key, value):
        legal = {"joint_names": [], "locked": ([], ["IMPAKT"]), "event_kind": []}
        if key not in file.header or value in legal.get(key, ()):
            return
        file.with_header(**{key: value})
        file.refuse()

    @pytest.mark.parametrize("key", ["gait", "settings"])
    def test_tables_are_tables(self, file, key):
        for value in ANYTHING[:-2]:
            file.with_header(**{key: value})
            file.refuse()

    @pytest.mark.parametrize("value", ["2", 2, True, None, 1.5, [1]])
    def test_versions(self, file, value):
        file.with_header(version=value)
        file.refuse("version 1")

    def test_every_entry_is_needed(self, file):
        for key in file.header:
            file.with_text(json.dumps({name: value for name, value in file.header.items() if name != key}))
            file.refuse()

    def test_names_of_joints_differ(self, tmp_path):
        file = Spoilt("space", tmp_path)
        file.with_header(joint_names=["hip", "hip"])
        file.refuse("joint_names")

    def test_what_is_no_text_of_json(self, file):
        good = json.dumps(file.header)
        for text in (
            "", "{", "[]", "3", '"text"', good[:-1], good[1:], good + "}", "[" * 100_000, '{"a": 1, "a": 2}',
            good[:-1] + ', "format": "frontal-biped-run"}', good[:-1] + ', "more": "\\ud800"}',
        ):  # fmt: skip
            file.with_text(text)
            file.refuse()
        file.with_text(f'{good[:-1]}, "version": {"9" * 5000}}}')
        file.refuse()
        for array in (np.zeros(3), np.array([good, good]), np.array(good.encode()), np.array(3.0)):
            file.with_array("header", array)
            file.refuse()
        file.with_entry("header.npy", told_npy("'<U2'", "()", b"\xff" * 8))  # beyond all characters
        file.refuse()

    def test_numbers_of_settings_need_not_be_finite(self, file):
        """Shares of a limit of 0 are not."""
        file.with_header(settings={"largest": float("inf")})
        assert file.load(file.path).settings == {"largest": float("inf")}

    def test_complaints_say_what_would_be_right(self, file):
        file.with_header(event_kind=["IMPACT", "LANDED"])
        file.refuse("event_kind = .'IMPACT', 'LANDED'.* is not a list of words among .*IMPACT, REVERSAL")


class TestArchives:
    def test_not_an_archive(self, file):
        for content in (
            b"",
            b"PK",
            b"PK\x03\x04 cut off",
            file.entries["t.npy"],
            b"\x1f\x8b" + bytes(100),
            bytes(10_000),
        ):
            file.path.write_bytes(content)
            file.refuse()

    def test_cut_off_anywhere(self, file):
        for length in range(0, len(file.good), 97):
            file.path.write_bytes(file.good[:length])
            file.refuse()

    @pytest.mark.parametrize("more", ["t.npy", "header.npy", "unknown.npy"])
    def test_an_entry_twice(self, file, more):
        twice = [*file.entries.items(), (more, file.entries["t.npy"]), (more, file.entries["t.npy"])]
        file.write(twice)
        file.refuse("there twice")

    @pytest.mark.parametrize("name", ["/t.npy", "../t.npy", "folder/t.npy", "t", "T.npy"])
    def test_an_entry_elsewhere(self, file, name):
        file.write((name if key == "t.npy" else key, content) for key, content in file.entries.items())
        file.refuse("t is missing")

    def test_more_entries_are_left(self, file):
        file.with_entry("mine.txt", b"notes")
        assert file.same()

    @pytest.mark.parametrize("compression", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
    def test_compressed_otherwise(self, file, compression):
        """These expand a kilobyte to a gigabyte in one piece."""
        file.write(file.entries.items(), compression)
        file.refuse("compressed")

    @pytest.mark.parametrize(("at", "value", "match"), [(8, 1, "encrypted"), (10, 99, "compressed"), (8, 32, None)])
    def test_flags(self, file, at, value, match):
        """At bytes of every entry of the directory, and two before in every entry itself."""
        content = bytearray(file.good)
        for magic, offset in ((b"PK\x01\x02", at), (b"PK\x03\x04", at - 2)):
            place = content.find(magic)
            while place >= 0:
                content[place + offset] |= value
                place = content.find(magic, place + 1)
        file.path.write_bytes(content)
        file.refuse(match)

    def test_a_directory_without_end(self, file):
        with zipfile.ZipFile(file.path, "w") as archive:
            for number in range(MOST_PIECE // 50):
                archive.writestr(f"{number:06d}.npy", b"")
        file.refuse("directory is too large")
        assert archive_format(file.path) == ""

    def test_neither_folder_nor_pipe_nor_device(self, file, tmp_path):
        os.mkfifo(tmp_path / "pipe.npz")
        for path, match in ((tmp_path, "directory"), (tmp_path / "pipe.npz", "pipe")):
            file.path = path
            file.refuse(match)
            assert archive_format(path) == "" and named_kind(path) is None
        for path in ("/dev/zero", "/dev/null"):
            with pytest.raises(TrajectoryFileError, match="device"):
                file.load(path)

    def test_names_that_cannot_be(self, file, tmp_path):
        for name in ("x" * 300 + ".npz", "run.npz\0", "absent/run.npz", "run.npz/run.npz"):
            with pytest.raises(TrajectoryFileError):
                file.load(tmp_path / name)
            assert archive_format(tmp_path / name) == "" and named_kind(tmp_path / name) is None

    def test_unreadable(self, file):
        file.path.chmod(0)
        code = f"""
import sys
from frontal_biped.exceptions import TrajectoryFileError
from frontal_biped.simulation import {file.load.__name__} as load
try:
    load(sys.argv[1])
except TrajectoryFileError as error:
    print(error)
"""
        command = [*as_ordinary_user(), sys.executable, "-c", code, str(file.path)]
        told = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        assert told.startswith(f"{file.path}: ") and "Permission denied" in told and told.count("\n") == 1


class TestSizes:
    """Judged by what the file says, before anything is read."""

    @pytest.mark.parametrize("size", [300_000_000, pytest.param(1_200_000_000, marks=pytest.mark.slow)])
    def test_a_bomb_is_not_expanded(self, file, size):
        """Zeros in an archive of a few megabytes: its directory is true, and every shape goes with the others."""
        rows = size // 8 // sum(int(np.prod(s.row)) for s in SCHEMAS[file.kind].values() if s.rows is None)
        assert FREELY < size < MOST_BYTES
        with zipfile.ZipFile(file.path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
            for name, content in file.entries.items():
                schema = SCHEMAS[file.kind].get(name.removesuffix(".npy"))
                if schema is None or schema.rows is not None:
                    archive.writestr(name, content)
                    continue
                with archive.open(name, "w", force_zip64=True) as stream:
                    shape = (rows, *schema.row)
                    stream.write(told_npy("'<f8'", f"({', '.join(map(str, shape))},)"))
                    left = 8 * int(np.prod(shape))
                    while left:
                        left -= stream.write(bytes(min(left, 1 << 24)))
        assert file.path.stat().st_size < size / 200
        tracemalloc.start()
        file.refuse("samples are [0-9]{9,10} bytes")
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 10_000_000

    def test_a_shape_that_is_not_there_is_not_allocated(self, file):
        """Ten million rows in every head, and a directory that agrees with none of them."""
        for name, schema in SCHEMAS[file.kind].items():
            if schema.rows is None:
                shape = (10**7, *schema.row)
                file.entries[f"{name}.npy"] = told_npy("'<f8'", f"({', '.join(map(str, shape))},)")
        file.write(file.entries.items())
        tracemalloc.start()
        file.refuse("t of shape .10000000,. has not as many numbers as it says")
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 10_000_000

    def test_a_header_of_a_hundred_megabytes(self, file):
        with zipfile.ZipFile(file.path, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("header.npy", told_npy(f"'<U{25_000_000}'", "()", b"{\0\0\0" * 25_000_000))
        file.refuse("header is larger than")
        assert archive_format(file.path) == ""

    def test_three_thousand_steps_in_space_fit(self):
        """Of a robot with 40 joints; what `MOST_BYTES` says."""
        columns = sum(int(np.prod(schema.row)) for schema in spatial_schema(40, 0).values() if schema.rows is None)
        assert columns == 186
        assert 2.0 * 8 * columns * round(3000 * 0.7 * 250.0) < MOST_BYTES


class TestText:
    """`named_kind` reads any text that a user names."""

    @pytest.mark.parametrize(
        "text",
        ["", "{", "[" * 100_000, '{"format": 3}', '{"format": ["a"]}', f'{{"a": {"9" * 5000}}}', '{"a": NaN}', "\0"],
    )
    def test_no_kind(self, text, tmp_path):
        path = tmp_path / "some.json"
        path.write_text(text, encoding="utf-8")
        assert named_kind(path) is None
        path.write_bytes(b"\xff\xfe" + text.encode())
        assert named_kind(path) is None

    def test_too_large_to_tell(self, tmp_path):
        path = tmp_path / "some.json"
        with path.open("wb") as stream:
            stream.truncate(10**10)
        began = time.monotonic()
        assert named_kind(path) is None
        assert time.monotonic() - began < PATIENCE


def spoil(content, generator):
    """Bytes with something at random done to them."""
    content = bytearray(content)
    for _ in range(generator.choice((1, 1, 2, 5))):
        at = generator.randrange(len(content))
        what = generator.randrange(5)
        if what == 0:
            content[at] ^= 1 << generator.randrange(8)
        elif what == 1:
            content[at : at + 4] = generator.choice((b"\0\0\0\0", b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f"))
        elif what == 2:
            del content[at : at + generator.randrange(1, 40)]
        elif what == 3:
            content[at:at] = generator.randbytes(generator.randrange(1, 40))
        else:
            other = generator.randrange(len(content))
            content[at : at + 30] = content[other : other + 30]
        if not content:
            return b""
    return bytes(content)


def check_bytes(file, seed, count):
    """Bytes of the archive, or of one of its entries, spoilt: refused, or the same run, or one that is as right."""
    generator = random.Random(seed)
    refused = 0
    for _ in range(count):
        inside = generator.random() < 0.5
        if inside:
            name = generator.choice(list(file.entries))
            file.with_entry(name, spoil(file.entries[name], generator))
        else:
            file.path.write_bytes(spoil(file.good, generator))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            archive_format(file.path), named_kind(file.path)
            try:
                back = file.load(file.path)
            except TrajectoryFileError as error:
                assert str(file.path) in str(error) and str(error).isprintable() and len(str(error)) < 1000
                refused += 1
                continue
        if not inside:  # the archive's own sums tell
            assert file.same()
        for name, schema in SCHEMAS[file.kind].items():
            array = getattr(back, name)
            assert array.shape == getattr(file.run, name).shape
            assert schema.posture or not (np.abs(array) > max(schema.most, LARGEST)).any()
    return refused


def test_bytes_at_random(file):
    assert check_bytes(file, 1, 150) > 100


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2, 6))
def test_many_bytes_at_random(file, seed):
    assert check_bytes(file, seed, 3000) > 2000
