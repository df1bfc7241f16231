"use strict";
// The robot, at the pose that the program sends: a gripper of two fingers with what it holds, on a forearm from the robot's side. At a
// place it stands beside it, so that it covers nothing, everywhere as large; its arm is thin and lies below everything. What it throws away
// falls into a bin beside where it rests.

const Robot = (() => {
  // Sizes of the gripper in em, of which that is taken with which it has room beside every place: with the least, what it holds can still be
  // told. Its distance from a place, and from an order with its frame.
  const SIZES = [7.4, 7.1, 6.8, 6.5, 6.2, 5.9, 5.6, 5.3], GAP = 0.15, FRAME = 0.8;
  // How far before the middle of the gripper it holds something, as a share of its size.
  const HELD = 0.2;
  // How high it is at most, for the height of its own place.
  const MOST_HIGH = 1.2;
  // How fast the drawn pose follows the one that is told, which comes 20 times a second.
  const FOLLOWS_MS = 40;
  let made = null, bin = null, stands = [], holds = "", told = null, drawn = null, ticked = 0;

  /** The rectangle of this size in em around a point. */
  const around = ([x, y], size, [wide, high]) => [x - (size * wide) / 2, y - (size * high) / 2, size * wide, size * high];
  const isInside = ([ax, ay, aw, ah], [bx, by, bw, bh]) => ax >= bx && ay >= by && ax + aw <= bx + bw && ay + ah <= by + bh;
  const centre = ([x, y, w, h]) => [x + w / 2, y + h / 2];

  /** What the hand must not cover: places and storages with their names, and whatever else is taken. */
  function obstacles(scene, room, taken) {
    const [wide, high] = room.em, spots = [...scene.locations, ...scene.storages];
    const names = spots.filter(({ kind }) => kind !== "order").map((spot) => {
      const size = room.nameSize(spot), width = room.widthOf(spot.label, size * wide);
      return [centre(spot.area)[0] - width / 2, spot.area[1] - 1.4 * size * high, width, 1.4 * size * high];
    });
    return [...spots.map(({ area }) => area), ...names, ...taken];
  }

  /** Where something of this size stands beside a place, clear of recipes where that can be; undefined where there is no room. */
  function beside({ area, kind }, size, room, others, cards) {
    // What is the robot's, it takes on its own side.
    const within = [room.sides()[0], [0, 0, 1, 1]].find((zone) => Room.overlaps(zone, area));
    const [[x, y, w, h], [wide, high], [cx, cy]] = [area, room.em, centre(area)];
    const [across, down] = [wide, high].map((em) => (size / 2 + (kind === "order" ? FRAME : GAP)) * em);
    // Rather on the side from which the arm comes.
    const [from] = room.base(), near = [[x - across, cy, 1, 0], [x + w + across, cy, -1, 0]].sort(([a], [b]) => Math.abs(a - from) - Math.abs(b - from));
    const sides = [...near, [cx, y + h + down, 0, -1], [cx, y - down, 0, 1]];
    for (const taken of [[...others, ...cards], others]) {
      for (const aside of [0, 0.25, -0.25, 0.5, -0.5]) for (const [left, top, dx, dy] of sides) {
        const at = [left + (dy ? aside * w : 0), top + (dx ? aside * h : 0)], rect = around(at, size, [wide, high]);
        if (isInside(rect, within) && !taken.some((other) => Room.overlaps(rect, other))) return { at, towards: [dx, dy] };
      }
    }
    return undefined;
  }

  /** Builds the robot for a kitchen as it is on the wall, in a layout of it; only its bin, where the robot is not shown. */
  function build(wall, room, { taken, cards }, element) {
    const scene = room.placed, ratio = scene.display_m[0] / scene.display_m[1], others = obstacles(scene, room, taken), [wide, high] = room.em;
    [made, holds] = [null, ""];
    const isTheirs = ({ kind, agent }) => kind !== "human_hand" && agent !== "human", theirs = ({ locations, storages }) => [...locations, ...storages].filter(isTheirs);
    const spots = theirs(scene), from = theirs(wall), home = spots.findIndex(({ kind }) => kind === "robot_hand");
    const standing = (one) => spots.map((spot, index) => (index === home ? null : beside(spot, one, room, others, cards)));
    // At rest it is clear of the name above its place.
    const isLow = (one) => one * high <= MOST_HIGH * spots[home].area[3];
    const size = SIZES.find((one) => isLow(one) && standing(one).every((stand) => stand !== undefined)) ?? SIZES[SIZES.length - 1];
    // At rest, what it holds is where the contents of its place are. Where there is no room beside a place, it lies below the place.
    const [x, y] = centre(spots[home].area), below = ([left, top, w, h]) => ({ at: [left + w / 2, top + h], towards: [0, -1], below: 1 });
    const rests = { at: [Math.max(x - HELD * size * wide, 0.5 * size * wide), y], towards: [1, 0] };
    stands = standing(size).map((stand, index) => ({ ...(stand === null ? rests : stand || below(spots[index].area)), from: centre(from[index].area) }));
    bin = element("div", "bin", `${Art.TRASH}<div class="item"></div>`);
    const { at } = beside(spots[home], size, room, [...others, around(rests.at, size, room.em)], cards) || below(spots[home].area);
    Object.assign(bin.style, { left: `${100 * at[0]}%`, top: `${100 * at[1]}%` });
    bin.style.setProperty("--size", `${size}em`);
    bin.style.setProperty("--from", `${((x - at[0]) / wide).toFixed(2)}em, ${((y - at[1]) / high).toFixed(2)}em`);
    if (scene.arm === "none") return [bin];
    const item = element("div", "item"), gripper = element("div", "gripper", Art.GRIPPER), hand = element("div", "robot-hand", gripper);
    hand.append(item);
    const isArm = scene.arm === "arm" && !room.isUpright, base = room.base();
    const inside = `<path/>${isArm ? `<circle class="joint" r=".013"/><circle class="joint" r=".018" cx="${base[0] * ratio}" cy="${base[1]}"/>` : ""}`;
    const arm = element("div", `robot-arm ${isArm ? "links" : ""}`, `<svg viewBox="0 0 ${ratio} 1" aria-hidden="true">${inside}</svg>`);
    made = { hand, gripper, item, arm, isArm, base, ratio, size, em: room.em, wall };
    drawn = null;
    move(told || { x: stands[home].from[0], y: stands[home].from[1], down: 0 });
    return [arm, bin, hand];
  }

  /** Where a pose is in this layout: at a place where the hand stands there, and between places what lies between. */
  function placed({ x, y }) {
    const sum = { x: 0, y: 0, dx: 0, dy: 0, below: 0 }, [wide, high] = made.wall.display_m;
    let weights = 0;
    for (const { from, at, towards, below = 0 } of stands) {
      const weight = 1 / Math.max(1e-6, Math.hypot(((from[0] - x) * wide) / high, from[1] - y)) ** 4;
      weights += weight;
      [...at, ...towards, below].forEach((value, index) => { sum[["x", "y", "dx", "dy", "below"][index]] += weight * value; });
    }
    return { x: sum.x / weights, y: sum.y / weights, turn: Math.atan2(sum.dy, sum.dx), isBelow: sum.below > weights / 2 };
  }

  /** Position of the elbow, on the robot's side; from above, links that reach up look shorter. */
  function elbow([x, y]) {
    const from = [made.base[0] * made.ratio, made.base[1]], [dx, dy] = [x - from[0], y - from[1]];
    return [from[0] + 0.5 * dx + 0.26 * dy, from[1] + 0.5 * dy - 0.26 * dx];
  }

  function draw({ down }, { x, y, turn, isBelow }) {
    const { hand, gripper, item, arm, isArm, base, ratio, size, em } = made;
    hand.style.transform = `translate(${(x / em[0]).toFixed(3)}em, ${(y / em[1]).toFixed(3)}em) scale(${((size / 10) * (1.03 - 0.03 * down)).toFixed(3)})`;
    gripper.style.transform = `rotate(${turn.toFixed(3)}rad)`;
    item.style.transform = `translate(${(10 * HELD * Math.cos(turn)).toFixed(3)}em, ${(10 * HELD * Math.sin(turn)).toFixed(3)}em)`;
    hand.classList.toggle("down", down > 0.5);
    hand.classList.toggle("below", isBelow);
    const wrist = [(x - 0.34 * size * Math.cos(turn) * em[0]) * ratio, y - 0.34 * size * Math.sin(turn) * em[1]];
    const bend = isArm ? elbow(wrist) : null, way = [[base[0] * ratio, base[1]], ...(bend ? [bend] : []), wrist].map((point) => point.map((value) => value.toFixed(4)).join(" "));
    arm.querySelector("path").setAttribute("d", `M${way.join(" L")}`);
    if (bend) ["cx", "cy"].forEach((name, axis) => arm.querySelector(".joint").setAttribute(name, bend[axis].toFixed(4)));
  }

  /** Draws the pose, which follows the told one frame by frame. */
  function follow(now) {
    if (!made) return (ticked = 0);
    const share = 1 - Math.exp(-Math.min(100, Math.max(0, now - ticked)) / FOLLOWS_MS), goal = told, near = (key) => Math.abs(goal[key] - drawn[key]) < 5e-4;
    for (const key of ["x", "y", "down"]) drawn[key] += (goal[key] - drawn[key]) * share;
    const isThere = ["x", "y", "down"].every(near);
    if (isThere) drawn = { ...goal };
    draw(drawn, placed(drawn));
    ticked = isThere ? 0 : now;
    return isThere || requestAnimationFrame(follow);
  }

  function move(pose) {
    told = pose;
    if (!made) return;
    Object.assign(made.hand.dataset, { x: pose.x, y: pose.y });
    if (!drawn) {
      drawn = { ...pose };
      return draw(drawn, placed(drawn));
    }
    if (ticked) return;
    ticked = performance.now();
    requestAnimationFrame(follow);
  }

  /** Shows what the hand holds. */
  function hold(what, contentOf) {
    const now = JSON.stringify(what);
    if (!made || now === holds) return;
    holds = now;
    const [inside, kind] = contentOf(what, false);
    made.item.innerHTML = inside;
    made.hand.dataset.holds = kind;
  }

  /** The frame of a signal about what the hand holds goes with it. */
  function highlight(isOn) {
    if (made) made.hand.classList.toggle("highlight", isOn);
  }

  /** Shows that this was thrown away: it falls from the hand into the bin. */
  function discard(what, contentOf, replay) {
    bin.querySelector(".item").innerHTML = contentOf(what, false)[0];
    replay(bin, "takes");
  }

  return { build, move, hold, highlight, discard, pose: () => told };
})();
