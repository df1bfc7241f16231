"""Makes the pictures of docs/display.md: each state of the participant's page, as the real program and a real browser show it.

    tests/outside/display_pictures.py TOMCOM FOLDER [--from-disk] [--out tests/snapshots/display]
"""

import argparse
import io
import os
import sys
from pathlib import Path

from PIL import Image

from display_states import items_of, opened, show, states, tutorial_steps
from page import browser

SIZE = (960, 540)
# A telephone.
UPRIGHT = (390, 844)
# Each picture but those of a telephone is drawn twice as large, then scaled down; it has at most so many bytes.
MAX_BYTES = 60_000


# What lies where, as in the middle of a trial.
CONTENTS = {
    "sushi": {"order_1": {"dish": "salmon nigiri"}, "order_2": {"dish": "crab maki"}, "human_hand": {"item": "nori"}, "robot_hand": {"item": "tuna raw"},
              "assembly_board": {"stack": ["rice cooked", "nori"]}, "counter": {"item": "salmon raw"}, "cooking_pot": {"item": "crab cooked"}},
    "burger": {"order": {"dish": "garden burger"}, "human_hand": {"item": "cheese"}, "robot_hand": {"item": "lettuce"},
               "board": {"stack": ["light bun", "soy grilled"]}, "grill_plate": {"item": "beef raw"}, "shelf": {"item": "tomato sliced"}},
}


def chosen(scene, kitchen):
    """The states that the page of the manual shows, by the names of their files."""
    every, lies = states(scene, kitchen), CONTENTS[kitchen]
    names = [spot["name"] for spot in scene["locations"]]
    contents = [lies.get(name, "empty") for name in names]
    order, place = next(index for index, name in enumerate(names) if name.startswith("order")), names.index("cooking_pot" if kitchen == "sushi" else "grill_plate")
    dish = contents[order]["dish"]
    running = {**every["empty"], "contents": contents, "served": 3}
    press = {"number": 1, "at": {"location": place}, "effective": False, "why": {"reason": "place_full", "about": place}}
    made = {stage: {**every[stage], "contents": contents} for stage in ("welcome", "instruction", "ready", "paused", "over", "questionnaire", "answers", "answered", "thanks")}
    for stage, text in (("questionnaire", "The signals came when I needed them."), ("answers", "Thank you. Are your answers as you meant them?")):
        made[stage]["question"] = {**made[stage]["question"], "title": "How was it?", "text": text}
    recipes, question = every["tutorial: cards"]["tutorial"], every["tutorial: question"]["tutorial"]
    steps = tutorial_steps(scene, kitchen)
    def worded(page, kind):
        number, step = next((number, step) for number, step in enumerate(steps, 1) if step["kind"] == kind)
        return {**page, "number": number, "of": len(steps), "title": step["title"], "text": step["text"]}, step
    recipes, _ = worded(recipes, "recipes")
    question, asked = worded(question, "question")
    question["question"] = {**question["question"], "choices": asked["choices"], "wrong": 2, "explanation": asked["explanation"]}
    guided = next(step for step in steps if step["kind"] == "order")
    order_page, _ = worded(every[f"tutorial: {guided['id']}"]["tutorial"], "order")
    ordered = ["empty" if at != order else {"dish": guided["dish"]} for at in range(len(names))]
    return made | {
        "tutorial-order": {**every[f"tutorial: {guided['id']}"], "contents": ordered, "served": 0, "tutorial": order_page},
        "tutorial-recipes": {**every["tutorial: cards"], "tutorial": recipes},
        "tutorial-question": {**every["tutorial: question"], "tutorial": question},
        "probe-question": every["probe: place"],
        "probe-recipe": every["probe: recipe"],
        "running": running,
        "recipe": {**running, "signal": {"recipe": {"order": order, "dish": dish, "items": items_of(kitchen)[dish]}}},
        "highlight": {**running, "signal": {"highlight": place}},
        "no-effect": {**running, "presses": [press, None]},
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tomcom")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--from-disk", action="store_true", help="with the page's files as they are now, not as they were built")
    parser.add_argument("--out", type=Path, default=Path("tests/snapshots/display"))
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    with browser() as chromium:
        for kitchen, language, wanted, (page_size, size), before in [
            ("sushi", "en", None, ((1920, 1080), SIZE), ""), ("burger", "de", ("running", "recipe"), ((1920, 1080), SIZE), "burger-de-"),
            ("sushi", "en", ("running", "recipe", "highlight"), (UPRIGHT, UPRIGHT), "upright-"),
        ]:
            folder = arguments.folder / f"pictures-{before}{kitchen}"
            with opened(arguments.tomcom, chromium, folder, kitchen, language, size=page_size, from_disk=arguments.from_disk) as page:
                for file, sight in chosen(page.ask("Stage.scene()"), kitchen).items():
                    if wanted and file not in wanted:
                        continue
                    show(page, sight)
                    page.page.wait_for_timeout(100)
                    picture = Image.open(io.BytesIO(page.page.screenshot())).convert("RGB").resize(size, Image.LANCZOS)
                    path = arguments.out / f"{before}{file}.webp"
                    picture.save(path, quality=80, method=6)
                    assert path.stat().st_size <= MAX_BYTES, f"{path}: {path.stat().st_size} bytes"
                    print(f"{path}: {path.stat().st_size} bytes", flush=True)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)
