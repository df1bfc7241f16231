"use strict";
// Connection of a page to the program. A lost connection is opened again automatically, and then transmits the whole
// state.

const Talk = (() => {
  const SILENCE_MS = 1200, LOOK_MS = 250, OPENING_MS = 3000, AGAIN_MS = 500;
  let socket = null, room = null, pinger = 0;
  // When the unanswered ping was sent; 0: no ping is unanswered. The timers of a hidden page are slow, so the time
  // since the last message does not show whether the connection works.
  let asked = 0;

  /** Name of the page, which it keeps when it is loaded again, so that it takes its old role again. */
  const page = (() => {
    let name = sessionStorage.getItem("page");
    if (!name) {
      name = [...crypto.getRandomValues(new Uint8Array(12))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
      sessionStorage.setItem("page", name);
    }
    return name;
  })();

  const isOpen = () => socket && socket.readyState === WebSocket.OPEN;
  const say = (message) => isOpen() && socket.send(JSON.stringify(message));

  function ping() {
    asked = asked || performance.now();
    const { more, next_ms } = room.ping();
    say({ kind: "ping", t: performance.now(), hidden: document.visibilityState === "hidden", ...more });
    clearTimeout(pinger);
    pinger = setTimeout(ping, next_ms);
  }

  function connect() {
    const made = new WebSocket(`ws://${location.host}/talk`);
    socket = made;
    asked = performance.now();
    made.onopen = () => { room.opened(); ping(); };
    made.onmessage = ({ data }) => { asked = 0; room.hear(JSON.parse(data)); };
    made.onclose = () => made === socket && lose();
  }

  function drop() {
    const old = socket;
    socket = null;
    asked = 0;
    clearTimeout(pinger);
    if (old) old.onopen = old.onmessage = old.onclose = null;
    if (old) old.close();
  }

  /** The connection does not work: that is told at once, without waiting for it to be closed, and another one is opened. */
  function lose() {
    drop();
    room.lost();
    setTimeout(connect, AGAIN_MS);
  }

  /**
   * Connects the page. `opened()` says hello; `hear(message)` takes what the program says; `lost()` is told that the
   * connection is lost; `ping()` gives further fields of the next ping, and the time until the one after it.
   */
  function begin(callbacks) {
    room = callbacks;
    // A connection that no longer answers is lost. Where the page itself stood still, the answer may be there already.
    let looked = 0;
    setInterval(() => {
      const now = performance.now(), stood = now - looked > 2 * LOOK_MS;
      looked = now;
      if (socket && asked && !stood && now - asked > (isOpen() ? SILENCE_MS : OPENING_MS)) lose();
    }, LOOK_MS);
    connect();
  }

  return { page, begin, isOpen, say, ping, end: drop };
})();
