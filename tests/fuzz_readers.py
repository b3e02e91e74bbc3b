"""The readers of files under a coverage-guided fuzzer: gait, run, URDF and TOML.

    pip install atheris
    python tests/fuzz_readers.py gait -max_total_time=600

A reader may return something or raise one of our errors, in one line; anything else is a crash, and the fuzzer keeps
what it was given. Arguments behind the name of the reader are libFuzzer's. Besides its own changes of bytes the fuzzer
makes those of `mutations`, without which it would seldom get through JSON, XML and ZIP. Its time limit is
generous: measured line by line, a table that is read in 0.2 s takes half a minute.
"""

import contextlib
import io
import os
import random
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["frontal_biped", "json", "tomllib", "zipfile", "numpy.lib"]):
    from frontal_biped.exceptions import FrontalBipedError
    from frontal_biped.gait.file import load_gait
    from frontal_biped.gait.specification import read_specification
    from frontal_biped.library.sweep import read_sweep
    from frontal_biped.model.catalogue import load_robot
    from frontal_biped.model.urdf.proposal import propose_description
    from frontal_biped.scenarios.file import load_scenario
    from frontal_biped.simulation.space.run import load_spatial_run
    from frontal_biped.simulation.trajectory import load_trajectory

import fuzz_campaign
import mutations

FOLDER = Path(tempfile.mkdtemp(prefix="fuzz-readers-"))


def _refused(read: Callable[[], object]) -> None:
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            read()
    except (FrontalBipedError, OSError) as error:
        message = str(error)
        if "\n" in message or not message:
            raise AssertionError(f"not one line: {message!r}") from error
        message.encode("utf-8")


def gait(content: bytes) -> None:
    """A gait file."""
    path = FOLDER / "gait.json"
    path.write_bytes(content)
    _refused(lambda: load_gait(path))


def run(content: bytes) -> None:
    """A run file, in the plane and in space."""
    path = FOLDER / "run.npz"
    path.write_bytes(content)
    _refused(lambda: load_trajectory(path))
    _refused(lambda: load_spatial_run(path))


def urdf(content: bytes) -> None:
    """A URDF: a description is proposed, and it is loaded with a description that is sound."""
    path = FOLDER / "mini.urdf"
    path.write_bytes(content)
    _refused(lambda: load_robot(FOLDER / "mini.toml"))
    _refused(lambda: propose_description(path))


def toml(content: bytes) -> None:
    """A description, a specification, a scenario, a sweep."""
    path = FOLDER / "any.toml"
    path.write_bytes(content)
    for read in (read_specification, load_scenario, read_sweep, load_robot):
        _refused(lambda read=read: read(path))


READERS: dict[str, tuple[Callable[[bytes], None], Callable[..., mutations.Spoilt], tuple[str, ...]]] = {
    "gait": (gait, mutations.spoil_json, ("gait.json",)),
    "run": (run, mutations.spoil_archive, ("run.npz", "space.npz")),
    "urdf": (urdf, mutations.spoil_urdf, ("mini.urdf",)),
    "toml": (toml, mutations.spoil_toml, ("mini.toml", "spec.toml", "walk.scenario.toml", "sweep.toml")),
}
"""Reader, how its files are spoilt, and those it starts from."""


def _main() -> None:
    name, *others = sys.argv[1:]
    read, spoil, sound = READERS[name]
    corpus = FOLDER / "corpus"
    corpus.mkdir()
    fuzz_campaign.make_files(FOLDER)
    for file in sound:
        (corpus / file).write_bytes((FOLDER / file).read_bytes())

    def mutate(content: bytes, most: int, seed: int) -> bytes:
        rng = random.Random(seed)
        try:
            return spoil(content, rng).content[:most] if rng.random() < 0.7 else atheris.Mutate(content, most)
        except Exception:  # no longer a file of its kind
            return atheris.Mutate(content, most)

    atheris.Setup([sys.argv[0], str(corpus), "-timeout=120", "-rss_limit_mb=4096", "-max_len=200000",
                   f"-artifact_prefix={FOLDER}/", *others], read,
                  custom_mutator=mutate)  # fmt: skip
    os.chdir(FOLDER)
    atheris.Fuzz()


if __name__ == "__main__":
    _main()
