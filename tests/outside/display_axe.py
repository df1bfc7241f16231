"""The participant's page has no violation of the rules of axe (WCAG among them), in any state.

    tests/outside/display_axe.py TOMCOM FOLDER [--from-disk]
"""

import argparse
import itertools
import os
import sys
from pathlib import Path

from axe_playwright_python.sync_playwright import Axe
from display_states import KITCHENS, opened, show, states
from page import browser

STATES = ("welcome", "instruction", "ready", "practice", "running 0", "served", "paused", "over", "questionnaire", "answered", "answers", "thanks")
# States whose names begin so: the first of each, and all.
ONE_OF, ALL_OF = ("recipe", "highlight", "no effect", "robot: stopped"), ("questionnaire:", "tutorial:", "probe:")
# The wall, and a telephone.
SIZES = ((1920, 1080), (390, 844))
# What axe cannot decide, and why it is right.
EXPLAINED = {"color-contrast": "the title of a zone stands on the zone, which other elements overlap; the two colours have a contrast above 4.5"}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tomcom")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--from-disk", action="store_true", help="the page's files as they are now, not as they were built")
    arguments = parser.parse_args()
    looked = 0
    with browser() as chromium:
        for kitchen, size in itertools.product(KITCHENS, SIZES):
            with opened(arguments.tomcom, chromium, arguments.folder / f"{kitchen}-{size[0]}", kitchen, "en", size=size, from_disk=arguments.from_disk) as page:
                every = states(page.ask("Stage.scene()"), kitchen)
                names = [*STATES, *[next(name for name in every if name.startswith(kind)) for kind in ONE_OF], *[name for name in every if name.startswith(ALL_OF)]]
                for name in names:
                    show(page, every[name])
                    looked += 1
                    found = Axe().run(page.page).response
                    wrong = [(rule["id"], [node["target"] for node in rule["nodes"]]) for rule in found["violations"]]
                    assert not wrong, f"{kitchen} at {size}, {name}: {wrong}"
                    open_ones = {rule["id"]: [node["target"] for node in rule["nodes"]] for rule in found["incomplete"] if rule["id"] not in EXPLAINED}
                    assert not open_ones, f"{kitchen} at {size}, {name}: axe cannot decide {open_ones}"
    print(f"axe finds nothing in {looked} states of the page", flush=True)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)
