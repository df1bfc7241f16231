"use strict";
// The observers' page: draws the wizard's screen cell by cell as text, and sends remarks.

(() => {
  const PING_MS = 500, LINE = 1.17;
  const find = (id) => document.getElementById(id);
  const screen = find("screen"), pairing = find("pairing"), remarks = find("remarks"), note = find("note"), told = find("told");
  const asksFor = new URLSearchParams(location.search);
  let observer = asksFor.get("observer") || sessionStorage.getItem("observer") || "", code = asksFor.get("code");
  let size = { columns: 0, rows: 0 }, number = 0, sent = null;

  /** A colour as CSS has it: of xterm's palette of 256, or its red, green and blue. */
  function colour(of) {
    const BASE = "#000000 #cd0000 #00cd00 #cdcd00 #0000ee #cd00cd #00cdcd #e5e5e5 #7f7f7f #ff0000 #00ff00 #ffff00 #5c5cff #ff00ff #00ffff #ffffff".split(" ");
    if (Array.isArray(of)) return `rgb(${of.join(" ")})`;
    if (of < 16) return BASE[of];
    if (of >= 232) return `rgb(${Array(3).fill(8 + 10 * (of - 232)).join(" ")})`;
    const level = (value) => (value ? 55 + 40 * value : 0), cube = of - 16;
    return `rgb(${[Math.floor(cube / 36), Math.floor(cube / 6) % 6, cube % 6].map(level).join(" ")})`;
  }

  function drawRun({ text, columns, ink, ground, styles }) {
    const run = document.createElement("span");
    run.className = `run ${styles || ""}`;
    run.textContent = text;
    // Whatever font a sign comes from, the next stretch begins in its own column.
    run.style.width = `${columns}ch`;
    if (ink !== undefined) run.style.setProperty("--run-ink", colour(ink));
    if (ground !== undefined) run.style.setProperty("--run-ground", colour(ground));
    return run;
  }

  function draw({ columns, rows, light, lines }) {
    document.body.classList.toggle("light", light);
    if (columns !== size.columns || rows !== size.rows) {
      size = { columns, rows };
      screen.replaceChildren(...Array.from({ length: rows }, () => {
        const line = document.createElement("div");
        line.className = "line";
        return line;
      }));
      fit();
    }
    for (const [index, runs] of lines) screen.children[index].replaceChildren(...runs.map(drawRun));
  }

  /** As large as the window allows. */
  function fit() {
    if (!size.columns) return;
    const probe = document.createElement("span");
    probe.textContent = "0".repeat(100);
    screen.style.fontSize = "100px";
    screen.append(probe);
    const cell = probe.getBoundingClientRect().width / 10000;
    probe.remove();
    const { clientWidth, clientHeight } = screen.parentElement;
    screen.style.fontSize = `${Math.max(4, Math.min(clientWidth / (size.columns * cell), clientHeight / (size.rows * LINE)))}px`;
    screen.style.width = `${size.columns}ch`;
  }

  function ask(why, waitS) {
    const words = {
      code: "", observer: observer ? "This is no code of an observer." : "",
      wrong: "This is not the pairing code.", locked: "Too many wrong codes: this one was not checked.",
    };
    if (why !== "observer") find("needs-code").hidden = false;
    code = null;
    pairing.hidden = false;
    screen.hidden = true;
    find("wrong").textContent = words[why] + (waitS ? ` The next one can be tried in ${waitS} s.` : "");
    find("observer").value = find("observer").value || observer;
    (find("observer").value && why !== "observer" ? find("code") : find("observer")).focus();
  }

  pairing.addEventListener("submit", (event) => {
    event.preventDefault();
    observer = find("observer").value.trim();
    code = find("code").value || null;
    hello();
    Talk.ping();
  });

  remarks.addEventListener("submit", (event) => {
    event.preventDefault();
    const text = note.value.trim();
    if (!text || sent) return;
    number += 1;
    if (Talk.isOpen() && !document.body.classList.contains("lost")) {
      sent = { number, text };
      Talk.say({ kind: "remark", number, note: text });
    } else told.textContent = "Not saved: the connection is lost.";
  });

  /** The program says what became of a remark; one that is in no recording stays in the field. */
  function answered({ number: of, refused }) {
    if (!sent || of !== sent.number) return;
    told.textContent = refused ? `Not saved: ${refused}.` : `Saved as a note of ${observer}.`;
    if (!refused && note.value.trim() === sent.text) note.value = "";
    sent = null;
  }

  function hello() {
    Talk.say({ kind: "hello", page: Talk.page, observer, code });
  }

  function hear(message) {
    if (message.kind === "frame") draw(message);
    else if (message.kind === "pairing") ask(message.why, message.wait_s);
    else if (message.kind === "remark") answered(message);
    else if (message.kind === "welcome") {
      sessionStorage.setItem("observer", observer);
      pairing.hidden = true;
      screen.hidden = false;
      size = { columns: 0, rows: 0 };
      document.body.classList.remove("lost");
      told.textContent = `You watch as ${observer}.`;
    } else if (message.kind === "full") {
      Talk.end();
      told.textContent = `${message.most} observers watch already, and no more are let in. Load the page again to try again.`;
    } else if (message.kind === "ended") {
      document.body.classList.add("lost");
      told.textContent = "The program has ended.";
    }
  }

  function lost() {
    if (sent) told.textContent = "The connection was lost: whether the remark was saved is not known.";
    else if (!document.body.classList.contains("lost")) told.textContent = "The connection is lost; it is opened again by itself.";
    sent = null;
    document.body.classList.add("lost");
  }

  window.addEventListener("resize", fit);
  document.addEventListener("visibilitychange", () => Talk.isOpen() && Talk.ping());
  Talk.begin({ opened: hello, hear, lost, ping: () => ({ more: {}, next_ms: PING_MS }) });
})();
