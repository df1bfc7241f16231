"use strict";
/** A freeze probe: one question after the other on the blanked display, answered by touch, mouse, keys or gamepad; then a count-down. */
const Probe = (() => {
  // Room of the choices in hundredths of the stage's width, and the least width of a choice there.
  const ROOM = [84, 32], LEAST = 11.4, BETWEEN = 0.8;
  // An answer that nothing follows for so long was not taken: it can be given again.
  const UNHEARD_MS = 2000;
  let tell = () => {}, key = "", shown = null, parts = null, timer = 0, ends = 0;
  // What is chosen and not told yet: numbers of choices. `waits`: they are to be confirmed by how sure the participant is.
  let chosen = [], waits = false, isTold = false;

  /** The columns in which so many choices have the largest pictures. */
  function columnsFor(count, tall) {
    let best = 1, most = 0;
    for (let columns = 1; columns <= count; columns += 1) {
      const wide = (ROOM[0] - BETWEEN * (columns - 1)) / columns, rows = Math.ceil(count / columns);
      const high = (ROOM[1] - BETWEEN * (rows - 1)) / rows;
      if (columns > 1 && wide < LEAST) break;
      // Recipe cards are as high as their items, other choices as a picture over two lines of words.
      const size = tall ? Math.min(high, wide * 1.4) : Math.min(high - 4, wide * 0.62);
      if (size > most + 0.01) [best, most] = [columns, size];
    }
    return best;
  }

  /** The picture of a choice: what lies there, a place, or nothing. */
  function pictureOf(shows, { scene, contentOf }) {
    if (!shows || shows === "empty") return `<span class="nothing"></span>`;
    if (shows.order !== undefined) return `<span class="order-sign">${Number(shows.order) + 1}</span>`;
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

  /** What the question is about, beside it. */
  function subjectOf(about, kit) {
    const made = kit.element("span", "subject");
    if (about.dish !== undefined) made.innerHTML = Art.dish(kit.scene, about.dish);
    else made.innerHTML = about.robot ? Art.place("robot_hand", 100) : pictureOf(about, kit);
    return made;
  }

  /** Draws the question, or what is shown before the first and after the last one. */
  function draw(sheet, probe, leftS, kit) {
    const { element, text, scene } = kit, words = scene.words, now = `${probe.probe}/${probe.question}/${probe.closed}`;
    if (now !== key) [key, chosen, waits, isTold] = [now, [], false, false];
    shown = probe;
    const all = element("div", "probe"), bar = element("div", "left");
    all.setAttribute("role", "group");
    parts = { all, buttons: [], kit };
    if (probe.closed) {
      all.append(text("p", "goes-on", words["probe goes on"]), text("p", "seconds", ""));
    } else if (!probe.choices.length) {
      all.append(text("h1", "", words.probe), text("p", "says", words["probe text"]));
    } else {
      const head = element("div", "asks"), title = element("div", "title");
      title.append(text("p", "count", words["probe count"].replace("#", probe.question).replace("#", probe.of)), text("h2", "", probe.text));
      head.append(subjectOf(probe.about, kit), title);
      const tall = probe.choices.some(({ shows }) => shows && shows.recipe), list = element("div", tall ? "choices cards" : "choices");
      list.style.setProperty("--columns", columnsFor(probe.choices.length, tall));
      list.append(...probe.choices.map((choice) => choiceOf(choice, kit)));
      if (probe.parts.length) title.append(text("p", "several", words["probe several"]));
      all.append(head, list, element("div", "row"), bar);
    }
    sheet.replaceChildren(all);
    if (!probe.closed && probe.choices.length) { update(); fit(all); }
    run(bar, all.querySelector(".seconds"), leftS);
  }

  /** Makes the words smaller until each stands in its place. */
  function fit(all) {
    const fits = (made) => made.scrollWidth <= made.clientWidth + 1 && made.scrollHeight <= made.clientHeight + 1;
    for (let size = 1; size > 0.5; size -= 0.04) {
      all.style.setProperty("--words", size);
      if (fits(all) && [...all.querySelectorAll(".choice, .choices, .title")].every(fits)) return;
    }
  }

  /** The time that is left: a quiet bar, or the seconds of the count-down. */
  function run(bar, seconds, leftS) {
    clearInterval(timer);
    ends = performance.now() + 1000 * leftS;
    const step = () => {
      const left = Math.max(0, (ends - performance.now()) / 1000);
      bar.style.width = `${Math.min(100, (100 * left) / shown.limit_s).toFixed(1)}%`;
      if (seconds) seconds.textContent = Math.max(1, Math.ceil(left - 0.05));
    };
    step();
    timer = setInterval(step, 100);
  }

  const itemOf = (number) => {
    const { shows } = shown.choices.find((choice) => choice.number === number);
    return shows && shows.item;
  };
  const slotOf = (number) => shown.parts.findIndex((items) => items.includes(itemOf(number)));

  /** Marks what is chosen, and draws the buttons below. */
  function update() {
    const { all, kit } = parts, words = kit.scene.words, row = all.querySelector(".row");
    for (const made of all.querySelectorAll(".choice")) {
      const isChosen = chosen.includes(Number(made.dataset.believe));
      made.classList.toggle("chosen", isChosen);
      made.setAttribute("aria-pressed", isChosen);
    }
    row.replaceChildren();
    const button = (name, value, label, isOpen = true) => {
      const made = kit.text("button", name, label);
      if (isOpen) made.dataset[name] = value;
      else made.disabled = true;
      row.append(made);
    };
    if (waits) {
      row.append(kit.text("span", "how-sure", words["probe sure"]));
      for (const step of [1, 2, 3]) button("sure", step, words[`probe sure ${step}`]);
    } else {
      button("unknown", 0, words["probe unknown"]);
      if (shown.parts.length) button("done", 0, words["probe done"], chosen.length > 0);
    }
    parts.buttons = [...all.querySelectorAll("button:not(:disabled)")];
    all.classList.toggle("told", isTold);
  }

  /** Tells the answer: a choice, items that lie on one another, or that the participant does not know. */
  function answer(numbers, sure) {
    isTold = true;
    update();
    const items = numbers.length > 1 ? numbers.map(itemOf) : [];
    tell({ kind: "believe", probe: shown.probe, question: shown.question, choice: numbers.length === 1 ? numbers[0] : null, items, sure });
    const told = key;
    setTimeout(() => { if (key === told && isTold) { isTold = false; update(); } }, UNHEARD_MS);
  }

  /** A choice is touched. Items of different slots are chosen together, where they can lie on one another. */
  function choose(number) {
    const slot = slotOf(number);
    if (!shown.parts.length) {
      chosen = [number];
      return conclude();
    }
    if (chosen.includes(number)) chosen = chosen.filter((one) => one !== number);
    else if (slot < 0) chosen = [number];
    else chosen = [...chosen.filter((one) => slotOf(one) >= 0 && slotOf(one) !== slot), number];
    waits = false;
    return update();
  }

  function conclude() {
    if (!shown.confidence) return answer(chosen, null);
    waits = true;
    const isByKeys = Boolean(parts.all.querySelector(".at"));
    update();
    if (isByKeys) mark(parts.all.querySelector("[data-sure]"));
    return undefined;
  }

  /** A touch of one of the buttons. */
  function touch({ believe, unknown, done, sure }) {
    if (isTold) return;
    if (believe) choose(Number(believe));
    else if (unknown) answer([], null);
    else if (done && chosen.length) conclude();
    else if (sure) answer(chosen, Number(sure));
  }

  function mark(made) {
    for (const other of parts.all.querySelectorAll(".at")) other.classList.remove("at");
    if (made) made.classList.add("at");
  }

  const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

  /** The button that lies next in a direction: what is off the way counts twice. */
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

  /** A key or a button of a gamepad; whether it means something here. */
  function press(name, isHeld) {
    const step = STEPS[name];
    if (!step && !["Enter", " "].includes(name)) return false;
    if (!shown || shown.closed || !parts.buttons.length || isTold) return true;
    const at = parts.all.querySelector(".at");
    if (step) mark(at && parts.buttons.includes(at) ? next(at, step) : parts.buttons[0]);
    else if (at && !isHeld) {
      const { believe } = at.dataset, { className } = at;
      touch(at.dataset);
      // The buttons below are drawn anew.
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
