"""The participant's tutorial on the display: the real program, a real browser, all pages by keys, by touch and by a gamepad, in both languages, on
the wall and on a telephone.

    tests/outside/tutorial.py TOMCOM FOLDER
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

from console import Console
from page import Page, browser, plain

PORT = 20332
# Presses of buttons that are not asked for.
OTHERS = ("take nori", "take shrimp", "cooking_pot")
# Whether the reason is shown, stands above the card, and what of that which is marked it hides.
REASON = """(() => {
    const made = document.querySelector(".why"), a = made.getBoundingClientRect(), layer = (one) => Number(getComputedStyle(one).zIndex);
    const marked = [...document.querySelectorAll(".hinted")];
    const hidden = marked.filter((one) => { const b = one.getBoundingClientRect(); return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom; });
    return { says: made.classList.contains("says") && marked.length > 0, above: layer(made) > layer(document.querySelector(".sheet")), hides: hidden.map((one) => one.dataset.button) };
})()"""


def session_file(folder, seconds):
    """The study of the project with another port, and recipe cards that are shown for so many seconds."""
    (folder / "tutorials").mkdir(parents=True, exist_ok=True)
    for name in ("sushi.toml", "sushi.de.toml"):
        text = Path("sessions/tutorials", name).read_text()
        (folder / "tutorials" / name).write_text(text.replace("seconds = 60.0", f"seconds = {seconds}"))
    text = Path("sessions/study.toml").read_text().replace("../layouts", str(Path("layouts").resolve()))
    text = text.replace("questionnaires/", f"{Path('sessions/questionnaires').resolve()}/")
    path = folder / "study.toml"
    text = text.replace('arm = "none"', 'arm = "hand"')
    path.write_text(text.replace("[display]\n", f"[display]\nport = {PORT}\n") + "\n[probes]\nper_trial = 0\n")
    return path


def overflows(page):
    """Words of the card that do not fit it, and cards that do not fit the screen."""
    return page.ask("""[...document.querySelectorAll(".lesson, .lesson *")].filter((made) => {
        const box = made.getBoundingClientRect(), card = document.querySelector(".lesson").getBoundingClientRect();
        return box.width > 0 && (box.left < card.left - 1 || box.right > card.right + 1 || box.top < card.top - 1 || box.bottom > card.bottom + 1
          || card.top < 0 || card.bottom > innerHeight || card.left < 0 || card.right > innerWidth);
    }).map((made) => made.outerHTML.slice(0, 80))""")


def turn(page, way, forward=True):
    """Turns the page, or tries to; on a gamepad by the cross."""
    if way == "touch":
        page.page.locator(".lesson .next" if forward else ".lesson .back").tap(force=True)
    elif way == "gamepad":
        page.push(15 if forward else 14)
    else:
        page.page.keyboard.press("ArrowRight" if forward else "ArrowLeft")


def verdict(page):
    return page.ask("document.querySelector('.lesson .verdict.line').textContent")


def checks_what_is_missing(page, way, step, words):
    """Whoever tries to go on too early is told what is missing. A gamepad's cross is a button of the kitchen while presses are asked for."""
    missing = {"press": "press", "order": "press", "question": "question", "recipes": "recipes", "robot_says": "robot"}.get(step["kind"])
    if missing and not (way == "gamepad" and missing == "press"):
        turn(page, way)
        page.wait_for("document.querySelector('.lesson .verdict.line.wrong').textContent")
        # What the robot shows is counted.
        said = words[f"page tutorial first {missing}"]
        assert re.fullmatch(re.escape(said).replace(r"\#", "[1-5]"), verdict(page)), (step["id"], verdict(page))
        assert not overflows(page), (step["id"], overflows(page))


def checks_another_press(page, way, words, folder):
    """A press of a button that is not asked for says why it does nothing: once, at its place, above the card, beside what is marked."""
    place = words.get("the cooking pot") or page.ask("Stage.scene().locations.find(({ name }) => name === 'cooking_pot').label")
    for button, said in (("take shrimp", "page tutorial another first"), ("cooking_pot", "page why both_empty")):
        if way != "gamepad":
            turn(page, way)
            page.wait_for(f"document.querySelector('.lesson .verdict.line').textContent === {json.dumps(words['page tutorial first press'])}")
            assert page.ask("!document.querySelector('.why.says')"), "two messages"
        page.press(button, way)
        assert verdict(page) == "", verdict(page)
        assert page.ask("document.querySelector('.why').textContent") == words[said].replace("#", place)
        assert page.ask(REASON) == {"says": True, "above": True, "hides": []}, (button, page.ask(REASON))
        assert not overflows(page), overflows(page)
        page.screenshot(folder / f"another-press-{button.replace(' ', '-')}.png")


