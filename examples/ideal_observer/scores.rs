//! Scores of predictions that a belief is false: area under the ROC curve, log score, and the way from a baseline to the
//! ideal observer.

use std::array;

use tomcom::analysis::trial_bootstrap::interval;
use tomcom::measures::belief_detection::{CALIBRATED, CALIBRATION_BINS};
use tomcom::measures::detection::{Calibration, auc};

/// Least and largest predicted probability: a prediction that is sure and wrong costs at most 7.6 nats.
const CLIP: [f64; 2] = [0.0005, 0.9995];
/// Times since somebody else changed a location that the baseline tells apart, in seconds.
const RECENT_S: [f64; 7] = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
/// Who predicts, in the order of the predictions of a case.
pub const PREDICTORS: [&str; 3] = ["baseline", "estimate", "ideal"];

/// One aspect before one press.
#[derive(Clone, Debug)]
pub struct Case {
    /// Number of the trial.
    pub trial: usize,
    /// Whether the participant's belief was false.
    pub is_false: bool,
    /// Class by which the baseline predicts; see [`class`].
    pub class: usize,
    /// Predicted probabilities of a false belief by estimate and ideal observer.
    pub predicted: [f64; 2],
}

/// The baseline's class of an aspect: for how long somebody else's last change of the location has been over. Recipes
/// have one class.
pub fn class(since_change_s: Option<f64>) -> usize {
    since_change_s.map_or(0, |since_s| 1 + RECENT_S.iter().filter(|&&limit| since_s >= limit).count())
}

/// The scores of a group of aspects over all trials.
#[derive(Clone, Debug)]
pub struct GroupScores {
    /// Number of cases, and share of false beliefs among them.
    pub cases: (usize, f64),
    /// Area under the ROC curve of each of [`PREDICTORS`].
    pub auc: [Option<f64>; 3],
    /// Mean log score per case of each of [`PREDICTORS`], in nats.
    pub log_score: [f64; 3],
    /// Share of the way from baseline to ideal observer that the estimate goes in log score, and its 95 % interval over
    /// trials.
    pub way: (f64, [f64; 2]),
    /// Calibration of estimate and ideal observer.
    pub calibration: [Calibration; 2],
}

impl GroupScores {
    /// Scores of all cases of a group; `trials` is the number of trials, `seed` the bootstrap's.
    pub fn new(cases: &[Case], trials: usize, seed: u64) -> GroupScores {
        let base = baseline(cases, trials);
        let log = |p: f64, is_false: bool| {
            let p = p.clamp(CLIP[0], CLIP[1]);
            if is_false { p.ln() } else { (1.0 - p).ln() }
        };
        let predicted = |case: &Case, base: f64| [base, case.predicted[0], case.predicted[1]];
        let mut sums = vec![[0.0; 3]; trials];
        for (case, &base) in cases.iter().zip(&base) {
            for (sum, p) in sums[case.trial].iter_mut().zip(predicted(case, base)) {
                *sum += log(p, case.is_false);
            }
        }
        let total = |sums: &[[f64; 3]]| array::from_fn::<f64, 3, _>(|who| sums.iter().map(|sum| sum[who]).sum());
        let way = |sums: &[[f64; 3]]| {
            let [base, estimate, ideal] = total(sums);
            (estimate - base) / (ideal - base)
        };
        let area = |who: usize| {
            let score = |(case, &base): (&Case, &f64)| predicted(case, base)[who];
            auc(&cases.iter().zip(&base).map(|one| (score(one), one.0.is_false)).collect::<Vec<_>>())
        };
        let calibration = |who: usize| {
            let pairs = cases.iter().map(move |case| (case.predicted[who], case.is_false));
            Calibration::from_predictions(pairs, CALIBRATED, CALIBRATION_BINS)
        };
        let wrong = cases.iter().filter(|case| case.is_false).count();
        GroupScores {
            cases: (cases.len(), wrong as f64 / cases.len() as f64),
            auc: array::from_fn(area),
            log_score: total(&sums).map(|sum| sum / cases.len() as f64),
            way: (way(&sums), interval(&sums, seed, way)),
            calibration: array::from_fn(calibration),
        }
    }

    /// The scores as lines of a table, with the reliability of estimate and ideal observer.
    pub fn print(&self, name: &str) {
        let number = |value: Option<f64>| value.map_or("-".to_string(), |value| format!("{value:.4}"));
        println!("{name}: {} cases, {:.4} false", self.cases.0, self.cases.1);
        for (who, predictor) in PREDICTORS.iter().enumerate() {
            let ece = who.checked_sub(1).and_then(|index| self.calibration[index].ece);
            let (auc, log) = (number(self.auc[who]), self.log_score[who]);
            println!("  {predictor:<9} AUC {auc}  log score {log:.5}  calibration error {}", number(ece));
        }
        let (way, [from, to]) = self.way;
        println!("  way from baseline to ideal observer: {way:.3} ({from:.3} to {to:.3})");
        for (calibration, who) in self.calibration.iter().zip(&PREDICTORS[1..]) {
            let bins = calibration.bins.iter().map(|bin| format!("{:.2}>{:.2} {}", bin.predicted, bin.observed, bin.n));
            println!("  {who}: {}", bins.collect::<Vec<_>>().join(" | "));
        }
    }
}

/// The baseline's predictions: how often beliefs of the same class are false in all other trials.
fn baseline(cases: &[Case], trials: usize) -> Vec<f64> {
    let classes = RECENT_S.len() + 2;
    let mut counts = vec![[0.0; 2]; classes * trials];
    let mut totals = vec![[0.0; 2]; classes];
    for case in cases {
        for sum in [&mut counts[case.trial * classes + case.class], &mut totals[case.class]] {
            sum[0] += f64::from(u8::from(case.is_false));
            sum[1] += 1.0;
        }
    }
    let predict = |case: &Case| {
        let [own, all] = [counts[case.trial * classes + case.class], totals[case.class]];
        (all[0] - own[0] + 0.5) / (all[1] - own[1] + 1.0)
    };
    cases.iter().map(predict).collect()
}
