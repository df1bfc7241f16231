"use strict";
// Picture of the robot's hand over the kitchen, and of its arm from above, at the pose that the program sends, with the
// item that the hand holds.

const Robot = (() => {
  // Lengths of the arm's two links and position of its base, in heights of the stage; the arm reaches every place.
  const LINK = 0.68, BASE = [-0.02, 0.5];
  let made = null, room = null, ratio = 1, holds = "", last = null;

  const svg = (inside) => `<svg viewBox="0 0 100 100" aria-hidden="true">${inside}</svg>`;
  const GRIPPER = svg(`<g fill="#d9e4f0" stroke="#33557d" stroke-width="3" stroke-linejoin="round">
    <rect x="20" y="4" width="13" height="46" rx="6"/><rect x="67" y="4" width="13" height="46" rx="6"/>
    <path d="M14 46 h72 q8 0 8 9 v14 q0 27 -44 27 q-44 0 -44 -27 v-14 q0 -9 8 -9 z"/></g><circle cx="50" cy="72" r="9" fill="#4f7fb5"/>`);

  /** Builds the hand for a scene in a layout; nothing, where the robot is not shown. */
  function build(scene, layout, element) {
    [made, room, holds, ratio] = [null, layout, "", scene.display_m[0] / scene.display_m[1]];
    if (scene.arm === "none") return [];
    const item = element("div", "item"), hand = element("div", "robot-hand", GRIPPER);
    hand.append(item);
    // On an upright screen places do not lie as they do around a real arm.
    const links = scene.arm === "arm" && !room.isUpright ? element("div", "robot-arm", `<svg viewBox="0 0 ${ratio} 1" aria-hidden="true"><path class="under"/><path class="over"/><circle r="0.028"/></svg>`) : null;
    made = { hand, item, links, at: scene.locations.findIndex(({ kind }) => kind === "robot_hand") };
    return links ? [links, hand] : [hand];
  }

  /** Position of the elbow, on the side that is nearer to the viewer. */
  function elbow([x, y]) {
    const [dx, dy] = [x - BASE[0], y - BASE[1]], away = Math.min(Math.hypot(dx, dy), 2 * LINK - 1e-6);
    const out = Math.sqrt(LINK * LINK - (away * away) / 4) / Math.max(away, 1e-6);
    return [BASE[0] + dx / 2 + dy * out, BASE[1] + dy / 2 - dx * out];
  }

  function move(pose) {
    const { x, y, down } = pose;
    last = pose;
    if (!made) return;
    const [left, top] = room.moved([x, y]);
    made.hand.style.transform = `translate(${(left / room.em[0]).toFixed(2)}em, ${(top / room.em[1]).toFixed(2)}em) scale(${(1.12 - 0.12 * down).toFixed(3)})`;
    made.hand.classList.add("there");
    made.hand.dataset.x = x;
    made.hand.dataset.y = y;
    if (!made.links) return;
    const tip = [x * ratio, y], bend = elbow(tip), way = `M${BASE.join(" ")} L${bend.join(" ")} L${tip.join(" ")}`;
    for (const path of made.links.querySelectorAll("path")) path.setAttribute("d", way);
    const joint = made.links.querySelector("circle");
    joint.setAttribute("cx", bend[0]);
    joint.setAttribute("cy", bend[1]);
    made.links.classList.add("there");
  }

  /** Shows the item that the hand holds, given the contents of all places. */
  function hold(contents, contentOf) {
    if (!made) return;
    const now = JSON.stringify(contents[made.at]);
    if (now === holds) return;
    holds = now;
    [made.item.innerHTML] = contentOf(contents[made.at], false);
  }

  /** The kitchen was laid out anew: the hand is where it was. */
  const again = () => last && move(last);

  return { build, move, again, hold, pose: () => last };
})();
