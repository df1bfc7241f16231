//! A wizard's training: the record of a session, as the program saves it, and its report as text: the criterion, every
//! false belief that led to errors with the signal that would have corrected it, and the score.

use std::path::Path;

use serde::{Deserialize, Serialize};

use tomcom_core::base::text::count;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::recommendation::{aspects_told, phrase};
use tomcom_core::communication::{Signal, signals, unavailable};
use tomcom_core::kitchen::{AspectId, Kitchen};
use tomcom_core::measures::matching::{CommunicationEvent, MatchCounts, WINDOW};
use tomcom_core::measures::wizard_performance::{FalseBeliefPeriod, TrainingCriterion, WizardMeasures};
use tomcom_core::mind::RecordedBelief;
use tomcom_session::Session;
use tomcom_session::history::wording;

/// With fewer, a share of hits is too uncertain: at 10, a share of 60 % is known to within 30 %.
const TELLING: u64 = 10;

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WizardTrainingSummary {
    pub wizard: String,
    pub folder: String,
    pub times: u64,
    /// Duration of all training sessions together, in minutes.
    pub minutes: f64,
    /// Criterion that the wizard had to meet in the last training session; null if there was none.
    pub criterion: Option<TrainingCriterion>,
    /// Whether the wizard met the criterion in the last training session; null if there was none.
    pub met: Option<bool>,
}

impl WizardTrainingSummary {
    pub fn from_records(folder: &Path, wizard: &str, records: &[WizardTrainingRecord]) -> WizardTrainingSummary {
        let last = records.last();
        WizardTrainingSummary {
            wizard: wizard.to_string(),
            folder: folder.display().to_string(),
            times: records.len() as u64,
            // The fold starts at 0, because the sum of an empty list of floats would be -0.
            minutes: records.iter().fold(0.0, |sum, record| sum + record.minutes),
            criterion: last.map(|record| record.criterion),
            met: last.map(|record| record.met),
        }
    }

    pub fn describe(&self) -> String {
        let Some(met) = self.met else {
            return format!("\nno training of {} in {}; see --training\n", self.wizard, self.folder);
        };
        let met = if met { "the criterion was met" } else { "the criterion was not met" };
        let times = count(self.times, "time", "times");
        format!("\n{}: trained {times}, {:.1} minutes; {met}\n", self.wizard, self.minutes)
    }
}

/// The record of a false belief episode before any signal of the wizard about that false belief was judged.
pub fn unheard(session: &Session, period: &FalseBeliefPeriod) -> HarmfulFalseBelief {
    HarmfulFalseBelief {
        aspect: session.kitchen.aspects[period.aspect.index()].name.clone(),
        began_ns: period.began,
        corrected_ns: period.corrected.map(|(end, _)| end),
        errors: period.errors,
        believed: String::new(),
        truth: String::new(),
        words: String::new(),
        signal: None,
        hit_by: None,
    }
}

pub fn hear(belief: &mut HarmfulFalseBelief, session: &Session, aspect: AspectId, witness: &RecordedBelief) {
    let kitchen = &session.kitchen;
    let Some(told) = witness.aspects.get(aspect.index()) else { return };
    let (values, value) = (&kitchen.aspects[aspect.index()], kitchen.true_value(session.state, aspect));
    let truth = &values.labels[value];
    belief.believed.clone_from(&told.believes);
    belief.truth.clone_from(truth);
    belief.words = match told.believes == *truth {
        true => format!("unsure of {}", phrase(&values.wordings[value])),
        false => {
            format!("believed {}, truly {}", phrase(kitchen.worded(&told.believes)), phrase(&values.wordings[value]))
        }
    };
    let tells = |signal: &Signal| {
        unavailable(kitchen, session.state, signal).is_none()
            && aspects_told(kitchen, session.state, signal).contains(&aspect)
    };
    let right = signals(kitchen, session.spec.highlights(kitchen)).into_iter().map(|(_, signal)| signal).find(tells);
    belief.signal = right.or(belief.signal.take());
}

/// A false belief in words: "recipe of tuna nigiri: believed salmon nigiri, truly tuna nigiri".
pub fn about(belief: &HarmfulFalseBelief) -> String {
    let what = belief.aspect.replace('_', " ");
    if belief.words.is_empty() { what } else { format!("{what}: {}", belief.words) }
}

pub fn right(belief: &HarmfulFalseBelief) -> String {
    belief.signal.as_ref().map_or("no signal could tell it".to_string(), |signal| {
        format!("right would have been: {}", wording::signal(signal))
    })
}

pub fn task(criterion: &TrainingCriterion) -> Vec<String> {
    vec![
        "When the participant believes something wrong, press the key of the place or order it is about, as in a session."
            .to_string(),
        "A hit is the first signal about a false belief that leads to an error, while it is held.".to_string(),
        format!(
            "Asked: at least {:.0} % of these beliefs hit, at most {:.0} % of the signals wrong or needless.",
            100.0 * criterion.hits,
            100.0 * criterion.wrong
        ),
    ]
}

pub fn lines(recordings: &[&WatchedRecording], criterion: &TrainingCriterion) -> Vec<String> {
    let sum = WizardMeasures::sum(recordings.iter().map(|one| &one.measures));
    let mut lines = vec![held_against(&sum, criterion)];
    let episodes = sum.episodes.unwrap_or(0);
    if episodes < TELLING {
        lines.push(format!(
            "{} that led to errors: so few say little. Watch for longer (--seconds), or more recordings.",
            count(episodes, "false belief", "false beliefs")
        ));
    }
    for recording in recordings {
        lines.extend(recording.beliefs.iter().flat_map(|belief| told(belief, &recording.signals)));
    }
    lines
}

