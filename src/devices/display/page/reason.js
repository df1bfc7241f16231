"use strict";
/** The line that says why a press had no effect: at its place, until the next press or for a moment. */
const Reason = (() => {
  // Around what is marked stands a frame; it is so wide, in heights of the line.
  const FRAME = 0.35;
  let made = null;

  function build(element) {
    made = element("div", "why");
    made.setAttribute("role", "status");
    return made;
  }

  /** Why a press has no effect; in the tutorial also, where it would have one in the task, that another step comes first. */
  function wordsOf({ why }, tutorial, { words, locations }) {
    const known = why ? (words[`why ${why.reason}`] || "").replace("#", locations[why.about].label) : "";
    return known || (tutorial?.missed ? words["tutorial another first"] : "");
  }

  /** The left end of a line that is so wide, within the screen. */
  const inside = (left, wide) => Math.min(0.994 - wide, Math.max(0.006, left));

  /** The usual area of the line; where it would hide what is marked, another one at the same place or beside what is marked. */
  function besides(marked, stage, usual, heights) {
    if (!marked) return usual;
    const box = marked.getBoundingClientRect(), [left, , wide, line] = usual, air = FRAME * line;
    const [from, to] = [box.left, box.right].map((x) => (x - stage.left) / stage.width), [above, under] = [box.top, box.bottom].map((y) => (y - stage.top) / stage.height);
    const across = (air * stage.height) / stage.width, isFree = ([x, y]) => x > to + across || x + wide < from - across || y > under + air || y + line < above - air;
    const lefts = [left, inside(from - 1.1 * across - wide, wide), inside(to + 1.1 * across, wide)];
    const tries = lefts.flatMap((x) => [usual[1], ...heights].map((y) => [x, y, wide, line]));
    return tries.find((rect) => rect[1] > 0 && rect[1] + line < 1 && isFree(rect)) || usual;
  }

  /**
   * Shows the line at a place, below it. Where the name of the next place or the end of the screen is below, it covers
   * the lower part of the place itself; so it does on an upright screen, where everything is close together. What the
   * tutorial has marked stays free.
   */
  function draw(said, { place, isInside, marked }, kitchen, { room, text, put, replay }) {
    made.replaceChildren(text("span", "", said));
    if (!said) return hide();
    const [box, stage] = [place.getBoundingClientRect(), kitchen.getBoundingClientRect()];
    // Its words are smaller where the stage is narrower than the line.
    const [em, line] = [room.em[0], 2.8 * room.em[1]], most = 0.988, natural = room.widthOf(said, 1.6 * em) + 3 * em, wide = Math.min(most, natural);
    const middle = (box.left + box.width / 2 - stage.left) / stage.width, [high, low] = [box.top, box.bottom].map((y) => (y - stage.top) / stage.height);
    made.style.setProperty("--words", (wide - 3 * em) / (natural - 3 * em));
    const left = inside(middle - wide / 2, wide), inner = low - line, below = low + 0.1 * line, usual = isInside || low > 0.9 ? inner : below;
    put(made, besides(marked, stage, [left, usual, wide, line], [below, inner, high - 1.1 * line, high]));
    return replay(made, "says");
  }

  /** Says something that is about no place, in the middle below. */
  function say(said, kitchen, { room, put, replay, text }) {
    const wide = Math.min(0.9, room.widthOf(said, 1.6 * room.em[0]) + 3 * room.em[0]);
    made.replaceChildren(text("span", "", said));
    made.style.setProperty("--words", 1);
    put(made, [0.5 - wide / 2, 0.94, wide, 2.8 * room.em[1]]);
    replay(made, "says");
  }

  const hide = () => made.classList.remove("says");

  return { build, wordsOf, draw, say, hide };
})();
