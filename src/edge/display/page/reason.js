"use strict";
/** The line that says why a press had no effect: at its place, until the next press or for a moment. */
const Reason = (() => {
  let made = null;

  function build(element) {
    made = element("div", "why");
    made.setAttribute("role", "status");
    return made;
  }

  /**
   * Shows the line at a place, below it. Where the name of the next place or the end of the screen is below, it covers
   * the lower part of the place itself; so it does on an upright screen, where everything is close together.
   */
  function draw(said, { place, isInside }, kitchen, { room, text, put, replay }) {
    made.replaceChildren(text("span", "", said));
    if (!said) return hide();
    const [box, stage] = [place.getBoundingClientRect(), kitchen.getBoundingClientRect()];
    // Its words are smaller where the stage is narrower than the line.
    const [em, line] = [room.em[0], 2.8 * room.em[1]], most = 0.988, natural = room.widthOf(said, 1.6 * em) + 3 * em, wide = Math.min(most, natural);
    const middle = (box.left + box.width / 2 - stage.left) / stage.width, low = (box.bottom - stage.top) / stage.height;
    made.style.setProperty("--words", (wide - 3 * em) / (natural - 3 * em));
    put(made, [Math.min(0.994 - wide, Math.max(0.006, middle - wide / 2)), isInside || low > 0.9 ? low - line : low + 0.1 * line, wide, line]);
    return replay(made, "says");
  }

  const hide = () => made.classList.remove("says");

  return { build, draw, hide };
})();
