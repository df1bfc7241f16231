"use strict";
/** Quiet tones, where the session wants them: one for a press without effect, another one for a signal, and none for anything else. */
const Sound = (() => {
  // Each tone: its notes, as frequency in Hz, beginning and duration in seconds.
  const TONES = { effectless: [[185, 0, 0.16]], signal: [[659, 0, 0.13], [880, 0.14, 0.2]] };
  const LOUDNESS = 0.07, SOFT_S = 0.015;
  let isOn = false, context = null;

  /** A browser lets a page sound once somebody touched it or pressed a key. */
  function wake() {
    if (!isOn) return;
    context = context || new AudioContext();
    if (context.state === "suspended") context.resume().catch(() => {});
  }

  function play(name) {
    if (!isOn || !context || context.state !== "running") return;
    for (const [hz, from, lasts] of TONES[name]) {
      const tone = context.createOscillator(), volume = context.createGain(), at = context.currentTime + from;
      tone.frequency.value = hz;
      volume.gain.setValueAtTime(0, at);
      volume.gain.linearRampToValueAtTime(LOUDNESS, at + SOFT_S);
      volume.gain.linearRampToValueAtTime(0, at + lasts);
      tone.connect(volume).connect(context.destination);
      tone.start(at);
      tone.stop(at + lasts);
    }
  }

  for (const kind of ["pointerdown", "pointerup", "keydown"]) window.addEventListener(kind, wake, true);
  return { build: (scene) => { isOn = scene.sound; }, play };
})();
