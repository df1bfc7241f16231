"use strict";
/** The tutorial: one card per step, frames around what the step explains, and a mark at the button to be pressed. */
const Tutorial = (() => {
  // What a page with presses can say of them.
  const PRESSED = ["tutorial first press", "tutorial right", "tutorial again"], ASKED = ["tutorial first question", "tutorial other answer"], TICK_MS = 250;
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
  function count(page, bar) {
    clearTimeout(timer);
    clearInterval(ticker);
    if (page.seconds === null) return;
    if (shownStep !== page.step) endsAt = performance.now() + 1000 * page.left_s;
    const left = Math.max(0, endsAt - performance.now()), [line, seconds] = bar.children;
    line.animate([{ width: `${left / page.seconds / 10}%` }, { width: "0%" }], { duration: left, fill: "forwards" });
    const tick = () => { seconds.textContent = `${Math.max(0, Math.ceil((endsAt - performance.now()) / 1000))} s`; };
    tick();
    ticker = setInterval(tick, TICK_MS);
    timer = setTimeout(() => told({ kind: "cards_shown", step: page.step }), left);
  }

  function cardsOf(page, scene, element, text) {
    const all = element("div", "dishes");
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

  /** What was done, or what is still to be done, and the class of the line that says it. `isAsked`: the participant tried to go on before that. */
  function verdictOf(page, isAsked) {
    const all = page.presses && page.presses[0] === page.presses[1];
    if (isAsked && page.question && page.question.wrong !== null) return ["tutorial other answer", "wrong"];
    if (isAsked) return [`tutorial first ${page.presses ? "press" : page.question ? "question" : "recipes"}`, "wrong"];
    if (all) return ["tutorial right", "right"];
    return page.presses && page.done ? ["tutorial again", ""] : ["", ""];
  }

  /** How a button is pressed: by what its badge shows, or by touch. */
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
    const button = (turn, label, isOpen) => {
      const made = text("button", turn, label);
      made.dataset.turn = turn;
      if (!isOpen) made.setAttribute("aria-disabled", "true");
      row.append(made);
    };
    if (page.number > 1) button("back", words.back, true);
    button("next", page.number === page.of ? words["tutorial end"] : words.next, page.done);
    return row;
  }

  /** The longest texts that the lines of the card can have until the step is done, line by line. */
  function longestOf({ presses, question }, words) {
    const longest = (names) => names.map((name) => words[name]).reduce((a, b) => (b.length > a.length ? b : a));
    // The explanation is not known before it is needed; its length is. Few letters are as wide as these, and few words as long, which leave lines unfilled.
    if (question) return [wrongOf(words, "nnnnnnnnnnn ".repeat(Math.ceil(question.explanation_length / 10))), longest(ASKED)];
    return presses ? [longest(PRESSED)] : [];
  }

  /** Puts the card into the first of these areas in which its words need not be much smaller, and keeps room for what it can say until the step is done: nothing that can be touched moves then. */
  function fit(card, isLarge, page, { scene, areas, enough, put, fitWords }) {
    const lines = [...card.querySelectorAll(".verdict")], said = lines.map((line) => line.textContent), longest = longestOf(page, scene.words);
    longest.forEach((words, at) => { lines[at].textContent = words; });
    if (isLarge) fitWords(card);
    else areas.some((area) => fitWords(put(card, area)) >= enough);
    longest.forEach((_, at) => {
      lines[at].classList.add("kept");
      lines[at].style.minHeight = `${lines[at].offsetHeight / parseFloat(getComputedStyle(lines[at]).fontSize)}em`;
    });
    lines.forEach((line, at) => { line.textContent = said[at]; });
  }

  /** Whether the time of the recipe cards is over, so that the page has none. */
  const isTimeOver = ({ kind, cards }) => kind === "recipes" && !cards.length;

  /** Draws the card of the step: in the free place of the kitchen, or large where the kitchen does not matter. */
  function draw(sheet, page, kit, isAsked = false) {
    const { scene, badges, element, text, partOf } = kit, words = scene.words, isLarge = page.kind === "recipes" || page.kind === "question";
    if (shownStep !== page.step) at = 0;
    drawn = { sheet, kit };
    const card = element("div", `card lesson ${isLarge ? "large" : ""}`), bar = element("div", "left", "<i></i><span></span>");
    card.append(text("p", "count", `${page.number} / ${page.of}`), text("h2", "", page.title), text("p", "says", isTimeOver(page) ? words["tutorial recipes over"] : page.text));
    if (page.number === 1) card.append(text("p", "says how", words[navigator.maxTouchPoints ? "tutorial turn" : "tutorial turn keys"]));
    if (page.explains_buttons) card.append(text("p", "says how", howOf(words, badges)));
    if (page.cards.length) card.append(cardsOf(page, scene, element, text));
    if (page.seconds !== null) card.append(bar);
    if (page.question) card.append(questionOf(page.question, words, element, text));
    if (page.presses) card.append(pressesOf(page, element));
    const [verdict, kind] = verdictOf(page, isAsked);
    card.append(text("p", `verdict line ${kind}`, words[verdict] || ""), turnsOf(page, words, element, text));
    sheet.classList.toggle("shaded", isLarge);
    sheet.replaceChildren(card);
    fit(card, isLarge, page, kit);
    count(page, bar);
    point(page, partOf, isAsked);
    shownStep = page.step;
  }

  function end() {
    clearMarks();
    clearTimeout(timer);
    clearInterval(ticker);
    clearTimeout(hinter);
    shownStep = "";
  }

  const isOpen = ({ question }) => question && question.right === null;

  /** What a key means here: the page's message, if it means anything. */
  function meant(key, page) {
    const choice = !isOpen(page) ? 0 : /^[1-9]$/.test(key) ? Number(key) : key === "Enter" ? at : 0;
    if (choice && choice <= page.question.choices.length) return { kind: "choose", step: page.step, choice };
    if (["ArrowRight", "Enter"].includes(key) && page.done) return { kind: "turn", step: page.step, forward: true };
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
    const message = meant(pressed, page);
    if (message && !isHeld) told(message);
    return Boolean(message);
  }

  /** Says what is missing, if a key that goes on is pressed before the step is done; whether it was such a key. */
  function refuse(pressed, page) {
    const goesOn = ["ArrowRight", "Enter"].includes(pressed) && !page.done;
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
    if (turn === "next" && refuse("ArrowRight", page)) return;
    told(choose ? { kind: "choose", step: page.step, choice: Number(choose) } : { kind: "turn", step: page.step, forward: turn === "next" });
  }

  return { draw, end, buttonOf, key, refuse, pad, touch, begin: (tell) => { told = tell; } };
})();
