"""Text on the participant's page is whole and hides nothing, in every language, kitchen, state and size.

    tests/outside/display_fits.py TOMCOM FOLDER [--from-disk] [--screenshots]

Languages: English, German, Japanese, and one whose words are 40 % longer than the English ones: with it, every word on the page is one of its
file, or of the session. What is measured are boxes of the rendered text, by the browser: no text is cut off, leaves its own box, or meets
another text, a button, a place or a tag; the robot's hand covers nothing where it stops. Capitals
of English and German text are at least 17 arc minutes high at 3 m, on a screen of the layout's width. On an upright telephone
of 390x844 what is touched is at least 44 pixels wide and high, and English and German text has capitals of at least 6.5 pixels.
"""

import argparse
import json
import os
import re
import sys
import tomllib
from pathlib import Path

from display_states import KITCHENS, long_language, opened, show, states
from page import browser, has_font

# Height of capitals on a screen of the layout's width, seen from the distance for which the page is made.
ARC_MINUTES, DISTANCE_M = 17, 3
SIZES = [(1920, 1080), (1280, 800), (3840, 2160)]
# Telephones in the hand, in pixels of CSS: that for which the layout is made, and a smaller one, on which everything is smaller.
UPRIGHT, TOUCH_PX, CAPITALS_PX = [(390, 844), (360, 640)], 44, 6.5
# Least width of what the robot holds, wherever its hand stands.
HELD_PX = 32

# So far away at most, in em, a reason stands from what was pressed, since it hides no name: in English, and where words are longer or the card of a lesson stands over the kitchen.
NEAR_EM = [8, 17]