/// The wizard's score beside the criterion: "1 of 2 hit (50 %, asked: at least 60 %); 3 of 9 signals wrong or needless
/// (33 %, asked: at most 40 %)".
fn held_against(sum: &WizardMeasures, criterion: &TrainingCriterion) -> String {
    let wrong = sum.wrong_or_needless().unwrap_or(0);
    let share = |part: u64, all: u64| match all {
        0 => "-".to_string(),
        all => format!("{:.0} %", 100.0 * part as f64 / all as f64),
    };
    let (hits, episodes) = (sum.hits.unwrap_or(0), sum.episodes.unwrap_or(0));
    format!(
        "{hits} of {episodes} hit ({}, asked: at least {:.0} %); {wrong} of {} wrong or needless ({}, asked: at most {:.0} %)",
        share(hits, episodes),
        100.0 * criterion.hits,
        count(sum.signals, "signal", "signals"),
        share(wrong, sum.signals),
        100.0 * criterion.wrong,
    )
}

/// When it was held, what was believed; then the right signal, and what was sent meanwhile.
fn told(belief: &HarmfulFalseBelief, signals: &[JudgedSignal]) -> [String; 2] {
    let end = belief.corrected_ns.map_or("the end".to_string(), |end| end.to_string());
    let errors = count(belief.errors, "error", "errors");
    let head = format!("{} to {end}  {}; {errors}", belief.began_ns, about(belief));
    if let Some(signal) = belief.hit_by.and_then(|index| signals.get(index)) {
        let after_s = signal.clock_ns.secs_since(belief.began_ns);
        return [head, format!("    hit after {after_s:.1} s by: {}", wording::signal(&signal.signal))];
    }
    let meanwhile = signals.iter().filter(|signal| {
        belief.began_ns <= signal.clock_ns && belief.corrected_ns.is_none_or(|end| signal.clock_ns < end)
    });
    let sent: Vec<String> = meanwhile
        .map(|signal| format!("{} at {} ({})", wording::signal(&signal.signal), signal.clock_ns, signal.worth))
        .collect();
    let sent = if sent.is_empty() { "nothing".to_string() } else { sent.join(", ") };
    [head, format!("    missed; {}; sent meanwhile: {sent}", right(belief))]
}

pub fn describe(record: &WizardTrainingRecord, path: &Path) -> String {
    let mut text = String::new();
    for one in &record.recordings {
        let measures = &one.measures;
        let latency =
            measures.latency_s.map_or(String::new(), |times| format!(", after {:.1} s in the median", times.median));
        let kappa =
            one.kappa_with_oneself.map_or(String::new(), |kappa| format!("; kappa with the time before {kappa:.2}"));
        let cut = if one.complete { "" } else { " (left before its end: does not meet the criterion)" };
        let signals = count(measures.signals, "signal", "signals");
        text += &format!("{}{cut}: {signals}{latency}{kappa}\n", one.recording);
    }
    let recordings: Vec<&WatchedRecording> = record.recordings.iter().collect();
    text.extend(lines(&recordings, &record.criterion).iter().map(|line| format!("{line}\n")));
    let met = if record.met { "met" } else { "not met" };
    let speed = match record.speed {
        speed if speed != 1.0 => format!(", played {speed} times as fast as it was"),
        _ => String::new(),
    };
    text += &format!("criterion {met}; {:.1} minutes{speed}\nrecorded in {}\n", record.minutes, path.display());
    text
}

pub fn with_oneself(kitchen: &Kitchen, one: &WatchedRecording, other: &WatchedRecording) -> Option<f64> {
    let said = |signal: &JudgedSignal| {
        let content = signal.signal.compared(kitchen);
        CommunicationEvent { press: signal.press, clock: signal.clock_ns, content }
    };
    let [one, again] = [one, other].map(|time| time.signals.iter().map(said).collect::<Vec<CommunicationEvent>>());
    let mut tally = MatchCounts::default();
    tally.add(&one, &again, other.presses, WINDOW);
    tally.similarity().kappa
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WizardTrainingRecord {
    /// The wizard's code, never a name.
    pub wizard: String,
    /// Wall clock time at which the training began (UTC, RFC 3339).
    pub at: String,
    /// Duration of the training, in minutes.
    pub minutes: f64,
    pub speed: f64,
    pub criterion: TrainingCriterion,
    pub met: bool,
    pub recordings: Vec<WatchedRecording>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WatchedRecording {
    /// A recording that was simulated for the training has its length in front of its name.
    pub recording: String,
    pub complete: bool,
    pub presses: u32,
    pub signals: Vec<JudgedSignal>,
    /// False beliefs that led to errors, among those that began in the part that was watched.
    pub beliefs: Vec<HarmfulFalseBelief>,
    pub measures: WizardMeasures,
    /// Cohen's kappa with the pass before through the same recording; null without one.
    pub kappa_with_oneself: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JudgedSignal {
    pub press: u32,
    /// Time of the signal on the trial's clock, in nanoseconds.
    pub clock_ns: SessionTime,
    pub signal: Signal,
    /// Judgement of the signal: "hit", "repeated", "harmless", "late", "wrong" or "needless".
    pub worth: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HarmfulFalseBelief {
    pub aspect: String,
    pub began_ns: SessionTime,
    /// Time at which the belief was corrected, on the trial's clock; null if the participant held it until the end.
    pub corrected_ns: Option<SessionTime>,
    pub errors: u32,
    pub believed: String,
    pub truth: String,
    /// Believed and true value in words for screens; filled in only while signals are judged, not in records on disk.
    #[serde(skip)]
    pub words: String,
    /// The signal that would have corrected the belief; null if no signal can.
    pub signal: Option<Signal>,
    /// Index, from 0, of the wizard's signal that hit the false belief; null if no signal hit it.
    pub hit_by: Option<usize>,
}
