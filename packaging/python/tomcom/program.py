"""The program `tomcom`, from Python."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sysconfig
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas

    from .recording import Recording

PathLike = str | os.PathLike[str]


class ProgramFailed(RuntimeError):
    """The program refused, or failed; its message says what was found and what would be right."""


def program() -> Path:
    """The program that came with this package, or else the first one on the PATH."""
    beside = Path(sysconfig.get_path("scripts")) / "tomcom"
    found = str(beside) if beside.exists() else shutil.which("tomcom")
    if found is None:
        raise ProgramFailed("tomcom is neither beside this package nor on the PATH; pip install tomcom brings it")
    return Path(found)


def run(*arguments: PathLike) -> str:
    """Runs a command, such as `run("kitchen", "layouts/sushi.toml")`, and returns what it printed."""
    done = subprocess.run([str(program()), *[os.fspath(argument) for argument in arguments]], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise ProgramFailed((done.stderr or done.stdout).strip())
    return done.stdout


def options(given: dict[str, Any]) -> list[str]:
    """`trials=2, arm="timed", rerun=True` as the program's options."""
    words = []
    for name, value in given.items():
        if value is None or value is False:
            continue
        words.append("--" + name.replace("_", "-"))
        if value is not True:
            words.extend(map(str, value) if isinstance(value, (list, tuple)) else [str(value)])
    return words


def simulate(session: PathLike, *, out: PathLike, **given: Any) -> list[Recording]:
    """Simulates trials, and returns their recordings. Further arguments are options of `tomcom simulate`: `trials`,
    `seed`, `condition`, `concept`, `arm`, `shadow`, …"""
    from .recording import Recording

    told = run("simulate", session, "--out", out, "--format", "json", *options(given))
    return [Recording(path) for path in json.loads(told)["recordings"]]


@dataclass
class Study:
    """The results of `tomcom study`. Tables are attributes: `trials`, `actions`, `participants`, `beliefs`, …"""

    folder: Path
    summary: dict[str, Any]
    tables: dict[str, pandas.DataFrame] = field(default_factory=dict, repr=False)

    @property
    def report(self) -> Path:
        """The report, a page for a browser."""
        return self.folder / "report.html"

    def __getattr__(self, name: str) -> pandas.DataFrame:
        path = self.folder / f"{name}.csv"
        if name.startswith("_") or not path.exists():
            there = ", ".join(sorted(one.stem for one in self.folder.glob("*.csv")))
            raise AttributeError(f"no table {name!r} in {self.folder}; there are: {there}")
        if name not in self.tables:
            import pandas

            self.tables[name] = pandas.read_csv(path, low_memory=False)
        return self.tables[name]

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *(path.stem for path in self.folder.glob("*.csv"))})


def study(*recordings: PathLike, out: PathLike | None = None, **given: Any) -> Study:
    """Analyses recordings, or folders of recordings, into tables and a report in `out` (the folder "study" in the first).
    Further arguments are options of `tomcom study`, such as `skip="concepts"`."""
    if not recordings:
        raise TypeError("study() needs a folder of recordings")
    folder = Path(out) if out is not None else Path(recordings[0]) / "study"
    told = run("study", *recordings, "--out", folder, "--format", "json", *options(given))
    return Study(folder, json.loads(told))