MEASURE = """([states, DISTANCE_M, NEAR_EM]) => Object.entries(states).map(([name, sight]) => {
  Hands.pressed = () => sight.pressed;
  Stage.show(sight, () => 17);
  for (const choice of (sight.probe && sight.probe.touched) || []) Probe.touch({ believe: choice });
  const SLACK = 1, found = [], stageMade = document.getElementById("stage"), stage = stageMade.getBoundingClientRect();
  const isSeen = (made) => made.checkVisibility({ opacityProperty: true, visibilityProperty: true });
  const box = (made) => made.getBoundingClientRect();
  const meets = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > SLACK && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > SLACK;
  const inside = (a, b) => a.left >= b.left - SLACK && a.right <= b.right + SLACK && a.top >= b.top - SLACK && a.bottom <= b.bottom + SLACK;
  const lettered = [...document.querySelectorAll("#stage *")].filter((made) =>
    !made.closest("svg") && isSeen(made) && !(made.closest(".given") && box(made).bottom > box(made.closest(".given")).bottom + SLACK) && [...made.childNodes].some((node) => node.nodeType === 3 && node.data.trim()));
  const texts = lettered.map((made) => {
    const range = document.createRange();
    range.selectNodeContents(made);
    // The ink of a letter is lower than its line.
    const { left, right, top, bottom } = range.getBoundingClientRect(), size = parseFloat(getComputedStyle(made).fontSize);
    const lines = Math.max(1, Math.round((bottom - top) / size / 1.1)), air = Math.max(0, ((bottom - top) - lines * size) / 2);
    return { made, said: made.textContent, left, right, top: top + air, bottom: bottom - air };
  });
  // No word in Latin letters is broken.
  for (const { made } of texts) for (const node of [...made.childNodes].filter(({ nodeType }) => nodeType === 3)) for (const { 0: word, index } of node.data.matchAll(/\\p{Script=Latin}+/gu)) {
    const range = document.createRange();
    range.setStart(node, index);
    range.setEnd(node, index + word.length);
    if (new Set([...range.getClientRects()].map(({ top }) => Math.round(top))).size > 1) found.push(`"${word}" is broken`);
  }
  const HOLDERS = ".pill, .spot.order, .recipe, .card, .why, .zone, .key, .toast, button, li";
  for (const text of texts) {
    const { made, said } = text, holder = made.closest(HOLDERS);
    if (!inside(text, stage)) found.push(`"${said}" leaves the screen`);
    if (holder && !inside(text, box(holder))) found.push(`"${said}" leaves its ${holder.className || holder.tagName}`);
    if (made.scrollWidth > made.clientWidth + SLACK && made.clientWidth) found.push(`"${said}" is cut off: ${made.scrollWidth} of ${made.clientWidth} px`);
  }
  // What the card of a lesson would cut is hidden.
  const lesson = document.querySelector(".sheet.open .lesson:not(.large)");
  for (const text of texts) if (lesson && !lesson.contains(text.made) && !text.made.closest(".why, .toast") && meets(text, box(lesson)) && !inside(text, box(lesson))) found.push(`the card of a lesson cuts "${text.said}"`);
  const sheet = document.querySelector(".sheet.open"), card = sheet && sheet.querySelector(".card");
  // A card stands over the dimmed kitchen on purpose, except for the instruction, which explains it.
  const over = (made) => made.closest(".why, .toast") || (card && !sheet.classList.contains("instruction") && card.contains(made));
  for (const [i, a] of texts.entries()) for (const b of texts.slice(i + 1)) {
    if (Boolean(over(a.made)) !== Boolean(over(b.made))) continue;
    if (meets(a, b)) found.push(`"${a.said}" meets "${b.said}"`);
  }
  const solid = [...document.querySelectorAll(".pill, .spot.order, .shelf, .spot .furniture, .key, .tag, .flash, .recipe.open, .bin, .go-on p, .instruction .card")].filter(isSeen);
  const related = (a, b) => a.contains(b) || b.contains(a);
  for (const text of texts.filter(({ made }) => !over(made))) for (const made of solid) {
    if (!related(made, text.made) && meets(text, box(made)) && !(made.matches(".furniture") && made.parentNode.contains(text.made))) {
      found.push(`"${text.said}" meets ${made.className} ${made.textContent.slice(0, 20) || made.parentNode.className}`);
    }
  }
  const boxes = solid.filter((made) => !made.matches(".key"));
  for (const [i, a] of boxes.entries()) for (const b of boxes.slice(i + 1)) {
    if (!related(a, b) && meets(box(a), box(b))) found.push(`${a.className} "${a.textContent}" overlaps ${b.className} "${b.textContent}"`);
  }
  for (const made of boxes) if (!inside(box(made), stage)) found.push(`${made.className} "${made.textContent}" leaves the screen`);
  // A button is within a zone or outside of it, and clear of an order's frame.
  const zones = [...document.querySelectorAll(".zone")].filter(isSeen), orders = [...document.querySelectorAll(".spot.order")].filter(isSeen);
  for (const made of document.querySelectorAll(".pill")) {
    if (!isSeen(made)) continue;
    for (const zone of zones) if (meets(box(made), box(zone)) && !inside(box(made), box(zone))) found.push(`${made.textContent} hangs over the edge of ${zone.className}`);
    for (const order of orders) {
      const { left, right, top, bottom } = box(order), frame = 0.005 * stage.width;
      if (meets(box(made), { left: left - frame, right: right + frame, top: top - frame, bottom: bottom + frame })) found.push(`${made.textContent} touches the frame of an order`);
    }
  }
  // A frame around something goes around texts, never through them: not the line of its border, its outline, or its inner lines.
  const grown = (a, by) => ({ left: a.left - by, right: a.right + by, top: a.top - by, bottom: a.bottom + by });
  const bands = (made, part) => {
    const style = getComputedStyle(made, part), own = box(made), px = (name) => parseFloat(style[name]) || 0;
    if (part && style.content === "none") return [];
    const edge = part ? { left: own.left + px("left"), right: own.right - px("right"), top: own.top + px("top"), bottom: own.bottom - px("bottom") } : own;
    const border = px("borderTopWidth"), lines = Math.max(0, ...[...style.boxShadow.matchAll(/0px 0px 0px ([0-9.]+)px inset/g)].map((match) => Number(match[1])));
    const outline = style.outlineStyle === "none" ? 0 : px("outlineWidth"), offset = px("outlineOffset");
    return [...(border ? [[edge, grown(edge, -border - lines)]] : []), ...(outline ? [[grown(edge, offset + outline), grown(edge, offset)]] : [])];
  };
  for (const made of document.querySelectorAll(".highlight, .framed, .hinted, .intended")) for (const part of [null, "::before"]) for (const [outer, inner] of bands(made, part)) {
    for (const text of texts) if (!over(text.made) && !text.made.matches(".key") && meets(text, outer) && !inside(text, inner)) found.push(`the frame of ${made.className} crosses "${text.said}"`);
  }
  // A reason hides nothing that is pressed next or read, and nothing that the robot does; a recipe neither, with its frame.
  const theirs = document.querySelector(".zone.robot"), em = parseFloat(getComputedStyle(stageMade).fontSize);
  const robots = [...document.querySelectorAll(".gripper"), ...(stageMade.classList.contains("upright") ? [] : [theirs])].filter(isSeen);
  for (const why of [...document.querySelectorAll(".why")].filter((made) => isSeen(made) && made.textContent)) {
    for (const made of [...solid.filter((one) => !one.matches(".flash")), ...robots]) if (meets(box(why), box(made))) found.push(`"${why.textContent}" hides ${made.className} ${made.textContent || made.parentNode.className}`);
    for (const text of texts.filter(({ made }) => (lesson ? !why.contains(made) : !over(made)))) if (meets(box(why), text)) found.push(`"${why.textContent}" hides "${text.said}"`);
  }
  // It stands at what was pressed.
  const press = sight.presses[0], line = document.querySelector(".why.says");
  if (press && press.why) {
    const a = box(line), b = box(sight.pressed ? document.querySelector(`[data-button="${sight.pressed}"]`) : document.querySelectorAll("storage" in press.at ? ".shelf" : ".spot")["storage" in press.at ? press.at.storage : press.at.location]);
    const away = Math.hypot(Math.max(0, b.left - a.right, a.left - b.right), Math.max(0, b.top - a.bottom, a.top - b.bottom)) / em;
    if (away > NEAR_EM[lesson ? 1 : 0]) found.push(`a reason is ${away.toFixed(1)} em away from what was pressed`);
    if (!line.querySelector(".tail")) found.push("a reason has no tail");
  }
  const open = document.querySelector(".recipe.open");
  for (const made of open ? [...solid, ...texts.map(({ made }) => made)] : []) if (!related(open, made) && meets(grown(box(open), 0.45 * em), box(made))) found.push(`the frame of the recipe meets ${made.className} "${made.textContent}"`);
  if (open && meets(box(open), box(theirs))) found.push("the recipe hides the robot's side");
  // Buttons of a card stand in it.
  for (const made of document.querySelectorAll(".sheet.open .card button:not(.given *)")) {
    if (isSeen(made) && !inside(box(made), box(made.closest(".card")))) found.push(`${made.textContent} leaves the card`);
  }
  const ruler = document.createElement("canvas").getContext("2d");
  const minutes = Object.fromEntries(texts.map(({ made, said }) => {
    const { fontWeight, fontSize, fontFamily } = getComputedStyle(made);
    ruler.font = `${fontWeight} 100px ${fontFamily}`;
    const cap = (ruler.measureText("H").actualBoundingBoxAscent / 100) * parseFloat(fontSize);
    const high_m = (cap / stage.width) * Stage.scene().display_m[0];
    return [`"${said}" (${made.className || made.tagName} in ${made.parentNode.className || made.parentNode.tagName})`, (Math.atan(high_m / DISTANCE_M) * 180 * 60) / Math.PI];
  }));
  const touched = [...document.querySelectorAll("#stage [data-button], #stage button:not(:disabled)")].filter(isSeen);
  const least = touched.map((made) => [Math.min(box(made).width, box(made).height), `${made.className} "${made.textContent}"`]);
  const lowest = Object.fromEntries(texts.map(({ made, said }) => {
    const { fontWeight, fontSize, fontFamily } = getComputedStyle(made);
    ruler.font = `${fontWeight} 100px ${fontFamily}`;
    return [`"${said}"`, (ruler.measureText("H").actualBoundingBoxAscent / 100) * parseFloat(fontSize)];
  }));
  // A line about no place stands over no card's edge, and hides no text. It takes the place of a reason, which is measured above.
  if (card || (sight.stage === "running" && !open)) {
    const others = texts.filter(({ made }) => (card ? card.contains(made) : !made.closest(".why, .toast")));
    Stage.say("nothing");
    const said = document.querySelector(".why.says");
    if (!said || (card && meets(box(said), box(card)) && !inside(box(said), box(card)))) found.push("a line stands over the edge of the card, or is not there");
    for (const text of others) if (said && meets(box(said), text)) found.push(`a line about no place hides "${text.said}"`);
    Stage.say("");
  }
  const labels = ["aria-label", "title", "alt", "placeholder"].flatMap((name) => [...document.querySelectorAll(`#stage [${name}]`)].map((made) => made.getAttribute(name)));
  const [choice] = [...document.querySelectorAll(".probing .choice")].map(box);
  return { name, found: [...new Set(found)], minutes, least, lowest, choice: choice && [choice.left, choice.top], said: [...texts.map(({ said }) => said), ...labels] };
})"""


