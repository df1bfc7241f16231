//! Files of a whole BIDS data set: those at its root, tables of sessions and questionnaires, and labels in file names.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value, json};

use crate::analysis::bids::{BidsFile, NOTHING, YES_NO, described, events, line, row, seconds};
use crate::column::{Levels, TableColumn, columns};
use tomcom_core::base::text::GUARDED;
use tomcom_core::base::time::SessionTime;
use tomcom_session::event::TrialEndReason;
use tomcom_session::plan::{AnswerFormat, PlanPosition, Questionnaire, QuestionnaireItem};
use tomcom_session::questionnaire::AnswerValue;
use tomcom_session::{LogHeader, Session};

pub(crate) const DESCRIPTION_NAME: &str = "dataset_description.json";
pub(crate) const PARTICIPANTS: &str = "participants";
pub(crate) const CODE_COLUMN: &str = "code";
pub(crate) const PROGRAM_NAME: &str = "tomcom";
/// Version of BIDS that the data set follows; BIDS has eye-tracking data since 1.10.
const BIDS_VERSION: &str = "1.10.1";

const KINDS: Levels = &[
    ("simulated", "A simulated participant"),
    ("keyboard", "A person at the keyboard of the console"),
    ("display", "A person at the participant's display"),
];

const CONSENTS: Levels = &[
    ("console", "Told to the wizard, who confirmed it on the console"),
    ("display", "The participant held a button on the display"),
];

fn participant_columns() -> Vec<TableColumn<BidsParticipant>> {
    columns! { |row: BidsParticipant|
        "participant_id", "", "The participant: sub- and the letters and digits of the code"
            => format!("sub-{}", row.label);
        CODE_COLUMN, "", "The participant's code in the recordings" => &row.code;
        "kind", KINDS, "Who took part" => &row.kind;
        "group", "", "Starting group of the plan: the order of conditions" => row.group.as_deref();
        "recordings", "", "Number of recordings" => row.recordings as u64;
        "left_out", "", "Number of these that are left out of the analysis; the table of sessions says why"
            => row.left_out as u64;
        "consent_on", CONSENTS, "Where consent was given" => row.consent[0].as_deref();
        "consent_at", "", "Wall clock time (UTC) at which the recording that begins with the consent began"
            => row.consent[1].as_deref();
        "consent_digest", "", "Digest of the text that was agreed to" => row.consent[2].as_deref();
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BidsParticipant {
    pub label: String,
    pub code: String,
    pub kind: String,
    pub group: Option<String>,
    pub recordings: usize,
    pub left_out: usize,
    /// The participant's consent, as far as a recording says it: where it was given, when, and the digest of its text.
    pub consent: [Option<String>; 3],
}

/// The files at the root of the data set. `plans`: the names of the studies' plans.
pub(crate) fn dataset_files(plans: &[String], participants: &[BidsParticipant], with_words: bool) -> Vec<BidsFile> {
    let name = if plans.is_empty() { "tomcom recordings".to_string() } else { plans.join(", ") };
    let description = json!({
        "Name": name,
        "BIDSVersion": BIDS_VERSION,
        "DatasetType": "raw",
        "GeneratedBy": [{
            "Name": PROGRAM_NAME,
            "Version": env!("CARGO_PKG_VERSION"),
            "Description": "tomcom export --bids",
        }],
    });
    let columns = participant_columns();
    let rows: String = participants.iter().map(|one| row(&columns, one)).collect();
    let [table, about] = BidsFile::table(PARTICIPANTS, &columns, &rows, described(&columns));
    let readme = BidsFile::new("README.md", readme(&name, participants.len(), with_words));
    vec![BidsFile::json(DESCRIPTION_NAME, &description), table, about, readme]
}

fn readme(name: &str, participants: usize, with_words: bool) -> String {
    let words = match with_words {
        true => {
            "What wizards and participants typed (notes, reasons, answers in words) is in the column `words` and in `phenotype/`."
        }
        false => "What wizards and participants typed (notes, reasons, answers in words) is left out.",
    };
    format!(
        "# {name}\n\n\
         Recordings of people or simulated people who cook together with a robot, made with tomcom, and exported by `tomcom export --bids`. \
         Participants: {participants}.\n\n\
         A recording is a session (`ses-`). `sub-*_sessions.tsv` says under which condition it was made, whether it is practice, and \
         whether and why it is left out of the analysis.\n\n\
         - `*_events.tsv`: one row for each event of the recording's log but samples. Times are session time: seconds since the \
         beginning of the recording.\n\
         - `*_recording-eye1_physio.tsv.gz`: gaze, one row for each sample; `*_physioevents.tsv.gz`: fixations and blinks, as the eye \
         tracker found them. `recording-pointer`: a mouse pointer that stands in for gaze.\n\
         - `*_recording-arm_stim.tsv.gz`: the motion of the robot's arm. It is sampled while the arm moves, so intervals differ.\n\
         - `*_beh.tsv`: what simulated participants believed, and the estimates of beliefs.\n\
         - `phenotype/`: questionnaires. `_2` is the second time that participants answered one.\n\n\
         Rows of events, gaze, fixations and blinks, and arm together are as many as the log has events; `seq` is the number of the event in \
         it. {words}\n\n\
         To be filled in before the data set is published: authors, license and ethics in `dataset_description.json`.\n"
    )
}

const CONDITIONS: Levels = &[
    ("none", "Nobody sent signals"),
    ("wizard", "The wizard could send signals"),
    ("assistant", "The assistant sent signals by itself"),
];
const ENDS: Levels = &[
    ("presses", "The set number of presses was reached"),
    ("time", "The set time was reached"),
    ("orders", "The set number of orders was served"),
    ("wizard", "The wizard ended it"),
    ("aborted", "It was aborted and does not count"),
];

pub(crate) struct BidsSession<'a> {
    pub label: &'a str,
    pub recording: &'a str,
    pub header: &'a LogHeader,
    pub session: &'a Session,
    pub ended: Option<TrialEndReason>,
    pub is_complete: bool,
    pub counts: bool,
    pub left_out: Option<&'a str>,
}

impl BidsSession<'_> {
    fn step(&self) -> Option<&PlanPosition> {
        self.session.spec.step.as_ref()
    }

    pub(crate) fn line(&self) -> String {
        row(&session_columns(), self)
    }
}

