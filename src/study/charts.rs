//! Charts of the study report, modelled on the figures of the paper; of the ratios between arms, and of power.
//!
//! They are SVG: CSS classes in the style sheet of the page set the colours for light and dark screens and for print.

use std::fmt::Write;

use maud::{Markup, PreEscaped, html};

use crate::analysis::probe_figures::ProbeSummary;
use crate::arm_comparison::{StudyArmContrast, StudyConditionSummary, events};
use crate::drawn_study::SignificanceTestMethod;
use crate::effect::{TrialPair, pairs};
use crate::figures::StudySummary;
use crate::power::{ALPHA, PowerSummary, WANTED};
use crate::report::STYLE;
use crate::roc::{ConceptRocCurve, RocPoint};
use crate::statistics::mean;
use crate::tables::trials::HEADLINE;
use crate::tournament::TournamentRow;
use crate::trial_statistics::TrialStatistics;
use tomcom_core::measures::detection::CalibrationBin;
use tomcom_session::plan::PrimaryOutcome;
use tomcom_session::study_arm::StudyArm;

/// After the paper's figure, top left; lines join the trials of a participant, means are black. `None` with one condition.
pub(crate) fn rates_by_condition(trials: &[TrialStatistics], outcome: PrimaryOutcome) -> Option<Markup> {
    let rate = |trial: &TrialStatistics| Some(percent(events(outcome, trial)? as f64 / trial.human_presses as f64));
    let is_of = |trial: &TrialStatistics, arm: StudyArm| {
        trial.counts() && trial.human_presses > 0 && trial.planned_arm == arm && rate(trial).is_some()
    };
    let arms: Vec<StudyArm> =
        StudyArm::ALL.into_iter().filter(|&arm| trials.iter().any(|trial| is_of(trial, arm))).collect();
    if arms.len() < 2 {
        return None;
    }
    // Of a repeated trial the last one counts.
    let of = |own: &'_ [TrialStatistics]| -> Vec<(f64, f64)> {
        let last = |arm| own.iter().rfind(|trial| is_of(trial, arm)).and_then(rate);
        arms.iter().enumerate().filter_map(|(x, &arm)| Some((x as f64, last(arm)?))).collect()
    };
    let people: Vec<(&TrialStatistics, Vec<(f64, f64)>)> =
        trials.chunk_by(|a, b| a.participant == b.participant).map(|own| (&own[0], of(own))).collect();
    let names: Vec<String> = arms.iter().map(|arm| arm.title().to_string()).collect();
    let label = match outcome {
        PrimaryOutcome::Errors => "errors per 100 presses of the human",
        PrimaryOutcome::BeliefRelatedErrors => "belief related errors per 100 presses of the human",
        PrimaryOutcome::Sequences => "sequences per 100 presses of the human",
    };
    let values = people.iter().flat_map(|(_, points)| points.iter().map(|(_, y)| *y));
    let width = WIDTH + 110.0 * (arms.len() - 2) as f64;
    let mut chart = SvgChart::new(width, 320.0, PlotAxis::named(&names), PlotAxis::over(label, values));
    for (first, points) in &people {
        let class = if arms.len() == 2 && first.is_assisted() { "first" } else { "second" };
        chart.line(&format!("thin {class}"), points);
        for (x, y) in points {
            chart.point(class, *x, *y, &format!("{}, {}: {y:.1}", first.participant, names[*x as usize]));
        }
    }
    let at =
        |x: usize| people.iter().flat_map(move |(_, points)| points.iter().filter(move |point| point.0 as usize == x));
    let means: Vec<(f64, f64)> =
        (0..arms.len()).filter_map(|x| Some((x as f64, mean(at(x).map(|point| point.1))?))).collect();
    chart.line("mean", &means);
    for (x, y) in means {
        chart.words("strong", x, y, x > 0.0, &format!("{y:.1}"));
    }
    Some(chart.finish("Errors by condition and participant"))
}

