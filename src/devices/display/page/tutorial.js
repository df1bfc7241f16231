"use strict";
/** The tutorial: one card per step, frames around what the step explains, and a mark at the button to be pressed. */
const Tutorial = (() => {
  // What a page with presses can say of them.
  const PRESSED = ["tutorial first press", "tutorial right", "tutorial again"], ASKED = ["tutorial first question", "tutorial other answer"], TICK_MS = 250;
  // How much larger than usual recipe cards and their pictures may be where there is room, step by step.
  const LARGEST = [["--pictures", 1.6], ["--cards", 1.3], ["--pictures", 2.2]];
  const PRACTISED = ["tutorial right", "tutorial probe wrong"];
  // A press of the robot: the way there, the press, and the rest after it; the hand is down at the end of its way.
  const WAY_MS = 1600, REST_MS = 700, DOWN_FROM = 0.8, FRAME_MS = 33;
  // What the robot's side can say, and how long each is shown.
  const SAYINGS = ["waits_human", "waits_order", "waits", "slow", "stopped"], SAYING_MS = 2500;
  let mover = 0, sayer = 0, rested = null;
  // Steps in which the robot showed all of it once, and the one in which it does so for the first time.
  const watched = new Set();
  let showing = null;
  // How much of it was shown, and how much there is.
  let seen = [0, 0];
  // Whether the question of a probe is practised now.
  let tries = false;
  let timer = 0, ticker = 0, hinter = 0, shownStep = "", endsAt = 0, told = () => {}, marked = [], drawn = null;
  // The choice that arrows or a gamepad are at, counted from 1; 0: none yet.
  let at = 0;

  function clearMarks() {
    for (const made of marked) made.classList.remove("framed", "hinted");
    marked = [];
  }

  function mark(made, className) {
    if (!made) return;
    made.classList.add(className);
    marked.push(made);
  }

  const buttonOf = (name) => document.querySelector(`[data-button="${CSS.escape(name)}"]`);

  /** Frames what the step explains, and marks the next button, at once or after a while. */
  function point(page, partOf, isAsked) {
    clearMarks();
    clearTimeout(hinter);
    for (const frame of page.frames) {
      if (frame.area) mark(document.querySelector(`.zone.${frame.area}`), "framed");
      else if (frame.place) mark(partOf(frame.place).made, "framed");
      else mark(buttonOf(frame.button), "framed");
    }
    if (!page.hint) return;
    const { button, after_s } = page.hint;
    if (after_s === 0 || isAsked) mark(buttonOf(button), "hinted");
    else hinter = setTimeout(() => mark(buttonOf(button), "hinted"), 1000 * after_s);
  }

  /** Shows the remaining time of the recipe cards as a bar and in seconds; at its end the program is told. */
  function count(page, bar, words) {
    clearTimeout(timer);
    clearInterval(ticker);
    if (page.seconds === null) return;
    if (shownStep !== page.step) endsAt = performance.now() + 1000 * page.left_s;
    const left = Math.max(0, endsAt - performance.now()), [line, seconds] = bar.children;
    line.animate([{ width: `${left / page.seconds / 10}%` }, { width: "0%" }], { duration: left, fill: "forwards" });
    const tick = () => { seconds.textContent = words.seconds.replace("#", Math.max(0, Math.ceil((endsAt - performance.now()) / 1000))); };
    tick();
    ticker = setInterval(tick, TICK_MS);
    timer = setTimeout(() => told({ kind: "cards_shown", step: page.step }), left);
  }

  /** Begins the question of a probe; `late`: its time went by before. */
  function practise(late) {
    const { sheet, page, kit } = drawn, ends = performance.now() + 1000 * page.probe.limit_s;
    tries = true;
    clearMarks();
    Reason.hide();
    sheet.classList.add("shaded");
    const take = (choice) => {
      if (choice === null) return practise(true);
      tries = false;
      draw(sheet, page, kit);
      return told({ kind: "choose", step: page.step, choice });
    };
    Probe.draw(sheet, { ...page.probe, late, practise: take }, () => (ends - performance.now()) / 1000, kit);
  }

  /** Ends what the robot shows, with the hand where it was before. */
  function rest() {
    clearInterval(mover);
    clearInterval(sayer);
    if (sayer) drawn.kit.sayOfRobot("");
    sayer = 0;
    document.getElementById("stage").classList.remove("moves");
    if (rested) Robot.move(rested);
    rested = showing = null;
  }

  /** Whether one can go on: what the robot shows must have been shown once. */
  const isDone = ({ done, step }) => done && showing !== step;

  /** The robot begins to show something, which has so many parts. */
  function begins({ step }, parts) {
    if (!watched.has(step)) [showing, seen] = [step, [0, parts]];
  }

  /** It showed so many parts of it: the card says so, and at the end one can go on. */
  function watch(page, parts) {
    if (parts === seen[1]) return finish(page);
    seen[0] = parts;
    const line = showing && document.querySelector(".lesson .verdict.line");
    if (line) line.textContent = wordsOf("tutorial first robot", drawn.kit.scene.words);
    return undefined;
  }

  /** It showed all of it once: one can go on. */
  function finish({ step }) {
    watched.add(step);
    if (showing !== step) return;
    showing = null;
    draw(drawn.sheet, drawn.page, drawn.kit);
  }

  /** Lets the robot's hand press one button after another, from the beginning again when all are pressed; or its side say one thing after another. */
  function demonstrate(page, kit) {
    const { kind, robot } = page, before = rested || Robot.pose();
    rest();
    if (kind === "robot_says") {
      let said = 0;
      const say = () => {
        kit.sayOfRobot(SAYINGS[said++ % SAYINGS.length]);
        watch(page, said);
      };
      begins(page, SAYINGS.length);
      say();
      sayer = setInterval(say, SAYING_MS);
    }
    if (!robot.length || !before) return;
    rested = before;
    begins(page, robot.length);
    document.getElementById("stage").classList.add("moves");
    const start = performance.now();
    let pressed = -1;
    mover = setInterval(() => {
      const passed = performance.now() - start, turn = Math.floor(passed / (WAY_MS + REST_MS)), nth = turn % robot.length;
      const share = Math.min(1, (passed % (WAY_MS + REST_MS)) / WAY_MS), along = Math.min(1, share / DOWN_FROM), eased = along * along * (3 - 2 * along);
      const from = turn ? robot.at(nth - 1).to : [before.x, before.y], { to } = robot[nth];
      Robot.move({ ...before, x: from[0] + (to[0] - from[0]) * eased, y: from[1] + (to[1] - from[1]) * eased, down: Math.max(0, (share - DOWN_FROM) / (1 - DOWN_FROM)) });
      const now = nth + (share === 1 ? 1 : 0);
      if (now !== pressed) kit.draws(now ? robot[now - 1].contents : kit.contents);
      pressed = now;
      watch(page, turn < robot.length ? now : robot.length);
    }, FRAME_MS);
  }

  function cardsOf(page, scene, element, text) {
    const all = element("div", "dishes"), many = page.cards.length;
    // At most four beside one another, and rows of one length.
    all.style.setProperty("--columns", Math.ceil(many / Math.ceil(many / 4)));
    for (const { dish, items } of page.cards) {
      const made = element("div", "dish-card"), head = element("figure", "of", Art.dish(scene, dish)), row = element("div", "parts");
      head.append(text("figcaption", "", scene.dishes[dish].label));
      for (const name of items) {
        const part = element("figure", "", Art.item(scene, name));
        part.append(text("figcaption", "", scene.items[name].label));
        row.append(part);
      }
      made.append(head, row);
      all.append(made);
    }
    return all;
  }

  /** What is said of a wrong answer. */
  const wrongOf = (words, explanation) => `${words["tutorial wrong"]} ${explanation || ""}`;

  function questionOf({ choices, wrong, right, explanation }, words, element, text) {
    const all = element("div", "choices");
    choices.forEach((choice, index) => {
      const state = right === index + 1 ? "right" : wrong === index + 1 ? "wrong" : "";
      const made = element("button", state);
      made.append(text("b", "", index + 1), text("span", "", choice));
      made.dataset.choose = index + 1;
      made.classList.toggle("at", right === null && at === index + 1);
      all.append(made);
    });
    const made = element("div", "", all), isRight = right !== null;
    made.append(text("p", `verdict ${isRight ? "right" : "wrong"}`, isRight ? words["tutorial right"] : wrong === null ? "" : wrongOf(words, explanation)));
    return made;
  }

  /** A line of the card; the one about what the robot shows has its count. */
  const wordsOf = (line, words) => (line === "tutorial first robot" ? words[line].replace("#", seen[0]).replace("#", seen[1]) : words[line] || "");

  /** What was done, or what is still to be done, and the class of the line that says it. `isAsked`: the participant tried to go on before that. */
  function verdictOf(page, isAsked) {
    if (page.kind === "probe") return page.missed ? ["tutorial probe wrong", "wrong"] : page.done ? ["tutorial right", "right"] : ["", ""];
    const all = page.presses && page.presses[0] === page.presses[1];
    if (isAsked && page.question && page.question.wrong !== null) return ["tutorial other answer", "wrong"];
    if (showing) return ["tutorial first robot", isAsked ? "wrong" : ""];
    if (isAsked) return [`tutorial first ${page.presses ? "press" : page.question ? "question" : "recipes"}`, "wrong"];
    if (all) return ["tutorial right", "right"];
    return page.presses && page.done ? ["tutorial again", ""] : ["", ""];
  }

  /** How a button is pressed: by the sign on it, or by touch. */
  function howOf(words, badges) {
    if (!badges) return words["tutorial touch"];
    const shown = words[`tutorial ${badges}`];
    return navigator.maxTouchPoints ? `${shown} ${words["tutorial touch too"]}` : shown;
  }

  function pressesOf({ presses }, element) {
    const dots = element("div", "dots");
    for (let press = 0; press < presses[1]; press += 1) dots.append(element("i", press < presses[0] ? "done" : ""));
    return dots;
  }

  /** The buttons that turn the page; the one that goes on looks closed until the step is done. */
  function turnsOf(page, words, element, text) {
    const row = element("div", "row");
    const button = (turn, label, key, isOpen) => {
      const made = Questions.sign(text("button", turn, label), key);
      made.dataset.turn = turn;
      if (!isOpen) made.setAttribute("aria-disabled", "true");
      row.append(made);
    };
    if (page.number > 1) button("back", words.back, "←", true);
    const onward = page.number === page.of ? words["tutorial end"] : words.next;
    button("next", page.probe ? words["tutorial try"] : onward, "↵", isDone(page) || page.probe);
    return row;
  }

  /** The longest texts that the lines of the card can have until the step is done, line by line. */
  function longestOf({ kind, presses, question }, words) {
    const longest = (names) => names.map((name) => words[name]).reduce((a, b) => (b.length > a.length ? b : a));
    // The explanation is not known before it is needed; its length is. Few letters are as wide as these, and few words as long, which leave lines unfilled.
    if (question) return [wrongOf(words, "nnnnnnnnnnn ".repeat(Math.ceil(question.explanation_length / 10))), longest(ASKED)];
    if (kind === "probe") return [longest(PRACTISED)];
    if (kind.startsWith("robot")) return [words["tutorial first robot"]];
    return presses ? [longest(PRESSED)] : [];
  }

  /** Puts the card into its area, with words as small as it needs, and keeps room for what it can say until the step is done: nothing that can be touched moves then. */
  function fit(card, isLarge, page, { scene, area, put, fitWords }) {
    const lines = [...card.querySelectorAll(".verdict")], said = lines.map((line) => line.textContent), longest = longestOf(page, scene.words);
    longest.forEach((words, at) => { lines[at].textContent = words; });
    fitWords(isLarge ? card : put(card, area));
    if (page.cards.length) for (const [what, largest] of LARGEST) fitWords(card, what, largest);
    longest.forEach((_, at) => {
      lines[at].classList.add("kept");
      lines[at].style.minHeight = `${lines[at].offsetHeight / parseFloat(getComputedStyle(lines[at]).fontSize)}em`;
    });
    lines.forEach((line, at) => { line.textContent = said[at]; });
  }

  /** Hides what the card would cut, with its name and buttons; what is marked stays. */
  function cover(card) {
    const over = card.getBoundingClientRect();
    const isCut = (made) => [made, ...made.children].map((part) => part.getBoundingClientRect()).some(({ left, right, top, bottom }) => left < over.right && over.left < right && top < over.bottom && over.top < bottom);
    for (const made of document.querySelectorAll(".spot, .shelf, .pill")) made.classList.toggle("covered", !made.matches(".framed, .hinted, .highlight") && isCut(made));
  }

  /** Whether the time of the recipe cards is over, so that the page has none. */
  const isTimeOver = ({ kind, cards }) => kind === "recipes" && !cards.length;

  /** Draws the card of the step: in the free place of the kitchen, or large where the kitchen does not matter. */
  function draw(sheet, page, kit, isAsked = false) {
    const { scene, badges, element, text, partOf } = kit, words = scene.words, isLarge = page.kind === "recipes" || page.kind === "question";
    if (shownStep !== page.step) [at, tries] = [0, false];
    drawn = { sheet, page, kit };
    if (tries && page.probe) return practise(false);
    Probe.end();
    if (shownStep !== page.step) demonstrate(page, kit);
    const card = element("div", `card lesson ${isLarge ? "large" : ""}`), bar = element("div", "left", "<i></i>");
    bar.append(text("span", "", words.seconds.replace("#", page.seconds)));
    card.append(text("p", "count", `${page.number} / ${page.of}`), text("h2", "", page.title), text("p", "says", isTimeOver(page) ? words["tutorial recipes over"] : page.text));
    if (page.number === 1) card.append(text("p", "says how", words[navigator.maxTouchPoints ? "tutorial turn" : "tutorial turn keys"]));
    if (page.explains_buttons) card.append(text("p", "says how", howOf(words, badges)));
    if (page.cards.length) card.append(cardsOf(page, scene, element, text));
    if (page.seconds !== null) card.append(bar);
    if (page.question) card.append(questionOf(page.question, words, element, text));
    if (page.presses) card.append(pressesOf(page, element));
    const [verdict, kind] = verdictOf(page, isAsked);
    card.append(text("p", `verdict line ${kind}`, wordsOf(verdict, words)), turnsOf(page, words, element, text));
    sheet.classList.toggle("shaded", isLarge);
    sheet.replaceChildren(card);
    fit(card, isLarge, page, kit);
    count(page, bar, words);
    point(page, partOf, isAsked);
    cover(card);
    shownStep = page.step;
    return undefined;
  }

  function end() {
    rest();
    tries = false;
    clearMarks();
    clearTimeout(timer);
    clearInterval(ticker);
    clearTimeout(hinter);
    watched.clear();
    shownStep = "";
  }

  const isOpen = ({ question }) => question && question.right === null;

  /** What a key means here: the page's message, if it means anything. */
  function meant(key, page) {
    const choice = !isOpen(page) ? 0 : /^[1-9]$/.test(key) ? Number(key) : key === "Enter" ? at : 0;
    if (choice && choice <= page.question.choices.length) return { kind: "choose", step: page.step, choice };
    if (["ArrowRight", "Enter"].includes(key) && isDone(page)) return { kind: "turn", step: page.step, forward: true };
    if (["ArrowLeft", "Backspace"].includes(key) && page.number > 1) return { kind: "turn", step: page.step, forward: false };
    return null;
  }

  /** Goes to the choice above or below. */
  function go(by, { question }) {
    at = at ? Math.min(question.choices.length, Math.max(1, at + by)) : 1;
    document.querySelectorAll("[data-choose]").forEach((made, index) => made.classList.toggle("at", at === index + 1));
    return true;
  }

  /** Whether a key means something here; it is told once, however long it is held. */
  function key(pressed, page, isHeld) {
    const by = { ArrowUp: -1, ArrowDown: 1 }[pressed];
    if (by && isOpen(page)) return go(by, page);
    if (page.probe && ["ArrowRight", "Enter"].includes(pressed)) return isHeld || practise(false) || true;
    const message = meant(pressed, page);
    if (message && !isHeld) told(message);
    return Boolean(message);
  }

  /** Says what is missing, if a key that goes on is pressed before the step is done; whether it was such a key. */
  function refuse(pressed, page) {
    const goesOn = ["ArrowRight", "Enter"].includes(pressed) && !isDone(page) && !page.probe;
    if (goesOn) {
      // One message at a time.
      Reason.hide();
      draw(drawn.sheet, page, drawn.kit, true);
    }
    return goesOn;
  }

  /** The same for a button of a gamepad. As long as presses are asked for, all its buttons are those of the kitchen. */
  const pad = (pressed, page) => (!page.presses || page.done) && (key(pressed, page, false) || refuse(pressed, page));

  function touch({ choose, turn }, page) {
    if (turn === "next" && page.probe) return practise(false);
    if (turn === "next" && refuse("ArrowRight", page)) return undefined;
    return told(choose ? { kind: "choose", step: page.step, choice: Number(choose) } : { kind: "turn", step: page.step, forward: turn === "next" });
  }

  const practises = () => tries;

  return { draw, end, practises, buttonOf, key, refuse, pad, touch, begin: (tell) => { told = tell; } };
})();
