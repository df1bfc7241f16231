//! Performance of a wizard: reaction times, targets and omissions (Riek 2012, "Wizard of Oz studies in HRI", asks for
//! the wizard's errors and reaction times to be reported).
//!
//! The wizard's signals are compared with periods of false belief. A period that led to an error and in which the
//! wizard sent no signal is an omission; periods without errors need no signal. All times are on the trial's clock.

use serde::{Deserialize, Serialize};

use super::median;
use crate::base::text::count;
use crate::base::time::SessionTime;
use crate::kitchen::AspectId;

/// A signal is late rather than wrong if the false belief ended at most this many presses of the human before the
/// signal.
pub const LATE_PRESSES: u32 = 3;

/// A period in which the participant's belief about an aspect was false.
#[derive(Clone, Debug, PartialEq)]
pub struct FalseBeliefPeriod {
    /// The aspect that the false belief is about.
    pub aspect: AspectId,
    /// Time at which the belief became false, on the trial's clock.
    pub began: SessionTime,
    /// End of the false belief period, and the number of human presses until then; `None` if the trial ended before.
    pub corrected: Option<(SessionTime, u32)>,
    /// Number of errors attributed to the false belief.
    pub errors: u32,
}

impl FalseBeliefPeriod {
    /// Whether the belief is false at this time on the trial's clock.
    pub fn holds(&self, clock: SessionTime) -> bool {
        self.began <= clock && self.corrected.is_none_or(|(end, _)| clock < end)
    }
}

/// A signal that a wizard sent.
#[derive(Clone, Debug, PartialEq)]
pub struct WizardSignal {
    /// Time at which the wizard sent the signal, on the trial's clock.
    pub clock: SessionTime,
    /// Number of presses of the human before the signal.
    pub press: u32,
    /// State aspects that the signal reveals.
    pub aspects: Vec<AspectId>,
    /// Time from the wizard's key press to the frame that shows the signal, in milliseconds; `None` if the time was not
    /// recorded.
    pub to_display_ms: Option<f64>,
    /// Whether the wizard withdrew the signal before the signal's time was over.
    pub taken_back: bool,
}

/// Judgement of a wizard's signal by the participant's beliefs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SignalVerdict {
    /// Hit: the first signal about a false belief that led to an error.
    Hit {
        /// Time from the beginning of the false belief to the signal, in seconds.
        latency_s: f64,
        /// The index of the false belief period that the signal is about.
        period: usize,
    },
    /// Repeated: a further signal about the same false belief.
    Repeated,
    /// Harmless: a signal about a false belief that led to no error.
    Harmless,
    /// Late: a signal about a false belief that had ended at most [`LATE_PRESSES`] presses before.
    Late,
    /// Wrong: a signal about a right belief while another belief was false.
    Wrong,
    /// Needless: a signal while no belief was false.
    Needless,
}

impl SignalVerdict {
    /// The judgement of the signal in a word; commands, reports, training and console use these words.
    pub fn name(self) -> &'static str {
        match self {
            SignalVerdict::Hit { .. } => "hit",
            SignalVerdict::Repeated => "repeated",
            SignalVerdict::Harmless => "harmless",
            SignalVerdict::Late => "late",
            SignalVerdict::Wrong => "wrong",
            SignalVerdict::Needless => "needless",
        }
    }
}

/// The verdict on each of a wizard's signals, in the order of the signals.
pub fn verdicts(sent: &[WizardSignal], periods: &[FalseBeliefPeriod]) -> Vec<SignalVerdict> {
    let mut hit = vec![false; periods.len()];
    let verdict = |sent: &WizardSignal| {
        let about = |period: &FalseBeliefPeriod| sent.aspects.contains(&period.aspect);
        let open = |period: &FalseBeliefPeriod| period.holds(sent.clock);
        let mut now = periods.iter().enumerate().filter(|(_, period)| about(period) && open(period));
        // If a signal shows two aspects, the aspect whose false belief led to an error counts.
        let of_errors = now.clone().find(|(_, period)| period.errors > 0);
        match of_errors.or_else(|| now.next()) {
            Some((index, period)) if period.errors > 0 && !hit[index] => {
                hit[index] = true;
                return SignalVerdict::Hit { latency_s: sent.clock.secs_since(period.began), period: index };
            }
            Some((_, period)) if period.errors > 0 => return SignalVerdict::Repeated,
            Some(_) => return SignalVerdict::Harmless,
            None => {}
        }
        let is_late = |period: &FalseBeliefPeriod| {
            period.corrected.is_some_and(|(end, press)| end <= sent.clock && sent.press <= press + LATE_PRESSES)
        };
        match () {
            () if periods.iter().any(|period| about(period) && is_late(period)) => SignalVerdict::Late,
            () if periods.iter().any(open) => SignalVerdict::Wrong,
            () => SignalVerdict::Needless,
        }
    };
    sent.iter().map(verdict).collect()
}

