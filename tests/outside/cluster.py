"""Runs the commands of docs/cluster.md that need GNU parallel, as they stand there, and compares the results with one analysis of all recordings.

    tests/outside/cluster.py TOMCOM FOLDER
"""

import filecmp
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

PAGE = Path("docs/cluster.md")


def blocks(text):
    """The page's blocks: what stands in the line before, the language, the text."""
    return re.findall(r"(?m)^(.*)\n```(\w+)\n((?s:.*?))^```$", text)


def main():
    tomcom, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    assert shutil.which("parallel"), "GNU parallel is not installed (Debian: parallel)"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name in ("sessions", "layouts", "recipes"):
        shutil.copytree(name, folder / name)
    page = blocks(PAGE.read_text())
    (settings,) = [text for _, language, text in page if language == "toml"]
    (folder / settings.split("\n", 1)[0].removeprefix("# ")).write_text(settings)
    (commands,) = [text for mark, _, text in page if "needs GNU parallel" in mark]
    (folder / "bin").mkdir()
    (folder / "bin" / "tomcom").symlink_to(tomcom)
    # The notice that asks for a citation waits for a key otherwise.
    home = {**os.environ, "PATH": f"{(folder / 'bin').resolve()}:{os.environ['PATH']}", "PARALLEL": "--will-cite"}
    subprocess.run(["bash", "-ec", commands], cwd=folder, env=home, check=True, stdout=subprocess.DEVNULL)
    shards = sorted((folder / "shards").iterdir())
    whole = ["tomcom", "study", *(one.relative_to(folder) for one in shards), "--out", "at-once"]
    subprocess.run(whole, cwd=folder, env=home, check=True, stdout=subprocess.DEVNULL)
    names = sorted(path.name for path in (folder / "at-once").iterdir())
    same, different, missing = filecmp.cmpfiles(folder / "results", folder / "at-once", names, shallow=False)
    assert not different and not missing and "report.html" in same, (different, missing)
    print(f"{len(shards)} parts by GNU parallel: {len(same)} files are the same as those of one analysis")


if __name__ == "__main__":
    main()
