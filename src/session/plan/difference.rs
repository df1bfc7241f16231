//! What differs between two versions of a plan: the settings that can change a trial, and what participants are told, taught
//! and asked.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use serde_json::{Value, json};

use crate::header::RecordedFile;
use crate::plan::{PhaseSpec, PlanPosition, Questionnaire, Study, WantedRecording};
use crate::{LogHeader, SessionSpec};

/// What cannot change a trial: addresses, viewers, appearance and texts of the wizard's console. Who takes part in a
/// recording and which device its gaze comes from are no part of the plan either: both are chosen at the start of a
/// recording and written to its header. The model's parameters are in `human`, and the layout's text stands beside the
/// settings.
const CANNOT_CHANGE_A_TRIAL: [&str; 28] = [
    "layout",
    "human_model",
    "participant.code",
    "participant.kind",
    "participant.gaze",
    "participant.gaze_port",
    "participant.gaze_listen",
    "participant.gaze_from",
    "participant.gaze_senders",
    "participant.button_box",
    "tracker.address",
    "tracker.port",
    "tracker.record",
    "tracker.file",
    "tracker.file_start_s",
    "tracker.missing_confidence",
    "tracker.gaps",
    "console.ascii",
    "console.theme",
    "console.click_sends",
    "console.keys",
    "console.notes",
    "console.reasons",
    "console.bell",
    "display.listen",
    "display.port",
    "rerun",
    "video",
];

/// The settings that can change a trial, by their path. A switch that is off, as by default, is left out: a new one
/// leaves the digests of all plans as they are.
pub(super) fn what_can_change_a_trial(session: &SessionSpec) -> BTreeMap<String, Value> {
    let by_path = |session: &SessionSpec| {
        let mut values = BTreeMap::new();
        collect(serde_json::to_value(session).unwrap_or_default(), "", &mut values);
        values
    };
    let default = toml::from_str(r#"layout = """#).map(|spec| by_path(&spec)).unwrap_or_default();
    let is_off = |value: &Value| matches!(value, Value::Null | Value::Bool(false));
    let mut values = by_path(session);
    values.retain(|path, value| !is_off(value) || default.get(path) != Some(&*value));
    values
}

/// A setting, or a text, that is not the same in two versions of a plan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlanDifference {
    /// Its dotted path in the session file ("trial.presses"), or what it is in words, and its index among settings with
    /// this path.
    pub path: String,
    pub nth: usize,
    /// Before and now, each as JSON; `None` where it is not set, both of a text that is only named.
    pub values: [Option<Value>; 2],
}

/// What may have changed where a recording shows no difference.
const UNRECORDED: &str = "something that this recording does not show: participants, block, consent or questionnaires under [plan], or \
                          what another trial begins or ends with";
/// Longest value that a message has in full, in characters, and most differences.
const LONGEST_VALUE: usize = 60;
const MOST_NAMED: usize = 8;

impl PlanDifference {
    fn text(path: String) -> PlanDifference {
        PlanDifference { path, nth: 0, values: [None, None] }
    }

    /// The values as text; of long ones, from where they differ.
    fn told(&self) -> [Option<String>; 2] {
        let texts = self.values.each_ref().map(|value| value.as_ref().map(Value::to_string));
        let [before, now] = texts.each_ref().map(|text| text.as_deref().unwrap_or_default());
        let same = before.chars().zip(now.chars()).take_while(|(before, now)| before == now).count();
        let is_long = [before, now].iter().any(|text| text.chars().count() > LONGEST_VALUE);
        let start = if is_long { same.saturating_sub(LONGEST_VALUE / 4) } else { 0 };
        let part = |text: String| {
            let shown: String = text.chars().skip(start).take(LONGEST_VALUE).collect();
            let goes_on = text.chars().count() > start + LONGEST_VALUE;
            [if start > 0 { "…" } else { "" }, &shown, if goes_on { "…" } else { "" }].concat()
        };
        texts.map(|text| text.map(part))
    }

    /// As it was, if now comes before.
    pub fn reversed(self) -> PlanDifference {
        let [before, now] = self.values;
        PlanDifference { values: [now, before], ..self }
    }

