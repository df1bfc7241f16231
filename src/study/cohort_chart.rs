//! Chart of the robustness table, as an SVG file: what the assistant saves for each cohort and how well the estimate
//! finds false beliefs.

use super::report::STYLE;
use super::svg::{PlotAxis, SvgChart, document};
use crate::analysis::cohort_table::{CohortRow, RobustnessTable};

/// Width of a cohort's column, and of the rest of the chart, in pixels.
const WIDTHS: [f64; 2] = [94.0, 230.0];
/// Height of the chart, in pixels.
const HEIGHT: f64 = 460.0;
/// Largest number of characters in a line of a cohort's name, and of lines.
const NAME: [usize; 2] = [13, 3];

/// A measure of the chart: its name, its value, and the ends of its interval.
type ChartedMeasure = (&'static str, fn(&CohortRow) -> (Option<f64>, Option<[f64; 2]>));

const MEASURES: [ChartedMeasure; 3] = [
    ("ROC, places", |of| (of.detection.auc_locations, of.auc_locations_interval)),
    ("ROC, recipes", |of| (of.detection.auc_recipes, of.auc_recipes_interval)),
    ("errors saved", |of| (of.saved, of.saved_interval)),
];

/// The chart of robustness: for each cohort and each measure a point with its interval.
pub fn robustness(table: &RobustnessTable) -> String {
    let names: Vec<String> = table.cohorts.iter().map(|row| wrapped(&row.cohort)).collect();
    let lows = table.cohorts.iter().flat_map(|of| {
        MEASURES.into_iter().filter_map(move |(_, measure)| match measure(of) {
            (_, Some([low, _])) => Some(low),
            (value, None) => value,
        })
    });
    let lowest = lows.fold(0.0, f64::min);
    let mut x = PlotAxis::named(&names);
    // Room for the names of measures at the right.
    x.to += 1.5;
    let y = PlotAxis::between("share of belief related errors saved; area under the ROC curve", lowest, 1.0);
    let width = WIDTHS[0] * names.len() as f64 + WIDTHS[1];
    let mut chart = SvgChart::new(width, HEIGHT, x, y);
    for (column, row) in table.cohorts.iter().enumerate() {
        let at = column as f64;
        for (name, measure) in MEASURES {
            let (Some(value), interval) = measure(row) else { continue };
            if let Some([low, high]) = interval {
                chart.line("first", &[(at, low), (at, high)]);
            }
            chart.point("first", at, value, &format!("{}: {name} {value:.3}", row.cohort));
        }
    }
    if let Some(last) = table.cohorts.last() {
        let end = table.cohorts.len() as f64 - 0.6;
        for (name, measure) in MEASURES {
            if let (Some(value), _) = measure(last) {
                chart.words("strong", end, value, true, name);
            }
        }
    }
    document(&chart.finish("Estimate and assistant for each cohort"), STYLE)
}

/// A cohort's name in lines that are short enough for its column, where its words are.
fn wrapped(name: &str) -> String {
    let [most, lines] = NAME;
    let mut text: Vec<String> = Vec::new();
    for word in name.split_whitespace() {
        match text.last_mut() {
            Some(line) if text_length(line) + 1 + text_length(word) <= most => *line = format!("{line} {word}"),
            _ => text.push(word.to_string()),
        }
    }
    text.truncate(lines);
    text.join("\n")
}

fn text_length(text: &str) -> usize {
    text.chars().count()
}
