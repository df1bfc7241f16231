"""Settings of the participant's page in a real browser: sound, voice, clock, number of served orders; its hands; and upright screens.

    tests/outside/display_settings.py TOMCOM FOLDER
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path

from display import operate, presses_for, seed_of, session_file, start, url, verified
from page import Page, browser, plain

# Counts what the page makes to be heard.
LISTEN = """() => {
window.tones = [], window.contexts = 0;
const make = AudioContext.prototype.createOscillator, Made = AudioContext;
AudioContext.prototype.createOscillator = function () { const tone = make.call(this); tones.push(tone); return tone; };
window.AudioContext = class extends Made { constructor(...all) { super(...all); contexts += 1; } };
}"""
UPRIGHT = (390, 844)
# What the robot's side says when the robot is slow: at once, and once that lasts.
SLOW = """async () => {
    const says = () => document.getElementById("stage").dataset.robot;
    Stage.show({ ...Stage.shown(), robot_does: "slow" });
    const before = says();
    await new Promise((then) => setTimeout(then, 2500));
    return [before === "slow", says()];
}"""


def heard(page):
    """The tones so far, as frequencies in Hz."""
    return page.ask("tones.map((tone) => tone.frequency.value)")


def sounds(tomcom, chromium, folder, seed, is_on):
    session = session_file(folder, "sushi", seed)
    if not is_on:
        session.write_text(session.read_text().replace("sound = true\n", ""))
    with operate(tomcom, session, folder) as console:
        page = Page(chromium, url())
        page.ask(LISTEN)
        start(console, page)
        # The first key lets the page sound; it has an effect, and is not heard.
        page.press("take rice", "keyboard")
        page.page.wait_for_timeout(300)
        assert heard(page) == [] and page.ask("contexts") == int(is_on), heard(page)
        page.press("cook", "keyboard")
        page.page.wait_for_timeout(100)
        assert heard(page) == ([185] if is_on else []), heard(page)
        console.key("q")
        page.wait_for("document.querySelector('.recipe').classList.contains('open')")
        page.page.wait_for_timeout(100)
        wanted = [185, 659, 880] if is_on else []
        assert heard(page) == wanted, heard(page)
        # What is not new is not heard: the robot, the end of the signal, the page that is drawn anew.
        console.key("\x7f")
        page.page.wait_for_timeout(500)
        page.press("cooking_pot", "keyboard")
        assert heard(page) == wanted, heard(page)
        page.close()
        console.quit()
    verified(tomcom, folder)
    print(f"sound {'on: a tone for a press without effect, another one for a signal, none for anything else' if is_on else 'off: nothing is heard'}", flush=True)


def counts(tomcom, chromium, folder, seed):
    """The clock goes, stands in a pause, and is the same on a page that is loaded again."""
    def left():
        minutes, seconds = page.ask("document.querySelector('.clock').textContent").split(":")
        return 60 * int(minutes) + int(seconds)

    with operate(tomcom, session_file(folder, "sushi", seed), folder) as console:
        page = Page(chromium, url())
        start(console, page)
        page.wait_for("document.querySelector('.clock').textContent < '15:00'")
        began, at = time.monotonic(), left()
        page.page.wait_for_timeout(4000)
        assert abs((at - left()) - (time.monotonic() - began)) < 1.2, (at, left())
        console.key(".")
        page.stage("paused")
        # Also between two questions of a probe, whose answers would lie there.
        assert page.ask("getComputedStyle(document.querySelector('.kitchen')).visibility") == "hidden"
        stands = left()
        page.page.wait_for_timeout(2500)
        assert left() == stands
        page.page.reload()
        page.stage("paused")
        page.page.wait_for_timeout(1500)
        assert abs(left() - stands) <= 1, (left(), stands)
        console.key(".")
        page.stage("running")
        page.wait_for(f"document.querySelector('.clock').textContent !== '{stands // 60}:{stands % 60:02}'")
        assert page.ask("document.querySelector('.served').textContent") == "✓ 0 served", page.ask("document.querySelector('.served').textContent")
        page.close()
        console.quit()
    plain_session = session_file(folder / "plain", "sushi", seed)
    plain_session.write_text(plain_session.read_text().replace("served = true\nclock = true\n", ""))
    with operate(tomcom, plain_session, folder / "plain") as console:
        page = Page(chromium, url())
        start(console, page)
        assert page.ask("[Stage.shown().served, Stage.shown().clock, document.querySelector('.status').innerText.trim()]") == [None, None, ""]
        assert page.ask(SLOW) == [False, "slow"]
        page.close()
        console.quit()
    print("clock: it goes, stands in a pause, and is told to a page that is loaded again; without the settings nothing is told", flush=True)


# A browser with voices for these languages, which keeps what it was told to speak.
VOICES = """
window.spoken = [];
const voices = LANGUAGES.map((lang) => ({ lang, name: lang, default: false, localService: true, voiceURI: lang }));
Object.defineProperty(window, "speechSynthesis", { value: Object.assign(new EventTarget(), { getVoices: () => voices, cancel: () => {}, speak: (one) => spoken.push([one.text, one.lang]) }) });
window.SpeechSynthesisUtterance = class { constructor(text) { this.text = text; } };
"""


def speaks(tomcom, chromium, folder, seed, languages):
    """Signals are spoken in the page's language, where the browser has a voice for it; the check before the trial says if not."""
    session = session_file(folder, "sushi", seed)
    session.write_text(session.read_text().replace("[display]\n", '[display]\nvoice = true\nlanguage = "de"\n'))
    with operate(tomcom, session, folder) as console:
        page = Page(chromium, url(), more=VOICES.replace("LANGUAGES", json.dumps(languages)))
        page.stage("welcome")
        page.page.mouse.move(960, 500)
        console.key("\x10")
        console.wait_for("ROBOT HELD")
        time.sleep(1.5)
        console.key(".")
        console.wait_for("Checks before the trial")
        has_voice = any(language.startswith("de") for language in languages)
        assert ("signals are not spoken" in plain(console.text())) != has_voice, console.text()
        console.key("o")
        page.stage("running")
        page.wait_for("Stage.shown().contents.some((what) => what.dish)")
        console.key("c")
        page.wait_for("document.querySelector('.highlight')")
        console.key("\x7f")
        page.wait_for("!document.querySelector('.highlight')")
        console.key("q")
        page.wait_for("document.querySelector('.recipe').classList.contains('open')")
        page.page.wait_for_timeout(100)
        spoken = page.ask("spoken")
        page.close()
        console.quit()
    verified(tomcom, folder)
    if has_voice:
        assert spoken[0] == ["Sehen Sie hierhin: Schneidebrett", "de-DE"], spoken
        assert len(spoken) == 2 and ":" in spoken[1][0] and "," in spoken[1][0], spoken
    else:
        assert spoken == [], spoken
    print(f"voices {languages}: {spoken or 'nothing is spoken, and the check before the trial says so'}", flush=True)


