"use strict";
/** What the session shows of the trial as a whole: the time that it still has, and the number of served orders. */
const Status = (() => {
  const TICK_MS = 100;
  let parts = null, timer = 0;

  function build(element) {
    const made = element("div", "status"), clock = element("span", "clock"), served = element("span", "served");
    clock.setAttribute("role", "timer");
    made.append(clock, served);
    parts = { clock, served };
    return made;
  }

  /** Minutes and seconds; the last second ends at 0:00. */
  function inWords(seconds) {
    const whole = Math.max(0, Math.ceil(seconds - 0.05));
    return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
  }

  /** `left` tells the seconds that the trial still has. */
  function draw({ clock, served }, left, words) {
    clearInterval(timer);
    const tick = () => {
      const said = clock ? inWords(left()) : "";
      if (parts.clock.textContent !== said) parts.clock.textContent = said;
    };
    tick();
    if (clock === "goes") timer = setInterval(tick, TICK_MS);
    parts.served.textContent = served === null ? "" : `✓ ${words["served count"].replace("#", served)}`;
  }

  return { build, draw };
})();
