//! A tournament of communication concepts: each acts in trials of the same seeds, so that trials can be compared in
//! pairs. The unassisted trials are the reference of every difference.

use serde::{Deserialize, Serialize};

use crate::arm_table::StudyArmStatistic;
use crate::pass::contest::{BeliefScores, ContestTrial};
use crate::statistics::{FEWEST, interval_where_known};
use tomcom_core::base::text::count;
use tomcom_core::kitchen::Kitchen;

/// Cost of a signal in presses in the paper's comparison of concepts: what the league counts.
pub const PAPERS_COST: f64 = 1.5;

/// What a tournament keeps beside a recording, since it cannot be read from the log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeptFigures {
    /// Number of questions to the concept.
    pub questions: u64,
    /// Computing time of its answers; an external concept's with the way there and back.
    pub computing_ns: u64,
    /// Number of useful signals; null where it was not judged.
    pub useful_signals: Option<u64>,
}

/// A concept with its trials, in the order of seeds.
#[derive(Clone, Debug)]
pub struct Contestant {
    /// Name of the concept, or the external program's command line.
    pub label: String,
    pub trials: Vec<(ContestTrial, Option<KeptFigures>)>,
    /// Number of trials that an earlier run simulated.
    pub found: u64,
}

/// A concept's row of the table. Rates are per 100 presses of the participant. Differences are to the unassisted trials of
/// the same seeds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TournamentRow {
    pub concept: String,
    /// The name by which an external concept introduced itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Trials that count.
    pub trials: u64,
    /// Trials that were aborted, since the external concept failed.
    pub failed: u64,
    /// Answers of an external concept that could not be used.
    pub faults: u64,
    /// Trials that an earlier run simulated: a program can have been changed since.
    pub found: u64,
    pub related_per_100: StudyArmStatistic,
    pub related_difference: StudyArmStatistic,
    pub signals_per_100: StudyArmStatistic,
    pub useless_per_100: StudyArmStatistic,
    pub orders_per_minute: StudyArmStatistic,
    pub orders_difference: StudyArmStatistic,
    /// Presses that errors cost less than in the unassisted trials, minus the cost of the signals.
    pub net_saving_per_100: StudyArmStatistic,
    /// Mean computing time of an answer.
    pub computing_ms: Option<f64>,
    /// Of the beliefs that an external concept tells; null if it tells none.
    pub told_auc: Option<f64>,
    pub told_ece: Option<f64>,
    /// Of the program's own estimate in the same trials.
    pub own_auc: Option<f64>,
    pub own_ece: Option<f64>,
}

/// The output of `tomcom tournament`; rows by net saving, the largest first.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tournament {
    pub program: String,
    pub seed: u64,
    /// Number of trials of each concept.
    pub trials: u64,
    pub cost_of_a_signal: f64,
    pub concepts: Vec<TournamentRow>,
    /// The first reason of every concept with failed trials.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<String>,
}

/// A trial and the unassisted trial of the same seed.
type Pair<'a> = (&'a ContestTrial, &'a ContestTrial);

fn sum<'a>(trials: impl Iterator<Item = &'a ContestTrial>, value: impl Fn(&ContestTrial) -> f64) -> f64 {
    trials.map(value).sum()
}

/// Per 100 presses of the participant.
fn rate<'a>(
    trials: impl Iterator<Item = &'a ContestTrial> + Clone,
    value: impl Fn(&ContestTrial) -> f64,
) -> Option<f64> {
    let presses = sum(trials.clone(), |trial| trial.summary.human_actions as f64);
    (presses > 0.0).then(|| 100.0 * sum(trials, value) / presses)
}

fn related(trial: &ContestTrial) -> f64 {
    trial.summary.beliefs.as_ref().map_or(0.0, |beliefs| beliefs.related as f64)
}

fn orders_per_minute<'a>(trials: impl Iterator<Item = &'a ContestTrial> + Clone) -> Option<f64> {
    let seconds = sum(trials.clone(), |trial| trial.summary.seconds);
    (seconds > 0.0).then(|| 60.0 * sum(trials, |trial| trial.summary.served.len() as f64) / seconds)
}

