//! Summaries of trials and simulations that commands print, and times of orders and signals. A number that cannot be
//! computed is null in JSON.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::analysis::offer_summary::{OfferDurations, TimedOffer};
use tomcom_core::base::text::{PathText, count, decimal};
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::{CostToGo, ProofBudget};
use tomcom_core::kitchen::{Agent, DishId, Kitchen, KitchenChange, LocationId};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::ErrorCause;
use tomcom_core::measures::sequences::{ErrorSequence, sequences, sequences_any_aspect};
use tomcom_session::follower::SessionFollower;
use tomcom_session::settings::ParticipantKind;
use tomcom_session::study_arm::StudyArm;
use tomcom_session::{Event, Session, TimelineEvent, TimestampedEvent};

#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialSummary {
    pub human_actions: u64,
    pub robot_actions: u64,
    pub errors: u64,
    /// Number of the human's presses that the robot may have overtaken (races), which do not count as errors.
    pub races: u64,
    pub signals: u64,
    /// Errors that follow from false beliefs; `None` where the participant's beliefs are not known.
    pub beliefs: Option<TrialFalseBeliefErrors>,
    /// For each served order, its dish and the number of presses of both agents since the previously served order.
    pub served: Vec<(DishId, u32)>,
    pub seconds: f64,
    /// For each closed offer, the time for which the offer stood, in milliseconds.
    pub offers_ms: Vec<u32>,
}

impl TrialSummary {
    pub fn from_follower(follower: &SessionFollower) -> TrialSummary {
        let session = &follower.session;
        let mut before = 0;
        let served = session.served.iter().map(|served| {
            let presses = served.presses - before;
            before = served.presses;
            (served.dish, presses)
        });
        let served = served.collect();
        let signals = session
            .timeline
            .iter()
            .filter(|entry| matches!(entry.what, TimelineEvent::Noted(Event::SignalShown { .. })));
        TrialSummary {
            human_actions: u64::from(session.presses[Agent::Human.index()]),
            robot_actions: u64::from(session.presses[Agent::Robot.index()]),
            errors: follower.errors() as u64,
            races: follower.judged.iter().filter(|press| press.verdict.race).count() as u64,
            signals: signals.count() as u64,
            beliefs: TrialFalseBeliefErrors::from_follower(follower),
            served,
            seconds: session.trial_clock(session.time).as_secs_f64(),
            offers_ms: TimedOffer::all(session)
                .iter()
                .filter_map(|one| Some((1000.0 * one.stood_s?).round() as u32))
                .collect(),
        }
    }
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialFalseBeliefErrors {
    pub related: u64,
    pub related_to_pairs: u64,
    pub sequences: Vec<ErrorSequence>,
    pub any_aspect: Vec<ErrorSequence>,
    pub episodes: u64,
}

impl TrialFalseBeliefErrors {
    /// Errors from false beliefs in a session so far; `None` unless the beliefs before every press are known.
    fn from_follower(follower: &SessionFollower) -> Option<TrialFalseBeliefErrors> {
        let judged = &follower.judged;
        let kind = follower.session.spec.participant.kind;
        let is_told = matches!(kind, ParticipantKind::Simulated | ParticipantKind::External);
        if !is_told || judged.iter().any(|press| !press.belief_known) {
            return None;
        }
        let [related, related_to_pairs] = belief_related(judged);
        Some(TrialFalseBeliefErrors {
            related,
            related_to_pairs,
            sequences: sequences(judged),
            any_aspect: sequences_any_aspect(judged),
            episodes: follower.episodes.harmful().count() as u64,
        })
    }
}

/// Number of errors that follow from false beliefs, and number of those that only two false beliefs together explain.
pub(crate) fn belief_related(judged: &[JudgedPress]) -> [u64; 2] {
    let causes = judged.iter().filter_map(|press| press.cause);
    causes.fold([0, 0], |[related, to_pairs], cause| match cause {
        ErrorCause::Belief { with, .. } => [related + 1, to_pairs + u64::from(with.is_some())],
        ErrorCause::Slip | ErrorCause::Planning => [related, to_pairs],
    })
}

/// Values are null where the participants' beliefs are not known.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FalseBeliefErrorSummary {
    pub belief_related_errors: Option<u64>,
    pub errors_of_two_beliefs: Option<u64>,
    pub sequences: Option<u64>,
    /// Mean number of errors in an error sequence; null also without sequences.
    pub mean_sequence_length: Option<f64>,
    /// Mean time from the first error of a sequence to the first correct press after its last error, in seconds.
    pub mean_recovery_s: Option<f64>,
    pub sequences_any_aspect: Option<u64>,
    /// Mean number of errors in the sequences of `sequences_any_aspect`; null also without such sequences.
    pub mean_sequence_length_any_aspect: Option<f64>,
    pub false_belief_episodes: Option<u64>,
}

