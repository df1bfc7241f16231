"use strict";
/** The line that says why a press had no effect: at its place, until the next press or for a moment. */
const Reason = (() => {
  let made = null;

  function build(element) {
    made = element("div", "why");
    made.setAttribute("role", "status");
    return made;
  }

  /** Why a press has no effect; in the tutorial also, where it would have one in the task, that another step comes first. */
  function wordsOf({ why }, tutorial, { words, locations }) {
    const known = why ? (words[`why ${why.reason}`] || "").replace("#", locations[why.about].said) : "";
    if (known) return known[0].toUpperCase() + known.slice(1);
    return tutorial?.missed ? words["tutorial another first"] : "";
  }

  // What is needed next: whatever is pressed, read or held. The line hides none of it, if there is room.
  const NEEDED = ".pill, .spot .furniture, .dock, .shelf, .spot.order, .key, .recipe.open, .gripper, .tag, .flash, .sheet.open button, .sheet.open p, .sheet.open h1, .sheet.open h2, .probing .left, .lesson:not(.large)";
  // What is better seen, too, but not at any distance.
  const NAMES = ".name, .zone h2, .status span";
  // Air around the line, and beside what a tutorial marks with a frame, in heights of the line; how far it is moved up or down in one try, and how many tries to each side.
  const AIR = 0.08, MARK = 0.4, STEP = 0.3, ASIDE = 6;
  // What hiding a share of the stage costs, and standing over a card's edge; to be the stage's height away costs 1.
  const HIDES = 1000, HIDES_NAME = 400, OVER = 100;

  /** The areas of what is seen of these on the stage, in fractions of it, with air around them in heights of the line. */
  function obstacles(names, stage, [wide, high], line, clear = AIR) {
    const area = (made) => {
      const box = made.getBoundingClientRect(), air = (made.matches(".hinted") ? MARK : clear) * line, across = (air * high) / wide;
      const [x, y] = [(box.left - stage.left) / stage.width, (box.top - stage.top) / stage.height];
      return [x - across, y - air, x + box.width / stage.width + across, y + box.height / stage.height + air];
    };
    return [...document.querySelectorAll(names)].filter((made) => made.checkVisibility({ visibilityProperty: true, opacityProperty: true })).map(area);
  }

  /** The area for a line of this size that is nearest to a point, hides nothing and stands over no card's edge; else the one that hides least. */
  function nearest([x, y], [wide, line], needed, names, cards) {
    const hidden = (areas, [left, top]) => areas.reduce((sum, [l, t, r, b]) => sum + Math.max(0, Math.min(r, left + wide) - Math.max(l, left)) * Math.max(0, Math.min(b, top + line) - Math.max(t, top)), 0);
    const crosses = ([l, t, r, b], [left, top]) => left < r && left + wide > l && top < b && top + line > t && (left < l || left + wide > r || top < t || top + line > b);
    let best = null, least = Infinity;
    const far = Math.ceil(1 / (STEP * line));
    for (let down = -far; down <= far; down += 1) for (let across = -ASIDE; across <= ASIDE; across += 1) {
      const top = y - line / 2 + down * STEP * line, left = Math.min(0.994 - wide, Math.max(0.006, x - wide / 2 + (across * wide) / (2 * ASIDE)));
      if (top < 0.006 || top + line > 0.994) continue;
      // Hiding something is worse than any distance.
      const covers = hidden(needed, [left, top]), isOver = cards.some((card) => crosses(card, [left, top]));
      const cost = (isOver ? OVER : 0) + (covers ? 10 + HIDES * covers : 0) + HIDES_NAME * hidden(names, [left, top]) + Math.abs(top + line / 2 - y) + 0.5 * Math.abs(left + wide / 2 - x);
      if (cost < least) [best, least] = [[left, top, wide, line], cost];
    }
    return best;
  }

  /** Shows a line near a point of the stage. */
  function place(said, at, root, { room, text, put, replay }) {
    made.replaceChildren(text("span", "", said));
    if (!said) return hide();
    // Its words are smaller where the stage is narrower than the line.
    const [em, line] = [room.em[0], 2.8 * room.em[1]], natural = room.widthOf(said, 1.6 * em) + 3 * em, wide = Math.min(0.988, natural);
    made.style.setProperty("--words", (wide - 3 * em) / (natural - 3 * em));
    const stage = root.getBoundingClientRect();
    put(made, nearest(at(stage), [wide, line], ...[[NEEDED], [NAMES], [".sheet.open .card", 0]].map(([names, air]) => obstacles(names, stage, [stage.width, stage.height], line, air))));
    return replay(made, "says");
  }

  /** Shows the line at what was pressed, as near as it can stand without hiding what is needed next. */
  function draw(said, pressed, root, kit) {
    place(said, (stage) => {
      const { left, top, width, height } = pressed.getBoundingClientRect();
      return [(left + width / 2 - stage.left) / stage.width, (top + height / 2 - stage.top) / stage.height];
    }, root, kit);
  }

  /** Says something that is about no place, in the middle below. */
  const say = (said, root, kit) => place(said, () => [0.5, 0.965], root, kit);

  const hide = () => made.classList.remove("says");

  return { build, wordsOf, draw, say, hide };
})();
