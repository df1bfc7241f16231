//! Questionnaires as BIDS phenotype tables: one table for each questionnaire and each time that it was answered, with
//! one row for each participant.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value, json};

use super::labels::free;
use super::tsv::{self, BidsFile};
use tomcom_core::base::text::GUARDED;
use tomcom_session::Session;
use tomcom_session::questionnaire::AnswerValue;
use tomcom_session::plan::{AnswerFormat, Questionnaire, QuestionnaireItem};

/// A questionnaire that a participant has filled in.
#[derive(Clone, Debug, PartialEq)]
struct FilledIn {
    participant: String,
    session: String,
    asked: Questionnaire,
    /// The participant's answers by the name of the questionnaire's item.
    answers: BTreeMap<String, AnswerValue>,
}

/// All questionnaires that participants filled in, in the order of the recordings, for BIDS phenotype tables.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct QuestionnairePhenotypes(Vec<FilledIn>);

impl QuestionnairePhenotypes {
    /// Adds the questionnaire that the participant has just confirmed. `participant`, `session_label`: BIDS labels of
    /// the participant and the session.
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

    /// The phenotype tables with their sidecar files. `with_words`: whether answers in the participants' own words are
    /// exported, too.
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
            files.extend(table(&free(&name, "_again", &mut taken), time, &filled, with_words));
        }
        files
    }
}

/// One phenotype table with its sidecar file: the participants' answers when they answered the questionnaire for the
/// `time`th time.
fn table(name: &str, time: usize, filled: &[&FilledIn], with_words: bool) -> [BidsFile; 2] {
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
                about.insert(item.id.clone(), described(item, &form));
            }
        }
    }
    let head = ["participant_id", "session_id"].into_iter().chain(columns.iter().copied());
    let mut text = tsv::line(head);
    for one in filled {
        let cell = |id: &&str| one.answers.get(*id).map_or_else(|| tsv::NOTHING.to_string(), AnswerValue::cell);
        let ids = [format!("sub-{}", one.participant), format!("ses-{}", one.session)];
        text += &tsv::line(ids.into_iter().chain(columns.iter().map(cell)));
    }
    let path = format!("phenotype/{name}");
    [BidsFile::new(format!("{path}.tsv"), text), BidsFile::json(format!("{path}.json"), &about.into())]
}

/// The description of a questionnaire's item in the sidecar file of a phenotype table.
fn described(item: &QuestionnaireItem, form: &AnswerFormat) -> Value {
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