    /// The setting before, and now, as a line of its table: "presses = 40", "no presses".
    pub fn settings(&self) -> [String; 2] {
        let key = self.path.rsplit('.').next().unwrap_or(&self.path);
        self.told().map(|value| value.map_or_else(|| format!("no {key}"), |value| format!("{key} = {value}")))
    }
}

impl fmt::Display for PlanDifference {
    /// "trial.presses from 20 to 40", "recipes/sushi.toml".
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.told() {
            [None, None] => write!(out, "{}", self.path),
            told => {
                let [before, now] = told.map(|value| value.unwrap_or("not set".to_string()));
                write!(out, "{} from {before} to {now}", self.path)
            }
        }
    }
}

impl Study {
    /// What participants are taught and asked that is not as in another version of the plan.
    pub fn texts_changed_since(&self, before: &Study) -> Vec<PlanDifference> {
        let texts = |study: &Study| {
            let mut values = BTreeMap::new();
            for asked in &study.questionnaires {
                collect(by_item(asked), &format!("questionnaire {}", asked.name), &mut values);
            }
            collect(json!(study.tutorial), "tutorial", &mut values);
            values
        };
        differing(&texts(before), &texts(self))
    }

    /// What has changed since a recording of the plan that has another digest, as far as the recording shows. `kitchen`:
    /// layout and recipes as they are now.
    pub fn changed_since(&self, recorded: &LogHeader, kitchen: [&RecordedFile; 2]) -> Vec<PlanDifference> {
        let files = [(&recorded.layout, kitchen[0]), (&recorded.recipes, kitchen[1])].into_iter();
        let mut changed: Vec<PlanDifference> = files
            .filter(|(before, now)| before.text != now.text)
            .map(|(_, now)| PlanDifference::text(now.path.trim_start_matches("../").to_string()))
            .collect();
        let Some(step) = &recorded.session.step else { return changed };
        let participant = step.participant as usize;
        let slot = self.slots(participant).iter().position(|slot| slot.period == step.period);
        if let Some(slot) = slot.filter(|_| participant < self.plan.codes().len()) {
            let wanted = WantedRecording { participant, slot, attempt: step.attempt, instructed: false };
            // Only live sessions have a time at which they were started.
            let (spec, _) = match (&recorded.started, step.period) {
                (None, Some(period)) => self.simulated(participant, period),
                _ => self.settings(wanted),
            };
            let without_step = |spec: &SessionSpec| SessionSpec { step: None, ..spec.clone() };
            changed.extend(differences(&without_step(&recorded.session), &without_step(&spec)));
            if let Some(now) = &spec.step {
                changed.extend(step.differences(now));
            }
        }
        changed
    }
}

/// What changed in another version of a plan, in one line; of many, the first.
pub fn listed(changed: &[PlanDifference]) -> String {
    if changed.is_empty() {
        return UNRECORDED.to_string();
    }
    let named: Vec<String> = changed.iter().take(MOST_NAMED).map(PlanDifference::to_string).collect();
    let more = changed.len().saturating_sub(MOST_NAMED);
    named.join("; ") + &if more == 0 { String::new() } else { format!("; and {more} more") }
}

/// The settings that differ and can change a trial.
pub fn differences(before: &SessionSpec, now: &SessionSpec) -> Vec<PlanDifference> {
    let values = [before, now].map(what_can_change_a_trial);
    let wholes = [before, now].map(|spec| serde_json::to_value(spec).unwrap_or_default());
    let paths: BTreeSet<&String> = values.iter().flat_map(BTreeMap::keys).collect();
    let mut found: Vec<PlanDifference> = Vec::new();
    for path in paths.into_iter().filter(|path| values[0].get(*path) != values[1].get(*path)) {
        // A list is one setting, and the numbers of lists are no part of a path in the session file.
        let is_number = |part: &&str| part.bytes().all(|byte| byte.is_ascii_digit());
        let mut parts: Vec<&str> = path.split('.').collect();
        while parts.pop_if(|part| is_number(&&**part)).is_some() {}
        let (numbers, names): (Vec<&str>, Vec<&str>) = parts.iter().partition(|part| is_number(part));
        let nth = numbers.first().and_then(|number| number.parse().ok()).unwrap_or(0);
        let value = |whole: &Value| whole.pointer(&format!("/{}", parts.join("/"))).filter(|it| !it.is_null()).cloned();
        let one = PlanDifference { path: names.join("."), nth, values: wholes.each_ref().map(value) };
        if !found.contains(&one) {
            found.push(one);
        }
    }
    found
}

