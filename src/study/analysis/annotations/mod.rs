//! A recording as annotations for programs that show them beside its films: ELAN ([`elan`]), BORIS ([`boris`]) and
//! subtitles ([`vtt`]); and raters' codes read back from what was annotated there ([`codes`]).
//!
//! All times are on one time line: that of the film that begins last if there are films, else session time.

pub mod boris;
pub mod codes;
pub mod elan;
pub mod vtt;

use std::collections::BTreeMap;

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Agent, Kitchen};
use tomcom_core::measures::raters::RaterCodes;
use tomcom_core::measures::raters::{ErrorCauseCode, ErrorCauseKind};
use tomcom_session::error_list::ListedError;
use tomcom_session::follower::SessionFollower;
use tomcom_session::history::{event_words, wording};
use tomcom_session::log::video_file::AttachedFilm;
use tomcom_session::{Event, TimestampedEvent};

/// Prefix of tiers, and of subjects, with a rater's codes: "codes R1".
const CODES: &str = "codes ";
const ERRORS: &str = "errors";
/// How long a moment is shown if nothing follows on its tier.
const MOMENT: SessionTime = SessionTime(1_500_000_000);

/// An annotation: from when to when, on the time line, and in which words.
#[derive(Clone, Debug, PartialEq)]
pub struct Annotation {
    pub begin: SessionTime,
    pub end: SessionTime,
    pub words: String,
}

/// Annotations of one kind, in the order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct AnnotationTier {
    pub name: String,
    /// Whether annotations last; else they are moments, and end when they are shown no more.
    pub lasts: bool,
    pub annotations: Vec<Annotation>,
}

/// A film on the time line of the annotations.
#[derive(Clone, Debug, PartialEq)]
pub struct AnnotatedFilm {
    /// A whole path.
    pub path: String,
    /// Time in the film at the beginning of the time line, in seconds; not negative.
    pub ahead_s: f64,
    pub length_s: Option<f64>,
    pub frame_s: Option<f64>,
}

/// A recording as annotations.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordingAnnotations {
    /// Name of the recording.
    pub recording: String,
    /// When the session began, by the wall clock.
    pub started: Option<String>,
    pub tiers: Vec<AnnotationTier>,
    pub films: Vec<AnnotatedFilm>,
    /// Codes that a rater can give, as words.
    pub code_words: Vec<String>,
    /// Number of annotations that are over before the film begins, which programs cannot show.
    pub before_film: usize,
}

/// Collects what is annotated while a recording is replayed.
#[derive(Debug, Default)]
pub struct AnnotationCollector {
    presses: [Vec<(SessionTime, String)>; 2],
    signals: Vec<(SessionTime, Option<SessionTime>, String)>,
    notes: Vec<(u64, SessionTime, String)>,
    end: SessionTime,
}

impl AnnotationCollector {
    /// Takes an event that was just applied.
    pub fn take(&mut self, stamped: &TimestampedEvent) {
        let now = stamped.time;
        self.end = now;
        match &stamped.event {
            Event::Press { agent, button, .. } => {
                self.presses[agent.index()].push((now, wording::location(button)));
            }
            Event::SignalShown { by, signal, .. } => {
                self.end_signal(now);
                self.signals.push((now, None, format!("{}: {}", wording::sender(*by), wording::signal(signal))));
            }
            Event::SignalEnded { .. } => self.end_signal(now),
            Event::Marker { note, observer } => {
                self.notes.push((stamped.seq, now, event_words::noted_words(note, observer.as_deref())));
            }
            Event::MarkerWorded { marker, note } => {
                if let Some((.., words)) = self.notes.iter_mut().find(|(seq, ..)| seq == marker) {
                    *words = event_words::noted_words(note, None);
                }
            }
            _ => {}
        }
    }

    fn end_signal(&mut self, now: SessionTime) {
        if let Some((_, end @ None, _)) = self.signals.last_mut() {
            *end = Some(now);
        }
    }

