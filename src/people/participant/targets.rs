//! Behaviour of a simulated participant during a gaze accuracy check: the participant looks at the targets.

use super::simulated::SimulatedParticipant;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;

impl SimulatedParticipant {
    /// Shows a target of the gaze accuracy check, or removes it. A copy of the eyes looks at the target, so a check
    /// changes nothing in the trial; the copy has the same offset of the eye tracker.
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

    /// Session time at which the next gaze sample of the accuracy check is due.
    pub fn target_due(&self) -> Option<SessionTime> {
        self.at_targets.as_ref().map(|eyes| eyes.due())
    }

    /// Produces the simulated participant's gaze sample that is due now in a gaze accuracy check.
    pub fn look_at_target(&mut self, now: SessionTime) -> Option<GazeSample> {
        self.at_targets.as_mut().map(|eyes| eyes.sample(now))
    }
}