/// After the paper's figure, top right; the difference of the means is twice the effect of assistance.
pub(crate) fn improvements(trials: &[TrialStatistics]) -> Option<Markup> {
    let pairs = pairs(trials, HEADLINE).pairs;
    if pairs.is_empty() {
        return None;
    }
    let names = ["first unassisted,\nthen assisted".to_string(), "first assisted,\nthen unassisted".to_string()];
    let all = pairs.iter().map(|pair| percent(pair.improvement()));
    let mut chart =
        SvgChart::new(WIDTH, 320.0, PlotAxis::named(&names), PlotAxis::over("fewer errors in the second trial", all));
    for (x, assisted_second) in [(0.0, true), (1.0, false)] {
        let class = if assisted_second { "second" } else { "first" };
        let of_group: Vec<&TrialPair> = pairs.iter().filter(|pair| pair.assisted_second == assisted_second).collect();
        for (index, pair) in of_group.iter().enumerate() {
            let y = percent(pair.improvement());
            chart.point(class, x + aside(index), y, &format!("{}: {y:+.1}", pair.participant));
        }
        if let Some(mean) = mean(of_group.iter().map(|pair| percent(pair.improvement()))) {
            chart.line("mean", &[(x - 0.25, mean), (x + 0.25, mean)]);
            // A mean that rounds to 0.0 is written without a sign.
            let words = if mean.abs() < 0.05 { "0.0".to_string() } else { minus(&format!("{mean:+.1}")) };
            chart.words("strong", x + 0.25, mean, true, &words);
        }
    }
    Some(chart.finish("Difference between the first and the second trial by starting group"))
}

/// After the paper's figure, bottom; the time between presses indicates experience.
pub(crate) fn press_durations(trials: &[TrialStatistics]) -> Option<Markup> {
    let cells: Vec<(u32, bool)> = vec![(1, false), (1, true), (2, false), (2, true)];
    let of = |&(period, assisted): &(u32, bool)| -> Vec<(&str, f64)> {
        let is_it = |trial: &&TrialStatistics| {
            trial.counts() && trial.period == Some(period) && trial.is_assisted() == assisted
        };
        let found = trials.iter().filter(is_it);
        found.filter_map(|trial| Some((trial.participant.as_str(), trial.press_s?))).collect()
    };
    let found: Vec<Vec<(&str, f64)>> = cells.iter().map(of).collect();
    if found.iter().all(Vec::is_empty) {
        return None;
    }
    let name = |(period, assisted): &(u32, bool)| {
        format!("trial {period}\n{}", if *assisted { "assisted" } else { "unassisted" })
    };
    let names: Vec<String> = cells.iter().map(name).collect();
    let all = found.iter().flatten().map(|(_, seconds)| *seconds);
    let mut chart =
        SvgChart::new(WIDTH, 320.0, PlotAxis::named(&names), PlotAxis::over("seconds between presses", all));
    for (x, (cell, found)) in cells.iter().zip(&found).enumerate() {
        let class = if cell.1 { "assisted" } else { "unassisted" };
        for (index, (participant, seconds)) in found.iter().enumerate() {
            chart.point(class, x as f64 + aside(index), *seconds, &format!("{participant}: {seconds:.2} s"));
        }
        if let Some(mean) = mean(found.iter().map(|(_, seconds)| *seconds)) {
            chart.line("mean", &[(x as f64 - 0.3, mean), (x as f64 + 0.3, mean)]);
        }
    }
    Some(chart.finish("Seconds between presses by trial and condition"))
}

/// Length of the longest error sequences that have a bar of their own; longer sequences share the last bar.
const LONGEST_BAR: usize = 12;

pub(crate) fn sequence_lengths(conditions: &[StudyConditionSummary]) -> Option<Markup> {
    let assisted = |one: &&StudyConditionSummary| one.condition != StudyArm::None;
    let per_trial = |is: &dyn Fn(&&StudyConditionSummary) -> bool| -> Vec<f64> {
        let found: Vec<&StudyConditionSummary> = conditions.iter().filter(is).collect();
        let trials: u64 = found.iter().map(|one| one.trials).sum();
        let mut counts = vec![0.0; LONGEST_BAR];
        for one in found {
            for (index, &count) in one.sequence_lengths.iter().enumerate() {
                counts[index.min(LONGEST_BAR - 1)] += count as f64 / trials.max(1) as f64;
            }
        }
        counts
    };
    let sets = [("unassisted", per_trial(&|one| !assisted(one))), ("assisted", per_trial(&assisted))];
    let all = || sets.iter().flat_map(|(_, counts)| counts.iter().copied());
    if all().all(|count| count == 0.0) {
        return None;
    }
    let names: Vec<String> = (1..=LONGEST_BAR)
        .map(|length| if length == LONGEST_BAR { format!("{length}+") } else { length.to_string() })
        .collect();
    let x = PlotAxis { label: "errors per sequence", ..PlotAxis::named(&names) };
    let mut chart = SvgChart::new(WIDTH, 320.0, x, PlotAxis::over("sequences per trial", all()));
    for (side, (class, counts)) in sets.iter().enumerate() {
        for (index, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0.0) {
            let from = index as f64 - 0.38 + 0.38 * side as f64;
            chart.bar(class, [from, from + 0.36], count, &format!("{class}: {count:.2} of {} errors", names[index]));
        }
    }
    Some(chart.finish("Lengths of error sequences by condition"))
}

