"use strict";
/** What is to be heard, where the session wants it: a tone for a press without effect, another one for a signal, and signals in words. */
const Sound = (() => {
  // Each tone: its notes, as frequency in Hz, beginning and duration in seconds.
  const TONES = { effectless: [[185, 0, 0.16]], signal: [[659, 0, 0.13], [880, 0.14, 0.2]] };
  const LOUDNESS = 0.07, SOFT_S = 0.015;
  let isOn = false, speaks = "", context = null, told = () => {};

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

  /** The browser's voice for the language of the page, if it has one. */
  const voice = () => (window.speechSynthesis ? speechSynthesis.getVoices() : []).find(({ lang }) => lang.toLowerCase().replace("_", "-").split("-")[0] === speaks);

  /** Speaks words at once, also where others are spoken still; without words, the voice falls silent. */
  function say(words) {
    const speaker = speaks && voice();
    if (!speaker) return;
    speechSynthesis.cancel();
    if (words) speechSynthesis.speak(Object.assign(new SpeechSynthesisUtterance(words), { voice: speaker, lang: speaker.lang }));
  }

  /** Tells whether there is a voice, where signals are spoken; a browser may know its voices only after a while. */
  const tellVoice = () => speaks && told({ kind: "voice", there: Boolean(voice()) });

  function build(scene) {
    [isOn, speaks] = [scene.sound, scene.voice ? scene.language.split("-")[0].toLowerCase() : ""];
    tellVoice();
  }

  function begin(tell) {
    told = tell;
    if (window.speechSynthesis) speechSynthesis.addEventListener("voiceschanged", tellVoice);
  }

  for (const kind of ["pointerdown", "pointerup", "keydown"]) window.addEventListener(kind, wake, true);
  return { begin, build, play, say, tellVoice, isOn: () => isOn || Boolean(speaks), hasVoice: () => !speaks || Boolean(voice()) };
})();
