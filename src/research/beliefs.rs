//! Command `tomcom-research beliefs`: checks the belief estimate before each press, how well it agrees with the
//! participant's recorded beliefs, and how well it predicts the press.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Serialize;
use tomcom_core::base::text::{count, decimal};
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::state::MAX_LOCATIONS;
use tomcom_core::kitchen::{Kitchen, KitchenChange, LocationId, Press};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::ErrorCause;
use tomcom_core::measures::detection::{
    BeliefsBeforePress, EstimateBeforePress, FalseBeliefDetection, TrialBeliefs, aspect_groups,
};
use tomcom_core::measures::flags::{
    FlagThresholds, MOST_FALSE_FLAGS, ThresholdChoice, ThresholdSource, chosen_thresholds,
};
use tomcom_core::measures::raters::BeliefSource;
use tomcom_core::mind::belief::Belief;
use tomcom_core::mind::choice::ChoiceParameters;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::replay::{RecordingReplay, SameKitchenCheck};
use tomcom_session::settings::ParticipantKind;
use tomcom_session::{Event, Session, TimestampedEvent};
use tomcom_study::analysis::likelihood::PressLogLikelihood;

use tomcom_study::analysis::probe_figures::{self, ProbeSummary};

use tomcom_study::analysis::probe_record::{ProbeCollector, ProbedTrial};
use tomcom_study::analysis::seen_contents::LastSeenContents;
use tomcom_study::gathered::GatheredRecordings;
use tomcom_study::parallel;

/// Seed of the bootstrap's random numbers: the same recordings give the same interval.
const SEED: u64 = 1;

/// How well the belief estimate agrees with beliefs and presses: the output of `tomcom-research beliefs`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BeliefCheck {
    pub recordings: u64,
    pub participants: u64,
    pub human_actions: u64,
    /// Source of what participants believed: recorded beliefs, or answers to freeze probes; null if there is neither.
    pub beliefs_from: Option<BeliefSource>,
    #[serde(flatten)]
    pub detection: FalseBeliefDetection,
    /// Log likelihood of the human's presses under the model, per press, in nats.
    pub log_likelihood: PressLogLikelihood,
    /// Answers to freeze probes, and how the belief estimate agrees with them; absent without answers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub probes: Option<ProbeSummary>,
}

impl BeliefCheck {
    /// Checks the belief estimate against the presses of several trials in one kitchen; `codes` holds the code of the
    /// participant of each trial. Without `thresholds` they are chosen by cross-fitting. Where no beliefs are recorded,
    /// answers to freeze probes in these trials take their place.
    pub fn from_trials(
        kitchen: &Arc<Kitchen>,
        trials: &[TrialBeliefs],
        codes: &[String],
        thresholds: Option<FlagThresholds>,
        probes: Option<ProbeSummary>,
    ) -> BeliefCheck {
        let mut cost = CostToGo::new(kitchen.clone());
        let known: BTreeSet<&String> = codes.iter().collect();
        let index = |code: &String| known.range::<&String, _>(..code).count();
        let participants: Vec<usize> = codes.iter().map(index).collect();
        let choice = thresholds.map_or(ThresholdChoice::CrossFitted(&participants), ThresholdChoice::Given);
        let mut detection = FalseBeliefDetection::from_trials(kitchen, trials, Some(choice));
        let is_recorded = trials.iter().flatten().any(|press| press.held.is_some());
        if let Some(found) = probes.as_ref().filter(|_| !is_recorded) {
            detection = found.detection.in_place_of(detection);
        }
        let by_probes = probes.as_ref().map(|found| found.beliefs_from);
        BeliefCheck {
            beliefs_from: if is_recorded { Some(BeliefSource::Recorded) } else { by_probes },
            recordings: trials.len() as u64,
            participants: known.len() as u64,
            human_actions: trials.iter().map(Vec::len).sum::<usize>() as u64,
            detection,
            log_likelihood: PressLogLikelihood::from_trials(
                kitchen,
                &mut cost,
                &ChoiceParameters::default(),
                trials,
                &participants,
                SEED,
            ),
            probes,
        }
    }
}

