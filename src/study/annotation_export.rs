//! Exports recordings as annotations for programs that show films: ELAN, BORIS, and players with subtitles.

use std::path::Path;

use serde::Serialize;

use crate::analysis::annotations::{AnnotationCollector, RecordingAnnotations, boris, elan, vtt};
use crate::files::annotation_files;
use crate::files::recordings::open_closed;
use tomcom_core::base::text::{PathText, count};
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::measures::raters::CodableErrors;
use tomcom_session::files::file_error::FileResult;
use tomcom_session::log::video_file::{self, AttachedFilm};
use tomcom_session::log::{ANNOTATION_NAMES, rater_codes};
use tomcom_session::replay::RecordingReplay;

/// A kind of annotation file, in the order of [`ANNOTATION_NAMES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnnotationFormat {
    Elan,
    Boris,
    Vtt,
}

impl AnnotationFormat {
    /// The text of the file; and what is near its beginning until another program saves it.
    fn text(self, annotations: &RecordingAnnotations) -> (String, &'static str) {
        match self {
            AnnotationFormat::Elan => (elan::text(annotations), elan::UNTOUCHED),
            AnnotationFormat::Boris => (boris::text(annotations), boris::UNTOUCHED),
            AnnotationFormat::Vtt => (vtt::text(annotations), vtt::UNTOUCHED),
        }
    }
}

/// What was exported of a recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AnnotationSummary {
    pub file: PathText,
    pub annotations: u64,
    pub films: u64,
    /// Number of annotations that are left out, since the film begins after them.
    pub before_film: u64,
}

/// Writes annotations of a recording beside its log. `blind`: only what raters see who code errors. Errors: the recording
/// cannot be read, or is still being written; or a file was saved by another program since, and is kept.
pub fn export(recording: &Path, formats: &[AnnotationFormat], blind: bool) -> FileResult<Vec<AnnotationSummary>> {
    let log = open_closed(recording)?;
    let folder = log.folder().to_path_buf();
    let started = log.header.started.clone().filter(|_| log.header.continues.is_none());
    let cost = CostToGo::new(log.kitchen.clone());
    let mut replay = RecordingReplay::over(log, cost).without_causes();
    let mut collector = AnnotationCollector::default();
    while let Some(event) = replay.step()? {
        collector.take(&event.stamped);
    }
    let kitchen = &replay.session().kitchen;
    let codes = rater_codes::read_all(&folder, &CodableErrors::from_presses(kitchen, &replay.follower.judged))?;
    let whole = annotation_files::whole(&folder)?;
    let path = |film: AttachedFilm| (film.path(&whole).to_string_lossy().into_owned(), film);
    let films: Vec<_> = video_file::read(&folder)?.films.into_iter().map(path).collect();
    let name = whole.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let annotations = collector.finish(&replay.follower, (name, started), &codes, &films, blind);
    let number: usize = annotations.tiers.iter().map(|tier| tier.annotations.len()).sum();
    let mut summaries = Vec::new();
    for &format in formats {
        let file = folder.join(ANNOTATION_NAMES[format as usize]);
        let (text, untouched) = format.text(&annotations);
        annotation_files::write(&file, &text, untouched)?;
        summaries.push(AnnotationSummary {
            file: file.into(),
            annotations: number as u64,
            films: annotations.films.len() as u64,
            before_film: annotations.before_film as u64,
        });
    }
    Ok(summaries)
}

pub fn describe(summaries: &[AnnotationSummary]) -> String {
    let line = |one: &AnnotationSummary| {
        let films = if one.films > 0 { format!(", {}", count(one.films, "film", "films")) } else { String::new() };
        let before = match one.before_film {
            0 => String::new(),
            number => format!("; left out, since the film begins later: {number}"),
        };
        format!("{}: {}{films}{before}\n", one.file.display(), count(one.annotations, "annotation", "annotations"))
    };
    summaries.iter().map(line).collect()
}