impl FalseBeliefErrorSummary {
    pub fn from_trials<'a>(trials: impl IntoIterator<Item = &'a TrialSummary>) -> FalseBeliefErrorSummary {
        let mut sums = BeliefSums::default();
        trials.into_iter().for_each(|trial| sums.add(trial.beliefs.as_ref()));
        sums.figures()
    }

    pub fn describe(&self, errors: u64) -> String {
        let (Some(related), Some(sequences)) = (self.belief_related_errors, self.sequences) else {
            return "belief related errors: not known, since nobody knows what the participant believed".to_string();
        };
        format!(
            "belief related errors: {related} of {errors} ({:.0} %), in {} of {} errors each ({} if a sequence may mix \
             aspects), over after {} s",
            100.0 * related as f64 / errors.max(1) as f64,
            count(sequences, "sequence", "sequences"),
            decimal(self.mean_sequence_length, 1),
            decimal(self.mean_sequence_length_any_aspect, 1),
            decimal(self.mean_recovery_s, 1),
        )
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct StudyArmTotals {
    pub arm: StudyArm,
    pub trials: u64,
    pub human_actions: u64,
    pub errors: u64,
    pub signals: u64,
}

/// Summary of simulated trials: the output of `tomcom simulate`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SimulationSummary {
    pub trials: u64,
    pub human_actions: u64,
    pub robot_actions: u64,
    pub errors: u64,
    /// Presses shortly after a change by the robot at the same location, which do not count as errors.
    pub races: u64,
    #[serde(flatten)]
    pub beliefs: FalseBeliefErrorSummary,
    pub signals: u64,
    /// Durations of offers, both of those that a wizard could see and of the others.
    pub offers: OfferDurations,
    pub orders_served: u64,
    /// Median over served orders of the number of presses of both agents since the previously served order.
    pub presses_per_order: Option<f64>,
    /// Median over served orders of the least number of presses for the dish from an empty kitchen.
    pub optimal_presses_per_order: Option<f64>,
    pub simulated_s: f64,
    pub wall_s: f64,
    pub excluded: u64,
    /// Trials that were aborted since an external mind failed, each with its reason.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub failed: Vec<String>,
    /// Number of complete recordings that already existed and were read instead of simulated anew.
    pub found: u64,
    /// Number of those in which a program of other people takes part, which can have been changed since.
    pub found_external: u64,
    /// New paths of logs that end within their header, as after a power failure; simulated anew.
    pub moved: Vec<String>,
    pub arms: Vec<StudyArmTotals>,
    pub recordings: Vec<PathText>,
}

#[derive(Clone, Debug, Default)]
struct BeliefSums {
    unknown: bool,
    related: u64,
    related_to_pairs: u64,
    lengths: Mean,
    recovery_s: Mean,
    lengths_any_aspect: Mean,
    episodes: u64,
}

impl BeliefSums {
    fn add(&mut self, trial: Option<&TrialFalseBeliefErrors>) {
        let Some(trial) = trial else {
            self.unknown = true;
            return;
        };
        self.related += trial.related;
        self.related_to_pairs += trial.related_to_pairs;
        self.episodes += trial.episodes;
        for sequence in &trial.sequences {
            self.lengths.add(f64::from(sequence.length()));
            if let Some(recovered) = sequence.recovered {
                self.recovery_s.add(recovered.secs_since(sequence.began));
            }
        }
        trial.any_aspect.iter().for_each(|sequence| self.lengths_any_aspect.add(f64::from(sequence.length())));
    }

    fn figures(&self) -> FalseBeliefErrorSummary {
        if self.unknown {
            return FalseBeliefErrorSummary::default();
        }
        FalseBeliefErrorSummary {
            belief_related_errors: Some(self.related),
            errors_of_two_beliefs: Some(self.related_to_pairs),
            sequences: Some(self.lengths.count),
            mean_sequence_length: self.lengths.mean(),
            mean_recovery_s: self.recovery_s.mean(),
            sequences_any_aspect: Some(self.lengths_any_aspect.count),
            mean_sequence_length_any_aspect: self.lengths_any_aspect.mean(),
            false_belief_episodes: Some(self.episodes),
        }
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    count: u64,
    sum: f64,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.count += 1;
        self.sum += value;
    }

    fn mean(self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }
}

/// Running sums over simulated trials; memory use does not grow with the number of trials.
#[derive(Clone, Debug, Default)]
pub struct SimulationSums {
    figures: SimulationSummary,
    beliefs: BeliefSums,
    /// Presses by the number of served orders that took them.
    presses_per_order: BTreeMap<u32, u64>,
    optimal_presses_per_order: BTreeMap<u32, u64>,
    /// Histogram of the times for which offers stood, in milliseconds.
    offers_ms: BTreeMap<u32, u64>,
}

