//! Comparison of wizard and assistants over recordings: how far they agree, and where they differ.

use std::collections::BTreeSet;

use serde::Serialize;

use crate::analysis::lesson_report::WizardTrainingSummary;
use crate::analysis::offer_summary::{OfferSummary, TimedOffer};
use crate::analysis::recording_summary::ExclusionStatus;
use crate::grouping::grouped;
use tomcom_core::base::text::{count, decimal};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::kitchen::{AspectId, Kitchen};
use tomcom_core::measures::matching::{CommunicationEvent, MatchCounts, MatchShares, Similarity, WINDOW};
use tomcom_session::event::WizardScreenContent;
use tomcom_session::history::belief_track::AspectBeliefSnapshot;
use tomcom_session::history::comparison::{Communication, SenderComparison, UnmatchedCommunication};
use tomcom_session::history::wording;
use tomcom_session::settings::Condition;
use tomcom_session::study_arm::StudyArm;
use tomcom_session::watcher::{SenderComparisonFollower, SenderComparisonSettings};
use tomcom_session::wizard_log::{self, WizardSummary};

const LISTED: usize = 20;

/// Agreement of wizard and assistants in recordings: the output of `tomcom compare`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComparisonSummary {
    /// Agreement of each two senders (the sent signals, each assistant's hypothetical ones) where recordings count.
    pub pairs: Vec<SenderPairSummary>,
    pub recordings: Vec<RecordingComparison>,
    pub training: Option<WizardTrainingSummary>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SenderPairSummary {
    /// "wizard", "assistant" or "nobody" for the sent signals, or an assistant's concept.
    pub of: String,
    pub with: String,
    /// Presses of the human within which two communications can match.
    pub window_actions: u32,
    #[serde(flatten)]
    pub similarity: Similarity,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordingComparison {
    pub recording: String,
    pub arm: StudyArm,
    #[serde(flatten)]
    pub standing: ExclusionStatus,
    pub human_actions: u64,
    pub lanes: Vec<SenderCommunicationList>,
    /// Summary of the wizard's signals; null where nobody could send signals.
    pub wizard: Option<WizardSummary>,
    /// Statistics of the offers that a wizard could see; null in recordings without offers.
    pub offers: OfferSummary,
    pub differences: Vec<UnmatchedCommunicationSummary>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SenderCommunicationList {
    /// Name of the sender: "wizard", or an assistant's concept as "tom-com".
    pub name: String,
    pub communications: Vec<ListedCommunication>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ListedCommunication {
    pub press: u32,
    pub clock_s: f64,
    pub says: String,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UnmatchedCommunicationSummary {
    /// Number of the difference, from 1, as the option `--open` takes it.
    pub number: usize,
    pub headline: String,
    pub by: String,
    pub not_by: String,
    #[serde(skip)]
    pair: usize,
    #[serde(skip)]
    by_sender: bool,
    #[serde(flatten)]
    pub spoken: ListedCommunication,
    /// Context of the communication; null if the assistants had not been asked for advice before the communication.
    pub knew: Option<CommunicationContextSummary>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CommunicationContextSummary {
    /// Estimated beliefs before it, as if the signals sent within the matching window before had not been sent.
    pub beliefs: Vec<ListedEstimatedBelief>,
    pub advice: Option<Recommendation>,
    /// Content of the wizard's screen then; null before the screen was first drawn, and without a wizard.
    pub screen: Option<WizardScreenContent>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ListedEstimatedBelief {
    pub aspect: String,
    pub truth: String,
    pub believes: String,
    pub p_truth: f64,
}

impl ComparisonSummary {
    /// Summarises comparisons. If there are several recordings, the agreement leaves out excluded ones.
    pub fn from_recordings(watched: &[RecordingSenderComparison]) -> ComparisonSummary {
        let counting: Vec<&RecordingSenderComparison> =
            watched.iter().filter(|one| watched.len() == 1 || one.standing.counts()).collect();
        let mut pairs: Vec<(SenderPairSummary, MatchCounts)> = Vec::new();
        for one in counting {
            let said: Vec<Vec<CommunicationEvent>> = one.comparison.lanes.iter().map(|lane| lane.said()).collect();
            for (a, b) in (0..said.len()).flat_map(|a| (a + 1..said.len()).map(move |b| (a, b))) {
                let [of, with] = [a, b].map(|lane| one.comparison.lanes[lane].name.clone());
                let (window, similarity) = (one.comparison.window, Similarity::default());
                let known = pairs.iter().position(|(pair, _)| pair.of == of && pair.with == with);
                let index = known.unwrap_or_else(|| {
                    let pair = SenderPairSummary { of, with, window_actions: window, similarity };
                    pairs.push((pair, MatchCounts::default()));
                    pairs.len() - 1
                });
                pairs[index].1.add(&said[a], &said[b], one.follower.presses(), window);
            }
        }
        let pairs = pairs.into_iter().map(|(pair, tally)| SenderPairSummary { similarity: tally.similarity(), ..pair });
        ComparisonSummary {
            pairs: pairs.collect(),
            recordings: watched.iter().map(RecordingComparison::from_recording).collect(),
            training: None,
        }
    }

    /// The summary without communications of other concepts than `concepts`. Differences keep their numbers.
    pub fn only(mut self, concepts: &[ConceptName]) -> ComparisonSummary {
        let hidden = ConceptName::ALL.into_iter().filter(|concept| !concepts.contains(concept));
        let hidden: Vec<&str> = hidden.map(ConceptName::name).collect();
        let is_shown = |lane: &str| !hidden.contains(&lane);
        self.pairs.retain(|pair| is_shown(&pair.of) && is_shown(&pair.with));
        for one in &mut self.recordings {
            one.lanes.retain(|lane| is_shown(&lane.name));
            one.differences.retain(|difference| is_shown(&difference.by) && is_shown(&difference.not_by));
        }
        self
    }
}

impl RecordingComparison {
    fn from_recording(watched: &RecordingSenderComparison) -> RecordingComparison {
        let comparison = &watched.comparison;
        let lanes = comparison.lanes.iter().map(|lane| SenderCommunicationList {
            name: lane.name.clone(),
            communications: lane.spoken.iter().map(ListedCommunication::from_communication).collect(),
        });
        let differences = comparison.differences.iter().enumerate();
        RecordingComparison {
            recording: watched.recording.clone(),
            arm: watched.follower.follower.session.study_arm(),
            standing: watched.standing.clone(),
            human_actions: u64::from(watched.follower.presses()),
            lanes: lanes.collect(),
            wizard: watched.wizard.clone(),
            offers: watched.offers.clone(),
            differences: differences
                .map(|(index, one)| UnmatchedCommunicationSummary::from_unmatched(watched, index, one))
                .collect(),
        }
    }
}

impl ListedCommunication {
    fn from_communication(spoken: &Communication) -> ListedCommunication {
        let (press, clock_s) = (spoken.said.press, spoken.said.clock.as_secs_f64());
        ListedCommunication { press, clock_s, says: wording::signal(&spoken.what) }
    }
}

impl UnmatchedCommunicationSummary {
    /// Order of importance of a difference, the most important lowest: differences from the first assistant come first,
    /// and among them differences about signals that the participant saw.
    fn rank(&self) -> (usize, bool, usize) {
        (self.pair, !self.by_sender, self.number)
    }

    fn from_unmatched(
        watched: &RecordingSenderComparison,
        index: usize,
        difference: &UnmatchedCommunication,
    ) -> UnmatchedCommunicationSummary {
        let comparison = &watched.comparison;
        let spoken = comparison.spoken(difference);
        let knew = spoken.known.as_ref().map(|known| {
            let held = |(index, held): (usize, &AspectBeliefSnapshot)| {
                let aspect = &watched.kitchen().aspects[index];
                let truth = watched.kitchen().true_value(known.state, AspectId(index as u8));
                ListedEstimatedBelief {
                    aspect: aspect.name.clone(),
                    truth: aspect.labels[truth].clone(),
                    believes: aspect.labels[usize::from(held.believes)].clone(),
                    p_truth: (f64::from(held.p_truth) * 1e4).round() / 1e4,
                }
            };
            CommunicationContextSummary {
                beliefs: known.held.iter().enumerate().map(held).collect(),
                advice: comparison.advice(difference).cloned(),
                screen: known.screen.clone(),
            }
        });
        UnmatchedCommunicationSummary {
            number: index + 1,
            headline: comparison.headline(difference),
            by: comparison.lanes[difference.lane].name.clone(),
            not_by: comparison.lanes[difference.not].name.clone(),
            pair: difference.lane.max(difference.not),
            by_sender: difference.lane == 0,
            spoken: ListedCommunication::from_communication(spoken),
            knew,
        }
    }
}

pub fn describe(figures: &ComparisonSummary, request: &SenderComparisonSettings) -> String {
    let mut text = format!(
        "{:<24}{:>7}{:>8}{:>8}{:>11}{:>6}{:>7}{:>8}\n",
        "", "window", "recall", "chance", "precision", "F1", "kappa", "lead"
    );
    figures.pairs.iter().for_each(|pair| text += &describe_pair(pair));
    text += &figures.training.as_ref().map_or(String::new(), WizardTrainingSummary::describe);
    let arms: BTreeSet<StudyArm> = figures.recordings.iter().map(|one| one.arm).collect();
    if arms.len() > 1 {
        let arms: Vec<&str> = arms.into_iter().map(StudyArm::title).collect();
        text += &format!(
            "signals alone: how errors differ between the conditions ({}) tells tomcom study RECORDING...\n",
            arms.join(", ")
        );
    }
    for one in &figures.recordings {
        let presses = count(one.human_actions, "press", "presses");
        text += &format!("\n{}: {presses} of the human\n", one.recording);
        if !one.standing.counts() {
            text += &format!("left out of the analysis: {}\n", one.standing.describe());
        }
        text += &one.wizard.as_ref().map_or(String::new(), wizard_log::describe);
        text += &one.offers.describe();
        text += &describe_differences(&one.differences);
        // The printed context is that of the session's own concept, if the session has one.
        if let Some(first) = one.differences.iter().min_by_key(|one| one.rank()) {
            text += &format!(
                "what each knew: tomcom compare {}{} --open {}\nthe moment itself: tomcom review {} --at {}\n",
                one.recording,
                flags(request),
                first.number,
                one.recording,
                SessionTime::from_secs_f64(first.spoken.clock_s).with_ms()
            );
        }
    }
    text
}

fn flags(request: &SenderComparisonSettings) -> String {
    let mut flags = String::new();
    if !request.with.is_empty() {
        let names: Vec<&str> = request.with.iter().map(|concept| concept.name()).collect();
        flags += &format!(" --with {}", names.join(","));
    }
    if request.window != WINDOW {
        flags += &format!(" --window {}", request.window);
    }
    flags
}

/// The unmatched communications as text, by sender, the session's own concept first; they are numbered by time.
fn describe_differences(differences: &[UnmatchedCommunicationSummary]) -> String {
    let mut sorted: Vec<&UnmatchedCommunicationSummary> = differences.iter().collect();
    sorted.sort_by_key(|one| one.rank());
    let groups = grouped(sorted.into_iter().map(|one| (format!("only {}, not {}", one.by, one.not_by), one)));
    let sums: Vec<String> = groups.iter().map(|(who, group)| format!("{} {who}", group.len())).collect();
    let mut text = match differences.len() as u64 {
        0 => return "no differences\n".to_string(),
        number => format!("{}: {}\n", count(number, "difference", "differences"), sums.join("; ")),
    };
    for (who, group) in groups {
        text += &format!("{who}:\n");
        for one in group.iter().take(LISTED) {
            let clock = SessionTime::from_secs_f64(one.spoken.clock_s);
            text += &format!("{:>4}  {clock}  {}\n", one.number, one.spoken.says);
        }
        if let Some(more @ 1..) = group.len().checked_sub(LISTED) {
            text += &format!("      … and {more} more: --format json has all\n");
        }
    }
    text
}

fn describe_pair(pair: &SenderPairSummary) -> String {
    let number = |value: Option<f64>| decimal(value, 2);
    let found = &pair.similarity;
    let lead = found.lead();
    let line = |what: &str, window: &str, level: MatchShares| {
        let [recall, chance, precision, f1] =
            [level.recall, level.chance_recall, level.precision, level.f1].map(number);
        format!("{what:<24}{window:>7}{recall:>8}{chance:>8}{precision:>11}{f1:>6}")
    };
    let what = format!("{}, {}", pair.of, pair.with);
    if found.of_n == 0 {
        // All shares would be 0, which reads as if somebody had been wrong.
        return format!(
            "{what:<24}{:>7}  nothing to compare: 0 from {}, {} said\n",
            pair.window_actions, pair.of, found.with_n
        );
    }
    let signal = line(&what, &pair.window_actions.to_string(), found.signal);
    let kappa = number(found.kappa);
    let said = format!("{} of {} matched, {} said", found.matched, found.of_n, found.with_n);
    format!(
        "{signal}{kappa:>7}{lead:>8}  {said}\n{}\n{}\n",
        line("  the same kind", "", found.kind),
        line("  the same time", "", found.any)
    )
}

pub struct RecordingSenderComparison {
    pub recording: String,
    pub follower: SenderComparisonFollower,
    pub standing: ExclusionStatus,
    pub comparison: SenderComparison,
    pub wizard: Option<WizardSummary>,
    pub offers: OfferSummary,
}

impl RecordingSenderComparison {
    /// The comparison of a recording that the follower has read to its end.
    pub fn new(
        recording: String,
        mut follower: SenderComparisonFollower,
        standing: ExclusionStatus,
    ) -> RecordingSenderComparison {
        follower.finish();
        let comparison = follower.comparison(true);
        let session = &follower.follower.session;
        let is_wizards = session.spec.trial.condition == Condition::Wizard;
        let wizard = is_wizards.then(|| WizardSummary::from_follower(&follower.follower));
        let offers = OfferSummary::from_offers(&TimedOffer::visible(session));
        RecordingSenderComparison { recording, follower, standing, comparison, wizard, offers }
    }

    pub fn kitchen(&self) -> &Kitchen {
        &self.follower.follower.session.kitchen
    }
}
