//! Values of command line options that stand for session settings.

use clap::ValueEnum;

use tomcom_core::communication::concept::ConceptName;
use tomcom_session::settings::{ArmKind, Condition, GazeSource, ParticipantKind};

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum ParticipantArg {
    /// A simulated participant.
    Simulated,
    /// A person at this keyboard: tab switches between the wizard's and the participant's keys.
    Keyboard,
    /// A person at the wall display: a page in a browser, with keys, gamepad or touch.
    Display,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum GazeArg {
    /// The simulated participant's gaze.
    Simulated,
    /// The mouse pointer over the kitchen, at the console or on the wall display.
    Mouse,
    /// The eye tracker Pupil Core, through the program Pupil Capture.
    Pupil,
    /// Recorded gaze from the file that --gaze-file names.
    File,
    /// Gaze samples as lines of JSON over TCP or UDP.
    Json,
    /// A stream of the Lab Streaming Layer: see [lsl.gaze] in the session file.
    Lsl,
    /// No gaze.
    None,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum ArmArg {
    /// A simulated UR5 that presses the buttons, slows near the hand, and stops when it touches the hand.
    Physics,
    /// A timed arm: every press takes a random duration.
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
    /// Nobody sends signals.
    None,
    /// The wizard sends signals.
    Wizard,
    /// The assistant sends signals by itself.
    Assistant,
}

/// Communication concept of the assistant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ConceptArg {
    /// Signals that save more presses than they cost (ToM-Com).
    TomCom,
    /// Signals about sufficiently certain false beliefs (ToM).
    Tom,
    /// Proposals of the next good presses after an error (DEV); on the display where the assistant acts by itself, at
    /// the console where a wizard decides.
    Dev,
    /// No signals.
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
            GazeArg::Lsl => GazeSource::Lsl,
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
    /// Nobody sends signals in the simulated trials.
    None,
    /// The scripted wizard of the session sends signals.
    Wizard,
    /// The assistant sends signals by itself.
    Assistant,
}
