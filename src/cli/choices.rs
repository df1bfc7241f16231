//! Values of command line options that stand for session settings.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::settings::{ConceptSpec, ExternalMind};
use tomcom_session::settings::{ArmKind, Condition, GazeSource, ParticipantKind};

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
pub(super) fn named<T: Copy + Send + Sync + 'static, const N: usize>(
    choices: [(&'static str, T, &'static str); N],
) -> impl TypedValueParser<Value = T> {
    let possible = choices.map(|(name, _, about)| PossibleValue::new(name).help(about));
    PossibleValuesParser::new(possible).try_map(move |chosen| {
        choices.iter().find(|(name, ..)| *name == chosen).map(|choice| choice.1).ok_or("no such name")
    })
}

pub(super) fn participant_parser() -> impl TypedValueParser<Value = ParticipantKind> {
    named([
        ("simulated", ParticipantKind::Simulated, "A simulated participant"),
        (
            "keyboard",
            ParticipantKind::Keyboard,
            "A person at this keyboard: tab switches between the wizard's and the participant's keys",
        ),
        (
            "display",
            ParticipantKind::Display,
            "A person at the wall display: a page in a browser, with keys, gamepad or touch",
        ),
    ])
}

pub(super) fn arm_parser() -> impl TypedValueParser<Value = ArmKind> {
    named([
        (
            "physics",
            ArmKind::Physics,
            "A simulated UR5 that presses the buttons, slows near the hand, and stops when it touches the hand",
        ),
        ("timed", ArmKind::Timed, "A timed arm: every press takes a random duration"),
    ])
}

/// Who sends signals at the console.
pub(super) fn condition_parser() -> impl TypedValueParser<Value = Condition> {
    named([
        ("none", Condition::None, "Nobody sends signals"),
        ("wizard", Condition::Wizard, "The wizard sends signals"),
        ("assistant", Condition::Assistant, "The assistant sends signals by itself"),
    ])
}

/// Who sends signals in simulated trials.
pub(super) fn simulated_condition_parser() -> impl TypedValueParser<Value = Condition> {
    named([
        ("none", Condition::None, "Nobody sends signals in the simulated trials"),
        ("wizard", Condition::Wizard, "The scripted wizard of the session sends signals"),
        ("assistant", Condition::Assistant, "The assistant sends signals by itself"),
    ])
}

pub(super) fn gaze_parser() -> impl TypedValueParser<Value = GazeSource> {
    named(GazeSource::ALL.map(|source| (source.entry().name, source, source.entry().about)))
}

/// Reads the name of a concept that can be asked about any recording.
pub(super) fn own_concept_parser() -> impl TypedValueParser<Value = ConceptName> {
    named(ConceptName::OWN.map(|concept| (concept.name(), concept, concept.entry().sends)))
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