/// Summary of durations: their number, median and maximum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimeSummary {
    /// Number of durations.
    pub n: u64,
    /// Median of the durations; the field that contains this summary names the unit.
    pub median: f64,
    /// The longest duration, in the same unit as the median.
    pub max: f64,
}

impl TimeSummary {
    /// The summary of a list of durations; `None` if the list is empty.
    pub fn from_times(times: Vec<f64>) -> Option<TimeSummary> {
        let max = times.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let n = times.len() as u64;
        median(times).map(|median| TimeSummary { n, median, max })
    }

    /// The summary of durations over several trials; its median is the median of the trials' medians.
    fn together(trials: impl Iterator<Item = TimeSummary>) -> Option<TimeSummary> {
        let trials: Vec<TimeSummary> = trials.collect();
        let medians = TimeSummary::from_times(trials.iter().map(|times| times.median).collect())?;
        let max = trials.iter().map(|times| times.max).fold(medians.max, f64::max);
        Some(TimeSummary { n: trials.iter().map(|times| times.n).sum(), max, ..medians })
    }
}

/// Performance of a wizard in a trial. Numbers that need the participant's beliefs are null if the beliefs are not
/// known.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WizardMeasures {
    /// Number of signals that the wizard sent.
    pub signals: u64,
    /// Number of signals that the wizard withdrew.
    pub taken_back: u64,
    /// Time from the wizard's key press to the frame that shows the signal, in milliseconds; null if the time was not
    /// recorded.
    pub key_to_display_ms: Option<TimeSummary>,
    /// Number of periods of false belief that led to errors.
    pub episodes: Option<u64>,
    /// Number of periods of false belief with errors in which the wizard sent a signal.
    pub hits: Option<u64>,
    /// Number of periods of false belief with errors in which the wizard sent no signal.
    pub omissions: Option<u64>,
    /// Time from the beginning of a false belief to the signal about it, in seconds.
    pub latency_s: Option<TimeSummary>,
    /// Number of signals about a false belief that an earlier signal had been about.
    pub repeated: Option<u64>,
    /// Number of signals about a false belief that had ended a few presses before.
    pub late: Option<u64>,
    /// Number of signals about a right belief while another belief was false.
    pub wrong_targets: Option<u64>,
    /// Number of signals while no belief was false.
    pub needless: Option<u64>,
    /// Number of signals about false beliefs that led to no error.
    pub harmless: Option<u64>,
}

impl WizardMeasures {
    /// The wizard's performance, from the signals of a trial and, where known, the periods of false belief.
    pub fn from_signals(sent: &[WizardSignal], periods: Option<&[FalseBeliefPeriod]>) -> WizardMeasures {
        let drawn: Vec<f64> = sent.iter().filter_map(|sent| sent.to_display_ms).collect();
        let measures = WizardMeasures {
            signals: sent.len() as u64,
            taken_back: sent.iter().filter(|sent| sent.taken_back).count() as u64,
            key_to_display_ms: TimeSummary::from_times(drawn),
            ..WizardMeasures::default()
        };
        let Some(periods) = periods else { return measures };
        let verdicts = verdicts(sent, periods);
        let number =
            |is: fn(&SignalVerdict) -> bool| Some(verdicts.iter().filter(|verdict| is(verdict)).count() as u64);
        let latency = |verdict: &SignalVerdict| {
            if let SignalVerdict::Hit { latency_s, .. } = verdict { Some(*latency_s) } else { None }
        };
        let latencies: Vec<f64> = verdicts.iter().filter_map(latency).collect();
        let episodes = periods.iter().filter(|period| period.errors > 0).count() as u64;
        WizardMeasures {
            episodes: Some(episodes),
            hits: Some(latencies.len() as u64),
            omissions: Some(episodes - latencies.len() as u64),
            latency_s: TimeSummary::from_times(latencies),
            repeated: number(|verdict| matches!(verdict, SignalVerdict::Repeated)),
            late: number(|verdict| matches!(verdict, SignalVerdict::Late)),
            wrong_targets: number(|verdict| matches!(verdict, SignalVerdict::Wrong)),
            needless: number(|verdict| matches!(verdict, SignalVerdict::Needless)),
            harmless: number(|verdict| matches!(verdict, SignalVerdict::Harmless)),
            ..measures
        }
    }
}

