"""API pages of every module; a warning is an error.

    python tests/api_pages.py DIR

`pdoc --docformat google frontal_biped` shows the public names on one page: it takes a package's ``__all__`` for all
there is. Here every module is named, so that rooms and modules have their pages too.
"""

import argparse
import os
import warnings
from pathlib import Path

import pdoc
import pdoc.extract
import pdoc.render
from module_graph import module_files

import frontal_biped


def page_names() -> list[str]:
    """What to name for pdoc so that every module has a page, and none two; `__main__` has none."""
    named: list[str] = []
    found: set[str] = set()
    for module in sorted(module_files(Path(frontal_biped.__file__).parent)):
        if module not in found and not module.endswith("__main__"):
            named.append(module)
            found.update(pdoc.extract.walk_specs([module]))
    return named


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="DIR")
    folder = parser.parse_args().folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    os.chdir(folder)  # where the clone lies pdoc would not know whether its folder or the installed package is meant
    warnings.simplefilter("error")
    warnings.simplefilter("ignore", DeprecationWarning)  # of the packages that ours imports
    pdoc.render.configure(docformat="google")
    pdoc.pdoc(*page_names(), output_directory=folder)
    pages = {path.relative_to(folder).with_suffix("").as_posix() for path in folder.rglob("*.html")}
    wanted = {name.replace(".", "/") for name in module_files(Path(frontal_biped.__file__).parent)}
    assert wanted - pages == {"frontal_biped/__main__"}, sorted(wanted - pages)
    print(f"{len(wanted) - 1} modules have their page in {folder}")
