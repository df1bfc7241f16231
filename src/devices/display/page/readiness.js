"use strict";
/** Before a trial: whether screen, delay, gamepad and sound are as they should be, with figures only where not, and a button for the full screen. */
const Readiness = (() => {
  // As the console's check of the display has it.
  const SMALL_PX = [1280, 720], SLOW_MS = 30;
  let took = null, made = null, scene = null, words = {}, isBoxes = false, isHeard = false, hasPad = false;

  const filled = (said, ...values) => values.reduce((text, value) => text.replace("#", value), said || "");

  function line(said, isFine, does) {
    const part = document.createElement(does ? "button" : "span");
    part.className = isFine ? "fine" : does ? "" : "poor";
    part.textContent = said;
    if (does) part.addEventListener("click", does);
    return part;
  }

  /** Whether letters of the page's words are as large as the boxes that stand for letters without a font. */
  function lacksFont() {
    const said = [...Object.values(words), ...scene.locations.map(({ label }) => label)].join("");
    const letters = [...new Set(said.match(/\p{L}/gu))].filter((letter) => letter > "\u02ff"), pen = document.createElement("canvas").getContext("2d");
    pen.font = `24px ${getComputedStyle(document.body).fontFamily}`;
    const size = (letter) => {
      const { width, actualBoundingBoxLeft: left, actualBoundingBoxRight: right, actualBoundingBoxAscent: top, actualBoundingBoxDescent: bottom } = pen.measureText(letter);
      return [width, left, right, top, bottom].join();
    };
    // Signs that no font has. A box may show the number of its sign: those of four digits are alike.
    const boxes = ["\uffff", "\u{10fffd}"].map(size);
    return letters.some((letter) => boxes.includes(size(letter)));
  }

  function draw() {
    if (!made) return;
    const [wide, high] = [window.innerWidth, window.innerHeight].map((length) => Math.round(length * devicePixelRatio));
    // Who holds an upright screen in the hand reads it from nearby.
    const isSmall = wide >= high && (wide < SMALL_PX[0] || high < SMALL_PX[1]);
    const lines = [line(isSmall ? filled(words["ready screen small"], wide, high) : words["ready screen"], !isSmall)];
    if (isBoxes) lines.push(line(words["ready font"], false));
    if (scene.foreign_tutorial) lines.push(line(words["ready tutorial"], false));
    if (took !== null) lines.push(took <= SLOW_MS ? line(words["ready delay"], true) : line(filled(words["ready delay slow"], Math.round(took)), false));
    if (hasPad && scene.buttons.some(({ gamepad }) => gamepad !== null)) lines.push(line(words["ready pad"], true));
    if (Sound.isOn()) lines.push(Sound.hasVoice() ? line(words[isHeard ? "ready sound on" : "ready sound"], isHeard, hear) : line(words["ready voice off"], false));
    if (document.fullscreenEnabled && !document.fullscreenElement) lines.push(line(words.fullscreen, false, () => document.documentElement.requestFullscreen().catch(() => {})));
    made.replaceChildren(...lines);
  }

  /** A touch is what lets a page sound, so that the sound is on from now on. */
  function hear() {
    Sound.play("signal");
    Sound.say(words.ready);
    isHeard = true;
    draw();
  }

  /** The list of what is ready, for a card. */
  function build(kitchen, element) {
    [scene, words] = [kitchen, kitchen.words];
    [isBoxes, isHeard] = [lacksFont(), false];
    made = element("p", "readiness");
    draw();
    return made;
  }

  /** The connection took so long to answer. */
  function note(ms) {
    const isNew = took === null || Math.round(ms) !== Math.round(took);
    took = ms;
    if (isNew) draw();
  }

  /** Whether there is a gamepad. */
  function notePad(isThere) {
    if (isThere === hasPad) return;
    hasPad = isThere;
    draw();
  }

  for (const kind of ["resize", "fullscreenchange"]) window.addEventListener(kind, draw);
  return { build, note, notePad };
})();
