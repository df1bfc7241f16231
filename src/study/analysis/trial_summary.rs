//! Summaries of trials and simulations that commands print. A number that cannot be computed is null in JSON.

use std::collections::BTreeMap;

use serde::Serialize;

use super::offer_summary::{OfferDurations, TimedOffer};
use tomcom_core::base::text::PathText;
use tomcom_core::base::text::{count, decimal};
use tomcom_core::kitchen::{Agent, DishId};
use tomcom_core::measures::attribution::ErrorCause;
use tomcom_core::measures::sequences::{ErrorSequence, sequences, sequences_any_aspect};
use tomcom_session::TimelineEvent;
use tomcom_session::follower::SessionFollower;
use tomcom_session::settings::ParticipantKind;
use tomcom_session::study_arm::StudyArm;

/// Summary of one trial: presses, errors, signals, served orders.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialSummary {
    /// Number of presses of the human.
    pub human_actions: u64,
    /// Number of presses of the robot.
    pub robot_actions: u64,
    /// Number of the human's presses that were errors.
    pub errors: u64,
    /// Number of the human's presses that the robot may have overtaken (races), which do not count as errors.
    pub races: u64,
    /// Number of signals shown to the participant.
    pub signals: u64,
    /// Errors that follow from false beliefs; `None` where the participant's beliefs are not known.
    pub beliefs: Option<TrialFalseBeliefErrors>,
    /// For each served order, its dish and the number of presses of both agents since the previously served order.
    pub served: Vec<(DishId, u32)>,
    /// Duration of the trial on its own clock, in seconds.
    pub seconds: f64,
    /// For each closed offer, the time for which the offer stood, in milliseconds.
    pub offers_ms: Vec<u32>,
}

impl TrialSummary {
    /// Summary of the session's trial up to the session's last event.
    pub fn from_follower(follower: &SessionFollower) -> TrialSummary {
        let session = &follower.session;
        let mut before = 0;
        let served = session.served.iter().map(|served| {
            let presses = served.presses - before;
            before = served.presses;
            (served.dish, presses)
        });
        let served = served.collect();
        let signals = session.timeline.iter().filter(|entry| matches!(entry.what, TimelineEvent::Signal { .. }));
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

/// Errors of one trial that follow from false beliefs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialFalseBeliefErrors {
    /// Number of errors that follow from false beliefs.
    pub related: u64,
    /// Number of errors that only a pair of false beliefs explains.
    pub related_to_pairs: u64,
    /// Error sequences: successive errors that follow from the same false belief.
    pub sequences: Vec<ErrorSequence>,
    /// Error sequences that are formed whichever false beliefs the errors follow from.
    pub any_aspect: Vec<ErrorSequence>,
    /// Number of false belief episodes that caused at least one error.
    pub episodes: u64,
}

impl TrialFalseBeliefErrors {
    /// Errors from false beliefs in a session so far; `None` unless the beliefs before every press are known.
    fn from_follower(follower: &SessionFollower) -> Option<TrialFalseBeliefErrors> {
        let judged = &follower.judged;
        let is_simulated = follower.session.spec.participant.kind == ParticipantKind::Simulated;
        if !is_simulated || judged.iter().any(|press| !press.belief_known) {
            return None;
        }
        let count =
            |is: fn(ErrorCause) -> bool| judged.iter().filter_map(|press| press.cause).filter(|&c| is(c)).count();
        Some(TrialFalseBeliefErrors {
            related: count(|cause| matches!(cause, ErrorCause::Belief { .. })) as u64,
            related_to_pairs: count(|cause| matches!(cause, ErrorCause::Belief { with: Some(_), .. })) as u64,
            sequences: sequences(judged),
            any_aspect: sequences_any_aspect(judged),
            episodes: follower.episodes.harmful().count() as u64,
        })
    }
}

/// Errors that follow from false beliefs, in one or several trials. Values are null where the participants' beliefs are
/// not known.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FalseBeliefErrorSummary {
    /// Number of errors that are attributed to a false belief.
    pub belief_related_errors: Option<u64>,
    /// Number of errors that only a pair of false beliefs explains.
    pub errors_of_two_beliefs: Option<u64>,
    /// Number of error sequences: successive errors that follow from the same false belief.
    pub sequences: Option<u64>,
    /// Mean number of errors in an error sequence; null also without sequences.
    pub mean_sequence_length: Option<f64>,
    /// Mean time from the first error of a sequence to the first correct press after its last error, in seconds.
    pub mean_recovery_s: Option<f64>,
    /// Number of error sequences that are formed whichever false beliefs the errors follow from.
    pub sequences_any_aspect: Option<u64>,
    /// Mean number of errors in the sequences of `sequences_any_aspect`; null also without such sequences.
    pub mean_sequence_length_any_aspect: Option<f64>,
    /// Number of false belief episodes that caused at least one error.
    pub false_belief_episodes: Option<u64>,
}