impl PlanPosition {
    /// What is not as in the same recording under the plan of `now`.
    fn differences(&self, now: &PlanPosition) -> Vec<PlanDifference> {
        let settings = |step: &PlanPosition| {
            let told = step.phases.iter().filter_map(PhaseSpec::told).collect();
            let own = json!({
                "the starting group": step.group, "the number of conditions": step.periods,
                "plan.aims": step.aims, "plan.familiarisation": step.criterion,
            });
            let mut values = BTreeMap::new();
            collect(own, "", &mut values);
            (values, told)
        };
        let ((mut before, told_before), (mut after, told_now)): ((_, BTreeMap<_, _>), (_, BTreeMap<_, _>)) =
            (settings(self), settings(now));
        let mut found = Vec::new();
        // A recording keeps the texts around its own trial only: what the plan has besides is no difference.
        for (path, value) in told_before {
            match told_now.get(&path) {
                None => found.push(PlanDifference::text(format!("{path}, which is left out"))),
                Some(now) => {
                    collect(value, &path, &mut before);
                    collect(now.clone(), &path, &mut after);
                }
            }
        }
        found.extend(differing(&before, &after));
        found
    }
}

/// The values that differ, by their paths.
fn differing(before: &BTreeMap<String, Value>, now: &BTreeMap<String, Value>) -> Vec<PlanDifference> {
    let paths: BTreeSet<&String> = before.keys().chain(now.keys()).collect();
    let differs = paths.into_iter().filter(|path| before.get(*path) != now.get(*path));
    let value =
        |values: &BTreeMap<String, Value>, path: &str| values.get(path).filter(|value| !value.is_null()).cloned();
    let one =
        |path: &String| PlanDifference { path: path.clone(), nth: 0, values: [value(before, path), value(now, path)] };
    differs.map(one).filter(|one| one.values.iter().any(Option::is_some)).collect()
}

/// With its items by their ids, so that a new one is one difference.
fn by_item(questionnaire: &Questionnaire) -> Value {
    let mut whole = json!(questionnaire);
    whole["item"] = Value::Object(questionnaire.items.iter().map(|item| (item.id.clone(), json!(item))).collect());
    whole
}

impl PhaseSpec {
    /// What participants are told, taught or asked in it, and by which name.
    fn told(&self) -> Option<(String, Value)> {
        match self {
            PhaseSpec::Instruction { steps } => Some(("plan.instruction".to_string(), json!(steps))),
            PhaseSpec::Debriefing { steps } => Some(("plan.debriefing".to_string(), json!(steps))),
            PhaseSpec::Tutorial { tutorial } => Some(("tutorial".to_string(), json!(tutorial))),
            PhaseSpec::Questionnaire { questionnaire } => {
                Some((format!("questionnaire {}", questionnaire.name), by_item(questionnaire)))
            }
            PhaseSpec::Familiarisation | PhaseSpec::Trial => None,
        }
    }
}

fn collect(value: Value, path: &str, values: &mut BTreeMap<String, Value>) {
    let below = |name: &str| if path.is_empty() { name.to_string() } else { format!("{path}.{name}") };
    match value {
        _ if CANNOT_CHANGE_A_TRIAL.contains(&path) => {}
        Value::Object(fields) => fields.into_iter().for_each(|(name, value)| collect(value, &below(&name), values)),
        Value::Array(items) => {
            items.into_iter().enumerate().for_each(|(at, item)| collect(item, &below(&at.to_string()), values));
        }
        value => drop(values.insert(path.to_string(), value)),
    }
}