impl WizardMeasures {
    /// The verdicts in two sentences, which `tomcom compare` and the console's card share; `None` if the beliefs are not
    /// known.
    pub fn words(&self) -> Option<[String; 2]> {
        let number = |value: Option<u64>| value.map_or("-".to_string(), |value| value.to_string());
        let episodes = count(self.episodes?, "false belief", "false beliefs");
        let (hits, missed) = (number(self.hits), number(self.omissions));
        let verdicts = [
            (self.repeated, SignalVerdict::Repeated),
            (self.late, SignalVerdict::Late),
            (self.wrong_targets, SignalVerdict::Wrong),
            (self.needless, SignalVerdict::Needless),
            (self.harmless, SignalVerdict::Harmless),
        ];
        let verdicts = verdicts.map(|(value, verdict)| format!("{} {}", number(value), verdict.name()));
        Some([format!("{episodes} with errors: {hits} hit, {missed} missed"), verdicts.join(", ")])
    }

    /// Signals that count as wrong in training: about a right belief, whether or not another one was false.
    pub fn wrong_or_needless(&self) -> Option<u64> {
        Some(self.wrong_targets? + self.needless?)
    }

    /// Totals of the wizard's performance over several trials: numbers are null where one trial's number is null;
    /// durations are the median of the trials' medians.
    pub fn sum<'a>(trials: impl IntoIterator<Item = &'a WizardMeasures>) -> WizardMeasures {
        let add = |a: Option<u64>, b: Option<u64>| Some(a? + b?);
        let trials: Vec<&WizardMeasures> = trials.into_iter().collect();
        let times = |of: fn(&WizardMeasures) -> Option<TimeSummary>| {
            TimeSummary::together(trials.iter().filter_map(|one| of(one)))
        };
        let (key_to_display_ms, latency_s) = (times(|one| one.key_to_display_ms), times(|one| one.latency_s));
        let zero = WizardMeasures { key_to_display_ms, latency_s, ..WizardMeasures::from_signals(&[], Some(&[])) };
        trials.into_iter().fold(zero, |sum, one| WizardMeasures {
            signals: sum.signals + one.signals,
            taken_back: sum.taken_back + one.taken_back,
            episodes: add(sum.episodes, one.episodes),
            hits: add(sum.hits, one.hits),
            omissions: add(sum.omissions, one.omissions),
            repeated: add(sum.repeated, one.repeated),
            late: add(sum.late, one.late),
            wrong_targets: add(sum.wrong_targets, one.wrong_targets),
            needless: add(sum.needless, one.needless),
            harmless: add(sum.harmless, one.harmless),
            ..sum
        })
    }
}

/// Criterion that a wizard has to meet in training.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrainingCriterion {
    /// Least share of hits among the periods of false belief that led to errors.
    pub hits: f64,
    /// Largest share of signals that are wrong or needless.
    pub wrong: f64,
}

impl TrainingCriterion {
    /// Whether a wizard's performance meets the training criterion; false where no period of false belief led to
    /// errors.
    pub fn is_met(&self, measures: &WizardMeasures) -> bool {
        let share = |part: Option<u64>, all: u64| part.map(|part| part as f64 / all as f64).filter(|_| all > 0);
        let hits = share(measures.hits, measures.episodes.unwrap_or(0));
        let wrong = share(measures.wrong_or_needless(), measures.signals).unwrap_or(0.0);
        hits.is_some_and(|hits| hits >= self.hits) && wrong <= self.wrong
    }
}
