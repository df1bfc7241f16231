//! Drop-outs of the simulated eye tracker: periods without gaze samples, on a seeded schedule.

use rand::RngExt;

use tomcom_core::base::rng::Stream;
use tomcom_core::base::time::SessionTime;

/// The schedule of the simulated eye tracker's drop-outs in one trial.
#[derive(Clone, Debug)]
pub struct GazeDropoutSchedule {
    random: Stream,
    every_s: f64,
    /// Natural logarithms of the shortest and the longest duration of a drop-out in seconds.
    lengths: [f64; 2],
    /// Beginning and end of the present or next drop-out; `None` before the first gaze sample.
    next: Option<[SessionTime; 2]>,
}

impl GazeDropoutSchedule {
    /// A schedule of drop-outs from the mean time between drop-outs, and the shortest and longest drop-out, in seconds.
    pub fn new(every_s: f64, [shortest_s, longest_s]: [f64; 2], random: Stream) -> GazeDropoutSchedule {
        GazeDropoutSchedule { random, every_s, lengths: [shortest_s.ln(), longest_s.ln()], next: None }
    }

    /// Whether the gaze sample that is due `now` is lost in a drop-out. The function must be called in the order of the
    /// samples' times.
    pub fn swallows(&mut self, now: SessionTime) -> bool {
        loop {
            let [begin, end] =
                *self.next.get_or_insert_with(|| after(now, self.every_s, self.lengths, &mut self.random));
            if now < end {
                return now >= begin;
            }
            self.next = Some(after(end, self.every_s, self.lengths, &mut self.random));
        }
    }
}

/// Draws the eye tracker's drop-out that follows `time`.
fn after(time: SessionTime, every_s: f64, [shortest, longest]: [f64; 2], random: &mut Stream) -> [SessionTime; 2] {
    let wait_s = -every_s * (1.0 - random.random::<f64>()).ln();
    let length_s = (shortest + (longest - shortest) * random.random::<f64>()).exp();
    let begin = time + SessionTime::from_secs_f64(wait_s);
    [begin, begin + SessionTime::from_secs_f64(length_s)]
}
