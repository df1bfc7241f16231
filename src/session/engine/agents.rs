//! Construction of the robot and of the simulated participant from the settings of a trial.

use std::sync::Arc;

use crate::SessionSpec;
#[cfg(not(feature = "physics"))]
use crate::features::{Feature, MissingFeature};
#[cfg(feature = "physics")]
use crate::settings::ParticipantKind;
use crate::settings::{ArmKind, RobotSpec};
use crate::tracker::GazeGapSpec;
#[cfg(feature = "physics")]
use tomcom_arm::body::SimulatedArm;
#[cfg(feature = "physics")]
use tomcom_arm::reaching::ReachingBehaviour;
use tomcom_arm::worker::RobotTaskExecutor;
use tomcom_core::base::rng::stream;
use tomcom_core::kitchen::Kitchen;
use tomcom_people::participant::SimulatedParticipant;
use tomcom_people::participant::eyes::GazeDropoutSchedule;
use tomcom_people::participant::population::Experience;
use tomcom_people::wizard::ScriptedWizard;

/// The simulated participant of a trial. In a study plan, one simulated participant has several trials and improves
/// with practice.
pub(super) fn simulated_participant(kitchen: Arc<Kitchen>, spec: &SessionSpec, trial: u64) -> SimulatedParticipant {
    let person = spec.step.as_ref().map_or(trial, |step| u64::from(step.participant));
    let trials = spec.step.as_ref().and_then(|step| step.period).map_or(0, |period| period.saturating_sub(1));
    // Presses of earlier trials are practice; about half of a trial's presses are the human's.
    let presses = f64::from(trials) * f64::from(spec.trial.presses) / 2.0;
    let population = spec.participant.population.clone().unwrap_or_default();
    SimulatedParticipant::new(kitchen, &population, spec.seed, person, trial, Experience { trials, presses })
}

/// The scripted wizard of a trial, if it has one; the script reads offers where the session shows offers.
pub(super) fn scripted_wizard(kitchen: &Arc<Kitchen>, spec: &SessionSpec, trial: u64) -> Option<ScriptedWizard> {
    let (highlights, seed) = (spec.highlights(kitchen), spec.seed);
    let script = spec
        .scripts_wizard()
        .then(|| ScriptedWizard::new(kitchen.clone(), spec.wizard.clone(), highlights, seed, trial))?;
    Some(if spec.script_reads_offers() { script.reading_offers(seed, trial) } else { script })
}

/// Schedule of the gaps in the data of the simulated eye tracker in a trial.
pub(super) fn gaze_gaps(spec: &SessionSpec, trial: u64) -> Option<GazeDropoutSchedule> {
    let GazeGapSpec { every_s, shortest_s, longest_s } = *spec.tracker.gaps.as_ref()?;
    Some(GazeDropoutSchedule::new(every_s, [shortest_s, longest_s], stream(spec.seed, "tracker's gaps", trial)))
}

/// The robot of a trial, with the kind of arm that the settings name.
///
/// # Panics
/// The settings ask for an arm with simulated physics, and this build has none.
pub(super) fn trial_robot(kitchen: &Kitchen, spec: &SessionSpec, trial: u64) -> RobotTaskExecutor {
    let RobotSpec { press_s, press_spread, initiative_s, .. } = spec.robot;
    let robot = RobotTaskExecutor::new(press_s, press_spread, initiative_s, spec.seed, trial);
    match spec.robot.arm {
        ArmKind::Timed => robot,
        ArmKind::Physics => with_physics(robot, kitchen, spec, trial),
    }
}

#[cfg(feature = "physics")]
fn with_physics(robot: RobotTaskExecutor, kitchen: &Kitchen, spec: &SessionSpec, trial: u64) -> RobotTaskExecutor {
    let hand = match spec.participant.kind {
        ParticipantKind::Simulated => ReachingBehaviour::SIMULATED,
        ParticipantKind::Keyboard | ParticipantKind::Display => ReachingBehaviour::UNSEEN,
    };
    robot.with_body(SimulatedArm::new(kitchen, hand, spec.seed, trial))
}

#[cfg(not(feature = "physics"))]
fn with_physics(_: RobotTaskExecutor, _: &Kitchen, _: &SessionSpec, _: u64) -> RobotTaskExecutor {
    panic!("{}", MissingFeature(Feature::Physics))
}