/// Collects, for each counted press of the human, the belief estimate before the press and the press's judgement.
#[derive(Default)]
pub struct TrialBeliefCollector {
    /// Presses of the trial so far, each with the belief estimate before the press.
    pub trial: TrialBeliefs,
    /// Recorded belief of the participant before the next press: probability of the true value, for each state aspect.
    held: Option<Vec<f64>>,
    before: Before,
}

impl TrialBeliefCollector {
    /// Adds an event that has just been applied to the session. A counted press of the human is added with its
    /// judgement and with the belief estimate before the press.
    pub fn add(
        &mut self,
        session: &Session,
        judged: Option<&JudgedPress>,
        estimate: Option<EstimateBeforePress>,
        stamped: &TimestampedEvent,
        change: &KitchenChange,
    ) {
        let kitchen = &session.kitchen;
        if let Event::ParticipantBelieves(witness) = &stamped.event {
            let fits = Belief::of_witness(kitchen, session.state, witness).is_some();
            self.held = fits.then(|| witness.aspects.iter().map(|aspect| aspect.p_truth).collect());
        }
        if let (Some(judged), Some(press)) = (judged, change.human_press()) {
            let view = self.before.press(kitchen, &press, judged, stamped.time, self.held.take());
            self.trial.push(BeliefsBeforePress { estimate, ..view });
        }
        self.before.notice(session, &stamped.event, change);
    }
}

/// State of a gaze baseline, which predicts beliefs from gaze without a belief filter, before the next event.
#[derive(Default)]
struct Before {
    seen: LastSeenContents,
    /// For each location, the time of its last change, if somebody other than the human made that change.
    others_changed: [Option<SessionTime>; MAX_LOCATIONS],
}

impl Before {
    /// Notes changes of the kitchen and gaze in an event that has just been applied.
    fn notice(&mut self, session: &Session, event: &Event, change: &KitchenChange) {
        self.seen.note(session, event, change);
        let is_own = change.human_press().is_some();
        for index in 0..session.kitchen.locations.len() {
            let location = LocationId(index as u8);
            if change.states().is_some_and(|(before, after)| before.code(location) != after.code(location)) {
                self.others_changed[index] = (!is_own).then_some(session.time);
            }
        }
    }

    /// The next press of the human with its judgement, and the estimate and the baseline's knowledge before the press.
    fn press(
        &self,
        kitchen: &Kitchen,
        press: &Press,
        judged: &JudgedPress,
        now: SessionTime,
        held: Option<Vec<f64>>,
    ) -> BeliefsBeforePress {
        let since_s = |at: &Option<SessionTime>| at.map(|at| now.secs_since(at));
        let mut press = BeliefsBeforePress {
            state: press.before,
            button: press.button,
            held,
            estimate: None,
            unseen_change: (0..kitchen.locations.len())
                .map(|index| self.seen.is_changed_unseen(LocationId(index as u8)))
                .collect(),
            since_change_s: self.others_changed[..kitchen.locations.len()].iter().map(since_s).collect(),
            errs_about: Vec::new(),
        };
        let targets = judged.cause.into_iter().flat_map(ErrorCause::targets);
        let about = targets.flat_map(|target| target.aspects(kitchen));
        press.errs_about = about.filter(|aspect| press.is_wrong(aspect.index()) == Some(true)).collect();
        press
    }
}

