"use strict";
// Inputs of the participant's hands: keys, gamepad, touch. Each press is sent once, with the time at which it happened. A key is where it
// is on the keyboard of the layout file, whatever is printed on it here: what is printed is what the page shows.

const Hands = (() => {
  // Presses of one button within this time are contact bounce.
  const BOUNCE_MS = 50, PUSHED_MS = 8;
  // Buttons of a standard gamepad, by the keys that mean the same in a probe and in the tutorial.
  // The sticks of a standard gamepad are buttons, too, which are pressed by a push to any side; the guide button belongs to the system.
  const STICKS = { 17: [0, 1], 18: [2, 3] }, GUIDE = 16, PUSHED = 0.6;
  const CODES = { "-": "Minus", "=": "Equal", "[": "BracketLeft", "]": "BracketRight", ";": "Semicolon", "'": "Quote", ",": "Comma", ".": "Period", "/": "Slash", "\\": "Backslash", "`": "Backquote" };
  const PAD = { 0: "Enter", 12: "ArrowUp", 13: "ArrowDown", 14: "ArrowLeft", 15: "ArrowRight" };
  const down = new Set(), pads = new Map(), last = new Map();
  // What is printed on the keys of this keyboard, by their codes, as far as the browser says or has shown it.
  const printed = new Map();
  let tell = () => {}, pressed = null;

  /** Where a key of the layout file is on the keyboard. */
  const codeOf = (key) => CODES[key] || (/^[a-z]$/i.test(key) ? `Key${key.toUpperCase()}` : /^[0-9]$/.test(key) ? `Digit${key}` : "");
  /** What is printed on the key of a button. */
  const printedOn = ({ key }) => (printed.get(codeOf(key)) || key).toUpperCase();

  /** The button of a key that was pressed: the one at this place of the keyboard, or the one with this sign. */
  function buttonOf({ buttons }, { code, key }) {
    const keyed = buttons.filter((button) => button.key);
    return keyed.find((button) => code && codeOf(button.key) === code) || keyed.find((button) => button.key.toLowerCase() === key.toLowerCase() && !printed.has(codeOf(button.key)));
  }

  /** Keeps what a key types, if it is another sign than the page shows on it. */
  function learn({ code, key, shiftKey }, button) {
    if (!code || shiftKey || key.length !== 1 || codeOf(button.key) !== code || printedOn(button) === key.toUpperCase()) return;
    printed.set(code, key);
    Stage.label();
  }

  function press(button, at) {
    if (at - (last.get(button) ?? -Infinity) < BOUNCE_MS) return;
    last.set(button, at);
    pressed = button;
    tell(button, at);
    // Where no button counts, the page says so.
    const { stage, tutorial } = Stage.shown() || {};
    if (stage !== "running" && !(tutorial && tutorial.presses)) Stage.sayNothing(true);
    // The program's answer usually arrives before this delay: then both are drawn in one frame, and the answer need not
    // wait for the next one.
    setTimeout(() => push(button), PUSHED_MS);
  }

  /** Shows that a button was pressed. */
  function push(button) {
    const drawn = document.querySelector(`[data-button="${CSS.escape(button)}"]`);
    if (!drawn) return;
    Stage.replay(drawn, "pushed");
    // Another stage must not play it once more.
    drawn.addEventListener("animationend", ({ animationName }) => ["pushed", "tried"].includes(animationName) && drawn.classList.remove("pushed"));
  }

  /** The time of an event; a time that is not on the page's clock is replaced by the present one. */
  function timeOf(stamp) {
    const now = performance.now();
    return stamp > 0 && stamp <= now && now - stamp < 1000 ? stamp : now;
  }

  function typed(event) {
    const scene = Stage.scene();
    if (!scene || event.target instanceof HTMLInputElement || event.ctrlKey || event.altKey || event.metaKey) return;
    // Typed text stays in its field; only the enter key leaves it, and the delete key an empty field.
    const leaves = event.key === "Enter" || (event.key === "Delete" && event.target.value === "");
    if (event.target instanceof HTMLTextAreaElement && (!leaves || event.isComposing)) return;
    const isHeld = event.repeat || down.has(event.code || event.key);
    down.add(event.code || event.key);
    const question = Stage.shown() && Stage.shown().question, focused = focusedButton(event.key);
    if (!(event.target instanceof HTMLTextAreaElement)) Stage.useBadges("keys");
    // A button that was reached by the tab key is what the enter key presses.
    if (focused) {
      event.preventDefault();
      return isHeld || act(focused, timeOf(event.timeStamp)) || focused.click();
    }
    if (question) {
      if (["Enter", " ", "Home", "End", "ArrowUp", "ArrowDown"].includes(event.key)) event.preventDefault();
      Questions.key(event.key, question, isHeld);
      return;
    }
    // During a freeze probe, no button of the kitchen can be pressed.
    if (Stage.asks()) {
      if (Probe.press(event.key, isHeld)) event.preventDefault();
      else if (!isHeld && event.key.length === 1) Stage.say("probe how");
      return;
    }
    const lesson = Stage.shown() && Stage.shown().tutorial;
    if (lesson && Tutorial.key(event.key, lesson, isHeld)) return event.preventDefault();
    const button = buttonOf(scene, event);
    if (!button && lesson && (isHeld || Tutorial.refuse(event.key, lesson))) return undefined;
    if (!button) return isHeld || event.key.length > 1 || Stage.sayNothing(false);
    event.preventDefault();
    learn(event, button);
    return isHeld || press(button.name, timeOf(event.timeStamp));
  }

  const ACTS = "[data-button], [data-rate], [data-option], [data-typed], [data-does], [data-review], [data-turn], [data-choose], [data-believe], [data-unknown], [data-sure]";

  /** The button that a key presses since it has the focus; what is held to consent is no such button. */
  function focusedButton(name) {
    const { activeElement: focused } = document;
    return ["Enter", " "].includes(name) && focused instanceof HTMLButtonElement && !focused.matches(".hold") ? focused : null;
  }

  /** Does what a button is for; returns whether it is one of the page's. */
  function act(hit, at) {
    if (!hit.matches(ACTS)) return false;
    const question = Stage.shown() && Stage.shown().question;
    const lesson = Stage.shown() && Stage.shown().tutorial;
    if (Stage.asks()) Probe.touch(hit.dataset);
    else if (lesson && (hit.dataset.turn || hit.dataset.choose)) Tutorial.touch(hit.dataset, lesson);
    else if (hit.dataset.button) press(hit.dataset.button, at);
    else if (question) Questions.touch(hit.dataset, question);
    return true;
  }

  function touched(event) {
    const hit = event.target.closest(ACTS);
    if (!hit || event.button > 0) return;
    event.preventDefault();
    act(hit, timeOf(event.timeStamp));
  }

  /** Reads gamepads and button boxes, which send no events of their own. */
  function poll() {
    const scene = Stage.scene();
    const there = [...(navigator.getGamepads ? navigator.getGamepads() : [])].filter(Boolean);
    // A gamepad that is unplugged does not report that its buttons are released.
    for (const index of [...pads.keys()].filter((known) => !there.some((pad) => pad.index === known))) {
      pads.delete(index);
      Stage.useBadges("keys");
      Questions.letGo();
    }
    for (const pad of there) {
      const before = pads.get(pad.index) || [];
      const now = [...pad.buttons].map((button) => (typeof button === "object" ? button.pressed : button > 0.5));
      if (pad.mapping === "standard") {
        for (const [number, axes] of Object.entries(STICKS)) now[number] = axes.some((axis) => Math.abs(pad.axes[axis] || 0) > PUSHED);
        now[GUIDE] = false;
      }
      now.forEach((isDown, number) => {
        if (!isDown || before[number] || !scene) return;
        Stage.useBadges("pad", pad.mapping === "standard");
        if (Stage.asks()) return Probe.press(PAD[number], false);
        const { tutorial: lesson, question } = Stage.shown() || {};
        // Of a questionnaire, only the consent is a gamepad's, which is held.
        if (question) return question.form?.kind === "consent" || Stage.say("nothing");
        if (lesson && PAD[number] && Tutorial.pad(PAD[number], lesson)) return;
        const button = scene.buttons.find(({ gamepad }) => gamepad === number);
        if (!button) return Stage.sayNothing(false);
        press(button.name, timeOf(pad.timestamp));
      });
      const wasDown = before.some(Boolean), isDown = now.some(Boolean);
      if (wasDown !== isDown) Questions.holdBy("gamepad", isDown, Stage.shown() && Stage.shown().question);
      pads.set(pad.index, now);
    }
    Readiness.notePad(pads.size > 0);
  }

  function begin(toTell, toAnswer, toPoint) {
    tell = toTell;
    Questions.begin(toAnswer);
    Tutorial.begin(toAnswer);
    Probe.begin(toAnswer);
    window.addEventListener("keydown", typed);
    window.addEventListener("keyup", (event) => {
      down.delete(event.code || event.key);
      Questions.holdBy("key", false);
    });
    // When the page loses the focus, all keys count as released, since later releases may never be reported.
    const leave = () => { down.clear(); Questions.letGo(); };
    window.addEventListener("blur", leave);
    document.addEventListener("visibilitychange", () => document.hidden && leave());
    window.addEventListener("pointerdown", touched);
    window.addEventListener("contextmenu", (event) => event.preventDefault());
    window.addEventListener("pointermove", (event) => event.pointerType === "mouse" && toPoint(event.clientX, event.clientY));
    // Gamepads are read more often than frames are drawn, so that a press need not wait for the next frame.
    setInterval(poll, 4);
    // Where the browser knows the keyboard, the page shows what is printed on it from the beginning.
    const known = navigator.keyboard && navigator.keyboard.getLayoutMap ? navigator.keyboard.getLayoutMap() : Promise.resolve([]);
    known.then((signs) => {
      for (const [code, sign] of signs) printed.set(code, sign);
      Stage.label();
    }).catch(() => {});
  }

  return { begin, printedOn, pressed: () => pressed };
})();
