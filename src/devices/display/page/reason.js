"use strict";
/** The line that says why a press had no effect: at its place, until the next press or for a moment. */
const Reason = (() => {
  let made = null, stand = () => {};

  function build(element) {
    made = element("div", "why");
    made.setAttribute("role", "status");
    return made;
  }

  /** Why a press has no effect; in the tutorial also, where it would have one in the task, that another step comes first. What is no dish of the menu is seen to be none. */
  function wordsOf({ at, why }, tutorial, { words, locations, plate }, contents) {
    const more = why?.reason === "not_served" && !contents[plate]?.dish ? "unfinished" : locations[at.location]?.kind, line = why && (words[`why ${why.reason} ${more}`] || words[`why ${why.reason}`]), known = line ? line.replace("#", locations[why.about].said) : "";
    if (known) return known[0].toUpperCase() + known.slice(1);
    return tutorial?.missed ? words["tutorial another first"] : "";
  }

  // What is needed next: whatever is pressed, read or held, and on a wall the side where the robot moves. The line hides none of it, if there is room.
  const NEEDED = "#stage:not(.upright) .zone.robot, .name, .zone h2, .status span, .go-on p, .pill, .spot .furniture, .dock, .shelf, .spot.order, .key, .recipe.open, .gripper, .tag, .flash, .sheet.open :is(button, p, h1, h2, textarea, .anchor, .slider, .slider b, .number, .given, .choices, .left), .lesson:not(.large)";
  // Lengths in em. Size of words, height of a line and room around the words; air around what is needed, also for a line about no place, beside what a tutorial marks with a frame, and beside a card that opens, which grows and has a frame;
  // how far the line is moved in one try.
  const WORDS = 1.6, LINE = 1.8, PAD = [2.4, 0.5], AIR = 0.1, CLEAR = 0.3, MARK = 0.6, OPENS = 1.4, STEP = 0.9;
  // Length of the line's tail, which points at what was pressed: what it has room for, what it has at most, and its width, in em; step of its length, and size of the line's corners.
  const TAIL = [0.7, 6, 1.1], TIP = 0.1, ROUND = 0.8;
  // How far away, in em, the line would rather stand than hide a square em of something, or stand over a card's edge, or have another line, or smaller words, or stand over the edge of an area.
  const HIDES = 60, OVER = 5000, BROKEN = 0.1, SMALLER = 8, EDGE = 5;
  // So small words can still be read on a screen in the hand, which alone is narrower than a line.
  const LEAST = 0.72;

  /** The areas of what is seen of these, in em from the stage's corner, with air around them. */
  function obstacles(names, stage, em, own) {
    const area = (made) => {
      const box = made.getBoundingClientRect(), air = names !== NEEDED || made.matches(".zone") ? 0 : made.matches(".recipe") ? OPENS : made.matches(".hinted") ? MARK : own ? AIR : CLEAR;
      return [(box.left - stage.left) / em - air, (box.top - stage.top) / em - air, (box.right - stage.left) / em + air, (box.bottom - stage.top) / em + air];
    };
    // A card that opens counts at once.
    const isSeen = (made) => made.checkVisibility({ visibilityProperty: true, opacityProperty: !made.matches(".recipe") });
    return [...document.querySelectorAll(names)].filter(isSeen).map(area);
  }

  /** The shapes that words can have, in one line to three: their size, the number of lines, and the size of words: smaller rather than broken, and down to `least` where that brings them nearer. */
  function shapesOf(said, measure, most, least) {
    const words = said.split(/ |(?<=、)/).map((word) => measure(word)), space = measure(" "), natural = measure(said);
    const linesIn = (wide) => words.reduce(([lines, used], word) => (used + space + word <= wide ? [lines, used + space + word] : [lines + 1, word]), [0, Infinity])[0];
    const shape = (lines, largest) => {
      let wide = Math.max(...words);
      while (linesIn(wide) > lines && wide < natural) wide += 0.3;
      const small = Math.min(largest, (most - PAD[0]) / wide);
      return { lines, small, size: [small * wide + PAD[0], small * lines * LINE + PAD[1]] };
    };
    const all = [1, least].flatMap((largest) => [1, 2, 3].slice(0, words.length).map((lines) => shape(lines, largest))), readable = all.filter(({ small }) => small >= LEAST);
    return readable.length ? readable : all.slice(-1);
  }

  /** The area for one of these shapes that is nearest to what was pressed, hides nothing and stands over no card's edge; else the one that costs least. */
  function nearest([l, t, r, b], shapes, [width, height], needed, cards, zones) {
    const hidden = (areas, x, y, w, h) => areas.reduce((sum, [al, at, ar, ab]) => sum + Math.max(0, Math.min(ar, x + w) - Math.max(al, x)) * Math.max(0, Math.min(ab, y + h) - Math.max(at, y)), 0);
    const crosses = ([al, at, ar, ab], x, y, w, h) => al < x + w && x < ar && at < y + h && y < ab && (x < al || x + w > ar || y < at || y + h > ab);
    let best = null, least = Infinity;
    for (const { lines, small, size: [w, h] } of shapes) {
      const [lowX, highX, lowY, highY] = [0.6, width - 0.6 - w, 0.2, height - 0.2 - h];
      // From where it stands close beside, above or below, to all sides.
      const across = [(l + r - w) / 2, l, r - w, l - w - TAIL[0], r + TAIL[0], l - w - AIR, r + AIR], down = [(t + b - h) / 2, t, b - h, t - h - TAIL[0], b + TAIL[0], t - h - AIR, b + AIR];
      for (let x = lowX; x <= highX; x += STEP) across.push(x);
      for (let y = lowY; y <= highY; y += STEP) down.push(y);
      down.push(highY);
      for (const y of down.filter((one) => one >= lowY && one <= highY)) for (const x of across.map((one) => Math.min(highX, Math.max(lowX, one)))) {
        const away = Math.hypot(Math.max(0, l - x - w, x - r), Math.max(0, t - y - h, y - b));
        // Too near is far, too, since a tail is seen. Of two that are as near, the one whose middle is nearer.
        const far = Math.max(away, 5 * (TAIL[0] - away)) + 0.05 * Math.hypot(x + w / 2 - (l + r) / 2, y + h / 2 - (t + b) / 2) + BROKEN * (lines - 1) + SMALLER * (1 - small);
        if (far >= least) continue;
        const cost = far + HIDES * hidden(needed, x, y, w, h) + (cards.some((card) => crosses(card, x, y, w, h)) ? OVER : 0) + (zones.some((zone) => crosses(zone, x, y, w, h)) ? EDGE : 0);
        if (cost < least) [best, least] = [{ area: [x, y, w, h], small }, cost];
      }
    }
    return best;
  }

  /** The tail of a line towards what was pressed, from where the line's corners are not round; it ends before what it would hide. */
  function tailOf([l, t, r, b], [pl, pt, pr, pb], needed) {
    // The nearest points of both, in the middle of the edges that they share.
    const between = (from, to, otherFrom, otherTo) => (to <= otherFrom ? [to, otherFrom] : otherTo <= from ? [from, otherTo] : Array(2).fill((Math.max(from, otherFrom) + Math.min(to, otherTo)) / 2));
    const [[nearX, px], [nearY, py]] = [between(l, r, pl, pr), between(t, b, pt, pb)], [x, y] = [Math.min(r - ROUND, Math.max(l + ROUND, nearX)), Math.min(b - ROUND, Math.max(t + ROUND, nearY))];
    const far = Math.hypot(px - x, py - y), isIn = ([al, at, ar, ab], [tipX, tipY]) => al < tipX && tipX < ar && at < tipY && tipY < ab;
    const tip = (along) => [x + ((px - x) * along) / far, y + ((py - y) * along) / far];
    const isFree = (along) => isIn([l, t, r, b], tip(along)) || !needed.some((area) => isIn(area, tip(along)));
    let length = 0;
    while (length + TIP <= Math.min(far, TAIL[1]) && isFree(length + TIP)) length += TIP;
    return { left: `${x - l}em`, top: `${y - t - TAIL[2] / 2}em`, width: `${length}em`, height: `${TAIL[2]}em`, rotate: `${Math.atan2(py - y, px - x)}rad` };
  }

  /** Shows a line near something of the stage, whose edges `at` gives in em. */
  function place(said, at, own, root, { room, text, put, replay }) {
    const tail = text("i", "tail", "");
    made.replaceChildren(text("span", "", said), ...(own ? [tail] : []));
    if (!said) return hide();
    stand = () => {
      const stage = root.getBoundingClientRect(), em = room.em[0] * stage.width, size = [stage.width / em, stage.height / em], most = size[0] - 1.2;
      const measure = (words) => room.widthOf(words, WORDS * room.em[0]) / room.em[0], shapes = shapesOf(said, measure, most, room.isUpright ? LEAST : 1);
      const pressed = at(stage, em), [needed, cards, zones] = [NEEDED, ".sheet.open .card", ".zone"].map((names) => obstacles(names, stage, em, own));
      const { area: [x, y, w, h], small } = nearest(pressed, shapes, size, needed, cards, zones);
      made.style.setProperty("--words", small);
      put(made, [x / size[0], y / size[1], w / size[0], h / size[1]]);
      Object.assign(tail.style, tailOf([x, y, x + w, y + h], pressed, needed));
    };
    stand();
    return replay(made, "says");
  }

  /** The edges of something with its name, in em from the stage's corner. */
  const edgesOf = (made) => (stage, em) => {
    const all = [made, ...made.querySelectorAll(":scope > .name")].map((part) => part.getBoundingClientRect()), edge = (most, name) => most(...all.map((box) => box[name]));
    return [(edge(Math.min, "left") - stage.left) / em, (edge(Math.min, "top") - stage.top) / em, (edge(Math.max, "right") - stage.left) / em, (edge(Math.max, "bottom") - stage.top) / em];
  };

  /** Shows the line at what was pressed, as near as it can stand without hiding what is needed next. */
  const draw = (said, pressed, root, kit) => place(said, edgesOf(pressed), pressed, root, kit);

  /** Says something that is about no place, near what can be done, or in the middle of a free area of the stage, or of the stage below. */
  function say(said, does, [x, y, w, h] = [0.5, 0.965, 0, 0], root, kit) {
    const middle = ({ width, height }, em) => [0, 1].flatMap(() => [((x + w / 2) * width) / em, ((y + h / 2) * height) / em]);
    place(said, does ? edgesOf(does) : middle, null, root, kit);
  }

  /** Makes room for a card that has opened. */
  const move = () => made.classList.contains("says") && stand();

  const hide = () => made.classList.remove("says");

  return { build, wordsOf, draw, say, move, hide };
})();
