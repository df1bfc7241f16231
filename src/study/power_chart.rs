//! Chart of the power of a study over its number of participants, as an SVG file.

use super::drawn_study::{SignificanceTestMethod, reference};
use super::power::{ALPHA, WANTED};
use super::power_answer::PowerSummary;
use super::report::STYLE;
use super::svg::{PlotAxis, SvgChart, document};
use tomcom_session::study_arm::StudyArm;

/// Size of the chart, in pixels.
const SIZE: [f64; 2] = [720.0, 420.0];
/// Least distance between the names of lines at the chart's border, as a share of the chart's height.
const APART: f64 = 0.05;

/// The chart of power: a line with a confidence band for each test against the reference arm.
pub fn power(found: &PowerSummary) -> String {
    let sizes: Vec<f64> = found.sizes.iter().map(|size| size.participants as f64).collect();
    let (first, last) = (sizes.first().copied().unwrap_or(0.0), sizes.last().copied().unwrap_or(1.0));
    let mut names: Vec<(f64, &str)> = Vec::new();
    let has_anova = found.needed.iter().any(|needed| needed.test.method == SignificanceTestMethod::MixedAnova);
    let (title, label, line, most) = match found.is_null() {
        true => ("Type I error by number of participants", "studies that find an effect", ALPHA, 0.2),
        false => ("Power by number of participants", "power", WANTED, 1.0),
    };
    let x = PlotAxis::between("participants", 0.0, 1.4 * last);
    let mut chart = SvgChart::new(SIZE[0], SIZE[1], x, PlotAxis::between(label, 0.0, most));
    chart.line("thin ideal", &[(first, line), (last, line)]);
    for (index, needed) in found.needed.iter().enumerate() {
        let test = needed.test;
        if test.against != reference(&found.conditions) {
            continue;
        }
        let class = class(test.arm, test.method);
        let shares: Vec<[f64; 3]> = found
            .sizes
            .iter()
            .map(|size| size.tests[index].found)
            .map(|one| [one.share, one.interval[0], one.interval[1]].map(|share| share.min(most)))
            .collect();
        let points: Vec<(f64, f64)> = sizes.iter().copied().zip(shares.iter().map(|share| share[0])).collect();
        let band: Vec<[f64; 3]> = sizes.iter().zip(&shares).map(|(x, share)| [*x, share[1], share[2]]).collect();
        chart.band(class, &band);
        chart.line(class, &points);
        for (x, share) in &points {
            chart.point(class, *x, *share, &format!("{}, {x} participants: {share:.3}", test.title()));
        }
        let name = match (test.method, has_anova) {
            (SignificanceTestMethod::MixedAnova, _) => "paper's test",
            (_, true) => "mixed model",
            (_, false) => test.arm.name(),
        };
        names.extend(points.last().map(|(_, share)| (*share, name)));
    }
    for (y, name) in apart(names, APART * most, most) {
        chart.words("strong", last, y, true, name);
    }
    document(&chart.finish(title), STYLE)
}

/// Heights of the names at the ends of lines, moved at least `gap` apart and at most `most` high.
fn apart(mut names: Vec<(f64, &str)>, gap: f64, most: f64) -> Vec<(f64, &str)> {
    names.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut highest = most;
    for (y, _) in &mut names {
        *y = y.min(highest);
        highest = *y - gap;
    }
    names
}

/// CSS class that gives a test its colour; the paper's test and the mixed model have different colours, and so have
/// arms.
fn class(arm: StudyArm, method: SignificanceTestMethod) -> &'static str {
    match (method, arm) {
        (SignificanceTestMethod::MixedAnova, _) | (_, StudyArm::WizardWithAdvice) => "first",
        (_, StudyArm::None | StudyArm::Wizard) => "second",
        (_, StudyArm::TomCom) => "tom-com",
        (_, StudyArm::Tom) => "tom",
        (_, StudyArm::Dev) => "dev",
    }
}
