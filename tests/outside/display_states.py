"""Every state of the participant's page, in a real browser: the real program's scene, with what a session can show put on it.

Used by display_fits.py and display_axe.py.
"""

import json
import os
import re
import tomllib
from contextlib import contextmanager
from pathlib import Path

from console import Console
from page import Page

PORT = 20361
PAGE = Path("src/devices/display/page")
LANGUAGES = Path("src/devices/sight/languages")
KITCHENS = ("sushi", "burger")
# Nothing moves while it is measured; what is shown for a moment only stays.
STILL = "*, *::before, *::after { animation: none !important; transition: none !important; } .why.says, [data-robot=\"discards\"] .bin.takes { opacity: 1 !important; visibility: visible !important; }"

# What the robot does is said for a second or more: here, each state comes late enough to be shown.
AT_ONCE = """(() => {
  const draw = Stage.show, now = performance.now.bind(performance);
  let ahead = 0;
  performance.now = () => now() + ahead;
  // That it is slow, once it lasts.
  Stage.show = (...all) => { for (let left = all[0].robot_does === "slow" ? 2 : 1; left > 0; left -= 1) { ahead += 2000; draw(...all); } };
})()"""


def longer(words):
    """The words of a language whose words are 40 % longer than the English ones."""
    def word(found):
        letters = found[0]
        return (letters + letters.lower())[: max(len(letters), round(1.4 * len(letters)))]
    return re.sub(r"[^\W\d_]+", word, words)


def long_language(folder, scene, kitchen):
    """A file with the page's words and the kitchen's names in that language; `scene` is the English one."""
    recipes = tomllib.loads(Path(f"recipes/{kitchen}.toml").read_text())
    english = tomllib.loads((LANGUAGES / "en.toml").read_text())
    named = {place["name"].replace("_", " "): place["label"] for place in scene["locations"]}
    named |= {name: known["label"] for kind in ("items", "dishes") for name, known in scene[kind].items()}
    named |= {shelf["name"]: shelf["name"] for shelf in recipes["ingredient"]}
    named |= {button["name"].split(" ")[0]: button["label"] for button in scene["buttons"] if button["does"] in ("process", "trash", "serve")}
    words = {name: longer(word) for name, word in (english | named).items()} | {"language": "en"}
    path = folder / "longer.toml"
    path.write_text("".join(f"{json.dumps(name)} = {json.dumps(word)}\n" for name, word in words.items()))
    return str(path.resolve())


@contextmanager
def opened(tomcom, browser, folder, kitchen, language, size=(1920, 1080), from_disk=False, settings=""):
    """The page of a session that has not started. `from_disk`: with the page's files and words as they are now, not as they were built."""
    folder.mkdir(parents=True, exist_ok=True)
    session = folder / "session.toml"
    words = LANGUAGES / f"{language}.toml"
    if from_disk and words.exists():
        language = words.resolve()
    layout = Path(f"layouts/{kitchen}.toml").resolve()
    session.write_text(f'layout = "{layout}"\n[participant]\nkind = "display"\ngaze = "none"\n[display]\nport = {PORT}\nlanguage = "{language}"\nserved = true\nclock = true\n{settings}')
    with Console(tomcom, [session, "--code", "P01", "--out", folder / f"recordings-{os.getpid()}"]) as console:
        console.wait_for("READY|NO DISPLAY")
        page = Page(browser, f"http://127.0.0.1:{PORT}", size=size, files=PAGE if from_disk else None)
        try:
            page.stage("welcome")
            page.page.add_style_tag(content=STILL)
            page.ask(AT_ONCE)
            yield page
        finally:
            page.close()


def items_of(kitchen):
    """What each dish is made of."""
    recipes = tomllib.loads(Path(f"recipes/{kitchen}.toml").read_text())
    return {dish["name"]: dish["items"] for dish in recipes["dish"]}


def forms():
    """Each kind of an item, with an answer."""
    options = [{"id": str(number), "text": longer(f"somewhat usual {number}")} for number in range(1, 10)]
    return {
        "scale": ({"kind": "scale", "points": 7, "low": "strongly disagree", "high": "strongly agree"}, 4),
        "choice": ({"kind": "choice", "options": options[:4], "several": False}, "2"),
        "choices": ({"kind": "choice", "options": options, "several": True}, ["1", "9"]),
        "number": ({"kind": "number", "min": 18, "max": 99, "unit": "years"}, 31),
        "text": ({"kind": "text", "length": 200}, "a few words"),
        "consent": ({"kind": "consent", "hold_s": 3.0}, None),
        "slider": ({"kind": "slider", "low": "very low", "high": "very high", "step": 5}, 45),
    }