impl FalseBeliefErrorSummary {
    /// Sums over several trials of the errors that follow from false beliefs.
    pub fn from_trials<'a>(trials: impl IntoIterator<Item = &'a TrialSummary>) -> FalseBeliefErrorSummary {
        let mut sums = BeliefSums::default();
        trials.into_iter().for_each(|trial| sums.add(trial.beliefs.as_ref()));
        sums.figures()
    }

    /// The errors from false beliefs as text; `errors` is the number of all errors.
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

/// Totals of presses, errors and signals over the trials of one study arm.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct StudyArmTotals {
    /// Study arm of the trials, as they were carried out.
    pub arm: StudyArm,
    /// Number of trials in the study arm.
    pub trials: u64,
    /// Number of presses of the human.
    pub human_actions: u64,
    /// Number of the human's presses that were errors.
    pub errors: u64,
    /// Number of signals shown to the participant.
    pub signals: u64,
}

/// Summary of simulated trials: the output of `tomcom simulate`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SimulationSummary {
    /// Number of simulated trials.
    pub trials: u64,
    /// Number of presses of the human.
    pub human_actions: u64,
    /// Number of presses of the robot.
    pub robot_actions: u64,
    /// Number of the human's presses that were errors.
    pub errors: u64,
    /// Number of the human's presses shortly after a change by the robot at the same location (races), which do not
    /// count as errors.
    pub races: u64,
    /// Errors that follow from false beliefs.
    #[serde(flatten)]
    pub beliefs: FalseBeliefErrorSummary,
    /// Number of signals shown to the participants.
    pub signals: u64,
    /// Durations of offers, both of those that a wizard could see and of the others.
    pub offers: OfferDurations,
    /// Number of orders served.
    pub orders_served: u64,
    /// Median over served orders of the number of presses of both agents since the previously served order.
    pub presses_per_order: Option<f64>,
    /// Median over served orders of the least number of presses for the dish from an empty kitchen.
    pub optimal_presses_per_order: Option<f64>,
    /// Duration of all trials together, by their own clocks, in seconds.
    pub simulated_s: f64,
    /// Duration of the simulation by the computer's clock, in seconds.
    pub wall_s: f64,
    /// Number of excluded recordings, which the summary leaves out.
    pub excluded: u64,
    /// Number of complete recordings that already existed and were read instead of simulated anew.
    pub found: u64,
    /// New paths of logs that end before the end of their header, as after a power failure; the trials of these logs
    /// were simulated anew.
    pub moved: Vec<String>,
    /// Totals of presses, errors and signals, by study arm.
    pub arms: Vec<StudyArmTotals>,
    /// Paths of the folders of the recordings.
    pub recordings: Vec<PathText>,
}

/// Running sums over trials of errors that follow from false beliefs.
#[derive(Clone, Debug, Default)]
struct BeliefSums {
    /// Whether the participant's beliefs are unknown in at least one trial.
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

/// Running mean of values; `None` while there are no values.
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
    /// Histograms over served orders: of the presses per order, and of the least number of presses for the order's
    /// dish.
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

    /// The summary of all added simulated trials.
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

/// Median of a histogram, which is the mean of the middle two values for an even count; `None` for an empty histogram.
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
