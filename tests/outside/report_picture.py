"""Makes the picture of a report, as a browser shows its beginning: a study of simulated participants, analysed by the program.

    tests/outside/report_picture.py TOMCOM FOLDER [--out tests/snapshots/report.png]
"""

import argparse
import subprocess
from pathlib import Path

from simulated import run

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("tomcom")
parser.add_argument("folder", type=Path)
parser.add_argument("--out", type=Path, default=Path("tests/snapshots/report.png"))
arguments = parser.parse_args()
recordings = arguments.folder / "recordings"
run(arguments.tomcom, "simulate", "sessions/paper.toml", "--arm", "timed", "--trials", 8, "--out", recordings)
run(arguments.tomcom, "study", recordings, "--skip", "concepts")
page = (recordings / "study" / "report.html").resolve().as_uri()
browser = ["chromium", "--headless", "--no-sandbox", "--hide-scrollbars", "--window-size=1000,1300"]
subprocess.run([*browser, f"--screenshot={arguments.out.resolve()}", page], check=True, capture_output=True)
print(f"{arguments.out}: {arguments.out.stat().st_size} bytes")