# The robot's hand at each place, as it is drawn there, what it covers, and whether it is everywhere as large.
HAND = """async () => {
  const stage = document.getElementById("stage").getBoundingClientRect(), found = [];
  const meets = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1.5 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1.5;
  const sizes = new Set();
  for (const [name, x, y] of PLACES) {
    Robot.move({ x, y, down: 0 });
    await new Promise((then) => setTimeout(then, 420));
    if (document.querySelector(".robot-hand.below")) continue;
    sizes.add(document.querySelector(".robot-hand .item").getBoundingClientRect().width.toFixed(1));
    if (sizes.size > 1 || Number([...sizes][0]) < LEAST_PX) return [name, [`a hand whose item is ${[...sizes]} px wide`]];
    const drawn = [...document.querySelectorAll(".gripper svg > g > *")].map((part) => part.getBoundingClientRect());
    const seen = [...document.querySelectorAll(".name, .pill, .key, .tag, .spot.order, .shelf, .spot:not(.robot_hand) .furniture, .zone h2, .status span")].filter((made) => made.checkVisibility());
    for (const made of seen) if (drawn.some((part) => meets(part, made.getBoundingClientRect()))) found.push(`${made.className} "${made.textContent}"`.trim());
    if (found.length) return [name, found];
  }
  return null;
}"""