    /// The annotations of a recording that was read to its end. `blind`: only what raters see who code errors.
    pub fn finish(
        self,
        follower: &SessionFollower,
        about: (String, Option<String>),
        codes: &BTreeMap<String, RaterCodes>,
        films: &[(String, AttachedFilm)],
        blind: bool,
    ) -> RecordingAnnotations {
        let kitchen = &follower.session.kitchen;
        let end = self.end;
        let moments = |name: String, all: Vec<(SessionTime, String)>| {
            let annotations: Vec<_> = all.into_iter().map(|(time, words)| (time, time + MOMENT, words)).collect();
            (name, false, annotations)
        };
        let spells = |name: String, all: Vec<(SessionTime, Option<SessionTime>, String)>| {
            let lasting = all.into_iter().map(|(begin, over, words)| (begin, over.unwrap_or(end), words)).collect();
            (name, true, lasting)
        };
        let [human, robot] = Agent::BOTH.map(Agent::index).map(|index| self.presses[index].clone());
        let judged = follower.judged.iter().enumerate();
        let spans: BTreeMap<u64, (SessionTime, SessionTime)> = judged
            .map(|(index, press)| (press.seq, (press.time, follower.judged_until(index).unwrap_or(end))))
            .collect();
        // A moment, which is shown for as long as the error lasts.
        let of_press = |press: u64, words: String| spans.get(&press).map(|(begin, end)| (*begin, *end, words));
        let listed = ListedError::all(follower);
        let errors = listed.iter().filter_map(|error| {
            let why = if error.why.is_empty() { String::new() } else { format!(" ({})", error.why) };
            of_press(error.press, format!("error {}: {}{why}", error.error, error.words()))
        });
        let mut tiers = vec![
            moments("presses human".to_string(), human),
            moments("presses robot".to_string(), robot),
            (ERRORS.to_string(), false, errors.collect()),
        ];
        if !blind {
            tiers.push(spells("signals".to_string(), self.signals));
            for (index, aspect) in kitchen.aspects.iter().enumerate() {
                let of_aspect = follower.false_beliefs.all().filter(|one| one.aspect.index() == index);
                let of_aspect: Vec<_> = of_aspect.map(|one| (one.began, one.ended, one.told(kitchen))).collect();
                if !of_aspect.is_empty() {
                    tiers.push(spells(
                        format!("false belief (estimate): {}", wording::location(&aspect.name)),
                        of_aspect,
                    ));
                }
            }
            let notes = self.notes.into_iter().map(|(_, time, words)| (time, words));
            tiers.push(moments("notes".to_string(), notes.collect()));
            for (rater, codes) in codes {
                let coded = codes.0.iter().filter_map(|(press, code)| of_press(*press, code_words(code)));
                tiers.push((format!("{CODES}{rater}"), false, coded.collect()));
            }
        }
        let master = films.iter().map(|(_, film)| film).min_by(|a, b| a.offset_s.total_cmp(&b.offset_s));
        let on_line = |time: SessionTime| master.map_or(time.as_secs_f64(), |film| film.film_s(time));
        let mut before_film = 0;
        let tiers = tiers.into_iter().map(|(name, lasts, annotations)| {
            let placed = annotations.into_iter().filter_map(|(begin, end, words)| {
                let (begin_s, end_s) = (on_line(begin), on_line(end));
                let is_shown = if lasts { end_s > 0.0 } else { begin_s >= 0.0 };
                before_film += usize::from(!is_shown);
                let [begin, end] = [begin_s, end_s].map(SessionTime::from_secs_f64);
                is_shown.then_some(Annotation { begin, end, words })
            });
            let annotations = placed.collect();
            AnnotationTier { name, lasts, annotations }
        });
        let tiers = tiers.collect();
        let first_s = master.map_or(0.0, |film| film.offset_s);
        let mut films: Vec<AnnotatedFilm> = films
            .iter()
            .map(|(path, film)| AnnotatedFilm {
                path: path.clone(),
                ahead_s: film.offset_s - first_s,
                length_s: film.length_s,
                frame_s: film.frame_ms.map(|frame_ms| frame_ms / 1e3),
            })
            .collect();
        // The film whose time is that of the annotations comes first.
        films.sort_by(|a, b| a.ahead_s.total_cmp(&b.ahead_s));
        let (recording, started) = about;
        RecordingAnnotations { recording, started, tiers, films, code_words: all_code_words(kitchen), before_film }
    }
}

/// Without control characters, which the formats cannot hold.
fn on_one_line(words: &str) -> String {
    words.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect()
}

/// A code in words: "slip", "belief: cooking_pot".
fn code_words(code: &ErrorCauseCode) -> String {
    match code.aspect() {
        Some(aspect) => format!("{}: {aspect}", code.kind().name()),
        None => code.kind().name().to_string(),
    }
}

fn all_code_words(kitchen: &Kitchen) -> Vec<String> {
    let beliefs = kitchen.locations.iter().map(|location| code_words(&ErrorCauseCode::Belief(location.name.clone())));
    let others = ErrorCauseKind::ALL.into_iter().filter(|kind| *kind != ErrorCauseKind::Belief);
    beliefs.chain(others.map(|kind| kind.name().to_string())).collect()
}

impl AnnotationTier {
    /// Annotations with an end after their beginning, none of which reaches into the next: in milliseconds.
    fn separate_ms(&self) -> Vec<(u64, u64, &str)> {
        let mut placed: Vec<(u64, u64, &str)> = Vec::new();
        for (index, annotation) in self.annotations.iter().enumerate() {
            let after = placed.last().map_or(0, |(_, end, _)| *end);
            let begin = annotation.begin.ms().max(after);
            let next = self.annotations.get(index + 1).map_or(u64::MAX, |next| next.begin.ms());
            placed.push((begin, annotation.end.ms().min(next).max(begin + 1), &annotation.words));
        }
        placed
    }
}
