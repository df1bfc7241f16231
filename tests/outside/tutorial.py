"""The participant's tutorial on the display: the real program, a real browser, all pages by keys, by touch and by a gamepad, in both languages, on
the wall and on a telephone.

    tests/outside/tutorial.py TOMCOM FOLDER
"""

import argparse
import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

from console import Console
from page import Page, browser

PORT = 20332


def session_file(folder, seconds):
    """The study of the project with another port, and recipe cards that are shown for so many seconds."""
    (folder / "tutorials").mkdir(parents=True, exist_ok=True)
    for name in ("sushi.toml", "sushi.de.toml"):
        text = Path("sessions/tutorials", name).read_text()
        (folder / "tutorials" / name).write_text(text.replace("seconds = 60.0", f"seconds = {seconds}"))
    text = Path("sessions/study.toml").read_text().replace("../layouts", str(Path("layouts").resolve()))
    text = text.replace("questionnaires/", f"{Path('sessions/questionnaires').resolve()}/")
    path = folder / "study.toml"
    path.write_text(text.replace("[display]\n", f"[display]\nport = {PORT}\n"))
    return path


def overflows(page):
    """Words of the card that do not fit it, and cards that do not fit the screen."""
    return page.ask("""[...document.querySelectorAll(".lesson, .lesson *")].filter((made) => {
        const box = made.getBoundingClientRect(), card = document.querySelector(".lesson").getBoundingClientRect();
        return box.width > 0 && (box.left < card.left - 1 || box.right > card.right + 1 || box.top < card.top - 1 || box.bottom > card.bottom + 1
          || card.top < 0 || card.bottom > innerHeight || card.left < 0 || card.right > innerWidth);
    }).map((made) => made.outerHTML.slice(0, 80))""")


def go_on(page, way, step):
    page.wait_for(f"Stage.shown().tutorial && Stage.shown().tutorial.step === {json.dumps(step)} && Stage.shown().tutorial.done")
    if way == "touch":
        page.page.locator(".lesson .next").tap()
    elif way == "gamepad":
        # The cross, or the button that goes on.
        page.push(15 if len(step) % 2 else 0)
    else:
        page.page.keyboard.press("ArrowRight")


def answer(page, way, choice):
    if way == "touch":
        page.page.locator(f'[data-choose="{choice}"]').tap()
    elif way == "gamepad":
        while page.ask("Number(document.querySelector('[data-choose].at')?.dataset.choose ?? 0)") != choice:
            at = page.ask("Number(document.querySelector('[data-choose].at')?.dataset.choose ?? 0)")
            page.push(13 if at < choice else 12)
        page.push(0)
    else:
        page.page.keyboard.press(str(choice))


def plays(tomcom, chromium, folder, language, way, size):
    session = session_file(folder, seconds=1.5)
    tutorial = tomllib.loads(Path("sessions/tutorials", "sushi.de.toml" if language == "de" else "sushi.toml").read_text())
    console = Console(tomcom, [session, "--language", language, "--out", folder / "recordings"], command="tutorial")
    with console:
        console.wait_for("Tutorial of the participant")
        page = Page(chromium, f"http://127.0.0.1:{PORT}", size=size, touch=way == "touch")
        page.stage("tutorial")
        for number, step in enumerate(tutorial["step"], 1):
            name = step["id"]
            page.wait_for(f"Stage.shown().tutorial && Stage.shown().tutorial.step === {json.dumps(name)}")
            page.page.wait_for_timeout(250)
            page.screenshot(folder / f"{number:02}-{name}.png")
            if way == "gamepad" and number == 2:
                page.push(14)
                page.wait_for("Stage.shown().tutorial.number === 1")
                page.push(15)
                page.wait_for("Stage.shown().tutorial.number === 2")
            assert not overflows(page), (name, overflows(page))
            for button in step.get("presses", []):
                page.press(button, way)
            if step["kind"] == "question":
                answer(page, way, step["right"] % len(step["choices"]) + 1)
                page.wait_for("Stage.shown().tutorial.question.wrong !== null")
                page.screenshot(folder / f"{number:02}-{name}-wrong.png")
                assert not overflows(page), (name, overflows(page))
                assert page.page.locator(".verdict.wrong").inner_text().endswith(step["explanation"])
                answer(page, way, step["right"])
            go_on(page, way, name)
        page.stage("ready")
        page.close()
        console.wait_for("leave the tutorial")
        console.quit()
    (recording,) = (folder / "recordings").iterdir()
    events = [json.loads(line) for line in (recording / "events.jsonl").read_text().splitlines()[1:]]
    assert not [event for event in events if event["kind"] == "press"], "no press of a trial"
    told = [event for event in events if event.get("what") == "tutorial"]
    wanted = [button for step in tutorial["step"] for button in step.get("presses", [])]
    assert [event["button"] for event in told if event["did"] == "pressed"] == wanted
    subprocess.run([tomcom, "replay", recording, "--verify"], check=True, stdout=subprocess.DEVNULL)
    print(f"tutorial in {language} by {way} at {size[0]}x{size[1]}: {len(tutorial['step'])} pages, the recording verifies", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tomcom")
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    with browser() as chromium:
        for language, way, size in (("en", "keyboard", (1920, 1080)), ("de", "touch", (1280, 800)), ("en", "gamepad", (1280, 800)),
                                    ("en", "touch", (390, 844)), ("de", "touch", (390, 844))):
            plays(arguments.tomcom, chromium, arguments.folder / f"{language}-{way}-{size[0]}", language, way, size)


if __name__ == "__main__":
    main()
    # All is checked. Libraries in C may crash while the interpreter is taken down, which says nothing of the program.
    sys.stdout.flush()
    os._exit(0)
