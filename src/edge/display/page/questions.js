"use strict";
/** An item of a questionnaire, to be touched or answered with digits. */
const Questions = {
  draw(sheet, question, words, { element, text }) {
    const card = element("div", "card question");
    card.append(text("h2", "", question.title));
    if (question.item) {
      card.append(text("p", "count", `${question.number} / ${question.of}`), text("p", "item", question.text));
      const scale = element("div", "scale");
      for (let point = 1; point <= question.points; point += 1) {
        const made = text("button", point === question.answer ? "chosen" : "", point);
        made.dataset.rate = point;
        scale.append(made);
      }
      const ends = element("div", "ends");
      ends.append(text("span", "", question.low), text("span", "", question.high));
      card.append(scale, ends);
    } else {
      card.append(text("p", "item", question.text));
      const given = element("ol", question.given.length > 6 ? "given small" : "given");
      for (const { text: asked, rated } of question.given) {
        const line = element("li", "");
        line.append(text("span", "", asked), text("b", "", rated ?? "–"));
        given.append(line);
      }
      card.append(given);
    }
    const row = element("div", "row");
    const button = (does, label) => { const made = text("button", does, label); made.dataset.does = does; row.append(made); };
    if (question.before) button("back", words.back);
    if (question.item) button("skip", words.skip);
    if (question.item && question.answer) button("next", words.next);
    if (!question.item) button("confirm", words.confirm);
    card.append(row);
    sheet.replaceChildren(card);
  },
};