/// Checks the belief estimates of recordings in one kitchen. The thresholds for flagging false beliefs are chosen on
/// the recordings `choose_on`, which are not checked, or by cross-fitting if there are none. `done` is called after
/// each recording.
///
/// # Errors
/// A recording cannot be read or replayed; the recordings are of different kitchens; a recording, or a participant, is
/// both checked and in `choose_on`; the beliefs in `choose_on` are not known.
pub fn check(
    recordings: &GatheredRecordings,
    choose_on: &GatheredRecordings,
    done: impl Fn() + Sync,
) -> FileResult<BeliefCheck> {
    let all = recordings.beside(choose_on)?;
    let recordings = &recordings.paths;
    let BeliefCheckTrials { kitchen, mut trials, mut participants, probes } = views(&all, done)?;
    let other = trials.split_off(recordings.len());
    let others = participants.split_off(recordings.len());
    if let Some((code, recording)) = others.iter().zip(&choose_on.paths).find(|(code, _)| participants.contains(code)) {
        let found = format!("a recording of {code}, of whom a recording is checked, too");
        let remedy = "--choose-on with recordings of other participants".to_string();
        return Err(FileError::from_finding(recording, found, remedy));
    }
    let thresholds = match choose_on.paths.first() {
        None => None,
        Some(first) => Some(chosen_thresholds(&other, &aspect_groups(&kitchen)).ok_or_else(|| {
            let found =
                "recordings for the choice of thresholds, in which the participants' beliefs are not known".to_string();
            FileError::from_finding(first, found, "recordings of simulated participants".to_string())
        })?),
    };
    let checked = participants.iter().zip(&probes).filter_map(|(code, probed)| Some((code.as_str(), probed.as_ref()?)));
    let probes = ProbeSummary::from_trials(checked);
    Ok(BeliefCheck::from_trials(&kitchen, &trials, &participants, thresholds, probes))
}

/// Trials of one kitchen whose belief estimates are checked.
#[derive(Clone, Debug)]
struct BeliefCheckTrials {
    kitchen: Arc<Kitchen>,
    /// The trials' presses with estimates, in the order of the recordings.
    trials: Vec<TrialBeliefs>,
    /// Code of the participant of each trial, with the seed in front if the participant is simulated.
    participants: Vec<String>,
    /// Freeze probes of each trial; `None` for trials without probes.
    probes: Vec<Option<ProbedTrial>>,
}

/// Replays recordings on all processors and collects their presses. `done` is called after each recording.
///
/// # Errors
/// The same errors as those of [`check`].
fn views(recordings: &[PathBuf], done: impl Fn() + Sync) -> FileResult<BeliefCheckTrials> {
    let results = parallel::each(recordings, |recording| view(recording), done);
    let (mut trials, mut participants, mut probes) = (Vec::new(), Vec::new(), Vec::new());
    let mut one_kitchen = SameKitchenCheck::default();
    for (result, recording) in results.into_iter().zip(recordings) {
        let RecordingView { kitchen, trial, participant, probed } = result?;
        one_kitchen.admit(recording, &kitchen)?;
        trials.push(trial);
        participants.push(participant);
        probes.push(probed);
    }
    Ok(BeliefCheckTrials { kitchen: one_kitchen.kitchen()?, trials, participants, probes })
}

struct RecordingView {
    kitchen: Arc<Kitchen>,
    trial: TrialBeliefs,
    participant: String,
    probed: Option<ProbedTrial>,
}

fn view(recording: &Path) -> FileResult<RecordingView> {
    let mut replay = RecordingReplay::open(recording)?;
    let mut probes = ProbeCollector::default();
    let mut views = TrialBeliefCollector::default();
    while let Some(replayed) = replay.step()? {
        let (follower, seq) = (&replay.follower, replayed.stamped.seq);
        let judged = follower.judged.last().filter(|press| press.seq == seq);
        let estimated = follower.estimated.as_ref().filter(|one| one.press == seq);
        let estimate = estimated.map(|one| EstimateBeforePress::from_witness(&one.witness(&follower.session.kitchen)));
        probes.note(&replayed.stamped, &replayed.change, follower);
        views.add(&follower.session, judged, estimate, &replayed.stamped, &replayed.change);
    }
    let session = replay.session();
    let spec = &session.spec;
    // Simulated participants have the same codes for every seed, so the seed is added to the code.
    let participant = match spec.participant.kind {
        ParticipantKind::Simulated => format!("seed{}-{}", spec.seed, spec.participant.code),
        _ => spec.participant.code.clone(),
    };
    let probed = Some(probes.finish(session)).filter(ProbedTrial::is_any);
    Ok(RecordingView { kitchen: session.kitchen.clone(), trial: views.trial, participant, probed })
}

