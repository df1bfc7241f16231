"use strict";
// How the things on the participant's display look: one function for each shape that recipe and layout files may name.
// Each returns SVG in a box of 100 by 100 (furniture: 100 high, as wide as its place). Similar things look alike on
// purpose.

const Art = (() => {
  const number = (value) => value.toFixed(1);

  /** A colour made lighter (above 0) or darker (below 0). */
  function shade(colour, by) {
    const part = (at) => {
      const value = parseInt(colour.slice(at, at + 2), 16);
      const shaded = by > 0 ? value + (255 - value) * by : value * (1 + by);
      return Math.round(Math.min(255, Math.max(0, shaded))).toString(16).padStart(2, "0");
    };
    return `#${part(1)}${part(3)}${part(5)}`;
  }

  function escaped(text) {
    return text.replace(/[&<>"']/g, (sign) => `&#${sign.charCodeAt(0)};`);
  }

  /** A colour for a thing whose look no file defines, computed from its name. */
  function ownColour(name) {
    let sum = 7;
    for (const sign of name) sum = (sum * 31 + sign.codePointAt(0)) % 360;
    const channel = (n) => {
      const k = (n + sum / 30) % 12;
      const value = 0.62 - 0.26 * Math.max(-1, Math.min(k - 3, 9 - k, 1));
      return Math.round(255 * value).toString(16).padStart(2, "0");
    };
    return `#${channel(0)}${channel(8)}${channel(4)}`;
  }

  const isDark = (colour) => [0.3, 0.59, 0.11].reduce((sum, weight, at) => sum + weight * parseInt(colour.slice(1 + 2 * at, 3 + 2 * at), 16), 0) < 128;
  const shadow = (cx, cy, rx, ry) => `<ellipse cx="${cx}" cy="${cy}" rx="${rx}" ry="${ry}" fill="#000" opacity=".13"/>`;
  const outline = (colour, width = 2.2) => `stroke="${shade(colour, -0.42)}" stroke-width="${width}" stroke-linejoin="round"`;

  const ITEMS = {
    grains(c) {
      const spots = [];
      for (let row = 0; row < 6; row += 1) {
        for (let column = 0; column <= row + 1; column += 1) {
          const x = 50 + (column - (row + 1) / 2) * 12.2, y = 30 + row * 9.4;
          spots.push(`<ellipse cx="${number(x)}" cy="${number(y)}" rx="6.6" ry="3.6" fill="${shade(c, ((row * 7 + column * 5) % 4) * 0.12)}" ${outline(c, 1.5)} transform="rotate(${(row * 53 + column * 71) % 180} ${number(x)} ${number(y)})"/>`);
        }
      }
      return shadow(50, 84, 46, 7) + spots.join("");
    },
    heap(c) {
      const puffs = [[28, 66, 17], [50, 70, 20], [72, 66, 17], [38, 50, 17], [62, 50, 17], [50, 38, 15]];
      const marks = [[30, 62], [44, 72], [60, 66], [74, 68], [40, 48], [56, 44], [50, 56], [66, 54], [49, 34]];
      return `${shadow(50, 86, 44, 7)}
        ${puffs.map(([x, y, r]) => `<circle cx="${x}" cy="${y}" r="${r + 1.6}" fill="#b9b09c"/>`).join("")}
        ${puffs.map(([x, y, r]) => `<circle cx="${x}" cy="${y}" r="${r}" fill="${c}"/>`).join("")}
        ${marks.map(([x, y], i) => `<path d="M${x - 4} ${y} q4 ${i % 2 ? 4 : -4} 8 0" fill="none" stroke="#cfc6b2" stroke-width="2" stroke-linecap="round"/>`).join("")}
        <path d="M38 20 q-5 -7 0 -13 M50 17 q-5 -7 0 -13 M62 20 q-5 -7 0 -13" fill="none" stroke="#b7bdc4" stroke-width="2.6" stroke-linecap="round"/>`;
    },
    block(c) {
      return `${shadow(50, 76, 42, 7)}
        <rect x="11" y="36" width="78" height="37" rx="17" fill="${c}" stroke="#b9b09c" stroke-width="2.4"/>
        <path d="M18 58 q32 12 64 0 v4 q-32 14 -64 0 z" fill="#e5dcc8" opacity=".7"/>
        ${[[26, 46], [38, 43], [50, 47], [63, 43], [75, 48], [32, 56], [46, 58], [58, 54], [70, 58]].map(([x, y], i) => `<path d="M${x - 4} ${y} q4 ${i % 2 ? 3.4 : -3.4} 8 0" fill="none" stroke="#cfc6b2" stroke-width="2" stroke-linecap="round"/>`).join("")}`;
    },
    sheet(c) {
      return `${shadow(50, 84, 38, 6)}
        <path d="M20 24 L76 16 L84 72 L28 82 Z" fill="${c}" ${outline(c)}/>
        ${[0, 1, 2, 3, 4].map((i) => `<path d="M${25 + 1.4 * i} ${33 + 10 * i} L${79 + 1.2 * i} ${25 + 10 * i}" stroke="${shade(c, 0.16)}" stroke-width="2.2" opacity=".8"/>`).join("")}
        ${[[36, 30], [58, 42], [46, 62], [70, 60], [66, 28], [34, 50]].map(([x, y]) => `<circle cx="${x}" cy="${y}" r="1.8" fill="${shade(c, 0.32)}"/>`).join("")}`;
    },
    fillet(c) {
      return `${shadow(50, 78, 42, 6)}
        <path d="M9 57 C14 31 44 19 76 26 C91 29 95 40 89 52 C78 73 40 80 18 72 C10 69 8 63 9 57 Z" fill="${c}" ${outline(c)}/>
        <path d="M11 62 C30 78 70 72 89 50 C80 73 40 80 18 72 C13 70 10 66 11 62 Z" fill="${shade(c, -0.2)}"/>
        ${[0, 1, 2, 3, 4].map((i) => `<path d="M${24 + 13 * i} ${39 - 3.2 * i + (i > 2 ? 2 * (i - 2) : 0)} q7 12 -1 ${27 - i}" fill="none" stroke="${shade(c, 0.62)}" stroke-width="3" stroke-linecap="round"/>`).join("")}`;
    },
    slices(c) {
      const slice = (x, y) => `<g transform="translate(${x} ${y})"><path d="M2 32 C2 20 14 6 34 4 C44 3 48 8 46 16 C42 32 26 42 12 42 C5 42 2 38 2 32 Z" fill="${c}" ${outline(c)}/>
        ${[0, 1, 2].map((i) => `<path d="M${13 + 10 * i} ${15 - 3.4 * i} q7 9 0 21" fill="none" stroke="${shade(c, 0.62)}" stroke-width="2.8" stroke-linecap="round"/>`).join("")}</g>`;
      return shadow(50, 80, 40, 6) + slice(8, 18) + slice(26, 27) + slice(44, 36);
    },
    prawn(c) {
      const arc = "M22 66 C14 34 44 14 68 26 C84 34 86 54 76 66";
      const rings = [[25, 50, 41, 55], [30, 34, 45, 45], [45, 23, 51, 39], [62, 22, 58, 39], [77, 32, 63, 45], [82, 48, 65, 54]];
      return `${shadow(52, 84, 36, 6)}<path d="${arc}" fill="none" stroke="${shade(c, -0.42)}" stroke-width="25" stroke-linecap="round"/>
        <path d="${arc}" fill="none" stroke="${c}" stroke-width="20.5" stroke-linecap="round"/>
        <path d="M26 58 C22 38 46 20 66 30" fill="none" stroke="${shade(c, 0.45)}" stroke-width="4.5" stroke-linecap="round" opacity=".8"/>
        ${rings.map(([x, y, toX, toY]) => `<path d="M${x} ${y} L${toX} ${toY}" stroke="${shade(c, -0.3)}" stroke-width="2.6" stroke-linecap="round"/>`).join("")}
        <path d="M70 66 L62 88 L76 80 L90 88 L84 66 Z" fill="${shade(c, -0.12)}" ${outline(c)}/>
        <circle cx="20" cy="62" r="3.1" fill="#2c2422"/>
        <path d="M16 70 q-8 6 -5 16 M24 75 q-2 8 4 13" fill="none" stroke="${shade(c, -0.35)}" stroke-width="2.4" stroke-linecap="round"/>`;
    },
    // The whole crab from above: a wide shell with legs and raised claws, whose outline no other thing has.
    claw(c) {
      const legs = [[24, 58, 8, 50, 3, 60], [22, 66, 8, 64, 4, 76], [26, 73, 13, 77, 11, 89]];
      const side = `${legs.map(([x, y, kneeX, kneeY, endX, endY]) => `<path d="M${x} ${y} L${kneeX} ${kneeY} L${endX} ${endY}"/>`).join("")}<path d="M30 52 C18 48 14 40 18 32"/>`;
      const limbs = (colour, width) => `<g fill="none" stroke="${colour}" stroke-width="${width}" stroke-linecap="round" stroke-linejoin="round">${side}<g transform="matrix(-1 0 0 1 100 0)">${side}</g></g>`;
      const pincer = `<path d="M17 36 C3 30 3 12 18 4 C16 12 18 17 23 20 C26 16 30 12 35 12 C37 26 30 38 17 36 Z" fill="${shade(c, -0.08)}" ${outline(c)}/>`;
      return `${shadow(50, 88, 40, 6)}${limbs(shade(c, -0.42), 9)}${limbs(shade(c, -0.08), 5)}${pincer}<g transform="matrix(-1 0 0 1 100 0)">${pincer}</g>
        <path d="M20 62 C20 46 34 41 50 41 C66 41 80 46 80 62 C80 78 64 85 50 85 C36 85 20 78 20 62 Z" fill="${c}" ${outline(c)}/>
        <path d="M28 58 C30 51 38 47 48 47" fill="none" stroke="${shade(c, 0.45)}" stroke-width="4" stroke-linecap="round" opacity=".8"/>
        <path d="M36 75 q14 -7 28 0" fill="none" stroke="${shade(c, -0.3)}" stroke-width="2.6" stroke-linecap="round"/>
        ${[43, 57].map((x) => `<path d="M${x} 42 V36" stroke="${shade(c, -0.42)}" stroke-width="3"/><circle cx="${x}" cy="34" r="3.4" fill="#2c2422"/>`).join("")}`;
    },
    morsels(c, light = "#fff1e6") {
      // Dark ones are sticks, since colour alone is not enough to tell two contents apart.
      const stick = (y) => `<g transform="translate(50 ${y}) rotate(-14)"><rect x="-40" y="-9" width="80" height="18" rx="6" fill="${light}" ${outline(c)}/>
        <path d="M-40 0 V-3 q0 -6 6 -6 H34 q6 0 6 6 V0 Z" fill="${c}"/><path d="M-36 4.5 H36" stroke="${c}" stroke-width="1.6"/></g>`;
      if (isDark(c)) return shadow(50, 84, 40, 6) + stick(30) + stick(51) + stick(72);
      const piece = (x, y, turn) => `<g transform="translate(${x} ${y}) rotate(${turn})"><rect x="-17" y="-11.5" width="34" height="23" rx="10" fill="${light}" ${outline(c)}/>
        <path d="M-14 -7.5 a10 10 0 0 1 8 -4 h12 a10 10 0 0 1 8 4 q-14 7 -28 0 z" fill="${c}"/>
        <path d="M-6 0 v7 M3 0 v7" stroke="${c}" stroke-width="2.6" stroke-linecap="round"/></g>`;
      return shadow(50, 82, 40, 6) + piece(30, 36, -12) + piece(69, 38, 10) + piece(35, 66, 8) + piece(71, 68, -8);
    },
    bun(c) {
      return `${shadow(50, 84, 40, 6)}
        <path d="M11 66 h78 v4 a12 12 0 0 1 -12 12 h-54 a12 12 0 0 1 -12 -12 z" fill="${shade(c, -0.06)}" ${outline(c)}/>
        <rect x="9" y="58" width="82" height="8" rx="4" fill="${shade(c, 0.55)}"/>
        <path d="M10 57 C10 30 30 17 50 17 C70 17 90 30 90 57 Z" fill="${c}" ${outline(c)}/>
        <path d="M20 46 C22 32 36 24 50 24" fill="none" stroke="${shade(c, 0.45)}" stroke-width="4" stroke-linecap="round" opacity=".8"/>
        ${[[38, 34], [52, 29], [64, 37], [46, 44], [74, 47], [58, 49]].map(([x, y]) => `<ellipse cx="${x}" cy="${y}" rx="3.2" ry="1.9" fill="#fdf3d8" transform="rotate(-20 ${x} ${y})"/>`).join("")}`;
    },
    cheese(c) {
      return `${shadow(50, 78, 42, 6)}
        <path d="M50 22 L92 50 L50 78 L8 50 Z" fill="${shade(c, -0.2)}" transform="translate(0 4)"/>
        <path d="M50 22 L92 50 L50 78 L8 50 Z" fill="${c}" ${outline(c)}/>
        ${[[36, 46, 7], [58, 40, 5], [56, 61, 6], [72, 51, 4]].map(([x, y, r]) => `<ellipse cx="${x}" cy="${y}" rx="${r}" ry="${r * 0.68}" fill="${shade(c, -0.2)}"/>`).join("")}`;
    },
    patty(c) {
      return `${shadow(50, 77, 42, 6)}
        <path d="M8 50 C8 34 28 26 50 26 C72 26 92 34 92 50 V56 C92 70 72 77 50 77 C28 77 8 70 8 56 Z" fill="${shade(c, -0.22)}" ${outline(c)}/>
        <ellipse cx="50" cy="49" rx="41" ry="22" fill="${c}"/>
        ${[[30, 42], [46, 38], [63, 42], [76, 49], [37, 54], [54, 52], [66, 60], [26, 54], [48, 64]].map(([x, y], i) => `<ellipse cx="${x}" cy="${y}" rx="4" ry="2.2" fill="${shade(c, i % 2 ? 0.35 : -0.2)}"/>`).join("")}`;
    },
    grilled(c) {
      return `${shadow(50, 77, 42, 6)}
        <path d="M8 50 C8 34 28 26 50 26 C72 26 92 34 92 50 V56 C92 70 72 77 50 77 C28 77 8 70 8 56 Z" fill="${shade(c, -0.28)}" ${outline(c)}/>
        <ellipse cx="50" cy="49" rx="41" ry="22" fill="${c}"/>
        <path d="M22 44 L40 66 M38 33 L62 68 M58 30 L80 59" stroke="${shade(c, -0.55)}" stroke-width="5" stroke-linecap="round"/>
        <path d="M38 18 q-5 -6 0 -11 M50 16 q-5 -6 0 -11 M62 18 q-5 -6 0 -11" fill="none" stroke="#b7bdc4" stroke-width="2.6" stroke-linecap="round"/>`;
    },
    round(c) {
      return `${shadow(50, 86, 34, 6)}
        <path d="M50 28 C76 22 90 38 88 56 C86 78 66 87 50 87 C34 87 14 78 12 56 C10 38 24 22 50 28 Z" fill="${c}" ${outline(c)}/>
        <path d="M24 46 C26 38 32 34 38 34" fill="none" stroke="${shade(c, 0.55)}" stroke-width="5" stroke-linecap="round"/>
        <path d="M50 30 L36 23 L46 23 L50 11 L55 23 L65 22 Z" fill="#4f8f3a" stroke="#2f5c22" stroke-width="2" stroke-linejoin="round"/>`;
    },
    bell(c) {
      return `${shadow(50, 88, 30, 6)}
        <path d="M50 28 C66 19 87 25 87 46 C87 64 77 88 64 88 C58 88 56 84 50 84 C44 84 42 88 36 88 C23 88 13 64 13 46 C13 25 34 19 50 28 Z" fill="${c}" ${outline(c)}/>
        <path d="M50 30 C44 46 44 66 48 82 M50 30 C60 46 62 64 57 83" fill="none" stroke="${shade(c, -0.24)}" stroke-width="2.6"/>
        <path d="M25 48 C26 38 31 33 37 32" fill="none" stroke="${shade(c, 0.55)}" stroke-width="5" stroke-linecap="round"/>
        <path d="M45 27 C46 18 44 14 41 10 L51 8 C54 14 55 20 56 27 Z" fill="#4f8f3a" stroke="#2f5c22" stroke-width="2" stroke-linejoin="round"/>`;
    },
    rings(c, light = "#f6b7a0") {
      const ring = (x, y) => `<g transform="translate(${x} ${y})"><ellipse rx="27" ry="21" fill="${c}" ${outline(c)}/><ellipse rx="20" ry="14.5" fill="${light}"/>
        ${[0, 72, 144, 216, 288].map((turn) => `<ellipse cx="0" cy="-8" rx="4.4" ry="3.2" fill="${shade(c, 0.1)}" transform="rotate(${turn}) "/>`).join("")}<circle r="2.8" fill="${c}"/></g>`;
      return shadow(50, 82, 40, 6) + ring(36, 40) + ring(63, 60);
    },
    leaf(c) {
      return `${shadow(50, 84, 36, 6)}
        <path d="M50 88 C40 92 34 84 26 82 C16 80 20 70 13 63 C8 57 15 51 13 43 C12 34 22 33 27 26 C32 19 41 23 48 16 C55 10 62 19 70 20 C79 22 77 32 84 38 C91 45 84 51 87 60 C90 69 80 72 76 79 C71 87 60 83 50 88 Z" fill="${c}" ${outline(c)}/>
        <path d="M50 86 C49 62 49 44 52 26 M50 66 L32 54 M50 66 L70 52 M50 48 L36 38 M51 48 L66 36" fill="none" stroke="${shade(c, 0.5)}" stroke-width="3" stroke-linecap="round"/>`;
    },
    jar(c) {
      return `${shadow(50, 88, 30, 5)}<rect x="32" y="10" width="36" height="13" rx="4" fill="${shade(c, -0.45)}"/>
        <path d="M28 24 h44 q8 6 8 16 v38 q0 10 -10 10 h-40 q-10 0 -10 -10 v-38 q0 -10 8 -16 z" fill="${shade(c, 0.55)}" ${outline(c)}/>
        <path d="M22 48 h56 v30 q0 8 -9 8 h-38 q-9 0 -9 -8 z" fill="${c}"/>`;
    },
    toast(c) {
      return `${shadow(50, 86, 36, 6)}<path d="M18 40 C10 24 24 14 36 16 H64 C76 14 90 24 82 40 V80 q0 6 -6 6 H24 q-6 0 -6 -6 z" fill="${shade(c, -0.15)}" ${outline(c)}/>
        <path d="M25 40 C20 29 29 23 37 24 H63 C71 23 80 29 75 40 V78 H25 z" fill="${shade(c, 0.35)}"/>`;
    },
    bowl(c) {
      return `${shadow(50, 88, 30, 5)}<path d="M8 44 h84 c0 26 -16 40 -30 42 h-24 c-14 -2 -30 -16 -30 -42 z" fill="${c}" ${outline(c)}/>
        <ellipse cx="50" cy="44" rx="42" ry="11" fill="${shade(c, 0.6)}" ${outline(c)}/>`;
    },
    nigiri(c, light) {
      // Flesh of another colour inside is that of shellfish, which has a tail and a seam.
      const across = [0, 1, 2, 3].map((i) => `M${26 + 16 * i} ${34 - (i === 1 || i === 2 ? 4 : 0)} q6 9 0 18`).join(" ");
      const tail = light ? `<path d="M72 40 C78 22 84 10 99 5 L94 20 L100 32 C94 44 86 48 76 46 Z" fill="${shade(c, -0.3)}" ${outline(c)}/>` : "";
      return `${shadow(50, 82, 42, 6)}
        <rect x="12" y="46" width="76" height="33" rx="15" fill="#fffdf6" stroke="#b9b09c" stroke-width="2.4"/>
        ${[[26, 66], [38, 70], [62, 70], [76, 66]].map(([x, y]) => `<path d="M${x - 4} ${y} q4 -4 8 0" fill="none" stroke="#cfc6b2" stroke-width="2" stroke-linecap="round"/>`).join("")}${tail}
        <path d="M7 56 C8 34 28 24 54 24 C78 24 93 36 93 55 C86 62 80 52 70 54 C56 58 46 52 34 56 C24 60 14 63 7 56 Z" fill="${c}" ${outline(c)}/>
        <path d="${light ? "M10 46 Q50 28 88 46 M22 32 V50 M34 28 V48 M66 28 V48 M77 32 V50" : across}" fill="none" stroke="${light || shade(c, 0.62)}" stroke-width="3.2" stroke-linecap="round"/>
        <path d="M43 24 h13 v54 h-13 z" fill="#24402f" stroke="#13251b" stroke-width="2"/>`;
    },
    roll(c, light) {
      const stick = `<rect x="-10" y="-6" width="20" height="12" fill="${light}" stroke="${shade(c, -0.35)}" stroke-width="1.6"/><path d="M-9 -5.2 H9 V0 H-9 Z" fill="${c}"/>`;
      const piece = (x, y) => `<g transform="translate(${x} ${y})"><path d="M-23 0 v18 a23 13 0 0 0 46 0 v-18 z" fill="#1d3427" stroke="#101f17" stroke-width="2"/>
        <ellipse rx="23" ry="13" fill="#24402f" stroke="#101f17" stroke-width="2"/><ellipse rx="19" ry="10.2" fill="#fffdf6"/>
        ${light ? stick : `<ellipse rx="9.5" ry="5.4" fill="${c}" stroke="${shade(c, -0.35)}" stroke-width="1.6"/><path d="M-5 -1 q5 -3 10 0" fill="none" stroke="${shade(c, 0.6)}" stroke-width="1.8"/>`}</g>`;
      return shadow(50, 84, 44, 7) + piece(50, 30) + piece(27, 54) + piece(73, 54);
    },
    burger(c, wrap = "#3f7fbf") {
      return `${shadow(50, 88, 38, 6)}
        <path d="M12 50 C12 24 32 12 50 12 C68 12 88 24 88 50 Z" fill="${c}" ${outline(c)}/>
        ${[[36, 28], [50, 22], [64, 29], [45, 38], [70, 41], [57, 41]].map(([x, y]) => `<ellipse cx="${x}" cy="${y}" rx="3.2" ry="1.9" fill="#fdf3d8" transform="rotate(-20 ${x} ${y})"/>`).join("")}
        <path d="M8 48 L20 53 L32 47 L44 53 L56 47 L68 53 L80 47 L92 50 L84 80 Q82 88 74 88 H26 Q18 88 16 80 Z" fill="${wrap}" ${outline(wrap)}/>
        <path d="M20 56 L30 86 M42 56 L44 87 M60 54 L57 87 M80 54 L71 86" stroke="${shade(wrap, 0.45)}" stroke-width="4.6" opacity=".85"/>
        <circle cx="50" cy="70" r="9" fill="#fff" opacity=".92"/><path d="M46 70 l3 4 l6 -8" fill="none" stroke="${wrap}" stroke-width="3" stroke-linecap="round" stroke-linejoin="round"/>`;
    },
  };

  // The robot's gripper, from above: wrist, palm, and two fingers towards the right.
  const finger = '<path class="finger" d="M36 38 L44 17 Q46 12 52 12 L90 14 Q97 15 96 21 L94 28 L57 25 L49 43 Z"/>';
  const gripper = `<g fill="#d5e0ec" stroke="#54779f" stroke-width="3" stroke-linejoin="round"><g>${finger}</g><g transform="matrix(1 0 0 -1 0 100)">${finger}</g>
    <rect x="22" y="31" width="26" height="38" rx="9" fill="#bccde0"/><circle cx="17" cy="50" r="14"/><circle cx="17" cy="50" r="5" fill="#54779f" stroke="none"/></g>`;

  // Furniture: `w` is its width when its height is 100.
  const PLACES = {
    board: (w) => `<rect x="4" y="8" width="${w - 8}" height="84" rx="12" fill="#d8b98c"/><rect x="4" y="8" width="${w - 8}" height="78" rx="12" fill="#e6cda4"/>
      <path d="M12 30 H${w - 12} M12 50 H${w - 12} M12 70 H${w - 12}" stroke="#d3b68a" stroke-width="2"/>`,
    plate: (w) => `<ellipse cx="${w / 2}" cy="54" rx="${w / 2 - 6}" ry="42" fill="#c9d2da"/><ellipse cx="${w / 2}" cy="50" rx="${w / 2 - 6}" ry="41" fill="#fff" stroke="#c3ccd4" stroke-width="2"/>
      <ellipse cx="${w / 2}" cy="50" rx="${w / 2 - 22}" ry="29" fill="#f4f7f9" stroke="#d6dde3" stroke-width="2"/>`,
    counter: (w) => `<rect x="4" y="8" width="${w - 8}" height="84" rx="8" fill="#b6bfc7"/><rect x="4" y="8" width="${w - 8}" height="78" rx="8" fill="#d5dbe0"/>
      <path d="M14 22 L34 14 M${w - 34} 78 L${w - 14} 70" stroke="#eef1f3" stroke-width="4" stroke-linecap="round"/>`,
    cutting: (w) => `<rect x="4" y="10" width="${w - 8}" height="82" rx="14" fill="#b98a55"/><rect x="4" y="8" width="${w - 8}" height="79" rx="14" fill="#cfa26c"/>
      <circle cx="${w - 19}" cy="24" r="7" fill="#f3eee4"/><path d="M18 26 L36 22 M22 74 L52 68 M${w - 52} 78 L${w - 28} 73" stroke="#b98a55" stroke-width="2.6" stroke-linecap="round"/>`,
    pot: (w) => `<path d="M6 42 h${w - 12}" stroke="#59646e" stroke-width="13" stroke-linecap="round"/>
      <path d="M20 30 h${w - 40} v46 q0 18 -18 18 h${-(w - 76)} q-18 0 -18 -18 z" fill="#7a8894" stroke="#59646e" stroke-width="2.4"/>
      <ellipse cx="${w / 2}" cy="30" rx="${w / 2 - 20}" ry="17" fill="#414b54"/><ellipse cx="${w / 2}" cy="33" rx="${w / 2 - 26}" ry="12" fill="#a9c8d8"/>`,
    mat: (w) => `<rect x="4" y="8" width="${w - 8}" height="84" rx="4" fill="#9fb26a"/>
      ${[0, 1, 2, 3, 4, 5, 6, 7].map((i) => `<rect x="4" y="${9 + 10.4 * i}" width="${w - 8}" height="8.2" rx="4" fill="${i % 2 ? "#c6d594" : "#d3e0a6"}"/>`).join("")}
      <path d="M${w * 0.28} 8 V92 M${w * 0.72} 8 V92" stroke="#8a6f45" stroke-width="2.4"/>`,
    grill: (w) => `<rect x="4" y="8" width="${w - 8}" height="84" rx="10" fill="#39424a"/><rect x="10" y="14" width="${w - 20}" height="72" rx="6" fill="#515c66"/>
      ${[0, 1, 2, 3, 4, 5].map((i) => `<rect x="14" y="${19 + 11.4 * i}" width="${w - 28}" height="5" rx="2.5" fill="#2b3238"/>`).join("")}`,
    shelf: (w) => `<rect x="4" y="8" width="${w - 8}" height="84" rx="6" fill="#c4a377"/><rect x="10" y="14" width="${w - 20}" height="66" rx="3" fill="#e9dcc6"/>
      <rect x="4" y="80" width="${w - 8}" height="12" rx="4" fill="#a98353"/>`,
    tray: (w) => `<rect x="4" y="8" width="${w - 8}" height="84" rx="16" fill="#b4473f"/><rect x="10" y="13" width="${w - 20}" height="72" rx="12" fill="#d9695f"/>
      <rect x="18" y="21" width="${w - 36}" height="56" rx="8" fill="#e27d73"/>`,
    human_hand: (w) => `<g transform="translate(${w / 2 - 50} 0)"><path d="M28 96 C20 84 12 70 8 58 C6 52 14 48 18 54 L27 66 L24 26 C23 18 33 17 34 25 L38 52 L40 16 C40 8 51 8 51 16 L52 52 L58 20 C59 12 69 14 68 22 L64 55 L74 34 C78 27 86 31 84 38 C80 54 78 74 68 96 Z" fill="#f6d3b3" stroke="#d3a57c" stroke-width="2.4" stroke-linejoin="round"/></g>`,
    robot_hand: (w) => `<g transform="translate(${w / 2 - 50} 0)">${gripper}</g>`,
  };

  /** A thing whose look no file defines: its name on a tile. */
  function tile(name, label, isDish) {
    const colour = ownColour(name);
    const words = label.split(/\s+/).slice(0, 3);
    const longest = Math.max(...words.map((word) => word.length));
    const size = Math.min(24, 150 / Math.max(longest, 4));
    const lines = words.map((word, i) => `<text x="50" y="${50 + (i - (words.length - 1) / 2) * size * 1.08}" font-size="${number(size)}" text-anchor="middle" dominant-baseline="central" font-weight="700" fill="#fff">${escaped(word)}</text>`).join("");
    const body = isDish
      ? `<path d="M10 70 C10 34 30 22 50 22 C70 22 90 34 90 70 Z" fill="${colour}" ${outline(colour)}/><circle cx="50" cy="17" r="6" fill="${colour}"/><rect x="4" y="70" width="92" height="9" rx="4" fill="${shade(colour, -0.35)}"/>`
      : `<rect x="10" y="14" width="80" height="72" rx="16" fill="${colour}" ${outline(colour)}/>`;
    return shadow(50, 88, 40, 5) + body + lines;
  }

  function picture(name, { label, look }, isDish) {
    const draw = look && ITEMS[look.shape];
    return draw ? draw(look.colours[0] || ownColour(name), look.colours[1]) : tile(name, label, isDish);
  }

  const svg = (inside, box = "0 0 100 100", more = "") => `<svg viewBox="${box}" ${more} aria-hidden="true">${inside}</svg>`;

  return {
    /** Picture of an item of the scene. */
    item: (scene, name) => svg(picture(name, scene.items[name], false)),
    /** Picture of a dish's final product. */
    dish: (scene, name) => svg(picture(name, scene.dishes[name], true)),
    /** Picture of stacked items, the last one on top. */
    stack(scene, names) {
      const scale = names.length > 2 ? 0.6 : 0.7, step = names.length > 2 ? 21 : 26;
      const first = 50 + (step * (names.length - 1)) / 2;
      return svg(names.map((name, i) => `<g transform="translate(50 ${first - i * step}) scale(${scale}) translate(-50 -50)">${picture(name, scene.items[name], false)}</g>`).join(""));
    },
    /**
     * Picture of the furniture of a place that is `w` wide and 100 high; it fills its box, or keeps its proportions in
     * it.
     */
    place(shape, w, keeps = false) {
      const draw = PLACES[shape] || PLACES.counter;
      return svg(draw(w), `0 0 ${number(w)} 100`, keeps ? "" : 'preserveAspectRatio="none"');
    },
    /** Cells of a display tag (marker): rows of "#" and " ". */
    tag(rows) {
      const cells = rows.flatMap((row, y) => [...row].map((cell, x) => (cell === "#" ? `M${x} ${y}h1v1h-1z` : "")));
      return svg(`<rect width="${rows.length}" height="${rows.length}" fill="#fff"/><path d="${cells.join("")}" fill="#000" shape-rendering="crispEdges"/>`, `0 0 ${rows.length} ${rows.length}`);
    },
    GRIPPER: svg(gripper),
    TRASH: svg('<path d="M24 30 L31 92 H69 L76 30 Z" fill="#e0b6b1" stroke="#8a4a44" stroke-width="3" stroke-linejoin="round"/><path d="M16 28 H84 M40 26 V17 H60 V26 M40 42 L43 80 M60 42 L57 80" fill="none" stroke="#8a4a44" stroke-width="5" stroke-linecap="round" stroke-linejoin="round"/>'),
    /** A button of a gamepad; a standard one by where it is, another one by its number from 1. */
    pad(number, isStandard) {
      const dots = [[50, 80], [80, 50], [20, 50], [50, 20]], arms = { 12: "M36 36 V8 H64 V36 Z", 13: "M36 64 V92 H64 V64 Z", 14: "M36 36 H8 V64 H36 Z", 15: "M64 36 H92 V64 H64 Z" };
      const names = { 4: "L1", 5: "R1", 6: "L2", 7: "R2" }, sticks = { 17: "L", 18: "R" }, pressed = { 10: "L", 11: "R" }, small = { 8: 22, 9: 58 };
      if (!isStandard || !(number in { ...dots, ...arms, ...names, ...sticks, ...pressed, ...small })) return String(number + 1);
      if (names[number]) return names[number];
      if (number < 4) return svg(dots.map(([x, y], at) => `<circle cx="${x}" cy="${y}" r="15" fill="currentColor" opacity="${at === number ? 1 : 0.35}"/>`).join(""));
      // The two in the middle of the gamepad have other names on each make.
      const body = "M24 14 H76 C100 14 104 86 88 86 C76 86 74 68 62 68 H38 C26 68 24 86 12 86 C-4 86 0 14 24 14 Z";
      if (small[number]) return svg(`<path d="${body}" fill="none" stroke="currentColor" stroke-width="5" opacity=".5"/>${Object.entries(small).map(([at, x]) => `<rect x="${x}" y="30" width="20" height="20" rx="6" fill="currentColor" opacity="${Number(at) === number ? 1 : 0.35}"/>`).join("")}`);
      if (arms[number]) return svg(`<path d="M36 8 H64 V36 H92 V64 H64 V92 H36 V64 H8 V36 H36 Z" fill="currentColor" opacity=".35"/><path d="${arms[number]}" fill="currentColor"/>`);
      // A push to a side has arrows aside, a press of the stick one into it.
      const stick = (letter, arrows) => svg(`<circle cx="50" cy="58" r="34" fill="none" stroke="currentColor" stroke-width="8"/><text x="50" y="61" font-size="46" font-weight="700" text-anchor="middle" dominant-baseline="central" fill="currentColor">${letter}</text><path d="${arrows}" fill="currentColor"/>`);
      return sticks[number] ? stick(sticks[number], "M8 38 V78 L-14 58 Z M92 38 V78 L114 58 Z") : stick(pressed[number], "M28 -12 H72 L50 16 Z");
    },
  };
})();