fn session_columns<'a>() -> Vec<TableColumn<BidsSession<'a>>> {
    columns! { |row: BidsSession<'a>|
        "session_id", "", "The recording's session" => format!("ses-{}", row.label);
        "acq_time", "", "When the recording began (UTC); n/a: simulated" => row.header.started.as_ref();
        "recording", "", "Name of the recording's folder" => row.recording;
        "kitchen", "", "Name of the kitchen" => &row.session.kitchen.name;
        "condition", CONDITIONS, "Who could send signals" => row.session.spec.trial.condition.name();
        "concept", "", "Communication concept of the assistant" => row.session.spec.assistant.concept.label();
        "study_arm", "", "Arm by what was done: none, wizard, wizard+advice (the wizard saw recommendations), \
            tom-com, tom or dev" => row.session.study_arm().name();
        "planned_arm", "", "Arm under which the trial counts: that of the plan, without a plan that of the settings"
            => row.session.planned_arm().name();
        "practice", YES_NO, "Whether it is practice, which no analysis takes"
            => row.step().is_some_and(|step| step.period.is_none());
        "period", "", "Number of the trial in the plan, from 1" => row.step().and_then(|step| step.period);
        "attempt", "", "Number of the attempt, from 1" => row.step().map(|step| step.attempt);
        "gaze", "", "Where gaze came from" => events::name(&row.session.spec.participant.gaze);
        "arm", "", "Kind of the robot's arm" => row.session.spec.robot.arm.name();
        "trial_time", "s", "Length of the trial by its own clock"
            => Some(row.session.trial_clock(row.session.time)).filter(|clock| *clock > SessionTime::ZERO).map(seconds);
        "ended", ENDS, "Why the trial ended; n/a: it did not" => row.ended.map(TrialEndReason::name);
        "complete", YES_NO, "Whether the recording has its end" => row.is_complete;
        "excluded", YES_NO, "Whether the trial was aborted or excluded" => !row.counts;
        "left_out", "", format!("Why the trial is left out of the analysis; --words adds the reason that was typed; n/a: it is \
            not; {GUARDED}") => row.left_out;
        "seed", "", "Seed of all random numbers" => row.session.seed();
        "trial", "", "Index of the trial: with the same seed, another index gives other orders" => row.header.trial;
        "log_version", "", "Version of the log's format" => row.header.version;
        "program", "", "Version of tomcom that made the recording" => &row.header.program;
    }
}

