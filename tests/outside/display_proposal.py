"""DEV as a live arm on the participant's display: after an error the page proposes the next presses, until they are made.

    tests/outside/display_proposal.py TOMCOM FOLDER
"""

import sys
from pathlib import Path

from display import operate, session_file, start, url, verified
from page import Page, browser, plain

CARD = "document.querySelector('.recipe')"
IS_OPEN = f"{CARD}.classList.contains('open')"
WORDS = {"en": ("Your next step:", "take rice"), "de": ("Ihr nächster Schritt:", "nehmen: Reis")}


def proposes(tomcom, chromium, folder, seed, language):
    session = session_file(folder, "sushi", seed)
    session.write_text(session.read_text().replace("[display]\n", f'[display]\nlanguage = "{language}"\n')
                       .replace("[assistant]\n", "[assistant]\nproposed_presses = 2\n"))
    console = operate(tomcom, session, folder, "--condition", "assistant", "--concept", "dev")
    with console:
        page = Page(chromium, url())
        start(console, page)
        page.press("take rice", "keyboard")
        assert not page.ask(IS_OPEN)
        page.press("trash", "keyboard")
        page.wait_for(IS_OPEN)
        told = page.ask("Stage.shown().signal.next.map((index) => Stage.scene().buttons[index].name)")
        assert len(told) == 2, told
        words = plain(page.ask(f"{CARD}.innerText"))
        head, first = WORDS[language]
        assert words.startswith(head), words
        assert told[0] != "take rice" or first in words, (told, words)
        # A picture for each press, inside of the card, which hides nothing of the kitchen.
        assert page.ask(f"{CARD}.querySelectorAll('svg').length") == 2
        overlaps = page.ask(f"""(() => {{
            const card = {CARD}.getBoundingClientRect();
            const over = (box) => box.left < card.right && box.right > card.left && box.top < card.bottom && box.bottom > card.top;
            return [...document.querySelectorAll('.spot, .shelf, .pill')].filter((made) => over(made.getBoundingClientRect())).length;
        }})()""")
        assert overlaps == 0, overlaps
        page.page.wait_for_timeout(300)
        page.screenshot(folder / f"proposal-{language}.png")
        page.press(told[0], "keyboard")
        page.wait_for(f"Stage.shown().signal && Stage.shown().signal.next.length === 1 && {IS_OPEN}")
        page.press(told[1], "keyboard")
        page.wait_for(f"!({IS_OPEN})")
        page.close()
        console.quit()
    events = verified(tomcom, folder)
    shown = [event["signal"] for event in events if event["kind"] == "signal_shown"]
    ended = [event["reason"] for event in events if event["kind"] == "signal_ended"]
    assert shown == [{"propose": told}] and ended == ["outdated"], (shown, ended)
    print(f"proposal ({language}): {', '.join(told)}, with pictures, crossed off press by press; the recording verifies", flush=True)


def main():
    tomcom, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    with browser() as chromium:
        for language in WORDS:
            proposes(tomcom, chromium, folder / language, 9707, language)


if __name__ == "__main__":
    main()