# Languages whose words are measured in one kitchen, on a wall and in the hand.
SUSHI_ALONE = ("es", "fr", "it")


def places(kitchen):
    """Name and middle of each location and storage on the wall where the robot can be."""
    layout = tomllib.loads(Path(f"layouts/{kitchen}.toml").read_text())
    spots = [spot for kind in ("order", "hand", "place", "storage") for spot in layout[kind] if spot.get("agent") != "human"]
    middle = lambda area: (area["x"] + area["w"] / 2, area["y"] + area["h"] / 2)
    return [(spot.get("name") or f"{spot['agent']}: {spot['ingredient']}", *middle(spot["display"])) for spot in spots]


def too_small(size, language, measured):
    """What is smaller than it may be at this size."""
    if size in SIZES:
        # The list of all answers is an exception: it is for whoever stands at the screen to confirm them.
        low = {text: minutes for text, minutes in measured["minutes"].items() if minutes < ARC_MINUTES and not text.endswith(" in LI)")}
        return [f"{text}: capitals of {minutes:.1f} arc minutes at {DISTANCE_M} m" for text, minutes in low.items() if language != "longer"]
    if size != UPRIGHT[0]:
        return []
    touched = [f"{what}: {px:.1f} px where it is touched" for px, what in measured["least"] if px < TOUCH_PX - 0.5]
    return touched + [f"{text}: capitals of {px:.1f} px" for text, px in measured["lowest"].items() if px < CAPITALS_PX and language != "longer"]