def checks_a_press_too_many(page, way, words, folder):
    """A press after the last one that is asked for is no mistake."""
    page.press("take nori", way)
    assert verdict(page) == words["page tutorial right"], verdict(page)
    assert page.ask("document.querySelector('.lesson .verdict.line').classList.contains('right')")
    assert not page.ask("document.querySelector('.why.says')?.textContent ?? ''").startswith(words["page tutorial another first"])
    page.screenshot(folder / "a-press-too-many.png")


def checks_the_robot_moves(page):
    """The robot's hand goes to what it takes, and lays it down; nothing is asked of the participant, whose press says that it does nothing. The
    card covers neither place, nor the hand there."""
    assert page.ask("document.querySelectorAll('.hinted').length") == 0
    framed = page.ask("""[...document.querySelectorAll(".framed")].map((made) => {
        const a = made.getBoundingClientRect(), b = document.querySelector(".card").getBoundingClientRect();
        return [made.className, a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom];
    })""")
    assert sorted(framed) == [["shelf robot framed", False], ["spot place framed", False]], framed
    page.page.keyboard.press("u")
    page.wait_for("document.querySelector('.why.says')")
    where = "document.querySelector('.robot-hand').dataset.x"
    before = page.ask(where)
    page.wait_for(f"{where} !== '{before}' && getComputedStyle(document.querySelector('.robot-hand')).visibility === 'visible'")
    assert page.ask("document.querySelector('.lesson .next[aria-disabled]') || [...document.querySelectorAll('.spot.place')].some((made) => made.dataset.holds === 'item')"), "one can go on before the robot has shown it"
    page.wait_for("[...document.querySelectorAll('.spot.place')].some((made) => made.dataset.holds === 'item')")


def practises(page, way, words, folder):
    """The question of a probe: "I don't know" first, then the right answer. What the kitchen holds cannot be seen meanwhile."""
    right = page.ask("Stage.shown().tutorial.probe.choices.find(({ shows }) => shows && shows.item === 'salmon cut').number")
    for selector, said in (("[data-unknown]", "page tutorial probe wrong"), (f'[data-believe="{right}"]', "page tutorial right")):
        turn(page, way)
        page.wait_for("document.querySelector('.probing .choices')")
        page.page.wait_for_timeout(300)
        page.screenshot(folder / "practised-probe.png")
        page.ask(f"Probe.touch(document.querySelector({json.dumps(selector)}).dataset)")
        page.wait_for(f"document.querySelector('.lesson .verdict.line')?.textContent === {json.dumps(words[said])}")
    page.wait_for("Stage.shown().tutorial.done")


def checks_the_time_goes_on(page, way, words, step):
    """The time of the recipe cards goes on where it was when the participant comes back to them, until it is over."""
    page.page.wait_for_timeout(300)
    turn(page, way, forward=False)
    page.wait_for(f"Stage.shown().tutorial.step !== {json.dumps(step)}")
    turn(page, way)
    page.wait_for(f"Stage.shown().tutorial.step === {json.dumps(step)}")
    seconds, left = page.ask("[Stage.shown().tutorial.seconds, Stage.shown().tutorial.left_s]")
    assert left < seconds - 0.3, (seconds, left)
    page.wait_for("Stage.shown().tutorial.done")
    assert page.ask("document.querySelector('.lesson .says').textContent") == words["page tutorial recipes over"]


def touchables(page):
    """Where what can be touched on the card stands."""
    return page.ask("[...document.querySelectorAll('.lesson button')].map((made) => { const { left, top } = made.getBoundingClientRect(); return [Math.round(left), Math.round(top)]; })")


def checks_the_step_before(page, way, words):
    """A step that was done and is shown again does not claim that it is done anew."""
    number = page.ask("Stage.shown().tutorial.number")
    turn(page, way, forward=False)
    page.wait_for(f"Stage.shown().tutorial.number === {number - 1}")
    assert verdict(page) == words["page tutorial again"], verdict(page)
    turn(page, way)
    page.wait_for(f"Stage.shown().tutorial.number === {number}")


