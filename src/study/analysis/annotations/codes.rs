//! Raters' codes in annotations that were made, or changed, in ELAN or BORIS. A code belongs to the error beside which it
//! stands: the errors are in the file, too.

use std::path::Path;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event as XmlEvent};
use serde_json::Value;
use std::collections::BTreeMap;

use super::boris::CODE;
use super::elan::RECORDING;
use super::{CODES, ERRORS};
use tomcom_core::measures::raters::{ErrorCauseCode, ErrorCauseKind};
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::log::rater_codes::wrong_line;

/// Farthest from the beginning of an error at which its code can begin, in seconds.
const NEAR_S: f64 = 2.0;
const CAUSES: &str = "slip, race, other, buttons, or belief: with the name of a location, such as belief: cooking_pot";

/// A code, with the number of the error that it stands beside.
#[derive(Clone, Debug, PartialEq)]
pub struct AnnotatedCode {
    /// In the file; 0 if the file is not read by lines.
    pub line: usize,
    pub recording: Option<String>,
    pub rater: String,
    /// From 1.
    pub error: u64,
    pub code: ErrorCauseCode,
}

/// What is annotated at a time.
struct Timed {
    line: usize,
    begin_s: f64,
    end_s: f64,
    words: String,
}

/// Errors and codes of one recording in a file.
#[derive(Default)]
struct AnnotatedRecording {
    name: Option<String>,
    errors: Vec<Timed>,
    codes: Vec<(String, Timed)>,
}

impl AnnotatedRecording {
    fn found(self, wrong: &impl Fn(usize, String, &str) -> FileError) -> FileResult<Vec<AnnotatedCode>> {
        let mut errors: Vec<(f64, u64)> = Vec::new();
        for error in &self.errors {
            let number =
                error.words.strip_prefix("error ").and_then(|rest| rest.split(':').next()?.trim().parse().ok());
            let Some(number) = number else {
                let found = format!("\"{}\" among the errors", error.words);
                return Err(wrong(
                    error.line,
                    found,
                    "the errors as tomcom export wrote them, such as \"error 3: take rice\"",
                ));
            };
            errors.push((error.begin_s, number));
        }
        let mut codes = Vec::new();
        for (rater, coded) in self.codes {
            let at = format!("the code \"{}\" of {rater} at {:.2} s", coded.words, coded.begin_s);
            let distance = |begin_s: f64| (begin_s - coded.begin_s).abs();
            let near = errors.iter().min_by(|a, b| distance(a.0).total_cmp(&distance(b.0)));
            let Some(&(begin_s, error)) = near else {
                return Err(wrong(
                    coded.line,
                    format!("{at}, in a file without errors"),
                    "the errors as tomcom export wrote them",
                ));
            };
            if distance(begin_s) > NEAR_S && !(coded.begin_s..=coded.end_s).contains(&begin_s) {
                let remedy = format!(
                    "a code that begins within {NEAR_S} s of an error; the nearest is error {error}, at {begin_s:.2} s"
                );
                return Err(wrong(coded.line, at, &remedy));
            }
            let (kind, aspect) = match coded.words.split_once(':') {
                Some((kind, aspect)) => (kind.trim(), Some(aspect.trim())),
                None => (coded.words.trim(), None),
            };
            let code = ErrorCauseKind::named(kind).and_then(|kind| ErrorCauseCode::new(kind, aspect));
            let Some(code) = code else { return Err(wrong(coded.line, at, CAUSES)) };
            if codes.iter().any(|known: &AnnotatedCode| known.error == error && known.rater == rater) {
                return Err(wrong(
                    coded.line,
                    format!("{at}, a second code for error {error}"),
                    "one code for an error, of each rater",
                ));
            }
            codes.push(AnnotatedCode { line: coded.line, recording: self.name.clone(), rater, error, code });
        }
        Ok(codes)
    }
}

