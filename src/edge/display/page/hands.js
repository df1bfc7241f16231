"use strict";
// The hands: keys, gamepad, touch. Each press is told once, with the time at which it happened.

const Hands = (() => {
  // The same button within so many milliseconds is a contact that bounces.
  const BOUNCE_MS = 50, PUSHED_MS = 8;
  // Buttons of a standard gamepad, by the keys that mean the same in a probe and in the tutorial.
  const PAD = { 0: "Enter", 12: "ArrowUp", 13: "ArrowDown", 14: "ArrowLeft", 15: "ArrowRight" };
  const down = new Set(), pads = new Map(), last = new Map();
  let tell = () => {};

  function press(button, at) {
    if (at - (last.get(button) ?? -Infinity) < BOUNCE_MS) return;
    last.set(button, at);
    tell(button, at);
    // The program's answer is there sooner: both are drawn in one frame, and the answer does not wait for the next.
    setTimeout(() => push(button), PUSHED_MS);
  }

  /** Shows that the button went down. */
  function push(button) {
    const drawn = document.querySelector(`[data-button="${CSS.escape(button)}"]`);
    if (!drawn) return;
    drawn.classList.remove("pushed");
    void drawn.offsetWidth;
    drawn.classList.add("pushed");
  }

  /** An event's own time; one that is not on the page's clock counts as now. */
  function timeOf(stamp) {
    const now = performance.now();
    return stamp > 0 && stamp <= now && now - stamp < 1000 ? stamp : now;
  }

  function typed(event) {
    const scene = Stage.scene();
    if (!scene || event.target instanceof HTMLInputElement || event.ctrlKey || event.altKey || event.metaKey) return;
    // Words are typed there; only the enter key leaves them.
    if (event.target instanceof HTMLTextAreaElement && (event.key !== "Enter" || event.isComposing)) return;
    const isHeld = event.repeat || down.has(event.code || event.key);
    down.add(event.code || event.key);
    const question = Stage.shown() && Stage.shown().question;
    if (question) {
      if (["Enter", " ", "Home", "End", "ArrowUp", "ArrowDown"].includes(event.key)) event.preventDefault();
      Questions.key(event.key, question, isHeld);
      return;
    }
    // While a probe is asked no button of the kitchen is pressed.
    if (Stage.shown() && Stage.shown().probe) {
      if (Probe.press(event.key, isHeld)) event.preventDefault();
      return;
    }
    const lesson = Stage.shown() && Stage.shown().tutorial;
    if (lesson && Tutorial.key(event.key, lesson, isHeld)) return event.preventDefault();
    const button = scene.buttons.find(({ key }) => key && key.toLowerCase() === event.key.toLowerCase());
    if (!button) return;
    event.preventDefault();
    if (!isHeld) press(button.name, timeOf(event.timeStamp));
  }

  function touched(event) {
    const hit = event.target.closest("[data-button], [data-rate], [data-option], [data-typed], [data-does], [data-turn], [data-choose], [data-believe], [data-unknown], [data-done], [data-sure]");
    if (!hit || event.button > 0) return;
    event.preventDefault();
    const question = Stage.shown() && Stage.shown().question;
    const lesson = Stage.shown() && Stage.shown().tutorial;
    if (Stage.shown() && Stage.shown().probe) Probe.touch(hit.dataset);
    else if (lesson && (hit.dataset.turn || hit.dataset.choose)) Tutorial.touch(hit.dataset, lesson);
    else if (hit.dataset.button) press(hit.dataset.button, timeOf(event.timeStamp));
    else if (question) Questions.touch(hit.dataset, question);
  }

  /** Looks at gamepads and button boxes: they do not say by themselves when a button goes down. */
  function poll() {
    const scene = Stage.scene();
    const there = [...(navigator.getGamepads ? navigator.getGamepads() : [])].filter(Boolean);
    // One that is unplugged says no more that its button went up.
    for (const index of [...pads.keys()].filter((known) => !there.some((pad) => pad.index === known))) {
      pads.delete(index);
      Questions.letGo();
    }
    for (const pad of there) {
      const before = pads.get(pad.index) || [];
      const now = [...pad.buttons].map((button) => (typeof button === "object" ? button.pressed : button > 0.5));
      now.forEach((isDown, number) => {
        if (!isDown || before[number] || !scene) return;
        if (Stage.shown() && Stage.shown().probe) return Probe.press(PAD[number], false);
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
    // Whoever leaves the page holds nothing: what goes up meanwhile may never be told.
    const leave = () => { down.clear(); Questions.letGo(); };
    window.addEventListener("blur", leave);
    document.addEventListener("visibilitychange", () => document.hidden && leave());
    window.addEventListener("pointerdown", touched);
    window.addEventListener("contextmenu", (event) => event.preventDefault());
    window.addEventListener("pointermove", (event) => event.pointerType === "mouse" && toPoint(event.clientX, event.clientY));
    // More often than frames: a press must not wait for the next one.
    setInterval(poll, 4);
  }

  return { begin };
})();