def go_on(page, way, step):
    # What the robot shows must have been shown once.
    page.wait_for(f"Stage.shown().tutorial && Stage.shown().tutorial.step === {json.dumps(step)} && Stage.shown().tutorial.done && !document.querySelector('.lesson .next[aria-disabled]')")
    if way == "gamepad" and len(step) % 2:
        # The button that goes on, and not the cross.
        page.push(0)
    else:
        turn(page, way)


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
    session = session_file(folder, seconds=8.0)
    tutorial = tomllib.loads(Path("sessions/tutorials", "sushi.de.toml" if language == "de" else "sushi.toml").read_text())
    words = tomllib.loads(Path(f"src/devices/sight/languages/{language}.toml").read_text())
    console = Console(tomcom, [session, "--language", language, "--out", folder / "recordings"], command="tutorial")
    with console:
        console.wait_for("Tutorial of the participant")
        page = Page(chromium, f"http://127.0.0.1:{PORT}", size=size, touch=way == "touch")
        page.stage("tutorial")
        heights = set()
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
            if step["kind"] not in ("recipes", "question"):
                heights.add(page.ask("(() => { const { top, height } = document.querySelector('.lesson .next').getBoundingClientRect(); return Math.round(top + height / 2); })()"))
            checks_what_is_missing(page, way, step, words)
            if step["kind"] == "order":
                checks_another_press(page, way, words, folder)
            if name == "stack" and way != "gamepad":
                checks_the_step_before(page, way, words)
            for button in step.get("presses", []) if step["kind"] != "robot" else []:
                page.press(button, way)
            if step["kind"] == "robot":
                checks_the_robot_moves(page)
            if step["kind"] == "probe":
                practises(page, way, words, folder)
            if name == "take":
                checks_a_press_too_many(page, way, words, folder)
            if step["kind"] == "recipes":
                checks_the_time_goes_on(page, way, words, name)
                page.screenshot(folder / f"{number:02}-{name}-over.png")
            if step["kind"] == "question":
                before = touchables(page)
                answer(page, way, step["right"] % len(step["choices"]) + 1)
                page.wait_for("Stage.shown().tutorial.question.wrong !== null")
                page.screenshot(folder / f"{number:02}-{name}-wrong.png")
                assert not overflows(page), (name, overflows(page))
                assert page.page.locator(".verdict.wrong:not(.line)").inner_text().endswith(step["explanation"])
                assert touchables(page) == before, (name, before, touchables(page))
                turn(page, way)
                page.wait_for(f"document.querySelector('.lesson .verdict.line').textContent === {json.dumps(words['page tutorial other answer'])}")
                assert touchables(page) == before, (name, before, touchables(page))
                answer(page, way, step["right"])
                page.wait_for("Stage.shown().tutorial.done")
                assert touchables(page) == before, (name, before, touchables(page))
            go_on(page, way, name)
        # "Next" stands at one height beside the kitchen, but for the words of a card that are smaller.
        assert size[0] < size[1] or max(heights) - min(heights) < 0.02 * size[1], heights
        page.stage("tutorial_over")
        page.screenshot(folder / "over.png")
        assert page.ask("document.querySelector('.card p').textContent") == words["page tutorial over text"]
        console.wait_for("leaves? the tutorial")
        console.quit()
        page.wait_for(f"[...document.querySelectorAll('.toast.open, .sheet.open')].some((made) => made.textContent.includes({json.dumps(words['page ended'])}))")
        wanted = [button for step in tutorial["step"] if step["kind"] != "robot" for button in step.get("presses", [])]
        questions = sum(step["kind"] in ("question", "probe") for step in tutorial["step"])
        steps = len(tutorial["step"])
        said = f"tutorial: {steps} of {steps} steps done, {len(wanted) + len(OTHERS)} presses, {questions} wrong answers"
        page.page.wait_for_timeout(300)
        assert said in plain(console.text()), console.text()
        page.close()
    (recording,) = (folder / "recordings").iterdir()
    events = [json.loads(line) for line in (recording / "events.jsonl").read_text().splitlines()[1:]]
    assert not [event for event in events if event["kind"] == "press"], "no press of a trial"
    told = [event for event in events if event.get("what") == "tutorial"]
    pressed = [event["button"] for event in told if event["did"] == "pressed"]
    assert sorted(pressed) == sorted([*wanted, *OTHERS]), pressed
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