def lines_stay(page, every):
    """Reasons that stay when what they are about is over, or where a recipe opens; and an end that is told twice."""
    recipe = next(sight["signal"] for name, sight in every.items() if name.startswith("recipe of"))
    boxes = "['.why.says', '.recipe.open'].map((name) => document.querySelector(name).getBoundingClientRect())"
    reasons = {name: sight for name, sight in every.items() if name.startswith("no effect")}
    for name, pressed in reasons.items():
        show(page, every["empty"])
        show(page, pressed)
        show(page, {**pressed, "signal": recipe})
        if page.ask(f"(([a, b]) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom)({boxes})"):
            yield f"a recipe opens below a reason: {name}"
    for name in ("robot: stopped", "questionnaire", "paused"):
        show(page, every["empty"])
        show(page, pressed)
        show(page, every[name])
        if page.ask("Boolean(document.querySelector('.why.says'))"):
            yield f"a reason is there still: {name}"
    show(page, every["thanks"])
    page.ask("Stage.mark({ ended: true })")
    if page.ask("Boolean(document.querySelector('.toast.open'))"):
        yield "the last page says twice for whom to wait"
    page.ask("Stage.mark({ ended: false })")


# So much of the outlines of raw or cooked shellfish, which are seen beside one another, may be the same.
SHELLFISH, MOST_ALIKE = [("shrimp raw", "crab raw"), ("shrimp cooked", "crab cooked")], 0.6
OUTLINES = """async (names) => {
  const inked = async (name) => {
    const image = new Image(), pen = new OffscreenCanvas(100, 100).getContext("2d");
    image.src = `data:image/svg+xml,${encodeURIComponent(Art.item(Stage.scene(), name).replace("<svg", '<svg xmlns="http://www.w3.org/2000/svg" width="100" height="100"'))}`;
    await image.decode();
    pen.drawImage(image, 0, 0);
    return pen.getImageData(0, 0, 100, 100).data.filter((_, at) => at % 4 === 3).map((alpha) => alpha > 128);
  };
  const [one, other] = [await inked(names[0]), await inked(names[1])];
  return one.filter((ink, at) => ink && other[at]).length / one.filter((ink, at) => ink || other[at]).length;
}"""

# Items and dishes that look alike, and are told apart without their colours.
TOLD_APART = (("item", "shrimp cut", "crab cut"), ("dish", "shrimp nigiri", "salmon nigiri"), ("dish", "crab maki", "salmon maki"))


def drawn_alike(page):
    """Pairs of these that differ in nothing but colours, and shellfish whose outlines are nearly the same."""
    shapes = lambda kind, name: re.sub("#[0-9a-f]{6}", "", page.ask(f"Art.{kind}(Stage.scene(), {json.dumps(name)})"))
    outlines = [f"{one} and {other} have nearly one outline" for one, other in SHELLFISH if page.page.evaluate(OUTLINES, [one, other]) > MOST_ALIKE]
    return outlines + [f"{one} and {other} differ in colours alone" for kind, one, other in TOLD_APART if shapes(kind, one) == shapes(kind, other)]


def words_in(text):
    """Its words of two letters or more, without case."""
    return {word.casefold() for word in re.findall(r"[^\W\d_]{2,}", text)}


# Fields of scene and state whose texts stand on the page; names of buttons, contents and places stand there in no language.
SAID = ("title", "label", "said", "words", "text", "unit", "low", "high", "answer", "choices", "explanation")


def said_in(told, field=""):
    """The texts in what the page is told."""
    if isinstance(told, dict):
        return [said for name, one in told.items() for said in said_in(one, "words" if field == "words" else name)]
    if isinstance(told, list):
        return [said for one in told for said in said_in(one, field)]
    return [told] if isinstance(told, str) and field in SAID else []


