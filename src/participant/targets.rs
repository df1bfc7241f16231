//! What a simulated participant does while its tracker's calibration is checked: it looks at the targets.

use super::simulated::SimulatedParticipant;
use crate::base::time::SessionTime;
use crate::gaze::GazeSample;

impl SimulatedParticipant {
    /// A target is shown, or none any more. The eyes that look at targets are copies, so that a check, which comes before or
    /// between what happens in the trial, changes nothing in it; the tracker's offset is the same.
    pub fn on_target(&mut self, now: SessionTime, target: Option<[f64; 2]>) {
        match (target, &mut self.at_targets) {
            (None, eyes) => *eyes = None,
            (Some(point), Some(eyes)) => eyes.look_at(now, point),
            (Some(point), eyes) => {
                let mut begun = self.eyes.clone();
                begun.start(now);
                begun.look_at(now, point);
                *eyes = Some(begun);
            }
        }
    }

    /// When the next sample of a check is due.
    pub fn target_due(&self) -> Option<SessionTime> {
        self.at_targets.as_ref().map(|eyes| eyes.due())
    }

    /// The sample of a check that is due now.
    pub fn look_at_target(&mut self, now: SessionTime) -> Option<GazeSample> {
        self.at_targets.as_mut().map(|eyes| eyes.sample(now))
    }
}