def hands(tomcom, chromium, folder, seed):
    """Keys are places on the keyboard, whatever is printed on them; a gamepad is shown once it is used; what does nothing says so."""
    badge = lambda page, button: page.ask(f"document.querySelector('[data-of=\"{button}\"]').textContent")
    with operate(tomcom, session_file(folder, "sushi", seed), folder) as console:
        page = Page(chromium, url())
        page.wait_for("document.querySelector('.readiness')?.textContent.includes(Stage.scene().words['ready pad'])")
        start(console, page)
        # A German keyboard with Caps Lock: where the layout has Y, Z is printed.
        def down(code, key):
            page.ask(f"for (const kind of ['keydown', 'keyup']) window.dispatchEvent(new KeyboardEvent(kind, {{ code: {json.dumps(code)}, key: {json.dumps(key)} }}))")
        assert badge(page, "take rice") == "Y"
        down("KeyY", "Z")
        page.wait_for("Stage.shown().presses[0]?.number === 1 && Stage.shown().presses[0].effective")
        assert badge(page, "take rice") == "Z"
        page.page.wait_for_timeout(100)
        down("KeyM", "m")
        page.wait_for("document.querySelector('.why.says')?.textContent === 'That does nothing here.'")
        assert page.presses() == 1
        page.ask("pad.axes = [0, 1, 0, 0]")
        page.wait_for("Stage.shown().presses[0].number === 2")
        page.ask("pad.axes[1] = 0")
        assert page.ask("document.querySelector('.key.of-pad svg') !== null")
        # The guide button belongs to the system.
        page.push(16)
        page.page.wait_for_timeout(100)
        assert page.presses() == 2
        page.page.keyboard.press("u")
        page.wait_for("Stage.shown().presses[0].number === 3")
        assert page.ask("document.querySelector('.key.of-pad')") is None
        # A page that only watches says nothing of that, and takes no part.
        other = Page(chromium, url() + "/?watch", size=(1280, 720))
        other.stage("running")
        assert not other.ask("document.querySelector('.toast.open')")
        page.close()
        console.wait_for("NO DISPLAY")
        other.page.keyboard.press("i")
        other.page.wait_for_timeout(500)
        assert not [message for message in other.said if message["kind"] in ("press", "take_part")], other.said
        other.close()
        console.quit()
    events = verified(tomcom, folder)
    assert [event["button"] for event in events if event["kind"] == "press" and event["agent"] == "human"] == ["take rice", "trash", "take nori"]
    print("keys by place, a stick, the guide button, a key that does nothing; a page that only watches", flush=True)


