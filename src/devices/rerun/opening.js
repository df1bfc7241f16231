// Rerun's page makes a viewer and starts it when it is loaded: this script is there before. While the recording loads, the
// page shows what has come so far, which looks like all there is: a note says that it is not.
function openRecording(timeline, end, time) {
  const clock = (ns) => {
    const s = Math.floor(ns / 1e9);
    return `${Math.floor(s / 60)}:${String(s % 60).padStart(2, "0")}`;
  };
  const note = document.createElement("div");
  note.id = "loading";
  note.style.cssText =
    "position:fixed;top:4px;left:50%;transform:translateX(-50%);z-index:10;padding:4px 12px;border-radius:4px;" +
    "background:#b3261e;color:#fff;font:14px sans-serif;pointer-events:none";
  note.textContent = "The recording is loading …";
  document.body.append(note);
  const original = wasm_bindgen.WebHandle.prototype.start;
  wasm_bindgen.WebHandle.prototype.start = function start(canvas) {
    let wanted = time;
    const timer = setInterval(() => {
      const recording = this.get_active_recording_id();
      const range = recording && this.get_timeline_time_range(recording, timeline);
      if (!range) return;
      const isWhole = Boolean(this.get_timeline_time_range(recording, end));
      if (wanted !== null && (isWhole || range.max >= wanted)) {
        this.set_time_for_timeline(recording, timeline, Math.min(wanted, range.max));
        wanted = null;
      }
      if (isWhole) {
        clearInterval(timer);
        note.remove();
      } else {
        const there = wanted === null ? "" : `; ${clock(wanted)} is not there yet`;
        note.textContent = `The recording is loading: up to ${clock(range.max)} so far${there}. Wait until this note is gone.`;
      }
    }, 200);
    return original.call(this, canvas);
  };
}
