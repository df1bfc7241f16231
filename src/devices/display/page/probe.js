"use strict";
/**
 * A freeze probe: questions one after another on the blanked display, answered by touch, mouse, keys or gamepad; then a
 * count-down.
 */
const Probe = (() => {
  // Lengths in hundredths of the stage's width: gap between choices, their frames (of recipes: AROUND), size of words
  // that can still be read from a distance, height of a row, and size of a recipe's pictures.
  const BETWEEN = 0.8, WITHIN = 0.9, AROUND = 2.4, READ = 1.38, HIGHEST = 17, LARGEST = 4.4;
  // An answer counts as lost if no new state follows within this time: then it can be given again.
  const UNHEARD_MS = 2000;
  // In the last seconds of a question its bar says that the time ends.
  const ENDS_S = 3;
  let tell = () => {}, key = "", shown = null, parts = null, timer = 0;
  // Number of the choice that is selected but not sent yet. `waits`: the participant's confidence has to be given first.
  let chosen = null, waits = false, isTold = false;

  const ruler = document.createElement("canvas").getContext("2d");

  /** Width of the longest word, in the smallest size that is easy to read. */
  function longest(all) {
    ruler.font = `600 100px ${getComputedStyle(document.body).fontFamily}`;
    return READ * Math.max(...all.flatMap((text) => text.split(/\s+/)).map((word) => ruler.measureText(word).width / 100));
  }

  /** Arranges the choices in the number of columns that gives the largest pictures. */
  function arrange(list, choices, scene) {
    const em = parseFloat(getComputedStyle(list).fontSize), room = [list.clientWidth / em, list.clientHeight / em];
    const recipes = choices.map(({ shows }) => shows && shows.recipe).filter(Boolean), items = Math.max(0, ...recipes.map((of) => of.length));
    const words = longest(items ? recipes.flat().map((name) => scene.items[name].label) : choices.map((choice) => choice.words));
    let best = { columns: 1, size: 0, beside: false };
    for (let columns = 1; columns <= choices.length; columns += 1) {
      const wide = (room[0] - BETWEEN * (columns - 1)) / columns, rows = Math.ceil(choices.length / columns);
      const high = (room[1] - BETWEEN * (rows - 1)) / rows, rest = wide - words;
      // Pictures stand above two lines of words, or beside them; a recipe's items are below one another, each beside
      // its words.
      const sizes = items ? [0, Math.min(LARGEST, (high - AROUND) / items - 0.4, rest - AROUND - 1)]
        : [rest < WITHIN ? 0 : Math.min(high - WITHIN - 3.4, HIGHEST - 4.3, wide - WITHIN), Math.min(high - WITHIN, rest - 2.4, HIGHEST / 2)];
      sizes.forEach((size, beside) => {
        // Among equal picture sizes, few rows are preferred; for recipes few columns, which leave more room for words.
        if (size > best.size + (items || beside ? 0.01 : -0.01)) best = { columns, size, beside: Boolean(beside && !items) };
      });
    }
    // With the same number of rows, choices are distributed evenly.
    list.style.setProperty("--columns", Math.ceil(choices.length / Math.ceil(choices.length / best.columns)));
    list.style.setProperty("--part", `${Math.max(1, best.size).toFixed(2)}em`);
    list.classList.toggle("beside", best.beside);
  }

  /** Picture of a choice: a content, a place, nothing, or what is not shown. */
  function pictureOf(shows, { scene, contentOf }) {
    if (!shows) return `<span class="other">…</span>`;
    if (shows === "empty") return `<span class="nothing"></span>`;
    if (shows === "trash") return Art.TRASH;
    // The orders as they stand side by side, this one marked.
    const orders = scene.locations.filter((spot) => spot.kind === "order").map((_, at) => `<i class="${at === shows.order ? "this" : ""}">${at === shows.order ? at + 1 : ""}</i>`);
    if (shows.order !== undefined) return `<span class="order-sign">${orders.join("")}</span>`;
    if (shows.location !== undefined) {
      const { look, kind } = scene.locations[shows.location];
      return Art.place(kind === "place" ? look && look.shape : kind, 130);
    }
    if (shows.storage !== undefined) return Art.item(scene, scene.storages[shows.storage].item);
    return contentOf(shows, false)[0];
  }

  function cardOf(items, { scene, element, text }) {
    const made = element("span", "parts");
    for (const name of items) {
      const part = element("span", "part", Art.item(scene, name));
      part.append(text("span", "words", scene.items[name].label));
      made.append(part);
    }
    return made;
  }

  function choiceOf(choice, kit) {
    const made = kit.element("button", "choice");
    made.dataset.believe = choice.number;
    if (choice.shows && choice.shows.recipe) {
      made.append(cardOf(choice.shows.recipe, kit));
    } else {
      made.append(kit.element("span", "picture", pictureOf(choice.shows, kit)), kit.text("span", "words", choice.words));
    }
    return made;
  }

  /** Picture of what the question is about, beside the question. */
  const subjectOf = (about, kit) => kit.element("span", "subject", pictureOf(about, kit));

  /** Draws the question, or the text before the first and after the last question; `practise`, in a tutorial, takes the answer, or null when the time is over. */
  function draw(sheet, probe, left, kit) {
    const { element, text, scene } = kit, words = scene.words, now = `${probe.probe}/${probe.question}/${probe.closed}`;
    // What the keys are at stays through a state that changes nothing of the question.
    const at = now === key && parts ? parts.all.querySelector(".at") : null;
    if (now !== key) [key, chosen, waits, isTold] = [now, null, false, false];
    shown = probe;
    const all = element("div", "probing"), bar = element("div", "left");
    all.setAttribute("role", "group");
    parts = { all, buttons: [], kit };
    // Its place is there in any case: what is touched stands where it stood before. Over the next question it passes, since it is not about that one.
    const late = text("p", !probe.late ? "late none" : probe.practise || probe.closed ? "late" : "late passes", probe.practise ? words["tutorial late"] : words["probe late"].replace("#", probe.closed ? probe.of : probe.question - 1));
    if (probe.late) late.setAttribute("role", "alert");
    if (probe.closed) {
      all.append(late, text("p", "goes-on", words["probe goes on"]), text("p", "seconds", ""));
    } else if (!probe.choices.length) {
      all.append(text("h1", "", words.probe), text("p", "says", words["probe text"]));
    } else {
      // Orders stand as they do in the kitchen, not shuffled: their place is what they are known by.
      const orderOf = ({ shows }) => shows?.order ?? scene.locations.length, choices = [...probe.choices].sort((a, b) => orderOf(a) - orderOf(b));
      const head = element("div", "asks"), title = element("div", "title");
      title.append(late, Questions.sign(text("p", "count", words["probe count"].replace("#", probe.question).replace("#", probe.of)), "← ↑ ↓ → ↵"), text("h2", "", probe.text));
      head.append(...(probe.about ? [subjectOf(probe.about, kit)] : []), title);
      const isCards = probe.choices.some(({ shows }) => shows && shows.recipe), list = element("div", isCards ? "choices cards" : "choices");
      list.append(...choices.map((choice) => choiceOf(choice, kit)));
      // The second try of a tutorial has no bar: what is late is not late again.
      all.append(head, list, element("div", "row"), ...(probe.practise && probe.late ? [] : [bar]));
    }
    sheet.replaceChildren(all);
    if (!probe.closed && probe.choices.length) {
      update();
      arrange(all.querySelector(".choices"), probe.choices, scene);
      fit(all);
      if (at) mark(parts.buttons.find((made) => isSame(made, at)));
    }
    run(bar, all.querySelector(".seconds"), left);
  }

  /** Whether a button drawn anew gives the same answer. */
  const isSame = (made, other) => ["believe", "unknown", "sure"].every((name) => made.dataset[name] === other.dataset[name]);

  /** Makes the words of choices and question smaller until they fit. */
  function fit(all) {
    const fits = (made) => made.scrollWidth <= made.clientWidth + 1 && made.scrollHeight <= made.clientHeight + 1;
    for (const [words, places] of [["--asks", ".asks, .title"], ["--words", ".choices, .choice, .choice .words"]]) {
      for (let size = 1; size > 0.5; size -= 0.02) {
        all.style.setProperty(words, size);
        if ([...all.querySelectorAll(places)].every(fits)) break;
      }
    }
    // If the words of one choice need two lines, all choices get room for two lines, so that pictures have one size.
    const isBroken = (made) => made.clientHeight > 1.7 * parseFloat(getComputedStyle(made).fontSize);
    const list = all.querySelector(".choices:not(.cards, .beside)");
    if (list && [...list.querySelectorAll(".words")].some(isBroken)) list.classList.add("two");
  }

  /** Shows the remaining time: as a bar, or as the seconds of the count-down. */
  function run(bar, seconds, left) {
    clearInterval(timer);
    const step = () => {
      const now = Math.max(0, left());
      if (shown.practise && now === 0) return shown.practise(null);
      bar.classList.toggle("ends", now < ENDS_S);
      bar.style.width = `${Math.min(80, (80 * now) / shown.limit_s).toFixed(1)}%`;
      if (seconds) seconds.textContent = Math.max(1, Math.ceil(now - 0.05));
      return undefined;
    };
    timer = setInterval(step, 100);
    step();
  }

  /** Marks the selected choice, and draws the buttons below. */
  function update() {
    const { all, kit } = parts, words = kit.scene.words, row = all.querySelector(".row");
    all.querySelectorAll(".choice").forEach((made, at) => {
      const isChosen = chosen === Number(made.dataset.believe);
      made.classList.toggle("chosen", isChosen);
      made.setAttribute("aria-pressed", isChosen);
      // Digits are those of the buttons below once these are asked for.
      Questions.sign(made, !waits && at < 9 && `${at + 1}`);
    });
    row.replaceChildren();
    const button = (name, value, label) => {
      const made = Questions.sign(kit.text("button", name, label), `${value}`);
      made.dataset[name] = value;
      row.append(made);
    };
    if (waits) {
      row.append(kit.text("span", "how-sure", words["probe sure"]));
      for (const step of [1, 2, 3]) button("sure", step, words[`probe sure ${step}`]);
    } else {
      button("unknown", 0, words["probe unknown"]);
    }
    // What is asked beside the choices stays in its line, between the tags.
    for (let size = 1; size > 0.5; size -= 0.02) {
      row.style.setProperty("--sure", size);
      if (row.scrollWidth <= row.clientWidth + 1) break;
    }
    parts.buttons = [...all.querySelectorAll("button")];
    all.classList.toggle("told", isTold);
  }

  /** Sends the answer: a choice, or null: the participant does not know. */
  function answer(choice, sure) {
    if (shown.practise) return shown.practise(choice ?? 0);
    isTold = true;
    update();
    tell({ kind: "believe", probe: shown.probe, question: shown.question, choice, sure });
    const told = key;
    return setTimeout(() => { if (key === told && isTold) { isTold = false; update(); } }, UNHEARD_MS);
  }

  function choose(number) {
    chosen = number;
    if (!shown.confidence) return answer(chosen, null);
    waits = true;
    return update();
  }

  /** One of the buttons is touched. */
  function touch({ believe, unknown, sure }) {
    if (isTold) return;
    if (believe) choose(Number(believe));
    else if (unknown) answer(null, null);
    else if (sure) answer(chosen, Number(sure));
  }

  function mark(made) {
    for (const other of parts.all.querySelectorAll(".at")) other.classList.remove("at");
    if (made) made.classList.add("at");
  }

  const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

  /** The next button in a direction; distance perpendicular to the direction counts twice. */
  function next(from, [x, y]) {
    const middle = (made) => { const { left, top, width, height } = made.getBoundingClientRect(); return [left + width / 2, top + height / 2]; };
    const [fromX, fromY] = middle(from);
    let best = from, least = Infinity;
    for (const made of parts.buttons) {
      const [atX, atY] = middle(made), ahead = (atX - fromX) * x + (atY - fromY) * y, aside = Math.abs((atX - fromX) * y) + Math.abs((atY - fromY) * x);
      if (ahead > 2 && ahead + 2 * aside < least) [best, least] = [made, ahead + 2 * aside];
    }
    return best;
  }

  /** Where keys begin: behind what was touched, whose answer they would replace. */
  const first = () => parts.all.querySelector(waits ? "[data-sure]" : ".chosen") ?? parts.buttons[0];

  /** A key or a gamepad button is pressed; returns whether it has a meaning here. */
  function press(name, isHeld) {
    const step = STEPS[name], numbered = /^[0-9]$/.test(name) && parts?.buttons.find((made) => made.dataset.key === name);
    if (!step && !numbered && !["Enter", " "].includes(name)) return false;
    if (!shown || shown.closed || !parts.buttons.length || isTold) return true;
    const at = parts.all.querySelector(".at");
    // A digit only selects: it may have been meant for a button of the kitchen. The first key of any kind shows where the keys are.
    if (numbered) mark(numbered);
    else if (step || !at) mark(at && parts.buttons.includes(at) ? next(at, step) : first());
    else if (!isHeld) {
      const { believe } = at.dataset, { className } = at;
      touch(at.dataset);
      // The buttons below have been drawn anew, so the marked one is restored.
      if (!parts.all.querySelector(".at")) mark(believe ? at : parts.buttons.find((made) => className.includes(made.className)));
    }
    return true;
  }

  function end() {
    clearInterval(timer);
    [shown, key] = [null, ""];
  }

  return { draw, end, touch, press, begin: (toTell) => { tell = toTell; } };
})();
