"""Files spoilt at random, each with what is known of the result: that it must be refused, or nothing.

`spoil` takes the content of a sound file and a random generator, and returns the spoilt content and whether it is
certainly rubbish. A mutation that may leave a sound file, another number say, is not called rubbish.
"""

import copy
import io
import json
import random
import re
import tomllib
import xml.etree.ElementTree as ElementTree
import zipfile
from collections.abc import Callable
from datetime import date, datetime, time
from typing import Any, NamedTuple

import numpy as np


class Spoilt(NamedTuple):
    """The content of a spoilt file.

    Attributes:
        content: bytes of it.
        what: was done to it, in words.
        rubbish: is it certain that nobody may accept it?
    """

    content: bytes
    what: str
    rubbish: bool


NO_NUMBERS: tuple[Any, ...] = (
    None, True, "", "abc", "1.0", "\n", "0x10", "1e", [], {}, [1.0], {"a": 1}, float("nan"), float("inf"),
    -float("inf"),
    10**400, int("9" * 4000), "\u0000", "\ud800".encode("utf-8", "surrogatepass").decode("latin-1"), "٣", "nan",
)  # fmt: skip
"""What stands for no finite number, in whatever file."""

STRANGE_NUMBERS = (0, -1, 1e308, -1e308, 1e-320, 2**63, -(2**63), 1e-9, 100, 10**6, 0.5, -0.0, 3.0000000001, 1e16)
"""Numbers that a field may or may not take."""

STRANGE_TEXTS = (
    "", " ", "a\nb", "a\tb", "\x1b[2Jx", "../../../../etc/passwd", "/dev/zero", "/etc/passwd", "file:///etc/passwd",
    "x" * 5000, "nul\x00byte", "ü" * 300, "%s%n", "{0}", "$(id)", "-o", "\u202egnp.exe", "<script>alert(1)</script>",
    "package://../../etc/passwd", ".", "~", "con",
)  # fmt: skip
"""Texts that a field may or may not take."""


# -- bytes ---------------------------------------------------------------------------------------------------------


def spoil_bytes(content: bytes, rng: random.Random) -> Spoilt:
    """Bytes cut off, changed, put in, taken out."""
    size = len(content)
    kind = rng.choice(("cut", "flip", "insert", "delete", "repeat", "zeros", "empty", "append", "utf-16", "random"))
    at = rng.randrange(size)
    match kind:
        case "cut":
            # what is behind the last character that says something may be missing
            rubbish = at < len(content.rstrip()) - 1 and content[:1] in b"{P"
            return Spoilt(content[:at], f"cut off at byte {at}", rubbish)
        case "flip":
            spoilt = bytearray(content)
            for _ in range(rng.choice((1, 1, 2, 8))):
                spoilt[rng.randrange(size)] ^= 1 << rng.randrange(8)
            return Spoilt(bytes(spoilt), "bits flipped", False)
        case "insert":
            more = rng.randbytes(rng.choice((1, 3, 100)))
            return Spoilt(content[:at] + more + content[at:], f"bytes put in at {at}", False)
        case "delete":
            return Spoilt(content[:at] + content[at + rng.choice((1, 5, 200)) :], f"bytes taken out at {at}", False)
        case "repeat":
            part = content[at : at + rng.choice((1, 50, 5000))]
            return Spoilt(content[:at] + part * rng.choice((2, 20)) + content[at:], "a part repeated", False)
        case "zeros":
            return Spoilt(content[:at] + bytes(min(64, size - at)) + content[at + 64 :], "a block of zeros", False)
        case "empty":
            return Spoilt(b"", "empty", True)
        case "append":
            return Spoilt(content + rng.choice((b"\x00", b"}", b"[[", rng.randbytes(50))), "appended to", False)
        case "utf-16":
            return Spoilt(content.decode("utf-8", "replace").encode("utf-16"), "in UTF-16", content[:1] == b"{")
        case _:
            return Spoilt(rng.randbytes(rng.choice((10, 1000, 50_000))), "random bytes", True)


# -- tables (JSON, TOML) -------------------------------------------------------------------------------------------


