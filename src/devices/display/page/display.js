"use strict";
// What the participant's page and the program say to each other: received messages go to the stage, inputs of the
// participant go to the program.

(() => {
  const RESIZED_MS = 400, IDLE_MS = 3000, PING_MS = 500, FIRST_PINGS = 5, FIRST_PING_MS = 60, POINTER_MS = 16;
  const { page, isOpen, say } = Talk;
  const asksFor = new URLSearchParams(location.search);
  // A page that only watches, for a second screen, says nothing of itself.
  const watches = asksFor.has("watch");
  let code = asksFor.get("code"), number = 0, acts = null, isFree = false;
  let trips = [], took = null, cue = null, pointed = null;
  // Times of presses whose effect is not on the screen yet.
  const waiting = [];
  // The seconds that a probe or the trial still has.
  let left = () => 0;

  /**
   * Converts a time of this page to the server's clock, with the offset measured by the ping that had the shortest
   * round trip.
   */
  const serverTime = (at) => {
    const best = trips.reduce((a, b) => (b.took < a.took ? b : a));
    return at + best.offset;
  };

  function hear(message) {
    const now = performance.now();
    if (message.kind === "pong") {
      took = now - message.t;
      Readiness.note(took);
      trips = [...trips.slice(-19), { took, offset: message.at - (message.t + now) / 2 }];
    } else if (message.kind === "pairing") {
      code = null;
      Stage.askCode(message.why, message.wait_s, (typed) => { code = typed; hello(); Talk.ping(); });
    } else if (message.kind === "words") {
      Stage.greet(message.words);
    } else if (message.kind === "role") {
      ({ acts, free: isFree } = message);
      Stage.mark({ acts, free: isFree });
      if (acts) Sound.tellVoice();
    } else if (message.kind === "scene") {
      Stage.build(message.scene);
      Stage.mark({ acts, free: isFree });
      cue = null;
    } else if (message.kind === "robot") {
      Robot.move(message.robot);
    } else if (message.kind === "ended") {
      Stage.mark({ ended: true });
    } else if (message.kind === "sight") {
      see(message);
    }
  }

  /** What is seen now. The seconds that probe or trial had left at a time of the program's clock, which a new page learns a moment later. */
  function see({ sight, at: toldAt, left_s }) {
    const before = Stage.shown(), count = (one) => (one && one.presses[0] ? one.presses[0].number : 0);
    const isAnswer = before && count(sight) > count(before);
    const since = () => (trips.length && sight.clock !== "stands" ? Math.max(0, serverTime(performance.now()) - toldAt) / 1000 : 0);
    left = () => (left_s || 0) - since();
    Stage.show(sight, () => left());
    const isNew = before && sight.cue !== null && sight.cue !== cue;
    cue = sight.cue;
    if (isNew) Stage.flash();
    const at = isAnswer ? waiting.shift() : undefined;
    if (isNew || at !== undefined) afterPaint(() => {
      if (isNew) say({ kind: "drawn", cue: sight.cue, at: serverTime(performance.now()) });
      if (at !== undefined) say({ kind: "redrawn", took: performance.now() - at });
    });
  }

  /** Calls `then` once the last change is on the screen. */
  function afterPaint(then) {
    requestAnimationFrame(() => {
      const channel = new MessageChannel();
      channel.port1.onmessage = then;
      channel.port2.postMessage(null);
    });
  }

  const size = () => {
    const pixels = (length) => Math.max(1, Math.round(length * devicePixelRatio));
    return { width: pixels(window.innerWidth), height: pixels(window.innerHeight), upright: Stage.isUpright() };
  };

  function hello() {
    // A page that was watching goes on watching, since the page that takes part may reconnect later than this one.
    say({ kind: "hello", page, ...size(), code, waits: watches || acts === false });
    trips = [];
    number = 0;
    waiting.length = 0;
  }

  function opened() {
    Stage.mark({ lost: false, ended: false });
    hello();
  }

  function lost() {
    // Nobody knows now whether the time goes on: it stands until the program tells it anew.
    const stood = left();
    left = () => stood;
    waiting.length = 0;
    Stage.mark({ lost: true });
  }

  function press(button, at) {
    // Without the server's clock a press has no time; without a connection it has no effect.
    if (!isOpen()) return Stage.refuse();
    if (!trips.length || !acts) return undefined;
    number += 1;
    const stage = Stage.shown() && Stage.shown().stage;
    if (stage === "running") waiting.push(at);
    return say({ kind: "press", number, button, at: serverTime(at) });
  }

  function point(x, y) {
    const now = performance.now(), scene = Stage.scene();
    // Places of an upright layout are not those of the kitchen's file, by which gaze is understood.
    if (!scene || !scene.pointer || !acts || Stage.isUpright()) return;
    pointed = Stage.point(x, y).map((value) => Math.min(2, Math.max(-1, Number(value.toFixed(5)))));
    if (now - (point.at || 0) < POINTER_MS) return;
    point.at = now;
    say({ kind: "pointer", x: pointed[0], y: pointed[1] });
  }

  // A resting pointer is sent repeatedly, as an eye tracker goes on sending while the eyes rest.
  setInterval(() => {
    const scene = Stage.scene();
    if (pointed && scene && scene.pointer && acts && !Stage.isUpright() && performance.now() - (point.at || 0) >= POINTER_MS) {
      point.at = performance.now();
      say({ kind: "pointer", x: pointed[0], y: pointed[1] });
    }
  }, POINTER_MS);
  // If no page takes part any more, touching a watching page makes it take part.
  for (const kind of ["pointerdown", "keydown"]) window.addEventListener(kind, () => acts === false && isFree && !watches && say({ kind: "take_part" }));
  let resized = 0, idle = 0;
  window.addEventListener("resize", () => {
    Stage.resize();
    clearTimeout(resized);
    resized = setTimeout(() => say({ kind: "size", ...size() }), RESIZED_MS);
  });
  // A resting pointer is hidden.
  const rest = () => document.body.classList.add("idle");
  window.addEventListener("pointermove", () => {
    document.body.classList.remove("idle");
    clearTimeout(idle);
    idle = setTimeout(rest, IDLE_MS);
  });
  rest();
  // Keeps the screen on, if the browser supports that.
  const stayOn = () => navigator.wakeLock && navigator.wakeLock.request("screen").catch(() => {});
  document.addEventListener("visibilitychange", () => {
    if (document.visibilityState === "visible") stayOn();
    // Tells the server whether the page is hidden, since it waits longer for hidden pages.
    if (isOpen() && trips.length) Talk.ping();
  });
  stayOn();
  Stage.mark({ watches });
  Sound.begin(say);
  Hands.begin(press, (message) => (isOpen() ? say(message) : Stage.refuse()), point);
  const ping = () => ({ more: { took }, next_ms: trips.length < FIRST_PINGS ? FIRST_PING_MS : PING_MS });
  Talk.begin({ opened, hear, lost, ping });
})();