TUTORIAL_PAGE = {"kind": "text", "title": "The cooking pot", "text": "Rice and crab are cooked there. It holds one thing: what lies in it is in the way of what comes next.", "number": 3,
                 "of": 18, "done": True, "frames": [], "hint": None, "presses": None, "explains_buttons": False, "missed": False, "cards": [], "seconds": None, "left_s": None, "question": None, "probe": None, "robot": []}


def tutorial_steps(scene, kitchen):
    """The steps of the kitchen's own tutorial in the scene's language."""
    return tomllib.loads(Path(f"sessions/tutorials/{kitchen}{'.de' if scene['language'] == 'de' else ''}.toml").read_text())["step"]


def tutorial_texts(scene, kitchen):
    """The steps of the kitchen's own tutorial that stand beside the kitchen: page and signal, with the longest line that it can have below its text."""
    at = {spot["name"]: {"place": {"location": index}} for index, spot in enumerate(scene["locations"])}
    steps = [step for step in tutorial_steps(scene, kitchen) if step["kind"] not in ("recipes", "question")]
    pressed = lambda step: step["kind"] in ("press", "order")
    first = next(step["id"] for step in steps if step["kind"] == "press")
    shelves = {shelf["item"].split(" ")[0]: {"place": {"storage": index}} for index, shelf in enumerate(scene["storages"]) if shelf["agent"] == "robot"}
    robots = lambda step: [at.get(name) or shelves[name.removeprefix("take ")] for name in step["presses"]] if step["kind"] == "robot" else []
    frames = lambda step: [at[name] if name in at else {"area": name} for name in step.get("point_at", [])] + robots(step)
    middle = lambda spot: [spot["area"][0] + spot["area"][2] / 2, spot["area"][1] + spot["area"][3] / 2]
    def moves(step):
        spots = [scene["locations" if "location" in place else "storages"][next(iter(place.values()))] for place in (frame["place"] for frame in robots(step))]
        return [{"to": middle(spot), "contents": ["empty"] * len(scene["locations"])} for spot in spots]
    hint = lambda step: {"button": step["presses"][0], "after_s": 0.0} if pressed(step) else None
    presses = lambda step: [0, len(step["presses"])] if pressed(step) else None
    order, dishes = next(at[name]["place"]["location"] for name in at if name.startswith("order")), items_of(kitchen)
    def signal(step):
        if step["kind"] != "signal":
            return None
        return {"highlight": at[step["highlight"]]["place"]["location"]} if "highlight" in step else {"recipe": {"order": order, "dish": step["dish"], "items": dishes[step["dish"]]}}
    return {step["id"]: ({"title": step["title"], "text": step["text"], "frames": frames(step), "hint": hint(step), "presses": presses(step), "missed": pressed(step) or step["kind"] == "probe",
                         "kind": step["kind"], "robot": moves(step), "probe": PROBE if step["kind"] == "probe" else None,
                         "done": step["kind"] in ("text", "signal", "robot", "robot_says"), "explains_buttons": step["id"] == first}, signal(step)) for step in steps}


def tutorial_pages(scene, dishes):
    """Pages of a tutorial, one of each kind."""
    button = next(button["name"] for button in scene["buttons"] if button["does"] == "process")
    question = {"choices": [f"The {number}. of three choices" for number in range(1, 4)], "right": None, "wrong": 1, "explanation": "It is the second one, which is said here once more.", "explanation_length": 54}
    return {
        "text": {"frames": [{"area": "human"}]},
        "press": {"kind": "press", "presses": [0, 2], "missed": True, "done": False, "hint": {"button": button, "after_s": 0.0}},
        "cards": {"kind": "recipes", "seconds": 60.0, "left_s": 60.0, "cards": [{"dish": dish, "items": items} for dish, items in dishes.items()]},
        "question": {"kind": "question", "done": False, "question": question},
    }


PROBE = {"probe": 1, "question": 2, "of": 3, "text": "", "about": None, "choices": [], "confidence": False, "limit_s": 12.0, "late": False, "closed": False}


