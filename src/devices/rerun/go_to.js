// Rerun's page makes a viewer and starts it when it is loaded: this script is there before.
function goTo(timeline, time) {
  const original = wasm_bindgen.WebHandle.prototype.start;
  wasm_bindgen.WebHandle.prototype.start = function start(canvas) {
    const timer = setInterval(() => {
      const recording = this.get_active_recording_id();
      const range = recording && this.get_timeline_time_range(recording, timeline);
      if (!range || range.max < time) return;
      clearInterval(timer);
      this.set_time_for_timeline(recording, timeline, time);
    }, 200);
    return original.call(this, canvas);
  };
}