pub fn roc(figures: &StudySummary) -> Option<Markup> {
    let points = || figures.roc.iter().flat_map(|roc| &roc.points);
    points().next()?;
    let x = PlotAxis::over("useless signals per press of the human", points().map(|point| point.fpr));
    let x = PlotAxis::between(x.label, 0.0, x.to);
    let y = PlotAxis::between("belief related errors prevented", 0.0, 1.0);
    let mut chart = SvgChart::new(WIDTH, 380.0, x, y);
    for roc in &figures.roc {
        chart.band(roc.concept.name(), &roc.band);
    }
    for roc in &figures.roc {
        curve(&mut chart, roc, f64::INFINITY, |point| (point.fpr, point.tpr));
    }
    Some(chart.finish("Receiver operating characteristics of communication concepts"))
}

/// Upper end of the axis for signals per 100 human presses; points beyond this end are not drawn.
pub(crate) const MOST_SIGNALS: f64 = 25.0;

pub(crate) fn equal_signals(figures: &StudySummary) -> Option<Markup> {
    figures.roc.iter().flat_map(|roc| &roc.points).next()?;
    let x = PlotAxis::between("signals per 100 presses of the human", 0.0, MOST_SIGNALS);
    let y = PlotAxis::between("belief related errors prevented", 0.0, 1.0);
    let mut chart = SvgChart::new(WIDTH, 380.0, x, y);
    for roc in &figures.roc {
        curve(&mut chart, roc, MOST_SIGNALS, |point| (point.signals_per_100_actions, point.tpr));
    }
    Some(chart.finish("Errors prevented by number of signals"))
}

fn curve(chart: &mut SvgChart, roc: &ConceptRocCurve, to: f64, of: fn(&RocPoint) -> (f64, f64)) {
    let class = roc.concept.name();
    let is_drawn = |point: &&RocPoint| of(point).0 <= to;
    let mut points: Vec<(f64, f64)> = roc.points.iter().filter(is_drawn).map(of).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    chart.line(class, &points);
    for point in roc.points.iter().filter(is_drawn) {
        let (x, y) = of(point);
        let title = format!("{} at {}: {y:.2} prevented, {x:.2}", roc.concept.title(), point.parameter);
        chart.point(&format!("small {class}"), x, y, &title);
    }
}

/// `None` if no predicted probability is in the calibrated range.
pub(crate) fn probe_calibration(found: &ProbeSummary) -> Option<Markup> {
    let filled: Vec<&CalibrationBin> = found.detection.calibration.bins.iter().filter(|bin| bin.n > 0).collect();
    filled.first()?;
    let x = PlotAxis::between("predicted probability of a false belief", 0.0, 1.0);
    let y = PlotAxis::between("share of wrong answers", 0.0, 1.0);
    let mut chart = SvgChart::new(WIDTH, 380.0, x, y);
    chart.line("ideal", &[(0.0, 0.0), (1.0, 1.0)]);
    let points: Vec<(f64, f64)> = filled.iter().map(|bin| (bin.predicted, bin.observed)).collect();
    chart.line("tom-com", &points);
    for bin in filled {
        let title = format!("{} answers: predicted {:.2}, wrong {:.2}", bin.n, bin.predicted, bin.observed);
        chart.point("tom-com", bin.predicted, bin.observed, &title);
    }
    Some(chart.finish("Calibration of the estimate by answers to probes"))
}

fn percent(rate: f64) -> f64 {
    100.0 * rate
}

/// Horizontal offset of the point with this index, so that points of equal height do not cover each other.
fn aside(index: usize) -> f64 {
    [0.0, -0.06, 0.06, -0.12, 0.12, -0.18, 0.18][index % 7]
}

/// Largest ratio that is drawn to scale; at the border of the chart longer intervals say where they end.
const LARGEST: f64 = 4.0;

