//! Settings and circumstances of recordings, for the paragraph on methods in the report.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use tomcom_core::kitchen::{LocationId, LocationKind};
use tomcom_people::wizard::{WizardKind, WizardSpec};
use tomcom_session::settings::{ArmKind, Condition, ParticipantKind, RobotSpec};
use tomcom_session::{LogHeader, Session};

/// Settings and circumstances by name (key), from one or several recordings; every value that occurred is kept.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RecordingFacts {
    found: BTreeMap<String, BTreeSet<String>>,
}

impl RecordingFacts {
    pub fn from_session(header: &LogHeader, session: &Session) -> RecordingFacts {
        let spec = &header.session;
        let mut facts = RecordingFacts::default();
        let mut is = |key: &'static str, value: String| facts.note(key, value);
        is("program", header.program.clone());
        is("format", header.version.to_string());
        is("kitchen", session.kitchen.title.clone());
        is("presses", spec.trial.presses.to_string());
        is("seconds", spec.trial.seconds.to_string());
        is("seed", spec.seed.to_string());
        is("robot", presses_of(&spec.robot));
        is("shown", format!("{} s", spec.signals.shown_s));
        is("cost", spec.assistant.cost_of_communication.to_string());
        is("initiative", format!("{} s", spec.robot.initiative_s));
        let places = session.kitchen.locations.iter().enumerate().filter(|(index, location)| {
            location.kind != LocationKind::Order && session.highlights().holds(LocationId(*index as u8))
        });
        is("highlights", places.map(|(_, location)| location.name.replace('_', " ")).collect::<Vec<_>>().join(", "));
        if spec.participant.kind == ParticipantKind::Simulated {
            // Parameters are numbers, and lists and tables of numbers, which can always be serialised.
            let population = spec.participant.population.clone().unwrap_or_default();
            let mut traits = Vec::new();
            flatten("", &serde_json::to_value(population).unwrap_or_default(), &mut traits);
            is("traits", traits.join(", "));
        }
        is("gaze", spec.participant.gaze.entry().title.to_string());
        is("participant", participant_kind(spec.participant.kind).to_string());
        if let Some(orders) = spec.trial.orders {
            is("orders", orders.to_string());
        }
        if let Some(step) = &spec.step {
            is("plan", format!("{} ({})", step.plan, step.digest));
        }
        if spec.trial.condition == Condition::Wizard {
            match spec.wizard.kind {
                WizardKind::Person => is("wizard saw", spec.console.visibility.title().to_string()),
                WizardKind::Scripted => is("scripted wizard", script(&spec.wizard)),
            }
            if let Some(offers) = spec.wizard.offers.as_ref().filter(|_| spec.script_reads_offers()) {
                let (taken, reads_s) = (100.0 * offers.takes, offers.reads_s);
                is("script's offers", format!("it takes {taken:.0} % of them, after {reads_s} s in the median"));
            }
            if session.unblinded {
                is("unblinded", String::new());
            }
        }
        if let Some(check) = &session.calibrated {
            is("accuracy", format!("{:.1}", check.accuracy_deg()));
        }
        facts
    }

    /// Name of the circumstance that raters coded errors of a simulated participant.
    pub const UNUSED_CODES: &str = "unused codes";

    pub(crate) fn note(&mut self, key: &str, value: String) {
        self.found.entry(key.to_string()).or_default().insert(value);
    }

    pub fn add(&mut self, other: RecordingFacts) {
        for (key, values) in other.found {
            self.found.entry(key).or_default().extend(values);
        }
    }

    /// All values of a setting or circumstance as text; `None` if there are none.
    pub fn all(&self, key: &str) -> Option<String> {
        let values: Vec<&str> = self.found.get(key)?.iter().map(String::as_str).collect();
        let (last, others) = values.split_last()?;
        Some(match others {
            [] => (*last).to_string(),
            _ => format!("{} and {last}", others.join(", ")),
        })
    }

    pub fn has(&self, key: &str) -> bool {
        self.found.contains_key(key)
    }
}

fn flatten(name: &str, value: &Value, all: &mut Vec<String>) {
    match value {
        Value::Object(fields) => match (fields.get("median"), fields.get("sigma")) {
            (Some(median), Some(sigma)) => all.push(format!("{name} {median} (spread {sigma})")),
            _ => {
                for (key, value) in fields {
                    let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                    flatten(&name, value, all);
                }
            }
        },
        Value::Null => {}
        value => all.push(format!("{name} {value}")),
    }
}

fn presses_of(robot: &RobotSpec) -> String {
    match robot.arm {
        ArmKind::Timed => format!("{} s in the median (spread {})", robot.press_s, robot.press_spread),
        ArmKind::Physics => "as long as its simulated arm takes".to_string(),
        ArmKind::Ur(_) => "as long as its arm takes, a real UR5".to_string(),
    }
}

fn script(wizard: &WizardSpec) -> String {
    format!(
        "median reaction time {} s; it notices {:.0} % of the errors and {:.0} % of the overlooked changes, and assumes another \
         cause in {:.0} %",
        wizard.reaction_s,
        100.0 * wizard.sees_errors,
        100.0 * wizard.sees_overlooked,
        100.0 * wizard.guesses_wrong
    )
}

fn participant_kind(kind: ParticipantKind) -> &'static str {
    match kind {
        ParticipantKind::Simulated => "simulated",
        ParticipantKind::Keyboard => "people at the console's keyboard",
        ParticipantKind::Display => "people at the wall display",
        ParticipantKind::External => "an external program",
    }
}