pub(crate) fn sessions_files(participant: &str, rows: &[String]) -> [BidsFile; 2] {
    let path = format!("sub-{participant}/sub-{participant}_sessions");
    let columns = session_columns();
    BidsFile::table(&path, &columns, &rows.concat(), described(&columns))
}

/// The letters and digits of a name; a BIDS label may contain nothing else.
pub(crate) fn letters_and_digits(name: &str) -> String {
    let kept: String = name.chars().filter(char::is_ascii_alphanumeric).collect();
    if kept.is_empty() { "x".to_string() } else { kept }
}

/// Labels that differ only in capitals count as alike, since they would be the same folder on some disks.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BidsLabelMap(BTreeMap<String, String>);

impl BidsLabelMap {
    /// The BIDS labels of these names: the label consists of the letters and digits of the name. A label that another
    /// name has already is followed by `x2`, `x3` and so on.
    pub fn from_names<'a>(names: impl IntoIterator<Item = &'a str>) -> BidsLabelMap {
        let all: BTreeSet<&str> = names.into_iter().collect();
        let (plain, others): (Vec<&str>, Vec<&str>) =
            all.into_iter().partition(|name| letters_and_digits(name) == *name);
        let mut taken = BTreeSet::new();
        let mut labels = BTreeMap::new();
        for name in plain.into_iter().chain(others) {
            labels.insert(name.to_string(), free(&letters_and_digits(name), "x", &mut taken));
        }
        BidsLabelMap(labels)
    }

    pub fn label(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(String::as_str)
    }

    pub fn changed(&self) -> Vec<(String, String)> {
        self.0.iter().filter(|(name, label)| name != label).map(|(name, label)| (name.clone(), label.clone())).collect()
    }
}

/// A free label: `label`, with a number behind it if that label is taken; the returned label counts as taken.
fn free(label: &str, between: &str, taken: &mut BTreeSet<String>) -> String {
    let tried = |number: usize| match number {
        1 => label.to_string(),
        number => format!("{label}{between}{number}"),
    };
    let mut number = 1;
    while !taken.insert(tried(number).to_ascii_lowercase()) {
        number += 1;
    }
    tried(number)
}

/// The place in the study plan, or else the number. `taken`: labels of the participant's earlier recordings.
pub fn session_label(step: Option<&PlanPosition>, taken: &mut BTreeSet<String>) -> String {
    let attempt = |step: &PlanPosition| match step.attempt {
        0 | 1 => String::new(),
        attempt => format!("attempt{attempt}"),
    };
    let label = match step {
        Some(step) => match step.period {
            Some(period) => format!("trial{period}{}", attempt(step)),
            None => format!("practice{}", attempt(step)),
        },
        None => format!("{:02}", taken.len() + 1),
    };
    free(&label, "again", taken)
}

#[derive(Clone, Debug, PartialEq)]
struct FilledIn {
    participant: String,
    session: String,
    asked: Questionnaire,
    answers: BTreeMap<String, AnswerValue>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct QuestionnairePhenotypes(Vec<FilledIn>);

impl QuestionnairePhenotypes {
    /// Adds the questionnaire that was just confirmed. `participant`, `session_label`: BIDS labels.
    pub fn note(&mut self, participant: &str, session_label: &str, session: &Session) {
        let (Some(asked), Some(protocol)) = (session.questionnaire(), &session.protocol) else { return };
        let given =
            |(index, item): (usize, &QuestionnaireItem)| Some((item.id.clone(), protocol.given(index)?.clone()));
        self.0.push(FilledIn {
            participant: participant.to_string(),
            session: session_label.to_string(),
            asked: asked.clone(),
            answers: asked.items.iter().enumerate().filter_map(given).collect(),
        });
    }