fn assisted<'a>(pairs: &'a [Pair<'a>]) -> impl Iterator<Item = &'a ContestTrial> + Clone {
    pairs.iter().map(|(trial, _)| *trial)
}

fn unassisted<'a>(pairs: &'a [Pair<'a>]) -> impl Iterator<Item = &'a ContestTrial> + Clone {
    pairs.iter().map(|(_, without)| *without)
}

impl Contestant {
    fn row(&self, reference: &Contestant, kitchen: &Kitchen) -> TournamentRow {
        let both = self.trials.iter().zip(&reference.trials);
        let pairs: Vec<Pair> =
            both.map(|(own, without)| (&own.0, &without.0)).filter(|(own, _)| own.failed.is_none()).collect();
        // Trials are drawn with their unassisted trials of the same seed.
        let figure = |value: &dyn Fn(&[Pair]) -> Option<f64>| StudyArmStatistic {
            value: value(&pairs),
            interval: interval_where_known(&pairs, value),
        };
        let signals = |trial: &ContestTrial| trial.summary.signals as f64;
        let useless = |pairs: &[Pair]| {
            let all: Option<Vec<f64>> =
                assisted(pairs).map(|trial| Some(signals(trial) - trial.useful? as f64)).collect();
            let presses = sum(assisted(pairs), |trial| trial.summary.human_actions as f64);
            all.filter(|_| presses > 0.0).map(|all| 100.0 * all.iter().sum::<f64>() / presses)
        };
        let saving = |pairs: &[Pair]| {
            let lost = |trial: &ContestTrial| trial.lost as f64;
            let spent = rate(assisted(pairs), |trial| lost(trial) + PAPERS_COST * signals(trial))?;
            Some(rate(unassisted(pairs), lost)? - spent)
        };
        let kept = self.trials.iter().filter_map(|(_, kept)| kept.as_ref());
        let (questions, ns) =
            kept.fold((0, 0), |(questions, ns), kept| (questions + kept.questions, ns + kept.computing_ns));
        let of_told = |scores: fn(&ContestTrial) -> &BeliefScores| {
            BeliefScores::scored(kitchen, self.trials.iter().map(|(trial, _)| scores(trial)))
        };
        let ((told_auc, told_ece), (own_auc, own_ece)) = (of_told(|trial| &trial.told), of_told(|trial| &trial.own));
        TournamentRow {
            concept: self.label.clone(),
            name: self.trials.iter().find_map(|(trial, _)| trial.name.clone()),
            trials: pairs.len() as u64,
            failed: self.trials.len() as u64 - pairs.len() as u64,
            faults: self.trials.iter().map(|(trial, _)| trial.faults).sum(),
            found: self.found,
            related_per_100: figure(&|pairs| rate(assisted(pairs), related)),
            related_difference: figure(&|pairs| {
                Some(rate(assisted(pairs), related)? - rate(unassisted(pairs), related)?)
            }),
            signals_per_100: figure(&|pairs| rate(assisted(pairs), signals)),
            useless_per_100: figure(&useless),
            orders_per_minute: figure(&|pairs| orders_per_minute(assisted(pairs))),
            orders_difference: figure(&|pairs| {
                Some(orders_per_minute(assisted(pairs))? - orders_per_minute(unassisted(pairs))?)
            }),
            net_saving_per_100: figure(&saving),
            computing_ms: (questions > 0).then(|| ns as f64 / 1e6 / questions as f64),
            told_auc,
            told_ece,
            own_auc,
            own_ece,
        }
    }
}

impl Tournament {
    /// `reference`: the unassisted trials of the same seeds.
    pub fn new(seed: u64, contestants: &[Contestant], reference: &Contestant, kitchen: &Kitchen) -> Tournament {
        let mut concepts: Vec<TournamentRow> = contestants.iter().map(|one| one.row(reference, kitchen)).collect();
        let saving = |row: &TournamentRow| row.net_saving_per_100.value.unwrap_or(f64::NEG_INFINITY);
        concepts.sort_by(|a, b| saving(b).total_cmp(&saving(a)));
        let failure = |one: &Contestant| {
            let reason = one.trials.iter().find_map(|(trial, _)| trial.failed.as_ref())?;
            Some(format!("{}: {reason}", one.label))
        };
        Tournament {
            program: env!("CARGO_PKG_VERSION").to_string(),
            seed,
            trials: reference.trials.len() as u64,
            cost_of_a_signal: PAPERS_COST,
            concepts,
            failures: contestants.iter().filter_map(failure).collect(),
        }
    }
}

/// Columns of the table: title in the text, name and unit in the CSV, digits, value.
type FigureColumn = (&'static str, [&'static str; 2], usize, fn(&TournamentRow) -> StudyArmStatistic);

const FIGURES: [FigureColumn; 7] = [
    ("net saving", ["net_saving", "_per_100"], 1, |row| row.net_saving_per_100),
    ("belief related", ["related", "_per_100"], 1, |row| row.related_per_100),
    ("difference", ["related_difference", ""], 1, |row| row.related_difference),
    ("signals", ["signals", "_per_100"], 1, |row| row.signals_per_100),
    ("useless", ["useless", "_per_100"], 1, |row| row.useless_per_100),
    ("orders a minute", ["orders", "_per_minute"], 2, |row| row.orders_per_minute),
    ("difference", ["orders_difference", ""], 2, |row| row.orders_difference),
];

pub fn describe(found: &Tournament) -> String {
    let mut text = format!("seed {}: {} simulated trials of each concept\n\n", found.seed, found.trials);
    text += "|   | concept | trials";
    for (title, ..) in FIGURES {
        text += &format!(" | {title}");
    }
    text += " | ms an answer | belief AUC, ECE |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";
    for (place, row) in found.concepts.iter().enumerate() {
        let failed = if row.failed > 0 { format!(" ({} failed)", row.failed) } else { String::new() };
        text += &format!("| {} | {} | {}{failed}", place + 1, row.concept, row.trials);
        for (_, _, digits, value) in FIGURES {
            text += &format!(" | {}", value(row).in_words(1.0, digits));
        }
        let ms = row.computing_ms.map_or("-".to_string(), |ms| format!("{ms:.1}"));
        let pair = |auc: Option<f64>, ece: Option<f64>| match (auc, ece) {
            (Some(auc), Some(ece)) => Some(format!("{auc:.2}, {ece:.2}")),
            (Some(auc), None) => Some(format!("{auc:.2}, -")),
            _ => None,
        };
        let told = pair(row.told_auc, row.told_ece);
        let own = pair(row.own_auc, row.own_ece).map_or("-".to_string(), |own| format!("(ours {own})"));
        text += &format!(" | {ms} | {} |\n", told.map_or(own.clone(), |told| format!("{told} {own}")));
    }
    let intervals = match found.trials {
        few if few < FEWEST as u64 => format!("{} are too few for intervals", count(few, "trial", "trials")),
        _ => "in brackets intervals of 95 %, by a bootstrap over trials".to_string(),
    };
    text += &format!(
        "\nper 100 presses of the human; differences to unassisted trials of the same seeds; {intervals}\n\
         net saving: presses that errors cost less, minus {PAPERS_COST} for each signal\n"
    );
    for row in found.concepts.iter().filter(|row| row.faults > 0) {
        text += &format!("{}: {} answers could not be used\n", row.concept, row.faults);
    }
    for row in found.concepts.iter().filter(|row| row.found > 0 && (row.name.is_some() || row.failed > 0)) {
        text += &format!("{}: {}\n", row.concept, of_earlier_run(row.found));
    }
    found.failures.iter().for_each(|failure| text += &format!("failed: {failure}\n"));
    text
}

/// What to know of trials with a program of other people that were not simulated now.
pub fn of_earlier_run(trials: u64) -> String {
    let trials = count(trials, "trial is", "trials are");
    format!("{trials} of an earlier run; if the program was changed since, delete them")
}

/// The names of the columns of the table as CSV.
pub fn csv_header() -> Vec<String> {
    let mut names = ["place", "concept", "name", "trials", "failed", "faults"].map(str::to_string).to_vec();
    for (_, [name, unit], ..) in FIGURES {
        names.extend([format!("{name}{unit}"), format!("{name}_low"), format!("{name}_high")]);
    }
    names.extend(["computing_ms", "told_auc", "told_ece", "own_auc", "own_ece"].map(str::to_string));
    names
}

/// The rows of the table as CSV; unknown values are empty.
pub fn csv_rows(found: &Tournament) -> Vec<Vec<String>> {
    let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.4}"));
    let row = |(place, row): (usize, &TournamentRow)| {
        let mut cells = vec![(place + 1).to_string(), row.concept.clone(), row.name.clone().unwrap_or_default()];
        cells.extend([row.trials, row.failed, row.faults].map(|count| count.to_string()));
        for (.., value) in FIGURES {
            let StudyArmStatistic { value, interval } = value(row);
            cells.extend([value, interval.map(|[low, _]| low), interval.map(|[_, high]| high)].map(number));
        }
        cells.extend([row.computing_ms, row.told_auc, row.told_ece, row.own_auc, row.own_ece].map(number));
        cells
    };
    found.concepts.iter().enumerate().map(row).collect()
}
