//! Values of command line options that stand for session settings.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

use clap::ValueEnum;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::settings::{ConceptSpec, ExternalMind};
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

/// Reads a whole number in this range.
pub(super) fn whole<N>(range: RangeInclusive<N>) -> impl Fn(&str) -> Result<N, String> + Clone + Send + Sync + 'static
where
    N: FromStr + PartialOrd + Display + Clone + Send + Sync + 'static,
{
    move |text: &str| {
        let right = || format!("wanted a whole number from {} to {}", range.start(), range.end());
        text.parse().ok().filter(|number| range.contains(number)).ok_or_else(right)
    }
}

/// Reads one of these values by its name; lists of choices say what each is.
fn named<T: Copy + Send + Sync + 'static, const N: usize>(
    values: [T; N],
    entry: fn(T) -> (&'static str, &'static str),
) -> impl TypedValueParser<Value = T> {
    let choices = values.map(|value| PossibleValue::new(entry(value).0).help(entry(value).1));
    PossibleValuesParser::new(choices)
        .try_map(move |name| values.into_iter().find(|value| entry(*value).0 == name).ok_or("no such name"))
}

/// Reads the name of a concept that can be asked about any recording.
pub(super) fn own_concept_parser() -> impl TypedValueParser<Value = ConceptName> {
    named(ConceptName::OWN, |concept| (concept.name(), concept.entry().sends))
}

/// Reads a concept's name, or the command line or address of an external concept.
pub(super) fn concept(text: &str) -> Result<ConceptSpec, String> {
    if let Some(name) = ConceptName::OWN.into_iter().find(|concept| concept.name() == text) {
        return Ok(name.into());
    }
    // A mistyped name is no program.
    if text.contains([' ', '/']) {
        return Ok(ConceptSpec::External(ExternalMind::new(text)));
    }
    let names = ConceptName::OWN.map(ConceptName::name).join(", ");
    Err(format!("wanted {names}, a command line such as \"python my_agent.py\", or tcp://127.0.0.1:PORT"))
}

pub(super) fn gaze_parser() -> impl TypedValueParser<Value = GazeSource> {
    named(GazeSource::ALL, |source| (source.entry().name, source.entry().about))
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