    /// `with_words`: whether answers in the participants' own words are exported, too.
    pub fn files(&self, with_words: bool) -> Vec<BidsFile> {
        let mut tables: BTreeMap<(&str, usize), Vec<&FilledIn>> = BTreeMap::new();
        for (index, filled) in self.0.iter().enumerate() {
            let same =
                |other: &&FilledIn| other.participant == filled.participant && other.asked.name == filled.asked.name;
            let before = self.0[..index].iter().filter(same).count();
            tables.entry((&filled.asked.name, before + 1)).or_default().push(filled);
        }
        let (mut taken, mut files) = (BTreeSet::new(), Vec::new());
        for ((name, time), filled) in tables {
            let name = if time == 1 { name.to_string() } else { format!("{name}_{time}") };
            files.extend(phenotype_table(&free(&name, "_again", &mut taken), time, &filled, with_words));
        }
        files
    }
}

/// The answers of the participants who answered the questionnaire for the `time`th time.
fn phenotype_table(name: &str, time: usize, filled: &[&FilledIn], with_words: bool) -> [BidsFile; 2] {
    let mut columns: Vec<&str> = Vec::new();
    let mut about = Map::new();
    let told = format!("{} Filled in by each participant for the {time}. time.", filled[0].asked.title);
    about.insert("MeasurementToolMetadata".to_string(), json!({ "Description": told }));
    about.insert("session_id".to_string(), json!({ "Description": "The session in which it was filled in" }));
    for FilledIn { asked, .. } in filled {
        for (index, item) in asked.items.iter().enumerate() {
            let Some(form) = asked.form(index).filter(|form| with_words || !matches!(form, AnswerFormat::Text { .. }))
            else {
                continue;
            };
            if !columns.contains(&item.id.as_str()) {
                columns.push(&item.id);
                about.insert(item.id.clone(), described_item(item, &form));
            }
        }
    }
    let head = ["participant_id", "session_id"].into_iter().chain(columns.iter().copied());
    let mut text = line(head);
    for one in filled {
        let cell = |id: &&str| one.answers.get(*id).map_or_else(|| NOTHING.to_string(), AnswerValue::cell);
        let ids = [format!("sub-{}", one.participant), format!("ses-{}", one.session)];
        text += &line(ids.into_iter().chain(columns.iter().map(cell)));
    }
    let path = format!("phenotype/{name}");
    [BidsFile::new(format!("{path}.tsv"), text), BidsFile::json(format!("{path}.json"), &about.into())]
}

fn described_item(item: &QuestionnaireItem, form: &AnswerFormat) -> Value {
    let mut about = json!({ "Description": item.text });
    match form {
        AnswerFormat::Scale(scale) => {
            let meaning = |point: u8| match point {
                1 => scale.low.clone(),
                point if point == scale.points => scale.high.clone(),
                point => format!("{point} of {}", scale.points),
            };
            // Every point of the rating scale is listed, since BIDS counts a value that is not listed as invalid.
            let levels: Map<String, Value> =
                (1..=scale.points).map(|point| (point.to_string(), json!(meaning(point)))).collect();
            about["Levels"] = Value::Object(levels);
        }
        AnswerFormat::Choice { options, several } => {
            let levels: Map<String, Value> =
                options.iter().map(|option| (option.id.clone(), json!(option.text))).collect();
            about["Levels"] = Value::Object(levels);
            if *several {
                about["Delimiter"] = json!(" ");
            }
        }
        AnswerFormat::Number { unit, .. } if !unit.is_empty() => about["Units"] = json!(unit),
        AnswerFormat::Slider { low, high, .. } => {
            about["Description"] = json!(format!("{} (0: {low}; 100: {high})", item.text));
        }
        AnswerFormat::Text { .. } => about["Description"] = json!(format!("{} ({GUARDED})", item.text)),
        AnswerFormat::Number { .. } => {}
    }
    if let Some(construct) = &item.about {
        about["Construct"] = json!(construct);
    }
    if item.reversed {
        about["Reversed"] = json!(true);
    }
    about
}
