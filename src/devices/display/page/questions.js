"use strict";
/** A questionnaire item, answered by touch, keys, or typed text. */
const Questions = (() => {
  const SLIDER_END = 100;
  // Longest entry of a number that is kept, in signs, and most digits of a number: beyond them it is refused, not cut.
  const LONGEST_ENTRY = 24, MOST_DIGITS = 15;
  // A touch within this time after another item appeared was meant for the item before it.
  const SETTLES_MS = 350;
  // Answer to the present item that is chosen, typed or dragged; `isSkipped`: "No answer" is chosen; `isRefused`: somebody tried to go on with it;
  // `isGiven`: it was sent, and is kept only until another item comes.
  const NONE = { item: null, value: null, isSkipped: false, isRefused: false, isGiven: false };
  let draft = NONE, redraw = () => {}, tell = () => {}, shownItem = "", settled = 0;

  const isOwn = (question) => draft.item === question.item;
  const pending = (question) => (isOwn(question) ? draft.value : null);
  const isSkipped = (question) => (isOwn(question) ? draft.isSkipped : question.skipped);
  const keep = (question, value) => {
    Stage.say("");
    draft = { ...NONE, item: question.item, value };
  };
  const give = (question, answer) => {
    draft = { ...draft, isGiven: true };
    tell({ kind: "answer", item: question.item, answer });
  };

  /** Marks what was chosen; going on gives it. */
  function mark(question, answer) {
    keep(question, answer);
    redraw();
  }

  /** Chooses "No answer"; what was typed stays to be seen until the participant goes on. */
  function skip(question) {
    draft = { ...NONE, item: question.item, value: pending(question), isSkipped: true };
    redraw();
  }

  function draw(sheet, question, words, kit) {
    const { element, text } = kit;
    // Text that is being typed is kept when the item is drawn again.
    redraw = () => draw(sheet, question, words, kit);
    settle(question, sheet);
    const isConsent = question.form && question.form.kind === "consent";
    const card = element("div", isConsent ? "card question consents" : "card question");
    const title = text("h2", "", question.title), kind = question.form?.kind;
    card.append(title);
    if (isConsent) {
      card.append(...FORMS.consent(question, words, kit));
      sheet.replaceChildren(card);
      const reading = card.querySelector(".reading");
      return sign(title, reading.scrollHeight > reading.clientHeight && "↑ ↓");
    }
    if (question.item) {
      card.append(text("p", "count", `${question.number} / ${question.of}`), text("p", "item", question.text));
      if (question.form) card.append(...FORMS[question.form.kind](question, words, kit));
    } else {
      const how = text("p", "hint", words.review);
      how.dataset.also = words["review keys"];
      card.append(text("p", "item done", question.text), how);
      const given = element("ol", question.given.length > 6 ? "given small" : "given");
      given.style.setProperty("--rows", Math.ceil(question.given.length / 2));
      for (const { item, text: asked, answer, form, point } of question.given) {
        const line = element("li", ""), row = element("button", "");
        row.dataset.review = item;
        row.append(text("span", "", asked), pointOf(form, point, kit) || text("b", answer === null ? "none" : "", answer ?? words.skip));
        line.append(row);
        given.append(line);
      }
      card.append(given);
    }
    // Each button has its place, whatever others there are: a second touch of one never meets another.
    const row = element("div", "turns");
    const button = (does, label, key, isOpen = true) => {
      const made = sign(text("button", does, label), key);
      [made.dataset.does] = does.split(" ");
      opens(made, isOpen);
      row.append(made);
    };
    if (question.before) button("back", words.back, kind === "slider" ? "⌫" : kind !== "text" && "←");
    if (question.item) button(isSkipped(question) ? "skip chosen" : "skip", words.skip, ["scale", "choice"].includes(kind) ? "0" : skipKey(question, words));
    if (question.item) button("next", words.next, "↵", isSkipped(question) || isComplete(question));
    else button("confirm", words.confirm, "↵");
    card.append(row);
    sheet.replaceChildren(card);
    const field = card.querySelector("textarea");
    if (field) { field.focus(); field.setSelectionRange(field.value.length, field.value.length); }
  }

  /** A given point of a scale or slider, on its line between the words of its two ends; nothing for other answers. */
  function pointOf(form, point, { element, text }) {
    if (point === null || !["scale", "slider"].includes(form?.kind)) return null;
    const made = element("b", "point"), line = element("u", ""), of = form.kind === "scale" ? form.points - 1 : SLIDER_END;
    if (form.kind === "scale") for (let at = 0; at <= of; at += 1) line.append(Object.assign(element("i", ""), { style: `left: ${(100 * at) / of}%` }));
    line.append(Object.assign(text("em", "", form.kind === "scale" ? point : ""), { style: `left: ${(100 * (form.kind === "scale" ? point - 1 : point)) / of}%` }));
    made.append(text("span", "", form.low), line, text("span", "", form.high));
    made.setAttribute("aria-label", `${form.low}, ${form.high}: ${point}`);
    made.setAttribute("role", "img");
    return made;
  }

  /** Another item takes touches once the participant can have seen it. */
  function settle({ item, title }, sheet) {
    const now = `${title}/${item}`;
    if (now === shownItem) return;
    if (draft.isGiven) draft = NONE;
    [shownItem, settled] = [now, performance.now() + SETTLES_MS];
    sheet.dataset.settles = "";
    setTimeout(() => { if (shownItem === now) delete sheet.dataset.settles; }, SETTLES_MS);
  }

  /** Shows the key that does the same, if there is one, where keys are used. */
  function sign(made, key) {
    if (key) made.dataset.key = key;
    else delete made.dataset.key;
    return made;
  }

  /** The delete key leaves an item out, but not where it deletes typed text. */
  const skipKey = (question, words) => (question.form?.kind === "text" && (pending(question) ?? question.answer) ? "" : words["key delete"]);

  /** Whether a button looks open; a closed one says what is missing. */
  function opens(made, isOpen) {
    if (isOpen) made?.removeAttribute("aria-disabled");
    else made?.setAttribute("aria-disabled", "true");
  }

  /** Several options that were all taken back are no answer. */
  const isAnswered = ({ answer }) => answer !== null && answer.length !== 0;
  const isTyped = ({ form }) => form && ["number", "text"].includes(form.kind);
  /** Whether an answer is sent when the participant goes on; sliders and several options are sent at once. */
  const isSentLate = (question) => isTyped(question) || question.form?.kind === "scale" || (question.form?.kind === "choice" && !question.form.several);
  /** Whether there is an answer with which one can go on. */
  function isComplete(question) {
    const value = isSentLate(question) ? pending(question) : null;
    if (value === null) return isAnswered(question);
    return question.form.kind === "number" ? isNumber(question.form, value) : value !== "";
  }

  /** A rating scale or slider with its end labels below the first and the last point. */
  const anchored = (made, low, high, { element, text }) => {
    const frame = element("div", "anchored");
    frame.append(made, text("span", "anchor low", low), text("span", "anchor high", high));
    return frame;
  };

  const FORMS = {
    scale(question, words, kit) {
      const { form } = question, answer = isSkipped(question) ? null : position(question);
      const scale = kit.element("div", "scale");
      for (let point = 1; point <= form.points; point += 1) {
        const made = kit.text("button", point === answer ? "chosen" : "", point);
        made.dataset.rate = point;
        scale.append(made);
      }
      return [anchored(scale, form.low, form.high, kit), kit.text("p", "hint", words.digits)];
    },
    choice(question, words, { element, text }) {
      const { form } = question, answer = isSkipped(question) ? null : position(question);
      const list = element("div", form.options.length > 5 ? "options many" : "options");
      form.options.forEach(({ id, text: label }, index) => {
        const made = element("button", [].concat(answer ?? []).includes(id) ? "chosen" : "");
        made.append(text("i", "", index + 1), text("span", "", label));
        made.dataset.option = id;
        list.append(made);
      });
      return [list, text("p", "hint", form.several ? words.several : words.digits)];
    },
    number(question, words, { element, text }) {
      const { form, answer } = question, value = pending(question) ?? String(answer ?? "");
      const entry = element("div", "number");
      entry.append(text("output", "", value || "\u00a0"), text("span", "", form.unit));
      const pad = element("div", "pad");
      for (const key of [..."123456789", form.min < 0 ? "-" : "", "0", "⌫"]) {
        const made = text(key ? "button" : "span", "", key);
        if (key) made.dataset.typed = key;
        pad.append(made);
      }
      // Signs that belong to no whole number stay in the field, since without them "7,5" would be another number: 75.
      const isOther = value && !isWhole(value) && value !== "-", isEntered = draft.isRefused || value.length >= Math.max(...[form.min, form.max].map((end) => String(end).length));
      const range = `${form.min} – ${form.max} ${form.unit}`, isWrong = !isSkipped(question) && (isOther || (value && isEntered && !isNumber(form, value)));
      const hint = text("p", isWrong ? "hint wrong" : "hint", isWrong && isOther ? `${words["whole number"]} ${range}` : isWrong ? `${words["number range"]} ${range}` : range);
      if (isWrong) hint.setAttribute("role", "alert");
      return [entry, hint, pad];
    },
    text(question, words, { element, text }) {
      const field = element("textarea", ""), hint = text("p", "hint wrong", ""), { length } = question.form;
      // A text that is too long is not cut, but refused.
      const count = () => {
        const given = lengthOf(field.value);
        hint.textContent = given > length ? words["too long"].replace("#", given).replace("#", length) : "";
      };
      Object.assign(field, { rows: 3, value: pending(question) ?? question.answer ?? "" });
      field.setAttribute("aria-label", question.text);
      field.addEventListener("input", () => {
        keep(question, field.value);
        opens(document.querySelector(".turns .next"), field.value);
        const left = sign(document.querySelector(".turns .skip"), skipKey(question, words));
        left.classList.remove("chosen");
        count();
      });
      hint.setAttribute("role", "alert");
      count();
      return [field, hint];
    },
    consent({ text: agreed, form }, words, { element, text }) {
      const reading = element("div", "reading");
      for (const paragraph of agreed.split(/\n\s*\n/)) reading.append(text("p", "", paragraph));
      const button = element("button", "hold");
      button.append(element("i", ""), sign(text("span", "", words.consent.replace("#", form.hold_s)), "↵"));
      button.style.setProperty("--hold", `${form.hold_s}s`);
      button.dataset.seconds = form.hold_s;
      button.addEventListener("pointerdown", (event) => {
        button.setPointerCapture(event.pointerId);
        hold("touch", true, form.hold_s);
      });
      for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
        button.addEventListener(end, () => hold("touch", false));
      }
      const hint = text("p", "hint asks", words["consent text"]), not = sign(text("button", "declines", words.decline), words["key delete"]);
      not.addEventListener("click", () => {
        tell({ kind: "decline" });
        not.classList.add("chosen");
        hint.textContent = words.declined;
        hint.classList.add("told");
      });
      const row = element("div", "choosing", button);
      row.append(not);
      return [reading, row, hint];
    },
    slider(question, words, kit) {
      const { form } = question, { element } = kit, slider = element("div", "slider"), thumb = element("b", "");
      const place = (value) => { thumb.style.left = `${value}%`; thumb.hidden = value === null; };
      if (SLIDER_END / form.step <= 25) {
        for (let at = 0; at <= SLIDER_END; at += form.step) slider.append(Object.assign(element("i", ""), { style: `left: ${at}%` }));
      }
      slider.append(thumb);
      place(position(question));
      const at = (event) => {
        const box = slider.getBoundingClientRect();
        return onStep(form, (SLIDER_END * (event.clientX - box.left)) / box.width);
      };
      const drag = (event) => { keep(question, at(event)); place(draft.value); };
      slider.addEventListener("pointerdown", (event) => { slider.setPointerCapture(event.pointerId); drag(event); });
      slider.addEventListener("pointermove", (event) => slider.hasPointerCapture(event.pointerId) && drag(event));
      slider.addEventListener("pointerup", (event) => slide(question, at(event)));
      const hint = sign(kit.text("p", "hint", position(question) === null ? words.slider : "\u00a0"), "← →");
      return [anchored(slider, form.low, form.high, kit), hint];
    },
  };

  const position = (question) => pending(question) ?? question.answer;
  const onStep = ({ step }, value) => Math.min(SLIDER_END, Math.max(0, Math.round(value / step) * step));
  const isWhole = (typed) => /^\s*-?[0-9]+\s*$/.test(typed);
  const isNumber = ({ min, max }, typed) => isWhole(typed) && typed.length <= MOST_DIGITS && Number(typed) >= min && Number(typed) <= max;
  /** A typed text in one line, without control characters, which no answer may have. */
  const inOneLine = (typed) => typed.replace(/[\s\p{Cc}]+/gu, " ").trim();
  /** Number of characters, as the program counts them: a sign of two code units is one. */
  const lengthOf = (typed) => [...inOneLine(typed)].length;

  /** Goes on to the next item, with what was chosen or typed or with the answer that was given before. */
  function next(question) {
    // The second of two quick presses, or one that was meant for the item before, goes nowhere.
    if (performance.now() < settled) return;
    const value = isSentLate(question) ? pending(question) : null, given = isTyped(question) && value !== null ? inOneLine(value) : value;
    const isLeft = isSkipped(question), isKept = isLeft ? question.skipped : value === null;
    if (!isLeft && (given === "" || (isKept && !isAnswered(question)))) return Stage.say(isTyped(question) ? "first type" : "tutorial first question");
    const { kind, length } = question.form ?? {};
    if (!isLeft && !isKept && ((kind === "text" && lengthOf(given) > length) || (kind === "number" && !isNumber(question.form, given)))) {
      draft.isRefused = true;
      return redraw();
    }
    settled = performance.now() + SETTLES_MS;
    if (isKept) tell({ kind: "next" });
    else give(question, isLeft ? null : kind === "number" ? Number(given) : given);
  }

  const back = (question) => question.before && tell({ kind: "back", item: question.before });

  /** Of several options, one that stands alone takes the others back, and each other one takes it back. */
  function choose(question, id) {
    const { several, options } = question.form, before = (!isSkipped(question) && question.answer) || [];
    if (!several) return mark(question, id);
    const isAlone = (one) => options.some((option) => option.id === one && option.alone);
    const left = before.includes(id) ? before : before.filter((one) => !isAlone(one) && !isAlone(id));
    keep(question, null);
    give(question, options.map((option) => option.id).filter((one) => left.includes(one) !== (one === id)));
    return redraw();
  }

  /** A sign or the delete key was typed or touched. */
  function type(question, key) {
    const typed = pending(question) ?? String(question.answer ?? "");
    // A digit begins anew after "No answer", and where an answer was given before.
    const next = key === "⌫" ? typed.slice(0, -1) : pending(question) === null || isSkipped(question) ? key : typed + key;
    if (next.length <= LONGEST_ENTRY) keep(question, next);
    redraw();
  }

  function slide(question, value) {
    keep(question, onStep(question.form, value));
    give(question, draft.value);
    redraw();
  }

  // Input that holds the consent button, and the timer at whose end consent is given.
  let holds = null, agrees = null, heldFrom = 0;

  /**
   * The consent button is pressed or released, by touch, a key or a gamepad. Only an uninterrupted hold of the whole
   * time gives consent; the program is told of the hold, and measures its time, too.
   */
  function hold(by, isDown, seconds) {
    if (isDown === (holds !== null) || (holds !== null && holds !== by)) return;
    holds = isDown ? by : null;
    clearTimeout(agrees);
    tell({ kind: "hold", held: isDown });
    const hint = document.querySelector(".hint.asks");
    document.querySelectorAll(".declines").forEach((not) => not.classList.remove("chosen"));
    if (hint && isDown) [hint.textContent, heldFrom] = [Stage.scene().words["consent hold"], performance.now()];
    else if (hint && performance.now() - heldFrom < 1000 * hint.parentNode.querySelector(".hold").dataset.seconds) hint.textContent = Stage.scene().words["consent short"];
    if (isDown) agrees = setTimeout(() => tell({ kind: "consent" }), 1000 * seconds);
    document.querySelectorAll(".hold").forEach((button) => button.classList.toggle("held", isDown));
  }

  /** A key or gamepad button is pressed or released while consent is asked for. */
  const holdBy = (by, isDown, question) => {
    if (!isDown) hold(by, false);
    else if (question && question.form && question.form.kind === "consent") hold(by, true, question.form.hold_s);
  };

  /** A key is pressed while an item is shown; `isHeld`: the key has been down since before. */
  function key(name, question, isHeld) {
    const { form } = question, kind = question.item && form && form.kind;
    if (kind === "consent" && name === "Delete") return isHeld || document.querySelector(".declines").click();
    if (kind === "consent") return ["Enter", " "].includes(name) ? holdBy("key", true, question) : read(name);
    const digit = /^[0-9]$/.test(name) ? Number(name) : null;
    const steps = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[name];
    if (kind === "slider" && steps) return slide(question, (position(question) ?? SLIDER_END / 2) + steps * form.step);
    if (isHeld) return undefined;
    if (kind === "slider" && digit !== null) return slide(question, 10 * digit);
    if (kind === "slider" && ["Home", "End"].includes(name)) return slide(question, name === "End" ? SLIDER_END : 0);
    if (kind === "number" && [...name].length === 1) return type(question, name);
    if (kind === "number" && name === "Backspace" && (pending(question) ?? question.answer ?? "") !== "") return type(question, "⌫");
    if (question.item && (name === "Delete" || (digit === 0 && ["scale", "choice"].includes(kind)))) return skip(question);
    if (kind === "scale" && digit !== null && digit <= form.points) return mark(question, digit);
    if (kind === "choice" && digit !== null && digit <= form.options.length) return choose(question, form.options[digit - 1].id);
    if (["ArrowLeft", "Backspace"].includes(name)) return back(question);
    if (question.item && ["ArrowRight", "Enter"].includes(name)) return next(question);
    if (!question.item && name === "Enter") return performance.now() < settled ? undefined : tell({ kind: "confirm" });
    const last = kind === "scale" ? form.points : kind === "choice" ? form.options.length : 0;
    if (digit !== null && last) return Stage.say("choose", Math.min(9, last));
    return kind !== "text" && [...name].length === 1 ? refuse(last) : undefined;
  }

  /** Says that a key does nothing here, and which do: the first `last` digits, and those shown. */
  function refuse(last) {
    const shown = [...document.querySelectorAll(".question [data-key]")].map(({ dataset }) => dataset.key), keys = [...(last ? [`1 – ${Math.min(9, last)}`] : []), ...shown];
    return Stage.say("nothing keys", keys.join(", "));
  }

  /** Scrolls a text that is longer than its area. */
  function read(name) {
    const rows = { ArrowDown: 1, ArrowUp: -1, PageDown: 8, PageUp: -8 }[name] || 0;
    if ([...name].length === 1) refuse(0);
    document.querySelectorAll(".reading").forEach((reading) => reading.scrollBy(0, rows * 40));
  }

  /** One of the buttons is touched. */
  function touch({ rate, option, typed, does, review }, question) {
    if (performance.now() < settled) return;
    if (rate) mark(question, Number(rate));
    else if (review) tell({ kind: "back", item: review });
    else if (option) choose(question, option);
    else if (typed) type(question, typed);
    else if (does === "skip") skip(question);
    else if (does === "next") next(question);
    else if (does === "back") back(question);
    else if (does === "confirm") tell({ kind: "confirm" });
  }

  /** The consent button counts as released, whatever holds it. */
  const letGo = () => hold(holds, false);

  return { draw, key, sign, touch, holdBy, letGo, begin: (toTell) => { tell = toTell; } };
})();