pub fn ratios(contrasts: &[StudyArmContrast]) -> Option<Markup> {
    if contrasts.is_empty() {
        return None;
    }
    let names: Vec<String> =
        contrasts.iter().map(|one| format!("{}\nto {}", one.arm.title(), one.against.title())).collect();
    let ends = contrasts.iter().flat_map(|one| one.interval).map(|end| end.min(LARGEST));
    let width = (160.0 + 110.0 * contrasts.len() as f64).max(WIDTH);
    let mut chart =
        SvgChart::new(width, 320.0, PlotAxis::named(&names), PlotAxis::over("ratio of rates", ends.chain([1.0])));
    chart.line("ideal", &[(-0.5, 1.0), (contrasts.len() as f64 - 0.5, 1.0)]);
    for (x, one) in contrasts.iter().enumerate() {
        let x = x as f64;
        let [low, high] = one.interval;
        chart.line("mean", &[(x, low.min(LARGEST)), (x, high.min(LARGEST))]);
        if high > LARGEST {
            chart.words("strong", x + 0.06, LARGEST, true, &format!("to {high:.2}"));
        }
        let title = format!("{} to {}: {:.2}", one.arm.title(), one.against.title(), one.ratio);
        chart.point("assisted", x, one.ratio.min(LARGEST), &title);
        chart.words("strong", x + 0.06, one.ratio.min(LARGEST), true, &format!("{:.2}", one.ratio));
    }
    Some(chart.finish("Ratio of rates between conditions, with intervals"))
}

/// Longest part of a concept's name in the chart of a league, in characters.
const LONGEST_NAME: usize = 18;

/// Net saving of the concepts of a tournament.
pub fn league(rows: &[TournamentRow]) -> String {
    let shown: Vec<(&TournamentRow, f64)> =
        rows.iter().filter_map(|row| Some((row, row.net_saving_per_100.value?))).collect();
    let name = |(row, _): &(&TournamentRow, f64)| {
        let name: Vec<char> = row.concept.chars().collect();
        name.chunks(LONGEST_NAME).take(2).map(|part| part.iter().collect::<String>()).collect::<Vec<_>>().join("\n")
    };
    let names: Vec<String> = shown.iter().map(name).collect();
    let ends = shown.iter().flat_map(|(row, value)| row.net_saving_per_100.interval.unwrap_or([*value; 2]));
    let label = "presses saved per 100, net of signals";
    let width = 120.0 + 130.0 * shown.len() as f64;
    let mut chart = SvgChart::new(width, 340.0, PlotAxis::named(&names), PlotAxis::over(label, ends));
    for (x, (row, value)) in shown.iter().enumerate() {
        let x = x as f64;
        if let Some([low, high]) = row.net_saving_per_100.interval {
            chart.line("mean", &[(x, low), (x, high)]);
        }
        chart.point("assisted", x, *value, &format!("{}: {value:.1}", row.concept));
        chart.words("strong", x + 0.04, *value, true, &minus(&format!("{value:.1}")));
    }
    document(&chart.finish("Net saving by concept, with intervals of 95 %"))
}

/// Width of a chart that fills a column of the report; wider ones fill both, so that all have letters of one size.
const WIDTH: f64 = 420.0;
const SIZE: [f64; 2] = [720.0, 420.0];
/// Least distance between the names of lines at the chart's border, as a share of the chart's height.
const APART: f64 = 0.05;

pub fn power(found: &PowerSummary) -> String {
    let sizes: Vec<f64> = found.sizes.iter().map(|size| size.participants as f64).collect();
    let (first, last) = (sizes.first().copied().unwrap_or(0.0), sizes.last().copied().unwrap_or(1.0));
    let mut names: Vec<(f64, (&str, String))> = Vec::new();
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
        let class = POWER_CLASSES[index % POWER_CLASSES.len()];
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
            (SignificanceTestMethod::MixedAnova, _) => "paper's test".to_string(),
            (_, true) => "mixed model".to_string(),
            (_, false) => format!("{} to {}", test.arm.title(), test.against.title()),
        };
        names.extend(points.last().map(|(_, share)| (*share, (class, name))));
    }
    for (y, (class, name)) in apart(names, APART * most, most) {
        chart.line(class, &[(1.03 * last, y), (1.09 * last, y)]);
        chart.words("strong", 1.09 * last, y, true, &name);
    }
    // Where no curve is: power rises to the right, and errors of type I are few.
    let (x, y) = if found.is_null() { (0.0, 0.95 * most) } else { (0.4 * last, 0.12 * most) };
    chart.words("strong", x, y, true, title);
    chart.words("", x, y - 0.07 * most, true, "bands: 95 % intervals of the simulation");
    document(&chart.finish(title))
}