pub fn describe(check: &BeliefCheck) -> String {
    let number = |value: Option<f64>| decimal(value, 3);
    let (found, flags, likely) = (&check.detection, &check.detection.flags, &check.log_likelihood);
    let thresholds = flags.thresholds.zip(flags.thresholds_from).map_or(String::new(), |(at, from)| {
        let [locations, recipes] = [at.locations, at.recipes].map(|threshold| format!("{threshold:.3}"));
        let from = match from {
            ThresholdSource::OtherRecordings => "chosen on other recordings".to_string(),
            ThresholdSource::OtherHalf => {
                "each half of the participants judged with those chosen on the other; all give".to_string()
            }
            ThresholdSource::OneParticipant => "of one participant, not judged without a second one".to_string(),
        };
        format!("\n  thresholds {from}: {locations} for locations, {recipes} for recipes")
    });
    // For a single participant there is no interval, since there is no spread between participants.
    let interval = likely.gain_interval.filter(|_| check.participants > 1);
    let interval = interval.map_or(String::new(), |[from, to]| format!(" ({from:.3} to {to:.3})"));
    let informed = match (likely.informed_tau, likely.informed_lapse) {
        (Some(tau), Some(lapse)) => format!(" (tau {tau:.2}, lapse {lapse:.3})"),
        _ => String::new(),
    };
    let mut text = format!(
        "{} of {}, {} of the human\n\
         what is believed wrong, area under the ROC: {} in the mean (locations {}, where knowing only what changed unseen \
         gives {}, and how long ago others changed it {}; recipes {})\n\
         false belief episodes of two or more errors flagged before the third: {} of {}, {} false flags per 20 presses, \
         wrongly flagged {} of the time{thresholds}\n\
         expected calibration error between 0.05 and 0.95: {}\n\
         log likelihood per press: {} (informed human {}{informed}, uniform {}); gain {}{interval} nats\n\
         \n{:<32}{:>8}{:>8}\n",
        count(check.recordings, "recording", "recordings"),
        count(check.participants, "participant", "participants"),
        count(check.human_actions, "press", "presses"),
        number(found.auc),
        number(found.auc_locations),
        number(found.auc_baseline),
        number(found.auc_recency),
        number(found.auc_recipes),
        number(flags.flagged_before_third_error),
        flags.episodes.map_or("-".to_string(), |episodes| episodes.to_string()),
        number(flags.false_flags_per_20_actions),
        number(flags.wrongly_flagged),
        number(found.ece),
        number(likely.model),
        number(likely.informed),
        number(likely.uniform),
        number(likely.gain),
        "aspect",
        "ROC",
        "wrong",
    );
    for aspect in &found.aspects {
        text.push_str(&format!("{:<32}{:>8}{:>8.3}\n", aspect.aspect, number(aspect.auc), aspect.wrong));
    }
    text += &check.probes.as_ref().map_or(String::new(), probe_figures::describe);
    text + &legend(check)
}

/// Least number of recordings for which the belief check prints statistics of single state aspects.
const TELLING: u64 = 20;

/// Explanation of the statistics that the belief check prints, as text.
fn legend(check: &BeliefCheck) -> String {
    let few = match check.recordings {
        TELLING.. => String::new(),
        few => format!(
            "\n{} little about single aspects, least about recipes, which are seldom wrong: take {TELLING} or more.",
            count(few, "recording says", "recordings say")
        ),
    };
    format!(
        "\nROC: how surely the estimate tells an aspect that is believed wrong from one that is not; 1 always, 0.5 no better \
         than chance.\nwrong: the share of the presses before which the aspect was believed wrong.\nflagged: the estimate \
         passes the threshold that catches most, with at most {MOST_FALSE_FLAGS} false flags per 20 presses of the human.\n\
         calibration error: how far the predicted probabilities of a false belief (belief in the truth below 0.5) are from how \
         often it is false; 0 is best.\ngain: by how much the estimate predicts presses better than a human who knows everything; above 0 it knows \
         something of beliefs (0.1 nats: presses are 10 % likelier).{few}\n"
    )
}
