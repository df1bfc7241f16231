"""The participant's page in Firefox: a first order by keys, in both kitchens, with pictures of it; and what the page says of a missing font.

    tests/outside/firefox.py TOMCOM FOLDER
"""

import argparse
import os
import sys
import time
from pathlib import Path

from PIL import Image

import bidi
from display import operate, presses_for, seed_of, session_file, url, verified
from page import has_font

SIZE = (1280, 800)


def serves_an_order(tomcom, folder, kitchen):
    seed = seed_of(tomcom, folder, kitchen)
    with operate(tomcom, session_file(folder, kitchen, seed), folder) as console, bidi.Firefox(SIZE) as firefox:
        firefox.open(url())
        firefox.wait_for("document.getElementById('stage').dataset.stage === 'welcome'")
        console.key("\x10")
        console.wait_for("ROBOT HELD")
        # Nothing moves the pointer here: the trial starts without gaze.
        console.key(".")
        console.wait_for("Checks before the trial")
        console.key("o")
        firefox.wait_for("Stage.shown() && Stage.shown().stage === 'running' && Stage.shown().contents.some((what) => what.dish)")
        dish = firefox.ask("Stage.shown().contents.find((what) => what.dish).dish")
        presses = presses_for(kitchen, dish, 1)
        firefox.screenshot(folder / "running.png")
        keys = firefox.ask("Object.fromEntries(Stage.scene().buttons.map(({ name, key }) => [name, key]))")
        for number, button in enumerate(presses, 1):
            # The same button within 0.05 s counts as a contact that bounces.
            time.sleep(0.08)
            firefox.key(keys[button])
            firefox.wait_for(f"Stage.shown().presses[0] && Stage.shown().presses[0].number === {number}")
        firefox.wait_for("Stage.shown().served === 1 && document.querySelector('.served').textContent === '✓ 1 served'")
        firefox.screenshot(folder / "served.png")
        assert firefox.ask("document.documentElement.scrollHeight <= window.innerHeight && document.documentElement.scrollWidth <= window.innerWidth")
        version = firefox.version
        console.quit()
    for name in ("running.png", "served.png"):
        picture = Image.open(folder / name).convert("RGB")
        colours = len(picture.getcolors(1 << 24))
        assert picture.size == SIZE and colours > 500, f"{name}: {picture.size}, {colours} colours"
    events = verified(tomcom, folder)
    told = [event["button"] for event in events if event["kind"] == "press" and event["agent"] == "human"]
    assert told == presses, told
    print(f"Firefox {version}: {dish} served with {len(presses)} keys in the {kitchen} kitchen; the recording verifies", flush=True)


def says_that_a_font_is_missing(tomcom, folder):
    """The check before the trial says so, where this machine has no font for the page's language."""
    session = session_file(folder, "sushi", 1)
    session.write_text(session.read_text().replace("[display]\n", '[display]\nlanguage = "ja"\n'))
    with operate(tomcom, session, folder) as console, bidi.Firefox(SIZE) as firefox:
        firefox.open(url())
        firefox.wait_for("document.querySelector('.readiness') !== null")
        says = firefox.ask("document.querySelector('.readiness').textContent.includes(Stage.scene().words['ready font'])")
        console.quit()
    assert says != has_font("ja"), says
    print(f"Firefox: the check before the trial {'says that there is no' if says else 'finds a'} font for Japanese", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tomcom")
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    if not bidi.is_there():
        return print(f"Firefox: not looked at, since {bidi.PROGRAM} is not on this machine", flush=True)
    for kitchen in ("sushi", "burger"):
        serves_an_order(arguments.tomcom, arguments.folder / kitchen, kitchen)
    says_that_a_font_is_missing(arguments.tomcom, arguments.folder / "font")
    return None


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)