impl SimulationSums {
    /// Adds a simulated trial. `plan_lengths`: the least number of presses for each dish from an empty kitchen.
    pub fn add(&mut self, arm: StudyArm, trial: &TrialSummary, plan_lengths: &[u32]) {
        let sums = &mut self.figures;
        sums.trials += 1;
        sums.human_actions += trial.human_actions;
        sums.robot_actions += trial.robot_actions;
        sums.errors += trial.errors;
        sums.races += trial.races;
        sums.signals += trial.signals;
        sums.orders_served += trial.served.len() as u64;
        sums.simulated_s += trial.seconds;
        let index = sums.arms.iter().position(|one| one.arm >= arm).unwrap_or(sums.arms.len());
        if sums.arms.get(index).is_none_or(|one| one.arm != arm) {
            sums.arms.insert(index, StudyArmTotals { arm, ..StudyArmTotals::default() });
        }
        let one = &mut sums.arms[index];
        one.trials += 1;
        one.human_actions += trial.human_actions;
        one.errors += trial.errors;
        one.signals += trial.signals;
        self.beliefs.add(trial.beliefs.as_ref());
        trial.offers_ms.iter().for_each(|&ms| *self.offers_ms.entry(ms).or_default() += 1);
        for (dish, presses) in &trial.served {
            *self.presses_per_order.entry(*presses).or_default() += 1;
            *self.optimal_presses_per_order.entry(plan_lengths[dish.index()]).or_default() += 1;
        }
    }

    pub fn figures(&self) -> SimulationSummary {
        SimulationSummary {
            beliefs: self.beliefs.figures(),
            presses_per_order: median_of(&self.presses_per_order),
            optimal_presses_per_order: median_of(&self.optimal_presses_per_order),
            offers: OfferDurations {
                n: self.offers_ms.values().sum(),
                median_s: median_of(&self.offers_ms).map(|ms| ms / 1000.0),
                shortest_s: self.offers_ms.keys().next().map(|&ms| f64::from(ms) / 1000.0),
            },
            ..self.figures.clone()
        }
    }
}

fn median_of(counts: &BTreeMap<u32, u64>) -> Option<f64> {
    let all: u64 = counts.values().sum();
    let nth = |wanted: u64| {
        let mut before = 0;
        counts.iter().find_map(|(value, count)| {
            before += count;
            (before > wanted).then_some(f64::from(*value))
        })
    };
    Some((nth(all.checked_sub(1)? / 2)? + nth(all / 2)?) / 2.0)
}

/// On the trial's clock, without pauses.
pub(crate) fn seconds_between(session: &Session, from: SessionTime, to: SessionTime) -> f64 {
    session.trial_clock_at(to).secs_since(session.trial_clock_at(from))
}

/// Seconds from the appearance of each served order to its serving, on the trial's clock.
pub fn order_times(session: &Session) -> Vec<f64> {
    let mut shown: BTreeMap<LocationId, SessionTime> = BTreeMap::new();
    let mut times = Vec::new();
    for entry in &session.timeline {
        match entry.what {
            TimelineEvent::OrderShown { order } => {
                shown.insert(order, entry.time);
            }
            TimelineEvent::Served { order } => {
                times.extend(shown.remove(&order).map(|since| seconds_between(session, since, entry.time)));
            }
            _ => {}
        }
    }
    times
}

#[derive(Clone, Copy, Debug, Default)]
pub struct RegretSum {
    lost: i64,
}

impl RegretSum {
    pub fn note(&mut self, kitchen: &Kitchen, cost: &mut CostToGo, change: &KitchenChange) {
        let KitchenChange::Press { press, .. } = change else { return };
        let recipes = kitchen.true_recipes();
        self.lost += match press.before == press.after {
            true => 1,
            false => {
                let mut budget = ProofBudget::default();
                let mut least = |state| i64::from(cost.proven_all_orders(state, &recipes, &mut budget).presses);
                1 + least(press.after) - least(press.before)
            }
        };
    }

    /// Regret (lost presses) per served order; `None` if no order was served.
    pub fn per_order(&self, served: u64) -> Option<f64> {
        (served > 0).then(|| self.lost as f64 / served as f64)
    }
}

/// Session times at which signals appeared on the display (true) and vanished (false).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SignalTimes {
    changes: Vec<(SessionTime, bool)>,
}

impl SignalTimes {
    pub fn note(&mut self, stamped: &TimestampedEvent) {
        match stamped.event {
            Event::SignalShown { .. } => self.changes.push((stamped.time, true)),
            Event::SignalEnded { .. } => self.changes.push((stamped.time, false)),
            _ => {}
        }
    }

    /// On the trial's clock. One signal is shown at a time: a new one replaces it, the trial's end removes it.
    pub fn seconds(&self, session: &Session) -> f64 {
        let end = session.trial_clock(session.time);
        let (mut shown, mut seconds): (Option<SessionTime>, f64) = (None, 0.0);
        for &(time, appears) in &self.changes {
            let now = session.trial_clock_at(time).min(end);
            let since = if appears { shown.replace(now) } else { shown.take() };
            seconds += since.map_or(0.0, |since| now.secs_since(since));
        }
        seconds + shown.map_or(0.0, |since| end.secs_since(since))
    }
}
