"use strict";
// Inputs of the participant's hands: keys, gamepad, touch. Each press is sent once, with the time at which it happened.

const Hands = (() => {
  // Presses of one button within this time are contact bounce.
  const BOUNCE_MS = 50, PUSHED_MS = 8;
  // Buttons of a standard gamepad, by the keys that mean the same in a probe and in the tutorial.
  const PAD = { 0: "Enter", 12: "ArrowUp", 13: "ArrowDown", 14: "ArrowLeft", 15: "ArrowRight" };
  const down = new Set(), pads = new Map(), last = new Map();
  let tell = () => {};

  function press(button, at) {
    if (at - (last.get(button) ?? -Infinity) < BOUNCE_MS) return;
    last.set(button, at);
    tell(button, at);
    // The program's answer usually arrives before this delay: then both are drawn in one frame, and the answer need not
    // wait for the next one.
    setTimeout(() => push(button), PUSHED_MS);
  }

  /** Shows that a button was pressed. */
  function push(button) {
    const drawn = document.querySelector(`[data-button="${CSS.escape(button)}"]`);
    if (!drawn) return;
    drawn.classList.remove("pushed");
    void drawn.offsetWidth;
    drawn.classList.add("pushed");
  }

  /** The time of an event; a time that is not on the page's clock is replaced by the present one. */
  function timeOf(stamp) {
    const now = performance.now();
    return stamp > 0 && stamp <= now && now - stamp < 1000 ? stamp : now;
  }

  function typed(event) {
    const scene = Stage.scene();
    if (!scene || event.target instanceof HTMLInputElement || event.ctrlKey || event.altKey || event.metaKey) return;
    // Typed text stays in its field; only the enter key leaves it.
    if (event.target instanceof HTMLTextAreaElement && (event.key !== "Enter" || event.isComposing)) return;
    const isHeld = event.repeat || down.has(event.code || event.key);
    down.add(event.code || event.key);
    const question = Stage.shown() && Stage.shown().question;
    if (question) {
      if (["Enter", " ", "Home", "End", "ArrowUp", "ArrowDown"].includes(event.key)) event.preventDefault();
      Questions.key(event.key, question, isHeld);
      return;
    }
    // During a freeze probe, no button of the kitchen can be pressed.
    if (Stage.asks()) {
      if (Probe.press(event.key, isHeld)) event.preventDefault();
      return;
    }
    const lesson = Stage.shown() && Stage.shown().tutorial;
    if (lesson && Tutorial.key(event.key, lesson, isHeld)) return event.preventDefault();
    const button = scene.buttons.find(({ key }) => key && key.toLowerCase() === event.key.toLowerCase());
    if (!button) return lesson && !isHeld && Tutorial.refuse(event.key, lesson);
    event.preventDefault();
    if (!isHeld) press(button.name, timeOf(event.timeStamp));
  }

  function touched(event) {
    const hit = event.target.closest("[data-button], [data-rate], [data-option], [data-typed], [data-does], [data-turn], [data-choose], [data-believe], [data-unknown], [data-sure]");
    if (!hit || event.button > 0) return;
    event.preventDefault();
    const question = Stage.shown() && Stage.shown().question;
    const lesson = Stage.shown() && Stage.shown().tutorial;
    if (Stage.asks()) Probe.touch(hit.dataset);
    else if (lesson && (hit.dataset.turn || hit.dataset.choose)) Tutorial.touch(hit.dataset, lesson);
    else if (hit.dataset.button) press(hit.dataset.button, timeOf(event.timeStamp));
    else if (question) Questions.touch(hit.dataset, question);
  }

  /** Reads gamepads and button boxes, which send no events of their own. */
  function poll() {
    const scene = Stage.scene();
    const there = [...(navigator.getGamepads ? navigator.getGamepads() : [])].filter(Boolean);
    // A gamepad that is unplugged does not report that its buttons are released.
    for (const index of [...pads.keys()].filter((known) => !there.some((pad) => pad.index === known))) {
      pads.delete(index);
      Questions.letGo();
    }
    for (const pad of there) {
      const before = pads.get(pad.index) || [];
      const now = [...pad.buttons].map((button) => (typeof button === "object" ? button.pressed : button > 0.5));
      now.forEach((isDown, number) => {
        if (!isDown || before[number] || !scene) return;
        if (Stage.asks()) return Probe.press(PAD[number], false);
        const lesson = Stage.shown() && Stage.shown().tutorial;
        if (lesson && PAD[number] && Tutorial.pad(PAD[number], lesson)) return;
        const button = scene.buttons.find(({ gamepad }) => gamepad === number);
        if (button) press(button.name, timeOf(pad.timestamp));
      });
      const wasDown = before.some(Boolean), isDown = now.some(Boolean);
      if (wasDown !== isDown) Questions.holdBy("gamepad", isDown, Stage.shown() && Stage.shown().question);
      pads.set(pad.index, now);
    }
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
  }

  return { begin };
})();