def upright(tomcom, chromium, folder, kitchen, seed):
    """An order on a telephone by touch: no gaze is sent until the screen is turned, and the check says why."""
    with operate(tomcom, session_file(folder, kitchen, seed), folder) as console:
        page = Page(chromium, url(), size=UPRIGHT, touch=True)
        page.stage("welcome")
        page.page.mouse.move(200, 500)
        console.key("\x10")
        console.wait_for("ROBOT HELD")
        time.sleep(1.5)
        console.key(".")
        console.wait_for("Checks before the trial")
        assert "turn the screen" in plain(console.text()), console.text()
        console.key("o")
        page.stage("running")
        page.wait_for("Stage.shown().contents.some((what) => what.dish)")
        presses = presses_for(kitchen, page.orders()[0], 1)
        page.page.wait_for_timeout(500)
        page.screenshot(folder / "running.png")
        for button in presses[:-1]:
            page.press(button, "touch")
            page.page.mouse.move(100 + len(button), 300)
        console.key("q")
        page.wait_for("document.querySelector('.recipe').classList.contains('open')")
        page.page.wait_for_timeout(300)
        page.screenshot(folder / "recipe.png")
        # Keys are shown once one is pressed.
        keys = "[...document.querySelectorAll('.key')].some((made) => made.checkVisibility())"
        assert not page.ask(keys)
        page.page.keyboard.press("m")
        assert page.ask(keys)
        assert not [message for message in page.said if message["kind"] == "pointer"], "gaze from an upright page"
        before = page.ask("JSON.stringify(Stage.shown().contents)")
        page.page.set_viewport_size({"width": UPRIGHT[1], "height": UPRIGHT[0]})
        page.page.wait_for_timeout(700)
        assert page.ask("[document.getElementById('stage').classList.contains('upright'), JSON.stringify(Stage.shown().contents)]") == [False, before]
        page.page.mouse.move(300, 200)
        page.page.wait_for_timeout(200)
        assert [message for message in page.said if message["kind"] == "pointer"], "no gaze from the turned page"
        page.press(presses[-1], "touch")
        page.wait_for("Stage.shown().served === 1")
        page.close()
        console.quit()
    verified(tomcom, folder)
    print(f"upright: an order of the {kitchen} kitchen by touch at {UPRIGHT[0]}x{UPRIGHT[1]}; no gaze until the screen is turned", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tomcom")
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    tomcom, folder = arguments.tomcom, arguments.folder
    with browser() as chromium:
        seeds = {kitchen: seed_of(tomcom, folder / kitchen, kitchen) for kitchen in ("sushi", "burger")}
        for is_on in (True, False):
            sounds(tomcom, chromium, folder / f"sound-{is_on}", seeds["sushi"], is_on)
        for languages in (["en-US", "de-DE"], ["en-US"]):
            speaks(tomcom, chromium, folder / f"voice-{len(languages)}", seeds["sushi"], languages)
        hands(tomcom, chromium, folder / "hands", seeds["sushi"])
        counts(tomcom, chromium, folder / "counts", seeds["sushi"])
        for kitchen, seed in seeds.items():
            upright(tomcom, chromium, folder / f"upright-{kitchen}", kitchen, seed)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)