def probe_pages(scene, kitchen, dishes):
    """Questions of probes, one of each kind and the longest lists of these kitchens, and what stands before and after them.

    `touched`: choices that are touched; where the page asks how sure the participant is, it does so then.
    """
    english, words = (tomllib.loads((LANGUAGES / f"{language}.toml").read_text()) for language in ("en", scene["language"]))
    stretch = longer if scene["language"] == "en" and scene["words"]["back"] != english["page back"] else str
    said = lambda name, what="": stretch({**english, **words}[name]).replace("#", what)
    recipes = tomllib.loads(Path(f"recipes/{kitchen}.toml").read_text())
    slots = [slot["items"] for slot in recipes["slot"]]
    at = {spot["name"]: index for index, spot in enumerate(scene["locations"])}
    label = lambda index: scene["locations"][index]["label"]
    nothing, other = (said("empty"), "empty"), (said("something else"), None)
    cards = lambda *all: [nothing, *[one for one in all if one != nothing][:10], other]
    items = [(known["label"], {"item": name}) for name, known in scene["items"].items()]
    menu = [(known["label"], {"dish": name}) for name, known in scene["dishes"].items()]
    pot, board, small = ("cooking_pot", "assembly_board", "rolling_mat") if kitchen == "sushi" else ("grill_plate", "board", "tray")
    first, second = slots[0], slots[1]
    stacks = [(" + ".join(scene["items"][item]["label"] for item in (below, second[0])), {"stack": [below, second[0]]}) for below in first]
    variants = [[one, *items[1:-1], last] for one in slots[0] for items in list(dishes.values())[:1] for last in slots[-1]][:8]
    dish = max(scene["dishes"], key=lambda name: len(scene["dishes"][name]["label"]))
    orders = [index for index, spot in enumerate(scene["locations"]) if spot["kind"] == "order"]
    takes = [(said("do take", shelf["label"]), {"storage": index}) for index, shelf in enumerate(scene["storages"]) if shelf["agent"] == "robot"]
    uses = [(said("do use", spot["label"]), {"location": index}) for index, spot in enumerate(scene["locations"]) if spot["kind"] == "place"]
    asked = {
        "before": {"question": 0},
        "place": {"text": said("ask " + pot.replace("_", " ")), "about": {"location": at[pot]}, "choices": cards(*items)},
        "stack": {"text": said("ask " + board.replace("_", " ")), "about": {"location": at[board]}, "choices": cards(*menu[:3], *stacks, *items)},
        "few": {"text": said("ask place", label(at[small])), "about": {"location": at[small]}, "choices": [nothing, *items[:2], *stacks]},
        "recipe": {"text": said("ask recipe", scene["dishes"][dish]["label"]), "about": {"dish": dish}, "choices": [("", {"recipe": variant}) for variant in variants]},
        "order": {"text": said("ask order", label(orders[0])), "about": {"order": 0}, "choices": [(said("no order"), "empty"), (said("served"), "served"), *menu]},
        "next order": {"text": said("ask next order"), "choices": [(label(index), {"order": number}) for number, index in enumerate(orders)]},
        "next press": {"text": said("ask next press"), "about": {"location": at["robot_hand"]}, "choices": (takes + uses)[:11] + [other]},
        "sure": {"text": said("ask robot hand"), "about": {"location": at["robot_hand"]}, "choices": cards(*items), "confidence": True, "touched": [3]},
        "late": {"text": said("ask " + pot.replace("_", " ")), "about": {"location": at[pot]}, "choices": cards(*items), "late": True},
        "after": {"question": 0, "closed": True, "late": True},
    }
    def page(number, state):
        choices = [{"number": at, "words": words, "shows": shows} for at, (words, shows) in enumerate(state.get("choices", []), 1)]
        return {**PROBE, **state, "probe": number, "choices": choices}
    return {name: page(number, state) for number, (name, state) in enumerate(asked.items(), 1)}