/// Heights of the names at the ends of lines, moved at least `gap` apart and at most `most` high.
fn apart<Name>(mut names: Vec<(f64, Name)>, gap: f64, most: f64) -> Vec<(f64, Name)> {
    names.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut highest = most;
    for (y, _) in &mut names {
        *y = y.min(highest);
        highest = *y - gap;
    }
    names
}

/// Colours and dashes of the lines of power, in the order of the tests.
const POWER_CLASSES: [&str; 6] = ["second", "dev", "tom", "external", "first", "unassisted"];

/// Margins around the plot area of a chart, in pixels: left, right, top, bottom.
const MARGIN: [f64; 4] = [54.0, 14.0, 14.0, 44.0];

#[derive(Clone, Debug)]
pub struct PlotAxis {
    pub label: &'static str,
    pub from: f64,
    pub to: f64,
    /// Ticks of the axis: position and label.
    pub ticks: Vec<(f64, String)>,
}

impl PlotAxis {
    /// Axis whose range includes these values and 0, with ticks at round numbers.
    pub fn over(label: &'static str, values: impl Iterator<Item = f64>) -> PlotAxis {
        let (low, high) = values
            .filter(|value| value.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        let (low, high) = if low > high { (0.0, 1.0) } else { (low.min(0.0), high.max(0.0)) };
        PlotAxis::between(label, low, if high > low { high } else { low + 1.0 })
    }

    pub fn between(label: &'static str, low: f64, high: f64) -> PlotAxis {
        let step = round_step((high - low) / 5.0);
        let (first, last) = ((low / step).floor() as i64, (high / step - 1e-9).ceil() as i64);
        let digits = digits(step);
        let tick = |number: i64| (number as f64 * step, minus(&format!("{:.digits$}", number as f64 * step)));
        PlotAxis { label, from: first as f64 * step, to: last as f64 * step, ticks: (first..=last).map(tick).collect() }
    }

    /// Axis of categories; the first category is at position 0, the next at 1.
    pub fn named(names: &[String]) -> PlotAxis {
        let ticks = names.iter().enumerate().map(|(index, name)| (index as f64, name.clone())).collect();
        PlotAxis { label: "", from: -0.5, to: names.len() as f64 - 0.5, ticks }
    }
}

/// The smallest of 1, 2, 2.5 and 5 times a power of ten that is at least `step`.
fn round_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 2.5, 5.0].into_iter().find(|factor| factor * power >= step * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

/// Number of decimals that show an axis step and its multiples without rounding.
fn digits(step: f64) -> usize {
    let is_exact = |digits: &usize| {
        let scaled = step * 10f64.powi(*digits as i32);
        (scaled - scaled.round()).abs() < 1e-6 * scaled
    };
    (0..12).find(is_exact).unwrap_or(12)
}

#[derive(Clone, Debug)]
pub struct SvgChart {
    width: f64,
    height: f64,
    x: PlotAxis,
    y: PlotAxis,
    body: String,
}

impl SvgChart {
    pub fn new(width: f64, height: f64, x: PlotAxis, y: PlotAxis) -> SvgChart {
        let mut chart = SvgChart { width, height, x, y, body: String::new() };
        chart.frame();
        chart
    }

    fn px(&self, x: f64) -> f64 {
        let [left, right, ..] = MARGIN;
        left + (x - self.x.from) / (self.x.to - self.x.from) * (self.width - left - right)
    }

    fn py(&self, y: f64) -> f64 {
        let [.., top, bottom] = MARGIN;
        self.height - bottom - (y - self.y.from) / (self.y.to - self.y.from) * (self.height - top - bottom)
    }

    fn add(&mut self, element: Markup) {
        self.body.push_str(&element.0);
        self.body.push('\n');
    }

    fn frame(&mut self) {
        let [left, right, top, bottom] = MARGIN;
        let (width, height) = (self.width, self.height);
        for (value, text) in self.y.ticks.clone() {
            let y = self.py(value);
            let class = if value == 0.0 { "axis" } else { "grid" };
            let path = format!("M{left:.1} {y:.1}H{:.1}", width - right);
            self.add(html! { path class=(class) d=(path) {} });
            self.add(html! { text class="tick end" x=(tenths(left - 7.0)) y=(tenths(y + 4.0)) { (text) } });
        }
        let base = height - bottom;
        let path = format!("M{left:.1} {top:.1}V{base:.1}H{:.1}", width - right);
        self.add(html! { path class="axis" d=(path) {} });
        for (value, text) in self.x.ticks.clone() {
            let x = self.px(value);
            self.add(html! { path class="axis" d=(format!("M{x:.1} {base:.1}v4")) {} });
            for (line, part) in text.split('\n').enumerate() {
                let y = base + 17.0 + 13.0 * line as f64;
                self.add(html! { text class="tick middle" x=(tenths(x)) y=(tenths(y)) { (part) } });
            }
        }
        let (x, y) = ((left + width - right) / 2.0, height - 8.0);
        self.add(html! { text class="label middle" x=(tenths(x)) y=(tenths(y)) { (self.x.label) } });
        let turned = format!("translate(13 {:.1}) rotate(-90)", (top + base) / 2.0);
        self.add(html! { text class="label middle" transform=(turned) { (self.y.label) } });
    }

    pub fn point(&mut self, class: &str, x: f64, y: f64, title: &str) {
        let (x, y) = (tenths(self.px(x)), tenths(self.py(y)));
        self.add(html! { circle class=(class) cx=(x) cy=(y) r="4" { title { (title) } } });
    }

    pub fn line(&mut self, class: &str, points: &[(f64, f64)]) {
        let path = self.path(points);
        self.add(html! { path class={ "line " (class) } d=(path) {} });
    }

    /// Adds a band to the chart: each element holds x, lower height and upper height.
    pub(crate) fn band(&mut self, class: &str, band: &[[f64; 3]]) {
        if band.is_empty() {
            return;
        }
        let there = band.iter().map(|&[x, _, high]| (x, high));
        let back = band.iter().rev().map(|&[x, low, _]| (x, low));
        let path = self.path(&there.chain(back).collect::<Vec<_>>());
        self.add(html! { path class={ "band " (class) } d={ (path) "Z" } {} });
    }

    /// Adds a bar from 0 to y to the chart, between two positions on the x axis.
    pub fn bar(&mut self, class: &str, [from, to]: [f64; 2], y: f64, title: &str) {
        let (x, right, base, top) = (self.px(from), self.px(to), self.py(0.0), self.py(y));
        let [x, y, width, height] = [x, top, right - x, base - top].map(tenths);
        self.add(html! { rect class=(class) x=(x) y=(y) width=(width) height=(height) { title { (title) } } });
    }

    pub fn words(&mut self, class: &str, x: f64, y: f64, right: bool, text: &str) {
        let (x, y) = (self.px(x) + if right { 9.0 } else { -9.0 }, self.py(y) + 4.0);
        let side = if right { "start" } else { "end" };
        self.add(html! { text class={ "words " (side) " " (class) } x=(tenths(x)) y=(tenths(y)) { (text) } });
    }

    fn path(&self, points: &[(f64, f64)]) -> String {
        let mut path = String::new();
        for (index, &(x, y)) in points.iter().enumerate() {
            let _ = write!(path, "{}{:.1} {:.1}", if index == 0 { "M" } else { "L" }, self.px(x), self.py(y));
        }
        path
    }

    pub fn finish(self, title: &str) -> Markup {
        let size = format!("0 0 {:.0} {:.0}", self.width, self.height);
        let columns = self.width / WIDTH;
        let class = (columns > 1.0).then_some("wide");
        let style = format!("--columns: {columns:.3}");
        html! {
            svg viewBox=(size) class=[class] style=(style) role="img" aria-label=(title) { "\n" (PreEscaped(self.body)) } "\n"
        }
    }
}

/// With the styles of the report, as a file of its own.
pub fn document(chart: &Markup) -> String {
    let style = format!("<style>\n{STYLE}svg {{ background: var(--paper); }}\n</style>\n");
    let chart = chart.0.replacen("<svg ", "<svg xmlns=\"http://www.w3.org/2000/svg\" ", 1);
    match chart.split_once('\n') {
        Some((head, body)) => format!("{head}\n{style}{body}"),
        None => chart,
    }
}

fn tenths(pixels: f64) -> String {
    format!("{pixels:.1}")
}

/// Replaces hyphens in numbers by minus signs.
pub fn minus(text: &str) -> String {
    text.replace('-', "\u{2212}")
}
