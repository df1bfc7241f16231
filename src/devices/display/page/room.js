"use strict";
// Positions of everything that the layout file does not place: names, buttons of actions, recipes. Text is measured in
// the page's own font. Rectangles are [left, top, width, height] in fractions of the stage; text sizes are fractions of
// its width.

const Room = (scene, fontFamily) => {
  // Size of names, and smallest size of text that has to be read at 3 m: its capitals are 17 arc minutes high there on
  // a stage of 1.5 m. Then the height of a name above its place, and the smallest size of an action's button.
  const NAME_SIZE = 0.0145, LEAST_SIZE = 0.0140, NAME = 0.034, PILL = [0.096, 0.05], GAP = 0.016;
  // Width of the frame around an order with a signal, and the sizes that are tried for a button's words until they fit.
  const FRAME = 0.007, SIZES = [1, 0.92, 0.84, 0.76, 0.68];
  const ratio = scene.display_m[0] / scene.display_m[1];
  const ruler = document.createElement("canvas").getContext("2d");

  const { overlaps } = Room;
  const around = (rects) => {
    const x = Math.min(...rects.map((r) => r[0])), y = Math.min(...rects.map((r) => r[1]));
    return [x, y, Math.max(...rects.map((r) => r[0] + r[2])) - x, Math.max(...rects.map((r) => r[1] + r[3])) - y];
  };
  const grown = ([x, y, w, h], [left, top, right, bottom]) => {
    const to = (low, high) => [Math.max(0.006, low), Math.min(0.994, high)];
    const [x0, x1] = to(x - left, x + w + right), [y0, y1] = to(y - top, y + h + bottom);
    return [x0, y0, x1 - x0, y1 - y0];
  };

  /** Width of bold words of this size. */
  function widthOf(said, size) {
    ruler.font = `700 100px ${fontFamily}`;
    return (ruler.measureText(said).width / 100) * size;
  }

  const named = [...scene.locations.filter(({ kind }) => kind !== "order"), ...(scene.names === "none" ? [] : scene.storages)];
  const nameArea = ({ label, area: [x, y, w] }, size) => {
    const wide = widthOf(label, size) + 0.004;
    return [x + w / 2 - wide / 2, y - NAME, wide, NAME];
  };

  /** Size of a place's name, so that no name overlaps another one or leaves its zone; if it would be too small for that, the stage. */
  function nameSize(spot) {
    const obstacles = [...scene.tags.map(({ area }) => area), ...named.filter((other) => other !== spot).map((other) => nameArea(other, NAME_SIZE))];
    const [zone, , wide] = [...sides(), table()].find((one) => overlaps(one, spot.area)) || [0, 0, 1];
    for (const [from, to, least] of [[zone + 0.004, zone + wide - 0.004, 0.8 * LEAST_SIZE], [0.004, 0.996, 0.005]]) {
      for (let size = NAME_SIZE; size > least; size -= 0.0005) {
        const area = nameArea(spot, size);
        if (area[0] >= from && area[0] + area[2] <= to && !obstacles.some((other) => overlaps(area, other))) return size;
      }
    }
    return LEAST_SIZE / 2;
  }

  /** Size of an action's button, for its words at `words` times the usual size and its key. */
  function pillOf(knob, words) {
    const wide = widthOf(knob.label, words * LEAST_SIZE) + 0.026 + (scene.keys && knob.key ? 0.03 : 0);
    return [Math.max(PILL[0], wide), PILL[1]];
  }

  const areas = (kind) => scene.locations.filter((spot) => spot.kind === kind).map((spot) => spot.area);
  /** The areas of robot and human, with equal height. */
  function sides() {
    const both = ["robot", "human"].map((agent) => around([...areas(`${agent}_hand`), ...scene.storages.filter((shelf) => shelf.agent === agent).map((shelf) => shelf.area)]));
    const top = Math.min(...both.map(([, y]) => y)), bottom = Math.max(...both.map(([, y, , h]) => y + h));
    // The side towards the table has room for the buttons of the hand.
    return both.map(([x, , w], human) => grown([x, top, w, bottom - top], [human ? 0.045 : 0.022, 0.085, human ? 0.022 : 0.045, 0.035]));
  }

  /** The area of the places between the two, as wide as their names need, as far as the sides leave room. */
  function table() {
    const [x, , w] = around(areas("place")), names = around(scene.locations.filter(({ kind }) => kind === "place").map((spot) => nameArea(spot, NAME_SIZE)));
    const [robots, humans] = sides(), room = [x - robots[0] - robots[2], humans[0] - x - w].map((wide) => (wide > 0.036 ? wide - 0.006 : 0.03));
    const [left, right] = [x - names[0], names[0] + names[2] - x - w].map((over, side) => Math.min(room[side], Math.max(0.03, over + 0.006)));
    return grown(around(areas("place")), [left, 0.085, right, 0.03]);
  }

  /** Where it says that one can go on without the robot: below what is the robot's. */
  function forGoOn() {
    const [x, y, w, h] = sides()[0], theirs = [...areas("robot_hand"), ...scene.storages.filter(({ agent }) => agent === "robot").map(({ area }) => area)];
    const top = Math.max(...theirs.map(([, low, , high]) => low + high)), tags = scene.tags.map(({ area }) => area).filter((area) => overlaps(area, [x, top, w, y + h - top]));
    const left = Math.max(x, ...tags.map(([from, , wide]) => from + wide)) + 0.006;
    return [left, top, x + w - 0.008 - left, y + h - 0.004 - top];
  }

  /** Where the robot's arm comes from: the edge of its side that is nearest to the viewer. */
  function base() {
    const [x, y, w, h] = sides()[0];
    return [x + w / 2, y + h];
  }

  /** The area of a location; for an order, with the frame that a signal draws around it. */
  const framed = ({ kind, area: [x, y, w, h] }) => (kind === "order" ? [x - FRAME, y - FRAME * ratio, w + 2 * FRAME, h + 2 * FRAME * ratio] : [x, y, w, h]);

  /** All areas that are taken already, so that nothing else is placed there. */
  function taken() {
    const titles = sides().map(([x, y, w]) => [x, y, w, 0.05]);
    const names = named.map((spot) => nameArea(spot, nameSize(spot)));
    // Keys hang over the right edges of places and storages.
    const keyed = scene.buttons.flatMap(({ does, at }) => (does === "use" ? scene.locations[at] : does === "take" ? scene.storages[at] : []));
    const keys = keyed.map(({ area: [x, y, w, h] }) => [x + w - 0.016, y + h - 0.024 * ratio, 0.018, 0.024 * ratio]);
    return [...scene.locations.map(framed), ...names, ...keys, ...scene.storages.map((shelf) => shelf.area), ...titles, ...scene.tags.map((tag) => tag.area)];
  }

  /**
   * The nearest free area for an action's button: below, above or beside its place, within the same zone; undefined if
   * there is none.
   */
  function besidePlace(area, [pw, ph], others) {
    const [x, y, w, h] = area, [zone, , wide] = [...sides(), table()].find((zone) => overlaps(zone, area)) || [0, 0, 1];
    const inside = (left) => Math.min(zone + wide - 0.006 - pw, Math.max(zone + 0.006, left));
    const middle = inside(x + w / 2 - pw / 2), tries = [[middle, y + h + GAP], [middle, y - NAME - GAP - ph]];
    // A wide button may be shifted a little to the side.
    for (const aside of [0.02, -0.02, 0.04, -0.04, 0.06, -0.06]) tries.push([inside(middle + aside), y + h + GAP], [inside(middle + aside), y - NAME - GAP - ph]);
    tries.push([x + w + GAP, y + h / 2 - ph / 2], [x - GAP - pw, y + h / 2 - ph / 2]);
    for (let step = 1; step < 6; step += 1) {
      for (const left of [middle, x + w + GAP, x - GAP - pw]) tries.push([inside(left), y + h + GAP + step * (ph + GAP)]);
    }
    const air = 0.0035, fits = (rect) => rect[0] >= 0 && rect[1] >= 0 && rect[0] + pw <= 1 && rect[1] + ph <= 1 && !others.some((other) => overlaps(grown(rect, [air, air, air, air]), other));
    return tries.map(([left, top]) => [left, top, pw, ph]).find(fits);
  }

  /**
   * Area of an action's button, and relative size of its words, which are smaller if there is no room for the usual
   * size.
   */
  function forPill(knob, others) {
    const at = framed(scene.locations[knob.at]);
    for (const words of SIZES) {
      const area = besidePlace(at, pillOf(knob, words), others);
      if (area) return { area, words };
    }
    // In a kitchen without a free area, the button is placed below its place.
    const words = SIZES[SIZES.length - 1], [w, h] = pillOf(knob, words);
    return { area: [Math.min(at[0], 1 - w), Math.min(at[1] + at[3], 1 - h), w, h], words };
  }

  /** Where clock and number of served orders stand, one below the other: on top, as near to the middle as there is room. */
  function forStatus(others) {
    const lines = Number(scene.clock) + Number(scene.served), [w, h] = [Math.max(widthOf("88:88", 0.02), widthOf(`✓ ${scene.words["served count"]}8`, 0.0155)), 0.05 * lines], y = 0.02, step = 0.01;
    const tries = Array.from({ length: Math.floor((1 - w) / step) }, (_, index) => [index * step, y, w, h]);
    const free = tries.filter((rect) => !others.some((other) => overlaps(rect, other)));
    const off = ([x]) => Math.abs(x + w / 2 - 0.5);
    return (free.length ? free : tries).reduce((best, rect) => (off(rect) < off(best) ? rect : best));
  }

  /**
   * Area of a recipe that covers nothing of the kitchen: the largest free rectangle, or one that is large enough and
   * near its order. At most so wide and high; `isClear`: not over the robot's side either, if there is room enough elsewhere.
   */
  function forRecipe(others, order, { most = [0.24, 0.5], isClear = false } = {}) {
    // A line is a picture with words beside it. A larger line height than `enough` does not improve reading, one of `least` is readable.
    const margin = 0.012, lines = 4.4, line = 5.2, enough = 0.08, least = 0.06;
    const clear = isClear && forRecipe([...others, sides()[0]], order, { most });
    if (clear && Math.min(clear[3] / lines, (clear[2] * ratio) / line) >= least) return clear;
    const walls = others.map((rect) => grown(rect, [margin, margin * ratio, margin, margin * ratio]));
    const lefts = [margin, ...walls.map(([x, , w]) => x + w)], rights = [1 - margin, ...walls.map(([x]) => x)];
    const aim = order ? order[0] + order[2] / 2 : 0.5;
    let best = [0, 0, 0, 0], highest = -Infinity;
    for (const left of lefts) for (const right of rights) {
      const columns = walls.filter(([x, , w]) => x < right && x + w > left).map(([, y, , h]) => [y, y + h]);
      let low = margin;
      for (const [top, bottom] of [...columns, [1 - margin, 1]].sort((a, b) => a[0] - b[0])) {
        const size = Math.min((top - low) / lines, ((right - left) * ratio) / line);
        const across = Math.max(0, left - aim, aim - right) + 0.15 * Math.abs((left + right) / 2 - aim);
        const down = order ? Math.max(0, low - order[1] - order[3]) : 0;
        // Among equal rectangles, the one nearer to the order or to the middle is taken.
        const worth = order ? Math.min(size, enough) - 0.03 * (across + down) : size - 0.01 * across;
        if (worth > highest) [best, highest] = [[left, low, right - left, top - low], worth];
        low = Math.max(low, bottom);
      }
    }
    const [x, y, w, h] = best, high = Math.min(h, most[1]), wide = Math.min(w, most[0]);
    const left = Math.min(x + w - wide, Math.max(x, aim - wide / 2));
    return [left, order ? y : y + (h - high) / 2, wide, high];
  }

  /** Where a page of the tutorial stands, over one whole side or all places: where it hides nothing that it is about; if something is pressed over the robot's side, else rather over the person's. */
  function forLesson(shows, page) {
    const [robots, humans] = sides(), middle = table(), y = robots[1] + 0.05, tags = scene.tags.map(({ area }) => area).filter((area) => area[1] > y);
    const end = Math.min(robots[1] + robots[3], ...tags.map((area) => area[1] - 0.012));
    return Room.leastHidden((page.presses ? [robots, humans, middle] : [humans, middle, robots]).map(([x, , w]) => [x, y, w, end - y]), Room.isAbout(scene, { robot: robots, human: humans, table: middle }, shows, page));
  }

  return {
    isUpright: false, placed: scene, em: [0.01, 0.01 * ratio],
    widthOf, nameSize: (spot) => 100 * nameSize(spot), sides, table, base, taken, forPill, forStatus, forGoOn, forRecipe,
    forLesson,
  };
};

