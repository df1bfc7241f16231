//! Annotations as a project of BORIS (format 7): an ethogram, one observation with its films, and events.

use serde_json::{Map, Value, json};

use super::{AnnotationTier, CODES, RecordingAnnotations, on_one_line};
use tomcom_core::base::time::SessionTime;

/// How a file begins that nobody has saved in BORIS since, which writes projects in one line.
pub const UNTOUCHED: &str = "{\n  \"behavioral_categories\"";
/// Number of players of BORIS.
const PLAYERS: usize = 8;
pub(super) const CODE: &str = "code";

/// What an event of a tier is in BORIS: its subject and its behaviour; the words are its modifier.
fn event_of(tier: &AnnotationTier) -> (String, String) {
    if let Some(rater) = tier.name.strip_prefix(CODES) {
        return (rater.to_string(), CODE.to_string());
    }
    match tier.name.split_once(' ') {
        Some(("presses", agent)) => (agent.to_string(), "press".to_string()),
        _ => (String::new(), tier.name.clone()),
    }
}

/// The text of the file.
pub fn text(annotations: &RecordingAnnotations) -> String {
    let mut behaviours: Vec<(String, bool, Vec<String>)> =
        vec![(CODE.to_string(), false, annotations.code_words.clone())];
    let mut subjects: Vec<String> = Vec::new();
    let mut events: Vec<(SessionTime, String, String, String)> = Vec::new();
    for tier in &annotations.tiers {
        let (subject, behaviour) = event_of(tier);
        if !subject.is_empty() && !subjects.contains(&subject) {
            subjects.push(subject.clone());
        }
        if !behaviours.iter().any(|(name, ..)| *name == behaviour) {
            behaviours.push((behaviour.clone(), tier.lasts, Vec::new()));
        }
        for annotation in &tier.annotations {
            let words = modifier(&annotation.words);
            events.push((annotation.begin, subject.clone(), behaviour.clone(), words.clone()));
            if tier.lasts {
                events.push((annotation.end, subject.clone(), behaviour.clone(), words));
            }
        }
    }
    for (_, _, behaviour, words) in &events {
        if let Some((_, _, values)) = behaviours.iter_mut().find(|(name, ..)| name == behaviour)
            && !values.contains(words)
        {
            values.push(words.clone());
        }
    }
    events.sort_by_key(|(time, ..)| *time);
    let ethogram = behaviours.iter().enumerate().map(|(index, (name, lasts, values))| {
        let modifiers =
            json!({ "0": { "name": "", "description": "", "type": 0, "ask at stop": false, "values": values } });
        let kind = if *lasts { "State event" } else { "Point event" };
        let behaviour = json!({
            "type": kind, "key": char::from(b'a' + index.min(25) as u8).to_string(), "code": name, "description": "",
            "color": "", "category": "", "modifiers": modifiers, "excluded": "", "coding map": "",
        });
        (index.to_string(), behaviour)
    });
    let subjects = subjects
        .iter()
        .enumerate()
        .map(|(index, name)| (index.to_string(), json!({ "key": "", "name": name, "description": "" })));
    let date = annotations.started.as_deref().unwrap_or("1970-01-01T00:00:00Z");
    let date = date.get(..19).unwrap_or(date);
    let ethogram: Map<String, Value> = ethogram.collect();
    let subjects: Map<String, Value> = subjects.collect();
    let project = json!({
        "behavioral_categories": [], "behaviors_conf": ethogram, "behaviors_coding_map": [], "coding_map": {},
        "converters": {}, "independent_variables": {}, "observations": { &annotations.recording: observation(annotations, date, events) },
        "project_date": date, "project_description": "written by tomcom export",
        "project_format_version": "7.0", "project_name": annotations.recording, "subjects_conf": subjects, "time_format": "hh:mm:ss",
    });
    serde_json::to_string_pretty(&project).expect("a value is JSON") + "\n"
}

/// A word that BORIS takes as one modifier.
fn modifier(words: &str) -> String {
    let words = on_one_line(words).replace('|', " ");
    // BORIS takes what stands in parentheses for a key.
    words.replace(" (", ", ").replace(')', "").trim().to_string()
}

fn observation(
    annotations: &RecordingAnnotations,
    date: &str,
    events: Vec<(SessionTime, String, String, String)>,
) -> Value {
    let round = |seconds: f64| (seconds * 1e3).round() / 1e3;
    let (mut files, mut offsets, mut lengths, mut rates, mut seen, mut heard) =
        (Map::new(), Map::new(), Map::new(), Map::new(), Map::new(), Map::new());
    for player in 0..PLAYERS {
        let film = annotations.films.get(player);
        files.insert((player + 1).to_string(), film.map_or(json!([]), |film| json!([film.path])));
        let Some(film) = film else { continue };
        offsets.insert((player + 1).to_string(), json!(round(film.ahead_s)));
        seen.insert(film.path.clone(), json!(true));
        heard.insert(film.path.clone(), json!(false));
        if let Some(length_s) = film.length_s {
            lengths.insert(film.path.clone(), json!(round(length_s)));
        }
        if let Some(frame_s) = film.frame_s.filter(|frame_s| *frame_s > 0.0) {
            rates.insert(film.path.clone(), json!(round(1.0 / frame_s)));
        }
    }
    let is_filmed = !annotations.films.is_empty();
    let events: Vec<Value> = events
        .into_iter()
        .map(|(time, subject, behaviour, words)| match (time.ms() as f64 / 1e3, is_filmed) {
            (time_s, true) => json!([time_s, subject, behaviour, words, "", "NA"]),
            (time_s, false) => json!([time_s, subject, behaviour, words, ""]),
        })
        .collect();
    json!({
        "file": files, "type": if is_filmed { "MEDIA" } else { "LIVE" }, "date": date, "description": "", "time offset": 0.0,
        "events": events, "observation time interval": [0, 0], "independent_variables": {},
        "visualize_spectrogram": false, "visualize_waveform": false, "media_creation_date_as_offset": false,
        "media_scan_sampling_duration": 0, "image_display_duration": 1, "close_behaviors_between_videos": false,
        "start_from_current_time": false, "start_from_current_epoch_time": false, "scan_sampling_time": 0,
        "media_info": { "length": lengths, "fps": rates, "hasVideo": seen, "hasAudio": heard, "offset": offsets },
    })
}
