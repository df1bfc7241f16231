"""A recording as a reviewer opens it: the third error that `tomcom review --errors` lists, opened by the listed command in
a browser, where Rerun's viewer has to stand at that time. With --picture it is made a picture of.

    tests/outside/review.py TOMCOM FOLDER [--picture tests/snapshots/review.png]
"""

import argparse
import os
import re
import shlex
import subprocess
import time
from pathlib import Path

from page import browser
from simulated import recordings_in, run

SIZE = {"width": 1500, "height": 912}
# What a browser draws with where there is no graphics card.
SOFTWARE = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
# The page keeps its viewer for itself: it is taken when it is started.
KEEP = """
const start = wasm_bindgen.WebHandle.prototype.start;
wasm_bindgen.WebHandle.prototype.start = function (canvas) { window.viewer = this; return start.call(this, canvas); };
"""
TIME = "() => { const id = window.viewer?.get_active_recording_id(); return id ? window.viewer.get_time_for_timeline(id, 'trial_clock_time') : null }"
PATIENCE_S = 300


def third_error(tomcom, recording):
    """The listed command of the third error, as words, and its time on the trial's clock in seconds."""
    lines = run(tomcom, "review", recording, "--errors", "--signals", "--beliefs").splitlines()
    kinds = {kind: sum(f", {kind}" in line for line in lines) for kind in ("error ", "signal ", "estimated false belief")}
    print(f"  {len(lines)} lines: {kinds}")
    assert all(kinds.values()), "no error, signal or estimated false belief"
    line = next(line for line in lines if ", error 3: " in line)
    print(f"  {line}")
    words = shlex.split(line, comments=True)
    minutes, seconds = words[words.index("--at") + 1].split(":")
    return [tomcom, *words[1:]], 60 * int(minutes) + float(seconds)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tomcom", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    tomcom = arguments.tomcom.resolve()
    run(tomcom, "simulate", "sessions/default.toml", "--condition", "assistant", "--trials", 1, "--seed", 7, "--out", arguments.folder)
    (recording,) = recordings_in(arguments.folder)
    command, at_s = third_error(tomcom, recording)
    without_screen = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    served = subprocess.Popen([*command, "--web"], stdout=subprocess.PIPE, text=True, env=without_screen)
    try:
        url = next(found[0] for line in served.stdout if (found := re.search(r"http://\S+", line)))
        with browser(*SOFTWARE) as chromium:
            page = chromium.new_page(viewport=SIZE, color_scheme="dark")
            page.goto(url, wait_until="domcontentloaded")
            page.add_script_tag(content=KEEP)
            end, there = time.monotonic() + PATIENCE_S, None
            while there != at_s:
                assert time.monotonic() < end, f"the viewer stands at {there} s, not at {at_s} s"
                time.sleep(0.5)
                now = page.evaluate(TIME)
                there = None if now is None else now // 1e6 / 1e3
            print(f"  the viewer in the browser stands at {there} s")
            # The page says so until all of the recording is there.
            page.wait_for_selector("#loading", state="detached", timeout=1000 * PATIENCE_S)
            if arguments.picture:
                # What came last is drawn.
                time.sleep(15)
                page.screenshot(path=arguments.picture, timeout=120_000)
    finally:
        served.terminate()
        served.wait()


if __name__ == "__main__":
    main()