/// Codes in a file of ELAN: on tiers "codes RATER".
pub fn from_elan(path: &Path, text: &str) -> FileResult<Vec<AnnotatedCode>> {
    // Up to where lines were counted, and the line there.
    let (mut counted, mut line) = (0, 1);
    let wrong = |line: usize, found: String, remedy: &str| wrong_line(path, text, line, found, remedy);
    let mut reader = Reader::from_str(text);
    let mut read = AnnotatedRecording::default();
    let mut times: BTreeMap<String, f64> = BTreeMap::new();
    let (mut tier, mut slots, mut words) = (String::new(), None, None::<String>);
    let mut is_elan = false;
    loop {
        let event = reader.read_event();
        let position = (reader.buffer_position() as usize).clamp(counted, text.len());
        line += text.as_bytes()[counted..position].iter().filter(|&&byte| byte == b'\n').count();
        counted = position;
        let not_read =
            |error: &dyn std::fmt::Display| wrong(line, error.to_string(), "a file that ELAN has saved (EAF)");
        let event = event.map_err(|error| not_read(&error))?;
        match &event {
            XmlEvent::Eof => break,
            XmlEvent::Start(start) | XmlEvent::Empty(start) => {
                let of = |name: &str| attribute(start, name);
                match start.name().as_ref() {
                    b"ANNOTATION_DOCUMENT" => is_elan = true,
                    b"TIME_SLOT" => {
                        // ELAN leaves out the time of a slot that is not aligned.
                        if let (Some(id), Some(time)) = (of("TIME_SLOT_ID"), of("TIME_VALUE")) {
                            let time: f64 = time.parse().map_err(|error| not_read(&error))?;
                            times.insert(id, time / 1e3);
                        }
                    }
                    b"TIER" => tier = of("TIER_ID").unwrap_or_default(),
                    b"ALIGNABLE_ANNOTATION" => slots = of("TIME_SLOT_REF1").zip(of("TIME_SLOT_REF2")),
                    b"ANNOTATION_VALUE" => words = Some(String::new()),
                    b"PROPERTY" if of("NAME").as_deref() == Some(RECORDING) => words = Some(String::new()),
                    _ => {}
                }
            }
            XmlEvent::Text(part) => {
                if let Some(words) = &mut words {
                    *words += &part.decode().map_err(|error| not_read(&error))?;
                }
            }
            XmlEvent::GeneralRef(reference) => {
                if let Some(words) = &mut words {
                    let name = reference.decode().map_err(|error| not_read(&error))?;
                    let letter = reference.resolve_char_ref().map_err(|error| not_read(&error))?;
                    let named = quick_xml::escape::resolve_predefined_entity(&name).map(str::to_string);
                    let Some(part) = letter.map(String::from).or(named) else {
                        return Err(wrong(line, format!("the entity &{name};"), "a file that ELAN has saved (EAF)"));
                    };
                    *words += &part;
                }
            }
            XmlEvent::End(end) => match end.name().as_ref() {
                b"PROPERTY" => read.name = words.take().or(read.name.take()),
                b"ANNOTATION_VALUE" => {
                    let (Some(words), Some((first, last))) = (words.take(), slots.take()) else { continue };
                    let rater = tier.strip_prefix(CODES).map(|rater| rater.trim().to_string());
                    if tier != ERRORS && rater.is_none() {
                        continue;
                    }
                    let (Some(&begin_s), Some(&end_s)) = (times.get(&first), times.get(&last)) else {
                        return Err(wrong(
                            line,
                            format!("\"{words}\" without a time"),
                            "annotations with a begin and an end",
                        ));
                    };
                    let timed = Timed { line, begin_s, end_s, words: words.trim().to_string() };
                    match rater {
                        Some(rater) if !timed.words.is_empty() => read.codes.push((rater, timed)),
                        Some(_) => {}
                        None => read.errors.push(timed),
                    }
                }
                _ => {}
            },
            _ => {}
        }
    }
    if !is_elan {
        return Err(FileError::from_finding(
            path,
            "no ELAN file".to_string(),
            "a file that ELAN has saved (EAF)".to_string(),
        ));
    }
    if read.codes.is_empty() {
        let remedy = "a tier for each rater, called codes R1 for the rater R1".to_string();
        return Err(FileError::from_finding(path, "no codes".to_string(), remedy));
    }
    read.found(&wrong)
}

fn attribute(start: &BytesStart, name: &str) -> Option<String> {
    let attribute = start.try_get_attribute(name).ok()??;
    Some(attribute.unescape_value().ok()?.into_owned())
}

/// Codes in a project of BORIS: events "code" whose subject is the rater, in observations called like the recordings.
pub fn from_boris(path: &Path, text: &str) -> FileResult<Vec<AnnotatedCode>> {
    const REMEDY: &str = "a project that BORIS has saved";
    let wrong = |_: usize, found: String, remedy: &str| FileError::from_finding(path, found, remedy.to_string());
    let project: Value = serde_json::from_str(text).map_err(|error| wrong(0, error.to_string(), REMEDY))?;
    let Some(observations) = project["observations"].as_object() else {
        return Err(wrong(0, "no observations".to_string(), REMEDY));
    };
    let mut all = Vec::new();
    for (name, observation) in observations {
        let mut read = AnnotatedRecording { name: Some(name.clone()), ..AnnotatedRecording::default() };
        for event in observation["events"].as_array().into_iter().flatten() {
            let (Some(begin_s), Some(behaviour)) = (event[0].as_f64(), event[2].as_str()) else {
                return Err(wrong(0, format!("the event {event} of the observation {name}"), REMEDY));
            };
            let word = |index: usize| event[index].as_str().unwrap_or_default().trim().to_string();
            let timed = Timed { line: 0, begin_s, end_s: begin_s, words: word(3) };
            match behaviour {
                CODE if word(1).is_empty() => {
                    let found = format!("a code at {begin_s:.2} s without a subject");
                    return Err(wrong(0, found, "the rater as the subject of each code"));
                }
                CODE => read.codes.push((word(1), timed)),
                ERRORS => read.errors.push(timed),
                _ => {}
            }
        }
        all.extend(read.found(&wrong)?);
    }
    if all.is_empty() {
        let remedy = "events with the behaviour code, the rater as subject, and the cause as modifier";
        return Err(wrong(0, "no codes".to_string(), remedy));
    }
    Ok(all)
}