def states(scene, kitchen):
    """Every state, by its name: what the program would tell the page."""
    dishes, spots = items_of(kitchen), scene["locations"]
    names, items = list(dishes), list(scene["items"])
    orders = [index for index, spot in enumerate(spots) if spot["kind"] == "order"]
    at = {spot["name"]: index for index, spot in enumerate(spots)}

    def contents(turn):
        number = iter(range(100))
        def content(spot):
            index = next(number) + turn
            if spot["kind"] == "order":
                return {"dish": names[index % len(names)]}
            return {"stack": dishes[names[index % len(names)]][:2]} if spot["name"] in ("assembly_board", "board") else {"item": items[index % len(items)]}
        return [content(spot) for spot in spots]

    def sight(stage="running", turn=0, **changed):
        return {"stage": stage, "practice": False, "contents": contents(turn), "served": 3, "clock": "stands" if stage in ("ready", "running", "paused", "over") else None, "presses": [None, None], "intention": None, "robot_does": None,
                "signal": None, "cue": None, "question": None, "tutorial": None, "probe": None, "target": None, "checks": False, **changed}

    made = {stage: sight(stage) for stage in ("welcome", "instruction", "ready", "paused", "over", "tutorial_over", "thanks")}
    made["practice"] = sight("ready", practice=True)
    for turn in range(len(names)):
        made[f"running {turn}"] = sight(turn=turn)
        for order in orders:
            dish = sight(turn=turn)["contents"][order]["dish"]
            made[f"recipe of {dish} at {spots[order]['name']}"] = sight(turn=turn, signal={"recipe": {"order": order, "dish": dish, "items": dishes[dish]}})
    served = contents(0)
    for order in orders:
        served[order] = "served"
    made["served"] = sight(contents=served)
    trashed = {"number": 1, "at": {"location": at["robot_hand"]}, "effective": True}
    made["robot: discards"] = sight(presses=[None, trashed], contents=["empty" if spot["name"] == "robot_hand" else what for spot, what in zip(spots, contents(0))])
    made["empty"] = sight(contents=["empty"] * len(spots), served=0)
    for what in ("waits_human", "waits_order", "waits", "slow", "stopped"):
        made[f"robot: {what}"] = sight(robot_does=what)
    for index, spot in enumerate(spots):
        if spot["kind"] != "order":
            made[f"highlight of {spot['name']}"] = sight(signal={"highlight": index})
    longest = max((index for index, spot in enumerate(spots) if spot["kind"] == "place"), key=lambda index: len(spots[index]["label"]))
    presses = [{"location": index} for index, spot in enumerate(spots) if spot["kind"] != "robot_hand"]
    presses += [{"storage": index} for index, shelf in enumerate(scene["storages"]) if shelf["agent"] == "human"]
    reasons = [key for key in scene["words"] if key.startswith("why ")]
    # The longest line at every place, and every line at one place.
    reasons.sort(key=lambda key: -len(scene["words"][key].replace("#", spots[longest]["label"])))
    lines = [(place, reasons[0]) for place in presses] + [(presses[0], reason) for reason in reasons[1:]]
    for number, (place, reason) in enumerate(lines, 1):
        press = {"number": number, "at": place, "effective": False, "why": {"reason": reason.removeprefix("why "), "about": longest}}
        made[f"no effect: {reason} at {json.dumps(place)}"] = sight(presses=[press, None])
    for number, button in enumerate(scene["buttons"], len(lines) + 1):
        press = {"number": number, "at": {"storage" if button["does"] == "take" else "location": button["at"]}, "effective": False, "why": {"reason": reasons[0].removeprefix("why "), "about": longest}}
        made[f"no effect of {button['name']}"] = sight(presses=[press, None], pressed=button["name"])
    question = {"title": longer("Acceptance of the signals"), "item": "a", "number": 3, "of": 12, "answer": None, "skipped": False, "before": "b", "given": [],
                "text": "The signals came at the moments at which they were needed, and told what was not known before."}
    for name, (form, answer) in forms().items():
        made["questionnaire" if name == "scale" else f"questionnaire: {name}"] = sight("questionnaire", question={**question, "form": form, "answer": answer})
    made["questionnaire: left out"] = sight("questionnaire", question={**question, "form": forms()["choice"][0], "skipped": True})
    made["answered"] = sight("answered")
    made["more questions"] = sight("more_questions")
    low, high = {"de": ("überhaupt nicht", "außerordentlich")}.get(scene["language"], ("not at all", "extraordinarily"))
    five = {"kind": "scale", "points": 5, "low": low, "high": high}
    given = [{"item": f"i{number}", "text": f"The signals of this trial helped in part {number}.", "answer": str(number % 7 + 1) if number != 5 else None,
              "form": (five if number == 3 else forms()["scale"][0], forms()["slider"][0], forms()["text"][0])[number % 3], "point": (number % 7 + 1 if number % 3 == 0 else 7 * number) if number != 5 and number % 3 < 2 else None} for number in range(1, 13)]
    made["answers"] = sight("questionnaire", question={**question, "item": None, "form": None, "given": given, "text": "Thank you. Are your answers as you meant them?"})
    for name, page in tutorial_pages(scene, dishes).items():
        made[f"tutorial: {name}"] = sight("tutorial", tutorial={**TUTORIAL_PAGE, "step": name, **page})
    for name, (page, signal) in tutorial_texts(scene, kitchen).items():
        made[f"tutorial: {name}"] = sight("tutorial", signal=signal, tutorial={**TUTORIAL_PAGE, "step": name, **page})
        if page["presses"]:
            press = {"number": 1, "at": {"location": orders[-1]}, "effective": False, "why": {"reason": "not_served", "about": orders[-1]}}
            made[f"tutorial: no effect at {name}"] = {**made[f"tutorial: {name}"], "presses": [press, None]}
    for name, page in probe_pages(scene, kitchen, dishes).items():
        made[f"probe: {name}"] = sight("probe", probe=page, contents=[])
    return made


def show(page, sight):
    page.ask(f"Stage.show({json.dumps(sight)}, () => 17)")
    for choice in (sight["probe"] or {}).get("touched", []):
        page.ask(f"Probe.touch({{ believe: {choice} }})")