Room.overlaps = ([ax, ay, aw, ah], [bx, by, bw, bh]) => ax < bx + bw && bx < ax + aw && ay < by + bh && by < ay + ah;

/** The areas that a page of the tutorial is about: what it frames and its signal shows, what the robot does, which is watched, and what is asked about; else
 * both sides. A button of the person is in none of them. */
Room.isAbout = (scene, zones, shows, { kind, frames, presses }) => {
  const areaOf = ({ area, place }) => zones[area] || (place && ("storage" in place ? scene.storages[place.storage] : scene.locations[place.location]).area);
  const all = [...frames.map(areaOf), shows, kind === "robot" && zones.robot, kind === "probe" && zones.table].filter(Boolean);
  return all.length || presses ? all : [zones.robot, zones.human];
};

/** The first of these areas that hides least of others. */
Room.leastHidden = (areas, others) => {
  const across = (from, wide, other, much) => Math.max(0, Math.min(from + wide, other + much) - Math.max(from, other));
  const hides = ([x, y, w, h]) => others.reduce((sum, [ax, ay, aw, ah]) => sum + across(x, w, ax, aw) * across(y, h, ay, ah), 0);
  return areas.map((area) => ({ area, hides: hides(area) })).reduce((best, one) => (one.hides < best.hides - 1e-9 ? one : best)).area;
};