def _places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Paths to every value inside a nested table."""
    found: list[tuple[Any, ...]] = []
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, part in items:
        found += [(*path, key), *_places(part, (*path, key))]
    return found


def _of(table: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        table = table[key]
    return table


def spoil_table(table: Any, rng: random.Random, free: tuple[str, ...] = ()) -> tuple[Any, str, bool]:
    """A nested table with one value changed, dropped, added or renamed.

    Args:
        table: of a sound file.
        rng: chooses.
        free: sections of which nothing is asked.

    Returns:
        The spoilt table, what was done, and whether it is certainly rubbish.
    """
    table = copy.deepcopy(table)
    path = rng.choice(_places(table))
    parent, key = _of(table, path[:-1]), path[-1]
    value, is_free = parent[key], str(path[0]) in free
    where = ".".join(map(str, path))
    kind = rng.choice(
        ("no number", "no number", "strange", "strange", "text", "drop", "add", "rename", "deep", "large")
    )
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    match kind:
        case "no number":
            parent[key] = rng.choice(NO_NUMBERS)
            # TOML has no null: what is None is left out there
            return table, f"{where} = {parent[key]!r:.40}", is_number and not is_free and parent[key] is not None
        case "strange":
            parent[key] = rng.choice(STRANGE_NUMBERS)
            # a range of a scenario may be a number as well
            is_range = isinstance(value, dict) and value.keys() <= {"within", "from", "to"}
            is_other = isinstance(value, str | list | dict) and not is_range
            return table, f"{where} = {parent[key]!r:.40}", is_other and not is_free
        case "text":
            parent[key] = rng.choice(STRANGE_TEXTS)
            return table, f"{where} = {parent[key]!r:.40}", isinstance(value, float | list) and not is_free
        case "drop":
            del parent[key]
            return table, f"{where} left out", False
        case "add":
            name = rng.choice(("unknown", "", "a b", "ü", "__class__", "\n"))
            if isinstance(parent, dict):
                parent[name] = 1
                return table, f"{where}: {name!r} beside it", not is_free and len(path) < 3
            parent.append(1)
            return table, f"{where}: one more", False
        case "rename":
            if isinstance(parent, dict):
                parent[f"{key}_"] = parent.pop(key)
                return table, f"{where} renamed", not is_free and len(path) < 3
            parent.reverse()
            return table, f"{where}: reversed", False
        case "deep":
            deep: Any = value
            for _ in range(rng.choice((1, 60))):
                deep = [deep]
            parent[key] = deep
            return table, f"{where} nested", is_number and not is_free
        case _:
            parent[key] = rng.choice(([value] * 3000, {f"k{i}": value for i in range(500)}, "9" * 100_000))
            return table, f"{where} large", is_number and not is_free


def spoil_json(content: bytes, rng: random.Random, free: tuple[str, ...] = ()) -> Spoilt:
    """A JSON file spoilt as bytes, as text or as a table."""
    if rng.random() < 0.25:
        return spoil_bytes(content, rng)
    text = content.decode()
    if rng.random() < 0.15:
        return _spoil_json_text(text, rng)
    table, what, rubbish = spoil_table(json.loads(text), rng, free)
    return Spoilt(json.dumps(table, indent=1).encode("utf-8", "surrogatepass"), what, rubbish)


def _spoil_json_text(text: str, rng: random.Random) -> Spoilt:
    numbers = list(re.finditer(r"(?m)(?<= )-?\d+\.\d+(?=,?$)", text))  # values, not parts of texts
    kind = rng.choice(("digits", "twice", "comment", "deep", "constant", "surrogate"))
    spot = rng.choice(numbers)
    before, after = text[: spot.start()], text[spot.end() :]
    match kind:
        case "digits":
            return Spoilt(f"{before}{'9' * 5000}{after}".encode(), "a number of 5000 digits", True)
        case "twice":
            key = rng.choice(re.findall(r'\n "(\w+)":', text))
            return Spoilt(text.replace("{", f'{{"{key}": 0,', 1).encode(), f"{key} twice", True)
        case "comment":
            return Spoilt(f"{before}/* */{spot.group()}{after}".encode(), "a comment", True)
        case "deep":
            return Spoilt(f"{before}{'[' * 100_000}{after}".encode(), "nested deep", True)
        case "constant":
            return Spoilt(f"{before}{rng.choice(('NaN', 'Infinity', '-Infinity'))}{after}".encode(), "a constant", True)
        case _:
            return Spoilt(f'{before}"\\ud800"{after}'.encode(), "half of a surrogate pair", True)


TOML_VALUES: tuple[Any, ...] = (
    date(2026, 1, 1), time(7, 30), datetime(2026, 1, 1, 7, 30), float("nan"), float("inf"), True, "x", "", [], [[]],
    [1, "a"], {}, {"a": {"b": 1}}, 2**63, -(2**70), int("9" * 4000), [float("nan")] * 2, {"from": 2, "to": 1},
)  # fmt: skip


def spoil_toml(content: bytes, rng: random.Random, free: tuple[str, ...] = ()) -> Spoilt:
    """A TOML file spoilt as bytes, as lines or as a table."""
    chance = rng.random()
    if chance < 0.2:
        spoilt = spoil_bytes(content, rng)
        # an empty specification says what suits the robot
        return spoilt._replace(rubbish=spoilt.rubbish and spoilt.what != "empty")
    if chance < 0.35:
        return _spoil_toml_lines(content.decode(), rng)
    table, what, rubbish = tomllib.loads(content.decode()), "", False
    if rng.random() < 0.5:
        table, what, rubbish = spoil_table(table, rng, free)
    else:
        path = rng.choice(_places(table))
        value = rng.choice(TOML_VALUES)
        old = _of(table, path)
        _of(table, path[:-1])[path[-1]] = value
        what = f"{'.'.join(map(str, path))} = {value!r:.40}"
        asked = isinstance(old, int | float) and not isinstance(old, bool) and str(path[0]) not in free
        rubbish = asked and not isinstance(value, int | dict | list)
    return Spoilt(toml_text(table).encode("utf-8", "surrogatepass"), what, rubbish)


def _spoil_toml_lines(text: str, rng: random.Random) -> Spoilt:
    lines = text.splitlines()
    i = rng.randrange(len(lines))
    match rng.choice(("drop", "twice", "swap", "digits", "deep")):
        case "drop":
            del lines[i]
            what, rubbish = f"line {i + 1} left out", False
        case "twice":
            lines.insert(i, lines[i])
            what, rubbish = f"line {i + 1} twice", "=" in lines[i].split("#")[0]
        case "swap":
            j = rng.randrange(len(lines))
            lines[i], lines[j] = lines[j], lines[i]
            what, rubbish = "lines exchanged", False
        case "digits":
            lines.insert(0, f"steps = {'9' * 5000}")
            what, rubbish = "a number of 5000 digits", True
        case _:
            lines.insert(0, f"name = {'[' * 20_000}")
            what, rubbish = "nested deep", True
    return Spoilt("\n".join(lines).encode(), what, rubbish)


def toml_text(table: dict[str, Any]) -> str:
    """A table as TOML; sections as inline tables, which say the same."""
    return "".join(f"{_key(key)} = {_toml(value)}\n" for key, value in table.items() if value is not None)


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _toml(key)


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(k)} = {_toml(v)}" for k, v in value.items() if v is not None) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_toml(part) for part in value if part is not None) + "]"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=True)
    if isinstance(value, date | time | datetime):
        return value.isoformat()
    return repr(value)


# -- URDF ----------------------------------------------------------------------------------------------------------

URDF_TEXTS = (
    "", "nan", "inf", "-inf", "1e400", "1e-400", "abc", "1_0", "0x1p3", "1,5", "1;2", "٣", "1 2", "1 2 3 4", "1e308",
    "-1", "0", "1e-320", "9" * 5000, "\u0000x", "a\nb", "<", "3_6.0", "+-1", "1d3", "1e", " 1 ", "\t1\n", "1 2 nan",
)  # fmt: skip

NO_URDF_NUMBERS = ("", "nan", "inf", "-inf", "1e400", "abc", "0x1p3", "1,5", "1;2", "+-1", "1d3", "1e", "1 2 nan")
"""Texts that no attribute with numbers takes."""


def spoil_urdf(content: bytes, rng: random.Random) -> Spoilt:
    """A URDF spoilt as bytes, as text or as a tree."""
    chance = rng.random()
    if chance < 0.2:
        return spoil_bytes(content, rng)
    if chance < 0.3:
        return _spoil_urdf_text(content.decode(), rng)
    root = ElementTree.fromstring(content)
    elements = [element for element in root.iter() if element is not root]
    element = rng.choice(elements)
    parents = {child: parent for parent in root.iter() for child in parent}
    match rng.choice(("attribute", "attribute", "attribute", "drop", "twice", "move", "rename", "missing", "type")):
        case "attribute" if element.attrib:
            key = rng.choice(list(element.attrib))
            numeric = re.fullmatch(r"[-+0-9.eE ]+", element.attrib[key]) is not None
            element.attrib[key] = rng.choice(URDF_TEXTS if rng.random() < 0.8 else STRANGE_TEXTS)
            in_link = element.tag in ("mass", "inertia", "origin", "axis", "limit")
            rubbish = numeric and in_link and element.attrib[key] in NO_URDF_NUMBERS
            what = f"<{element.tag} {key}={element.attrib[key]!r:.30}>"
            element.attrib[key] = re.sub(r"[\x00-\x08\x0b-\x1f]", "\ufffd", element.attrib[key])
        case "drop":
            parents[element].remove(element)
            what, rubbish = f"<{element.tag}> left out", False
        case "twice":
            parents[element].append(copy.deepcopy(element))
            rubbish = element.tag in ("link", "joint")
            what = f"<{element.tag}> twice"
        case "move":
            parents[element].remove(element)
            rng.choice([root, *root]).append(element)
            what, rubbish = f"<{element.tag}> moved", False
        case "rename":
            element.tag += "s"
            what, rubbish = f"<{element.tag}>", False
        case "missing" if element.attrib:
            del element.attrib[rng.choice(list(element.attrib))]
            what, rubbish = f"<{element.tag}> with an attribute less", False
        case _:
            joint = rng.choice(root.findall("joint"))
            kinds = ("fixed", "floating", "planar", "continuous", "prismatic", "", "Revolute", "spherical")
            joint.set("type", rng.choice(kinds))
            what, rubbish = f"joint {joint.get('name')} {joint.get('type')!r}", joint.get("type") in ("", "spherical")
    return Spoilt(ElementTree.tostring(root), what, rubbish)


def _spoil_urdf_text(text: str, rng: random.Random) -> Spoilt:
    bomb = '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa">' + "".join(
        f'<!ENTITY {chr(98 + i)} "{f"&{chr(97 + i)};" * 10}">' for i in range(9)
    )
    match rng.choice(("bomb", "external", "deep", "many", "xacro", "latin", "bom")):
        case "bomb":
            return Spoilt((bomb + "]>" + text.replace("<robot", "<robot about='&j;'", 1)).encode(), "entities", True)
        case "external":
            entity = '<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]>'
            return Spoilt((entity + text.replace("</robot>", "&x;</robot>")).encode(), "an external entity", True)
        case "deep":
            return Spoilt(
                text.replace("</robot>", "<a>" * 50_000 + "</a>" * 50_000 + "</robot>").encode(), "deep", False
            )
        case "many":
            links = "".join(f'<link name="l{i}"/>' for i in range(20_000))
            return Spoilt(text.replace("</robot>", links + "</robot>").encode(), "20 000 links without joints", True)
        case "xacro":
            spoilt = text.replace("<robot", '<robot xmlns:xacro="http://wiki.ros.org/xacro"', 1)
            return Spoilt(
                spoilt.replace("</robot>", '<xacro:include filename="/etc/passwd"/></robot>').encode(), "xacro", False
            )
        case "latin":
            return Spoilt(
                ('<?xml version="1.0" encoding="latin-1"?>' + text).encode("latin-1", "replace"), "latin-1", False
            )
        case _:
            return Spoilt(b"\xef\xbb\xbf" + text.encode(), "a byte-order mark", False)


# -- NumPy archives ------------------------------------------------------------------------------------------------


def spoil_archive(content: bytes, rng: random.Random) -> Spoilt:
    """A NumPy archive spoilt as bytes, in one array, in its header, or in its directory."""
    chance = rng.random()
    if chance < 0.25:
        spoilt = spoil_bytes(content, rng)
        return spoilt._replace(rubbish=spoilt.rubbish or spoilt.what.startswith("cut off"))
    with np.load(io.BytesIO(content), allow_pickle=False) as archive:
        arrays = {name: archive[name] for name in archive.files}
    if chance < 0.5:
        header, what, rubbish = spoil_table(json.loads(str(arrays["header"])), rng, ("gait", "settings"))
        arrays["header"] = np.array(json.dumps(header))
        return Spoilt(_archive(arrays), f"header {what}", rubbish and "beside it" not in what)
    if chance < 0.58:
        return _spoil_directory(content, arrays, rng)
    name = rng.choice([name for name in arrays if name != "header"])
    array, (what, change) = arrays[name], rng.choice(ARRAY_CHANGES)
    changed = change(array)
    if changed is None:
        del arrays[name]
    else:
        arrays[name] = changed
    # an array without entries, of events that did not happen, has none to spoil
    rubbish = what in SURELY_RUBBISH and array.size > 1
    if what == "not a number":
        # what a run does not know may be, rates of joints too
        rubbish = rubbish and name in ("t", "q", "step", "phase", "stance", "event_t")
    return Spoilt(_archive(arrays), f"{name} {what}", rubbish)


def _nan(array: np.ndarray) -> np.ndarray:
    changed = array.astype(float)
    changed.flat[: max(1, changed.size // 2)] = np.nan
    return changed


ARRAY_CHANGES: tuple[tuple[str, Callable[[np.ndarray], np.ndarray | None]], ...] = (
    ("left out", lambda array: None),
    ("one row less", lambda array: array[:-1]),
    ("one axis more", lambda array: array[None]),
    ("flat", lambda array: array.reshape(-1)[:3]),
    ("a scalar", lambda array: np.array(1.0)),
    ("empty", lambda array: array[:0]),
    ("texts", lambda array: np.full(array.shape, "a")),
    ("complex", lambda array: array.astype(complex) * 1j),
    ("dates", lambda array: np.zeros(array.shape, dtype="datetime64[s]")),
    ("records", lambda array: np.zeros(array.shape, dtype=[("a", "f8")])),
    ("objects", lambda array: np.full(array.shape, None)),
    ("not a number", _nan),
    ("reversed", lambda array: array[::-1]),
    ("huge", lambda array: array * 0.0 + 1e308),
    ("tiny", lambda array: array * 0.0 + 1e-320),
    ("negative", lambda array: -np.abs(array) - 1.0),
    ("fractions", lambda array: array + 0.25),
    ("big-endian", lambda array: array.astype(">f8")),
    ("single", lambda array: array.astype(np.float32)),
    ("Fortran", lambda array: np.asfortranarray(array)),
    ("long", lambda array: np.repeat(array, 50, axis=0) if array.ndim else array),
)

SURELY_RUBBISH = {
    "left out", "one row less", "one axis more", "a scalar", "empty", "texts", "complex", "dates", "records", "objects",
    "not a number", "long",
}  # fmt: skip


def _archive(arrays: dict[str, np.ndarray]) -> bytes:
    stream = io.BytesIO()
    np.savez_compressed(stream, allow_pickle=True, **arrays)
    return stream.getvalue()


def _spoil_directory(content: bytes, arrays: dict[str, np.ndarray], rng: random.Random) -> Spoilt:
    stream = io.BytesIO()
    kind = rng.choice(("npy", "bomb", "header of many rows", "lies", "stored", "text inside"))
    match kind:
        case "npy":
            np.save(stream, arrays["t"])
        case "bomb":
            with (
                zipfile.ZipFile(io.BytesIO(content)) as source,
                zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as to,
            ):
                for name in source.namelist():
                    to.writestr(name, source.read(name) if name != "q.npy" else bytes(300_000_000))
        case "header of many rows" | "lies" | "text inside":
            fake = io.BytesIO()
            np.lib.format.write_array_header_1_0(
                fake, {"descr": "<f8", "fortran_order": False, "shape": (10**7, 40) if kind[0] == "h" else (10**15,)}
            )
            inside = b"not an array" if kind == "text inside" else fake.getvalue() + b"\0" * 80
            with zipfile.ZipFile(io.BytesIO(content)) as source, zipfile.ZipFile(stream, "w") as to:
                for name in source.namelist():
                    to.writestr(name, source.read(name) if name != "q.npy" else inside)
        case _:
            np.savez(stream, **arrays)
    return Spoilt(stream.getvalue(), kind, kind != "stored")
