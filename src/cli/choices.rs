//! Settings of a session file as the command line says them.

use clap::ValueEnum;

use crate::communication::concept::ConceptName;
use crate::session::settings::{ArmKind, Condition, GazeSource, ParticipantKind};

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum ParticipantArg {
    /// A simulated person.
    Simulated,
    /// Somebody at this keyboard: tab switches between the wizard's and the participant's keys.
    Keyboard,
    /// Somebody at the wall display: a page in a browser, with keys, gamepad or touch.
    Display,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum GazeArg {
    /// The simulated person's.
    Simulated,
    /// The mouse pointer over the kitchen, at the console or on the wall display.
    Mouse,
    /// Pupil Core, through Pupil Capture.
    Pupil,
    /// What was recorded before: see --gaze-file.
    File,
    /// Lines of JSON over TCP or UDP on localhost.
    Json,
    /// No gaze at all.
    None,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum ArmArg {
    /// By a simulated UR5 that presses the buttons, slows near the hand, and stops when it touches it.
    Physics,
    /// By the clock: a while by chance.
    Timed,
}

impl From<ArmArg> for ArmKind {
    fn from(arm: ArmArg) -> ArmKind {
        match arm {
            ArmArg::Physics => ArmKind::Physics,
            ArmArg::Timed => ArmKind::Timed,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum ConditionArg {
    /// Nobody.
    None,
    /// The wizard.
    Wizard,
    /// The assistant, by itself.
    Assistant,
}

/// By what an assistant decides what to say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ConceptArg {
    /// What saves more presses than a signal costs.
    TomCom,
    /// What is believed wrong surely enough.
    Tom,
    /// After an error, the next good presses; they are advice, since no signal says them.
    Dev,
    /// Nothing is said.
    None,
}

impl From<ConceptArg> for ConceptName {
    fn from(concept: ConceptArg) -> ConceptName {
        match concept {
            ConceptArg::TomCom => ConceptName::TomCom,
            ConceptArg::Tom => ConceptName::Tom,
            ConceptArg::Dev => ConceptName::Dev,
            ConceptArg::None => ConceptName::None,
        }
    }
}

impl From<ParticipantArg> for ParticipantKind {
    fn from(participant: ParticipantArg) -> ParticipantKind {
        match participant {
            ParticipantArg::Simulated => ParticipantKind::Simulated,
            ParticipantArg::Keyboard => ParticipantKind::Keyboard,
            ParticipantArg::Display => ParticipantKind::Display,
        }
    }
}

impl From<GazeArg> for GazeSource {
    fn from(gaze: GazeArg) -> GazeSource {
        match gaze {
            GazeArg::Simulated => GazeSource::Simulated,
            GazeArg::Mouse => GazeSource::Mouse,
            GazeArg::Pupil => GazeSource::Pupil,
            GazeArg::File => GazeSource::File,
            GazeArg::Json => GazeSource::Json,
            GazeArg::None => GazeSource::None,
        }
    }
}

impl From<ConditionArg> for Condition {
    fn from(condition: ConditionArg) -> Condition {
        match condition {
            ConditionArg::None => Condition::None,
            ConditionArg::Wizard => Condition::Wizard,
            ConditionArg::Assistant => Condition::Assistant,
        }
    }
}

impl From<SimulatedCondition> for Condition {
    fn from(condition: SimulatedCondition) -> Condition {
        match condition {
            SimulatedCondition::None => Condition::None,
            SimulatedCondition::Wizard => Condition::Wizard,
            SimulatedCondition::Assistant => Condition::Assistant,
        }
    }
}

/// Who sends signals in simulated trials.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum SimulatedCondition {
    /// Nobody.
    None,
    /// The wizard, where the session scripts one.
    Wizard,
    /// The assistant, by itself.
    Assistant,
}
