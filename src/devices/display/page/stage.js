"use strict";
// The stage, which draws the kitchen: built once from a scene, then changed by every state message. It shows what it
// receives and knows nothing else.

const Stage = (() => {
  const root = document.getElementById("stage");
  // Higher than wide by so much, the screen shows the layout of upright screens, which is between so wide and so wide for its height.
  const UPRIGHT = 1.2, NARROW = 0.42, WIDE = 1 / UPRIGHT;
  // For so long at least it is said what the robot does, and what it has just done; it is slow once it was so for so long.
  const SAYS_MS = 1000, TOLD_MS = 2500, SLOW_MS = 1000, says = { does: null, news: "", until: 0, slowFrom: Infinity, timer: 0 };
  let pad = null, isKeyed = false, told = null, scene = null, room = null, shown = null, parts = null, words = {}, timeLeft = () => 0;
  let marks = { lost: false, ended: false, acts: true, free: false }, wasLost = false;

  function element(kind, className, inside = "") {
    const made = document.createElement(kind);
    made.className = className;
    if (inside instanceof Node) made.append(inside);
    else if (inside) made.innerHTML = inside;
    return made;
  }

  function text(kind, className, words) {
    const made = document.createElement(kind);
    made.className = className;
    made.textContent = words;
    return made;
  }

  const percent = (value) => `${(100 * value).toFixed(3)}%`;
  function put(made, [x, y, w, h]) {
    Object.assign(made.style, { left: percent(x), top: percent(y), width: percent(w), height: percent(h) });
    return made;
  }

  /** The badge of a button: its key or its gamepad's button, or only the colour of its cap. */
  function key(knob) {
    const named = scene.keys && knob && knob.key;
    if (!knob || (!named && !knob.colour)) return "";
    const badge = text("kbd", named ? "key" : "key cap", "");
    if (knob.colour) badge.dataset.colour = knob.colour;
    if (named) labelBadge(badge, knob);
    badge.dataset.of = knob.name;
    return badge;
  }

  function labelBadge(badge, knob) {
    const isPad = pad && knob.gamepad !== null;
    badge.classList.toggle("of-pad", Boolean(isPad));
    if (isPad) badge.innerHTML = Art.pad(knob.gamepad, pad.standard);
    else badge.textContent = Hands.printedOn(knob);
  }

  /** Writes all badges anew: the keyboard is known better now, or there is a gamepad. */
  function label() {
    if (!scene || !scene.keys) return;
    for (const badge of root.querySelectorAll(".key:not(.cap)")) labelBadge(badge, scene.buttons.find(({ name }) => name === badge.dataset.of));
  }

  /** The participant uses the keyboard, or the gamepad: badges show the buttons of that, and signs what keys do. */
  function useBadges(kind, standard) {
    isKeyed = true;
    markHands(kind);
    if (kind === (pad ? "pad" : "keys")) return;
    pad = kind === "pad" ? { standard } : null;
    label();
  }

  /** On a wall there are keys where there is a mouse; a screen in the hand has them once one is pressed. */
  function markHands(kind = pad ? "pad" : "keys") {
    root.classList.toggle("keyed", isKeyed || (!isUpright() && matchMedia("(hover: hover)").matches));
    root.classList.toggle("padded", kind === "pad");
  }

  function knobOf(does, at) {
    return scene.buttons.find((button) => button.does === does && button.at === at);
  }

  function makeTouch(made, knob) {
    if (!knob) return;
    made.dataset.button = knob.name;
    made.setAttribute("role", "button");
    made.setAttribute("aria-label", knob.label);
  }

  function buildZone(className, area, label) {
    const zone = put(element("section", `zone ${className}`), area);
    zone.append(text("h2", "", label));
    return zone;
  }

  function buildLocation(spot, index) {
    const [, y, w, h] = spot.area;
    const wide = (100 * w * scene.display_m[0]) / (h * scene.display_m[1]);
    const made = put(element("div", `spot ${spot.kind}`), spot.area);
    const shape = spot.kind === "place" ? spot.look && spot.look.shape : spot.kind;
    if (spot.kind !== "order") {
      // A highlighted place is framed together with its name.
      const name = text("div", "name", spot.label), size = room.nameSize(spot);
      const over = Math.max(0, room.widthOf(spot.label, size) - w / room.em[0]) / 2;
      made.style.setProperty("--side", `${(over + (room.isUpright ? 1.2 : 1.5)).toFixed(2)}em`);
      made.style.setProperty("--under", `${-Math.min(room.isUpright ? 0.55 : 0.7, (1 - y - h) / room.em[1] - 0.05).toFixed(2)}em`);
      name.style.fontSize = `${size.toFixed(3)}em`;
      // The robot's hand itself lies there, if it is drawn.
      const isDock = spot.kind === "robot_hand" && scene.arm !== "none";
      made.append(isDock ? element("div", "dock") : element("div", "furniture", Art.place(shape, wide)), name);
    }
    const content = element("div", "content");
    made.append(content, element("div", "ring"));
    if (spot.kind === "place") {
      const knob = knobOf("use", index);
      makeTouch(made, knob);
      made.append(key(knob));
    }
    return { made, content, drawn: null };
  }

  function buildStorage(shelf, index) {
    const made = put(element("div", `shelf ${shelf.agent}`), shelf.area);
    made.append(element("div", "content", Art.item(scene, shelf.item)), element("div", "ring"));
    if (scene.names !== "none") {
      const name = text("div", "name", shelf.label);
      name.style.fontSize = `${room.nameSize(shelf).toFixed(3)}em`;
      made.append(name);
    }
    if (shelf.agent === "human") {
      const knob = knobOf("take", index);
      makeTouch(made, knob);
      made.append(key(knob));
    }
    return { made };
  }

  /**
   * Builds the buttons of actions, each beside its place; `others` are the taken areas, to which those of the buttons
   * are added.
   */
  function buildPills(others) {
    const makePill = (knob) => {
      const { area, words } = room.forPill(knob, others);
      others.push(area);
      const made = put(element("div", `pill ${knob.does}`), area);
      made.style.setProperty("--words", words);
      const said = text("span", "", knob.short ?? knob.label);
      if (knob.short) said.dataset.number = knob.label.slice(knob.short.length);
      made.append(said, key(knob));
      makeTouch(made, knob);
      return made;
    };
    return scene.buttons.filter(({ does }) => ["process", "trash", "serve"].includes(does)).map(makePill);
  }

  const isUpright = () => window.innerHeight > UPRIGHT * window.innerWidth;
  const uprightRatio = () => Math.min(WIDE, Math.max(NARROW, window.innerWidth / window.innerHeight));

  /** The layout for the window as it is. */
  function roomFor(next) {
    const fontFamily = getComputedStyle(root).fontFamily;
    return isUpright() ? Upright(next, fontFamily, uprightRatio()) : Room(next, fontFamily);
  }

  /** Gives the stage the shape of its layout; before a kitchen is there, too. */
  function shape() {
    const [wide, high] = told ? told.display_m : [16, 9];
    root.classList.toggle("upright", isUpright());
    markHands();
    root.style.setProperty("--wide", Upright.wideOf(uprightRatio()));
    root.style.setProperty("--ratio", isUpright() ? uprightRatio() : wide / high);
  }

  /** The window has another size: an upright layout is one for this size, and goes when the screen is turned. */
  function resize() {
    if (!scene) return shape();
    if (!isUpright() && !room.isUpright) return undefined;
    const last = shown;
    build(told);
    return last && show(last, timeLeft);
  }

  function build(next) {
    told = next;
    room = roomFor(next);
    scene = room.placed;
    shown = null;
    document.documentElement.lang = scene.language;
    document.title = scene.title;
    root.replaceChildren();
    shape();
    Sound.build(scene);
    const kitchen = element("div", "kitchen");
    const [theirs, mine] = room.sides(), robots = buildZone("robot", theirs, scene.words.robot);
    Object.assign(says, { does: null, news: "", until: 0, slowFrom: Infinity });
    kitchen.append(robots, buildZone("human", mine, scene.words.human));
    kitchen.append(put(element("section", "zone table"), room.table()));
    const locations = scene.locations.map(buildLocation), storages = scene.storages.map(buildStorage);
    const others = room.taken();
    const pills = buildPills(others);
    const tally = room.forStatus(others), all = [...others, tally];
    // A recipe opens near its order, beside the robot's side if that is drawn; the instruction opens in the largest free area.
    const free = room.forRecipe(all, undefined, { isClear: scene.arm !== "none" });
    const cards = scene.locations.map(({ kind, area }) => (kind === "order" ? room.forRecipe(all, area, { isClear: scene.arm !== "none" }) : free));
    const recipe = put(element("div", "recipe"), free), goOn = put(element("div", "go-on"), room.forGoOn());
    const robot = Robot.build(told, room, { taken: all, cards }, element);
    kitchen.append(...robot, ...locations.map((l) => l.made), ...storages.map((s) => s.made), ...pills, goOn, recipe);
    const sheet = element("div", "sheet"), toast = element("div", "toast"), status = put(Status.build(element), tally), target = element("div", "target", "<i></i>");
    root.append(kitchen, status, sheet, Reason.build(element), toast, target, ...scene.tags.map((tag) => put(element("div", "tag", Art.tag(tag.rows)), tag.area)));
    const flash = element("div", "flash");
    if (scene.flash) {
      const tag = scene.tags[2] ? scene.tags[2].area : [0.99, 0.98, 0, 0];
      root.append(put(flash, [tag[0] - 0.033, 1 - 0.0267 * Number(scene.display_m[0] / scene.display_m[1]) * 0.9375 - 0.004, 0.025, 0.025 * (scene.display_m[0] / scene.display_m[1])]));
    }
    parts = { kitchen, robots, goOn, locations, storages, recipe, sheet, toast, flash, target, free, cards };
    mark({});
  }

  function contentOf(what, isOrder) {
    if (what === "empty") return isOrder ? [`<span class="none">–</span>`, "empty"] : ["", "empty"];
    if (what === "served") return [`<span class="done">✓</span>`, "served"];
    if (what.item) return [Art.item(scene, what.item), "item"];
    if (what.stack) return [Art.stack(scene, what.stack), "stack"];
    return [Art.dish(scene, what.dish), "dish"];
  }

  function drawLocation(index, what) {
    const part = parts.locations[index], now = JSON.stringify(what), isOrder = scene.locations[index].kind === "order";
    if (part.drawn === now) return;
    const isNew = part.drawn !== null;
    part.drawn = now;
    if (scene.locations[index].kind === "robot_hand" && scene.arm !== "none") return Robot.hold(what, contentOf);
    const [inside, kind] = contentOf(what, isOrder);
    part.made.dataset.holds = kind;
    part.content.innerHTML = inside;
    part.content.dataset.shown = now;
    if (isOrder) {
      const words = what === "served" ? scene.words.served : what.dish && scene.names === "orders" ? scene.dishes[what.dish].label : "";
      part.content.append(text("span", "dish", words));
      fitWords(part.content);
    }
    if (isNew) replay(part.content, "arrives");
  }

  /** Restarts an animation. */
  function replay(made, className) {
    made.classList.remove(className);
    void made.offsetWidth;
    made.classList.add(className);
  }

  function partOf(spot) {
    return "storage" in spot ? parts.storages[spot.storage] : parts.locations[spot.location];
  }

  /** Shows what the robot throws away; what it held is known from before the press. */
  function drawDiscard({ at, effective }, contents) {
    const spot = scene.locations[at.location], held = shown.contents[at.location];
    if (!effective || !spot || spot.kind !== "robot_hand" || contents[at.location] !== "empty" || !held || held === "empty") return;
    says.news = "discards";
    Robot.discard(held, contentOf, replay);
  }

  /** The button that was pressed last on this page, as it is drawn. */
  const pressedButton = () => root.querySelector(`[data-button="${CSS.escape(Hands.pressed() ?? "")}"]`);

  function drawPresses({ presses, tutorial, contents }) {
    ["human", "robot"].forEach((agent, index) => {
      const now = presses[index], before = shown && shown.presses[index];
      if (!now || !shown || (before && before.number === now.number)) return;
      const { made } = partOf(now.at);
      made.querySelector(".ring").className = `ring ${agent} ${now.effective ? "works" : "fails"}`;
      replay(made.querySelector(".ring"), "pulse");
      if (agent === "robot") return drawDiscard(now, contents);
      if (!now.effective) {
        replay(made, "shakes");
        Sound.play("effectless");
      }
      // The line stands at the button itself, if the page knows which it was.
      const knob = scene.buttons.find(({ name }) => name === Hands.pressed()), isIt = knob && knob.at === (knob.does === "take" ? now.at.storage : now.at.location);
      Reason.draw(Reason.wordsOf(now, tutorial, scene, contents), (isIt && pressedButton()) || made, root, { room, text, put, replay });
    });
  }

  function drawSignal(signal, contents) {
    // A signal about the robot's hand is at the hand, wherever that is.
    const isDrawn = ({ kind }) => kind === "robot_hand" && scene.arm !== "none";
    const hand = scene.locations.findIndex(isDrawn), highlight = signal ? signal.highlight : undefined;
    parts.locations.forEach(({ made }, index) => {
      made.classList.toggle("highlight", highlight === index && index !== hand);
      made.classList.toggle("asked", Boolean(signal && signal.recipe && signal.recipe.order === index));
    });
    Robot.highlight(hand >= 0 && highlight === hand);
    const recipe = signal && signal.recipe, next = signal && signal.next;
    parts.recipe.classList.toggle("open", Boolean(recipe || next));
    parts.recipe.classList.toggle("proposal", Boolean(next));
    if (next) drawProposal(next, contents);
    if (!recipe) return;
    put(parts.recipe, parts.cards[recipe.order]);
    const dish = element("figure", "of", Art.dish(scene, recipe.dish));
    dish.append(text("figcaption", "", scene.dishes[recipe.dish].label));
    const items = recipe.items.map((name) => {
      const made = element("figure", "", Art.item(scene, name));
      made.append(text("figcaption", "", scene.items[name].label));
      return made;
    });
    parts.recipe.replaceChildren(dish, ...items);
    fitWords(parts.recipe);
  }

  /** Shows proposed presses in the largest free area: picture, name and key of each button. */
  function drawProposal(next, contents) {
    put(parts.recipe, parts.free);
    const head = element("figure", "of");
    head.append(text("figcaption", "", scene.words.proposes));
    const presses = next.map((index, place) => {
      const { picture, label } = pictureOf(scene.buttons[index], contents);
      const made = element("figure", "", picture);
      made.append(text("figcaption", "", next.length > 1 ? `${place + 1}. ${label}` : label), key(scene.buttons[index]));
      return made;
    });
    parts.recipe.replaceChildren(head, ...presses);
    fitWords(parts.recipe);
  }

  /** Picture and name of the human's button in a proposal. */
  function pictureOf({ does, at, label }, contents) {
    const named = (what) => scene.words[`proposes ${does}`].replace("#", what);
    if (does === "take") return { picture: Art.item(scene, scene.storages[at].item), label: named(scene.storages[at].label) };
    const spot = scene.locations[at], wanted = contents[at] && contents[at].dish;
    if (does === "serve" && wanted) return { picture: Art.dish(scene, wanted), label: named(scene.dishes[wanted].label) };
    const picture = Art.place(spot.kind === "place" ? spot.look && spot.look.shape : spot.kind, 150, true);
    return { picture, label: does === "use" ? named(spot.label) : label };
  }

  /** Makes the words, or what else has such a size, smaller until no name is broken and none is higher than its line. */
  function fitWords(made, what = "--words", largest = 1) {
    const fits = (said) => said.scrollWidth <= said.clientWidth && said.scrollHeight <= said.parentNode.clientHeight;
    for (let size = largest; size > 0.5; size -= 0.05) {
      made.style.setProperty(what, size);
      if ([...made.querySelectorAll("figcaption, .dish, h1, h2, p")].every(fits) && made.scrollHeight <= made.clientHeight) return;
    }
  }

  function drawIntention(spot) {
    for (const part of [...parts.locations, ...parts.storages]) part.made.classList.remove("intended");
    if (spot) partOf(spot).made.classList.add("intended");
  }

  /** The robot's side says this of the robot; a stop is seen at a glance. */
  function sayOfRobot(does) {
    root.dataset.robot = does;
    parts.robots.querySelector("h2").textContent = scene.words[does ? `robot ${does.replace("_", " ")}` : "robot"];
    parts.goOn.replaceChildren(...(does === "stopped" ? [text("p", "", scene.words["robot go on"])] : []));
    [parts.robots, parts.goOn].forEach((made) => fitWords(made));
  }

  /** Says what the robot has just done, else what it does if it does not simply work; each for a while, but a stop at once. */
  function drawRobot() {
    clearTimeout(says.timer);
    const now = performance.now(), isSlow = shown?.robot_does === "slow";
    says.slowFrom = isSlow ? Math.min(says.slowFrom, now) : Infinity;
    const slowAt = says.slowFrom + SLOW_MS, isBrief = isSlow && now < slowAt, state = (!isBrief && shown?.robot_does) || "";
    if (state === "stopped" || (says.does === says.news && says.until <= now)) says.news = "";
    const does = says.news || state;
    if (says.does !== does && (says.until <= now || says.news || state === "stopped")) {
      Object.assign(says, { does, until: now + (says.news ? TOLD_MS : SAYS_MS) });
      sayOfRobot(does);
    }
    const next = Math.max(says.until, isBrief ? slowAt : 0);
    if (next > now) says.timer = setTimeout(drawRobot, next - now);
  }

  /** What the buttons show of themselves: their keys, their gamepad's buttons, the colours of their caps, or nothing. */
  function badges() {
    if (room.isUpright && !isKeyed) return "";
    if (scene.keys && pad) return "pad";
    if (scene.keys && scene.buttons.some((knob) => knob.key)) return "keys";
    return scene.buttons.some((knob) => knob.colour) ? "colours" : "";
  }

  const BIG = ["welcome", "questionnaire", "thanks", "probe"];
  function drawSheet(sight, left) {
    const { stage, practice } = sight;
    root.dataset.stage = stage;
    const name = practice && stage === "ready" ? "practice" : practice && stage === "over" ? "practice over" : stage.replace("_", " ");
    parts.sheet.className = `sheet ${stage === "running" ? "" : "open"} ${BIG.includes(stage) ? "big" : ""} ${stage}`;
    if (stage === "questionnaire" && sight.question) return Questions.draw(parts.sheet, sight.question, scene.words, { element, text });
    if (sight.tutorial) {
      const { recipe, highlight } = sight.signal || {}, shows = recipe ? parts.cards[recipe.order] : scene.locations[highlight]?.area;
      const area = room.forLesson(shows, sight.tutorial);
      return Tutorial.draw(parts.sheet, sight.tutorial, { scene, area, badges: badges(), element, text, put, partOf, fitWords, contentOf, sayOfRobot, draws: drawContents, contents: sight.contents });
    }
    Tutorial.end();
    if (sight.probe) return Probe.draw(parts.sheet, sight.probe, left, { scene, element, text, contentOf });
    Probe.end();
    const card = element("div", "card");
    card.append(text("h1", "", scene.words[name] || ""), text("p", "", scene.words[`${stage === "paused" && wasLost ? "paused lost" : name} text`] || ""));
    if (stage === "over" && sight.served !== null) card.append(text("p", "", `✓ ${scene.words["served count"].replace("#", sight.served)}`));
    if (["welcome", "ready"].includes(stage)) card.append(Readiness.build(scene, element));
    // The kitchen is explained during the instruction, so nothing covers it.
    if (stage === "instruction") put(card, parts.free);
    parts.sheet.replaceChildren(card);
    if (stage === "instruction") fitWords(card);
  }

  function drawContents(contents) {
    contents.forEach((what, index) => drawLocation(index, what));
  }

  /** Shows the target of a gaze accuracy check, alone on the screen, so that nothing else attracts the eyes. */
  function drawTarget({ target, checks }) {
    root.classList.toggle("checks", checks);
    const [x, y] = target || [0, 0], is = JSON.stringify(target);
    parts.target.classList.toggle("open", Boolean(target));
    if (target && parts.target.dataset.is !== is) {
      Object.assign(parts.target.style, { left: percent(x), top: percent(y) });
      replay(parts.target, "draws");
    }
    parts.target.dataset.is = is;
  }

  /** A signal as it is spoken. */
  function inWords({ recipe, next, highlight }) {
    if (recipe) return `${scene.dishes[recipe.dish].label}: ${recipe.items.map((name) => scene.items[name].label).join(", ")}.`;
    if (next) return next.length ? `${scene.words.proposes} ${pictureOf(scene.buttons[next[0]], shown.contents).label}` : "";
    return scene.words["says highlight"].replace("#", scene.locations[highlight].label);
  }

  /** Whether a signal is new: sent just now, or explained by another page of the tutorial. */
  const isNewSignal = (sight) => shown && sight.signal && (sight.cue !== shown.cue || (sight.tutorial && JSON.stringify(shown.signal) !== JSON.stringify(sight.signal)));

  /** What the sheet depends on; in the tutorial also presses, since each removes the line that says what is missing. */
  const onSheet = ({ stage, practice, question, tutorial, probe, presses }) => [stage, practice, question, tutorial, probe, tutorial && presses];

  /** What a line is said in: it goes with the phase, the question, the robot's stop. */
  const saidIn = ({ stage, checks, question, probe, robot_does }) => [stage, checks, question?.title, question?.item, probe?.probe, probe?.question, robot_does === "stopped"].join("/");

  /** `left` tells the seconds that a probe or the trial still has. */
  function show(sight, left = () => 0) {
    if (!scene) return;
    timeLeft = left;
    wasLost = wasLost && sight.stage === "paused";
    if (isNewSignal(sight)) {
      Sound.play("signal");
      Sound.say(inWords(sight.signal));
    } else if (shown && shown.signal && !sight.signal) Sound.say("");
    // During a freeze probe the program sends no contents; afterwards the kitchen is as it was.
    drawContents(sight.contents);
    if (!shown || JSON.stringify(shown.signal) !== JSON.stringify(sight.signal)) {
      drawSignal(sight.signal, sight.contents);
      Reason.move();
    }
    drawPresses(sight);
    if (shown && saidIn(shown) !== saidIn(sight)) Reason.hide();
    drawIntention(sight.intention);
    if (!shown || JSON.stringify(onSheet(shown)) !== JSON.stringify(onSheet(sight))) drawSheet(sight, left);
    drawTarget(sight);
    Status.draw(sight, left, scene.words);
    if (shown && shown.robot_does === "stopped" && sight.robot_does !== "stopped" && sight.stage === "running") says.news = "goes_on";
    shown = sight;
    drawRobot();
  }

  /** Flashes the square by which an external video is synchronised. */
  function flash() {
    if (parts) replay(parts.flash, "on");
  }

  /** Shows whether the connection works, and whether this page takes part. */
  function mark(change) {
    // A trial that is paused when the connection is back stands still for that.
    wasLost = wasLost || Boolean(change.lost && shown && shown.stage !== "paused");
    marks = { ...marks, ...change };
    root.classList.toggle("lost", marks.lost);
    if (!parts) return;
    const role = marks.acts || marks.watches ? "" : marks.free ? scene.words.free : scene.words.watches;
    const isLost = marks.lost && !marks.ended;
    // The end is told once.
    const isTold = parts.sheet.textContent.includes(scene.words.ended), line = marks.ended ? (isTold ? "" : scene.words.ended) : role;
    parts.toast.replaceChildren(...(isLost ? [text("b", "", scene.words.lost), text("span", "", scene.words["lost text"])] : [line]));
    parts.toast.className = `toast ${isLost ? "open says-lost" : parts.toast.textContent ? "open" : ""}`;
  }

  // What is to be pressed or answered now, or what goes on.
  const DOES = ".hinted, .scale, .slider, .options, .number, textarea, .choosing, .probing .choices, .lesson .choices, .lesson .next, .turns .confirm";

  /** Says something that is about no place, with `what` for its "#": near what can be done, in a trial where other texts open; nothing takes back what was said. */
  function say(name, what = "") {
    if (!shown || !marks.acts) return undefined;
    if (!name) return Reason.hide();
    const does = [...root.querySelectorAll(DOES)].find((made) => made.checkVisibility({ visibilityProperty: true }));
    return Reason.say(scene.words[name].replace("#", what), does, shown.stage === "running" ? parts.free : undefined, root, { room, put, replay, text });
  }

  /** What was pressed does nothing, or, where it is one of the kitchen's buttons, nothing yet. */
  function sayNothing(isButton) {
    const stage = shown && shown.stage, name = isButton && ["welcome", "instruction", "ready"].includes(stage) ? "nothing yet" : isButton && stage === "paused" ? "paused text" : "nothing";
    const button = name === "nothing yet" && marks.acts ? pressedButton() : null;
    if (!button?.checkVisibility({ visibilityProperty: true })) return say(name);
    return Reason.draw(scene.words[name], button, root, { room, text, put, replay });
  }

  /** A press without a connection has no effect, and the page says so once more. */
  function refuse() {
    if (parts) replay(parts.toast, "refuses");
    Sound.play("effectless");
  }

  /** Receives the texts of the page, which arrive before anything else. */
  function greet(next) {
    words = next;
    if (scene) return;
    shape();
    const card = element("div", "card");
    card.append(text("h1", "", words.welcome), text("p", "", words["welcome text"]));
    root.replaceChildren(element("div", "sheet open big", card));
  }

  /**
   * Asks for the pairing code; the next attempt is possible after `waitS` seconds. Typed text is kept when the
   * connection comes back.
   */
  function askCode(why, waitS, then) {
    const typed = why === "code" && root.querySelector("form input")?.value;
    told = scene = shown = parts = null;
    shape();
    const card = element("form", "card");
    const field = element("input", "");
    Object.assign(field, { maxLength: 12, autocomplete: "off", spellcheck: false, autofocus: true, value: typed || "" });
    field.setAttribute("aria-label", words.pairing);
    const hints = { code: [words["pairing text"]], wrong: [words["pairing wrong"]], locked: [words["pairing locked"]] };
    if (waitS) hints[why].push(words["pairing wait"].replace("#", waitS));
    card.append(text("h1", "", words.pairing), field, text("p", why === "code" ? "" : "wrong", hints[why].join(" ")));
    // Codes sent before the waiting time is over would not be checked.
    const from = performance.now() + 1000 * waitS;
    card.addEventListener("submit", (event) => {
      event.preventDefault();
      field.disabled = true;
      setTimeout(() => then(field.value), Math.max(0, from - performance.now()));
    });
    const sheet = element("div", "sheet open big", card);
    root.replaceChildren(sheet);
    field.focus();
  }

  /** Converts a point of the window to fractions of the stage. */
  function point(x, y) {
    const box = root.getBoundingClientRect();
    return [(x - box.left) / box.width, (y - box.top) / box.height];
  }

  return { build, show, resize, flash, mark, refuse, say, sayNothing, label, useBadges, greet, askCode, point, replay, isUpright, scene: () => scene, shown: () => shown, asks: () => Boolean(shown && shown.probe) || Tutorial.practises() };
})();