def of_the_page(measured, language, sight, scene):
    """Words that stand on the page and in no file: in the language whose words are longer, those that neither it nor the state has."""
    if language != "longer":
        return []
    known = words_in(" ".join(said_in([sight, scene])))
    return sorted({f'"{word}" is not from the file of the language' for said in measured["said"] for word in words_in(said) - known})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tomcom")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--from-disk", action="store_true", help="the page's files as they are now, not as they were built")
    parser.add_argument("--screenshots", action="store_true", help="of states that fail")
    arguments = parser.parse_args()
    failed, looked = {}, 0
    with browser() as chromium:
        for kitchen in KITCHENS:
            scene = None
            for language in ("en", "de", "ja", "longer", *(SUSHI_ALONE if kitchen == "sushi" else ())):
                folder = arguments.folder / f"{kitchen}-{language}"
                folder.mkdir(parents=True, exist_ok=True)
                words = language if language != "longer" else long_language(folder, scene, kitchen)
                with opened(arguments.tomcom, chromium, folder, kitchen, words, from_disk=arguments.from_disk) as page:
                    here = page.ask("Stage.scene()")
                    scene = scene or here
                    if page.ask("document.querySelector('.readiness').textContent.includes(Stage.scene().words['ready font'])") == has_font(here["language"]):
                        failed.setdefault(f"the readiness check is wrong about the font for {language}", []).append(kitchen)
                    failed |= {problem: [kitchen] for problem in (drawn_alike(page) if kitchen == "sushi" else [])}
                    for size in [SIZES[0], UPRIGHT[0]] if language in SUSHI_ALONE else SIZES + UPRIGHT:
                        page.page.set_viewport_size({"width": size[0], "height": size[1]})
                        page.page.wait_for_timeout(150)
                        # Lessons are measured in the languages that they have.
                        every = {name: sight for name, sight in states(here, kitchen).items() if language not in SUSHI_ALONE or not name.startswith("tutorial")}
                        if size in (SIZES[0], UPRIGHT[0]):
                            show(page, every["empty"])
                            show(page, every["highlight of robot_hand"])
                            if page.ask("document.querySelectorAll('.highlight').length !== 1 || !document.querySelector('.robot-hand.highlight')"):
                                failed.setdefault("a signal about the robot's hand is not at the hand", []).append(f"{kitchen} {language} {size[0]}x{size[1]}")
                            for problem in lines_stay(page, every):
                                failed.setdefault(problem, []).append(f"{kitchen} {language} {size[0]}x{size[1]}")
                            show(page, every["empty"])
                            covered = page.ask(HAND.replace("PLACES", json.dumps(places(kitchen))).replace("LEAST_PX", str(HELD_PX)))
                            if covered:
                                failed.setdefault(f"the robot's hand at {covered[0]} covers {covered[1]}", []).append(f"{kitchen} {language} {size[0]}x{size[1]}")
                        stands = {}
                        for measured in page.page.evaluate(MEASURE, [every, DISTANCE_M, NEAR_EM if language == "en" else NEAR_EM[1:] * 2]):
                            looked += 1
                            name, found = measured["name"], measured["found"] + too_small(size, language, measured) + of_the_page(measured, language, every[measured["name"]], here)
                            stands[name] = measured["choice"]
                            if name == "probe: late" and stands[name] != stands["probe: place"]:
                                found.append("what says that an answer came too late moves the choices")
                            for problem in found:
                                failed.setdefault(problem, []).append(f"{kitchen} {language} {size[0]}x{size[1]}: {name}")
                            if found and arguments.screenshots:
                                show(page, every[name])
                                page.screenshot(arguments.folder / f"{kitchen}-{language}-{size[0]}-{name.split(':')[0].replace(' ', '_')}.png")
    for problem, where in failed.items():
        print(f"{problem}\n    {where[0]} and {len(where) - 1} more states")
    assert not failed, f"{len(failed)} texts do not fit or are too small"
    print(f"texts fit in {looked} states of the page: 2 kitchens, 7 languages (one with words 40 % longer), {len(SIZES + UPRIGHT)} sizes", flush=True)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)
