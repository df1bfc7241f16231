"use strict";
// The layout of upright screens, such as a phone in the hand: the areas of the kitchen below one another in reading order, all that the
// person touches at least 44 pixels high on a width of 390. Orders on top, below them room for recipes and texts, the robot's side small,
// the shared places, the person's side. It answers the same questions as Room. Lengths are in em: the stage is 48 wide, or wider where it is less high.

const Upright = (wall, fontFamily, ratio) => {
  const WIDE = Upright.wideOf(ratio), BETWEEN = 0.8, EDGE = 0.8;
  // Height of a name above its place; sizes of names and words; least and most height of what is touched; height of orders, as a share of it;
  // height for recipes and texts on the least high stage, what they have more as such a share, and of a higher one as a share of what it has more.
  const NAME = 2.1, WORDS = 1.6, TOUCH = [5.8, 12], ORDER = 1.35, TEXTS = [1.8, 1.4, 0.15];
  // Room below what is touched, height of the title of the robot's side, and width of the robot's hand beside something; room that the card of a lesson leaves
  // below the orders for the line that says why a press there has no effect.
  const INNER = 1.1, TITLE = 2.7, HAND = 6.2, REASON = 1.9;
  // Width of a place, as a share of its height, of which names and buttons leave less; its least width; room beside it towards the middle, where the robot's hand stands;
  // room beside the words of a button, between buttons, and between a button and a place or its name, around which a frame can go.
  const FLAT = 1.4, PLACE = 9.6, ASIDE = 3.3, PAD = 1, APART = 0.5, FRAMED = 1.6;
  // So much wider is a column of places with buttons than the middle of the screen, if the other has none.
  const WIDER = 4;
  // The buttons of several orders are told apart by their numbers, which are shown where keys are not.
  const served = wall.locations.flatMap(({ kind }, index) => (kind === "order" ? [index] : []));
  const numbered = (knob) => (knob.does === "serve" && served.length > 1 ? { ...knob, label: `${knob.label} ${served.indexOf(knob.at) + 1}`, short: knob.label } : knob);
  const scene = { ...wall, buttons: wall.buttons.map(numbered), display_m: [ratio, 1], tags: [] }, high = WIDE / ratio;
  const across = Room(scene, fontFamily), measure = across.widthOf;
  const of = (kind) => scene.locations.flatMap((spot, index) => (spot.kind === kind ? [index] : []));
  const places = of("place").sort((a, b) => scene.locations[a].area[1] - scene.locations[b].area[1] || scene.locations[a].area[0] - scene.locations[b].area[0]);
  const wordsOf = ({ label }) => Math.max(...label.split(" ").map((word) => measure(word, WORDS)));
  const shelves = (agent) => scene.storages.flatMap((shelf, index) => (shelf.agent === agent ? [index] : []));
  const knobsAt = (index) => scene.buttons.filter((knob) => knob.at === index && ["process", "trash"].includes(knob.does));
  const chunks = (all, size) => Array.from({ length: Math.ceil(all.length / size) }, (_, row) => all.slice(row * size, (row + 1) * size));
  const rows = { places: chunks(places, 2), mine: chunks(shelves("human"), 5), theirs: chunks([...of("robot_hand").map((at) => ({ location: at })), ...shelves("robot").map((at) => ({ storage: at }))], 7) };
  // What is left of the height goes to what is touched and what the robot has, then to recipes and texts.
  const named = 1 + rows.places.length + rows.mine.length, column = (WIDE - 2 * EDGE) / Math.max(...rows.theirs.map((row) => row.length));
  // What the robot has is as large as what is touched, if its hand, where it is drawn, has room beside it; else smaller, with room for the hand below. As shares of what is touched.
  const isBeside = wall.arm !== "none" && column - HAND >= TOUCH[0], [theirs, lane] = isBeside ? [1, 0] : [0.85, wall.arm === "none" ? 0 : 0.85];
  const least = TEXTS[0] + TEXTS[2] * (high - Upright.LEAST_HIGH);
  const fixed = 2 * EDGE + 3 * BETWEEN + named * (NAME + INNER) + 3 * INNER + TITLE + rows.theirs.length * (NAME + INNER) + least, shares = ORDER + named + (theirs + lane) * rows.theirs.length + TEXTS[1];
  const touch = Math.min(TOUCH[1], Math.max(TOUCH[0], (high - fixed) / shares)), small = Math.min(theirs * touch, column - (isBeside ? HAND : 3)), order = ORDER * touch;
  const texts = least + TEXTS[1] * touch + Math.max(0, high - fixed - shares * touch), flat = FLAT * touch;

  const areas = { locations: [], storages: [], knobs: new Map(), limits: new Map() };
  const rect = (x, y, w, h) => [x / WIDE, y / high, w / WIDE, h / high];
  const spread = (count, from, wide, gap) => Array.from({ length: count }, (_, index) => [from + (index * (wide + gap)) / count, (wide + gap) / count - gap]);

  /** Orders side by side, each with its button; returns where they end. */
  function putOrders(top) {
    const orders = of("order");
    spread(orders.length, EDGE, WIDE - 2 * EDGE, BETWEEN).forEach(([x, wide], at) => {
      const knob = scene.buttons.find(({ does, at: where }) => does === "serve" && where === orders[at]), pill = knob ? Math.min(10, wide / 2.5) : 0;
      areas.locations[orders[at]] = rect(x, top, wide - pill - (knob ? 1 : 0), order);
      if (knob) areas.knobs.set(knob.name, rect(x + wide - pill, top, pill, order));
    });
    return top + order;
  }

  function putTheirs(top) {
    let y = top + TITLE;
    for (const row of rows.theirs) {
      // Each as wide as its name, where there is room; a hand's name keeps off the edge; the frame of one that is not drawn goes around its name, and needs more of it. Where the hand stands beside them, all alike.
      const spots = row.map(({ location, storage }) => (storage === undefined ? scene.locations[location] : scene.storages[storage]));
      const air = row.map(({ storage }) => (storage !== undefined ? 0.6 : wall.arm === "none" ? 2.6 : 1.6)), total = (all) => all.reduce((sum, width) => sum + width, 0);
      const wanted = (share) => spots.map(({ label }, at) => (isBeside ? column : Math.max(small + 0.4, share * measure(label, WORDS) + air[at])));
      let share = 1;
      while (share > 0.5 && total(wanted(share)) > WIDE - 2 * EDGE) share -= 0.02;
      const widths = wanted(share), rest = (WIDE - 2 * EDGE - total(widths)) / row.length;
      let x = EDGE;
      row.forEach(({ location, storage }, at) => {
        const wide = widths[at] + rest, area = rect(x + (wide - small) / 2, y + NAME, small, small);
        areas[storage === undefined ? "locations" : "storages"][storage === undefined ? location : storage] = area;
        areas.limits.set(area, wide - air[at]);
        x += wide;
      });
      y += NAME + small + lane * touch + INNER;
    }
    return y;
  }

  /** Places in two columns, as on the wall: the buttons of a place stand beside it, away from the middle. */
  function putPlaces(top) {
    let y = top + INNER / 2;
    const withKnobs = [0, 1].map((at) => rows.places.map((row) => row[at]).filter((index) => index !== undefined && knobsAt(index).length));
    const middle = WIDE / 2 + WIDER * (Math.sign(withKnobs[0].length) - Math.sign(withKnobs[1].length)), columns = [middle - EDGE, WIDE - EDGE - middle];
    // What place, name and buttons of a column share, what its buttons need of that, and its longest name.
    const room = columns.map((column) => column - 0.7 - ASIDE), most = (all) => Math.max(0, ...all);
    const needs = withKnobs.map((all) => most(all.map((index) => knobsAt(index).reduce((sum, knob) => sum + Math.max(TOUCH[0], wordsOf(knob) + PAD) + APART, -APART)))), names = withKnobs.map((all) => most(all.map((index) => measure(scene.locations[index].label, WORDS))));
    const wide = Math.max(PLACE, Math.min(flat, ...[0, 1].filter((at) => withKnobs[at].length).map((at) => [room[at] - needs[at] - FRAMED, names[at]]).flatMap(([left, named]) => [left, 2 * left - named])));
    const gaps = [0, 1].map((at) => Math.max(FRAMED, Math.min(FRAMED + (names[at] - wide) / 2, room[at] - wide - needs[at])));
    for (const row of rows.places) {
      row.forEach((index, at) => {
        const left = at ? middle : EDGE, column = columns[at], knobs = knobsAt(index), aside = knobs.length ? ASIDE : (column - wide) / 2, gap = gaps[at];
        const x = at ? left + aside : left + column - aside - wide;
        areas.locations[index] = rect(x, y + NAME, wide, touch);
        areas.limits.set(areas.locations[index], knobs.length ? wide + 2 * Math.min(ASIDE, gap - FRAMED) : column - 2.6);
        spread(knobs.length, at ? x + wide + gap : left + 0.7, room[at] - wide - gap, APART).forEach(([from, width], one) => areas.knobs.set(knobs[one].name, rect(from, y + NAME, width, touch)));
      });
      y += NAME + touch + INNER;
    }
    return y + INNER / 2;
  }

  /** The hand with what is done in it, below it the storages. */
  function putMine(top) {
    let y = top + INNER / 2;
    const [hand] = of("human_hand"), knobs = knobsAt(hand);
    areas.locations[hand] = rect(EDGE + 8.6, y + NAME, PLACE, touch);
    areas.limits.set(areas.locations[hand], 12);
    const from = EDGE + 21, wide = WIDE - EDGE - 0.8 - from;
    spread(knobs.length, from, wide, 1).forEach(([x, width], at) => areas.knobs.set(knobs[at].name, rect(x, y + NAME, width, touch)));
    y += NAME + touch + INNER;
    for (const row of rows.mine) {
      spread(row.length, EDGE + 0.8, WIDE - 2 * EDGE - 1.6, 1).forEach(([x, width], at) => {
        areas.storages[row[at]] = rect(x + Math.max(0, width - 11) / 2, y + NAME, Math.min(11, width), touch);
        areas.limits.set(areas.storages[row[at]], width + 0.8);
      });
      y += NAME + touch + INNER;
    }
    return y;
  }

  const top = { orders: EDGE };
  top.texts = putOrders(top.orders) + BETWEEN;
  top.theirs = top.texts + texts;
  top.places = putTheirs(top.theirs) + BETWEEN;
  top.mine = putPlaces(top.places) + BETWEEN;
  const end = putMine(top.mine), zone = (from, to) => rect(EDGE, from, WIDE - 2 * EDGE, to - from);
  const zones = { theirs: zone(top.theirs, top.places - BETWEEN), places: zone(top.places, top.mine - BETWEEN), mine: zone(top.mine, Math.min(end + 0.3, high - 0.3)) };
  const free = rect(EDGE, top.texts, WIDE - 2 * EDGE, texts - BETWEEN);

  const placed = {
    ...scene,
    locations: scene.locations.map((spot, index) => ({ ...spot, area: areas.locations[index] })),
    storages: scene.storages.map((shelf, index) => ({ ...shelf, area: areas.storages[index] })),
  };

  /** The size of a place's name, in em: smaller where it would meet its neighbour's. */
  function nameSize({ label, area }) {
    return Math.min(WORDS, (areas.limits.get(area) ?? WIDE) / Math.max(0.01, measure(label, 1)));
  }

  /** Where a button of an action stands, and how large its words are, of which each has a line of its own if need be. */
  function forPill({ name, label }) {
    const area = areas.knobs.get(name);
    return { area, words: Math.min(1, (area[2] * WIDE - PAD) / wordsOf({ label })) };
  }

  /** Where a text of the tutorial stands: below the orders and over the robot's side; where nothing is pressed, rather over the person's side or over the places. */
  function forLesson(shows, page) {
    const from = free[1] + (page.presses ? REASON / high : 0), above = [free[0], from, free[2], zones.theirs[1] + zones.theirs[3] - from];
    return Room.leastHidden(page.presses ? [above, zones.places] : [zones.mine, zones.places, above], Room.isAbout(placed, { robot: zones.theirs, human: zones.mine, table: zones.places }, shows, page));
  }

  return {
    isUpright: true, placed, em: [1 / WIDE, 1 / high], nameSize, forPill, forLesson,
    widthOf: (said, size) => measure(said, size),
    sides: () => [zones.theirs, zones.mine], table: () => zones.places, base: () => [isBeside ? areas.locations[of("robot_hand")[0]][0] : 0.5, zones.theirs[1] + zones.theirs[3]], taken: () => [rect(EDGE, top.mine, measure(scene.words.human, WORDS) + 1.6, TITLE)],
    forGoOn: () => rect(WIDE / 2 - 2, top.theirs + 0.1, WIDE / 2 + 0.8 - EDGE, TITLE + 0.2), forStatus: () => rect(WIDE - EDGE - 18, top.mine + 0.3, 17, NAME), forRecipe: () => free,
  };
};

// How wide the stage is, in em; it is never less high than the layout needs.
Upright.LEAST_HIGH = 85;
Upright.wideOf = (ratio) => Math.max(48, Upright.LEAST_HIGH * ratio);
