//! The robustness table as text for the terminal, at most 125 characters wide, since few trials give shares beyond -100 %;
//! and as a chart (SVG): what the assistant saves for each cohort, and how well the estimate finds false beliefs.

use tomcom_core::base::text::{count, decimal};
use tomcom_core::measures::flags::MOST_FALSE_FLAGS;
use tomcom_study::charts::{PlotAxis, SvgChart, document};

use super::table::{CohortRow, RobustnessTable};

/// Heading of the robustness table as text; the column of cohort names is `width` characters wide.
pub fn heading(width: usize) -> String {
    let columns = |first: &str, names: [&str; 11]| {
        let [places, recipes, ece, flagged, false_flags, gain, without, with, saved, signals, orders] = names;
        let line = format!(
            "{first:<width$}{places:>7}{recipes:>8}{ece:>6}{flagged:>12}{false_flags:>6}{gain:>6}{without:>8}{with:>6}{saved:>19}\
             {signals:>8}{orders:>11}"
        );
        line.trim_end().to_string()
    };
    let above = ["ROC", "ROC", "", "", "false", "", "errors", "", "", "signals", ""];
    let below =
        ["places", "recipes", "ECE", "flagged", "flags", "gain", "without", "with", "saved, %", "/100", "orders/min"];
    format!("{}\n{}\n", columns("", above), columns("cohort", below))
}

/// The row of one cohort as text. The column of cohort names is `width` characters wide.
pub fn describe_row(of: &CohortRow, width: usize) -> String {
    let name = &of.cohort;
    let without = format!("{:.1}", of.unassisted.related_per_100);
    let (found, flags) = (&of.detection, &of.detection.flags);
    let flagged = match (flags.flagged_before_third_error, flags.episodes) {
        (Some(share), Some(episodes)) => format!("{share:.2} of {episodes}"),
        _ => "-".to_string(),
    };
    let saved = match (of.saved, of.saved_interval) {
        (Some(share), Some([from, to])) => {
            format!("{:.0} ({:.0} to {:.0})", 100.0 * share, 100.0 * from, 100.0 * to)
        }
        (Some(share), None) => format!("{:.0}", 100.0 * share),
        (None, _) => "-".to_string(),
    };
    let orders = format!("{:.2}, {:.2}", of.unassisted.orders_per_minute, of.assisted.orders_per_minute);
    format!(
        "{name:<width$}{:>7}{:>8}{:>6}{:>12}{:>6}{:>6}{without:>8}{:>6} {saved:>18}{:>8}{orders:>11}\n",
        decimal(found.auc_locations, 3),
        decimal(found.auc_recipes, 3),
        decimal(found.ece, 3),
        flagged,
        decimal(flags.false_flags_per_20_actions, 2),
        decimal(of.log_likelihood.gain, 2),
        decimal(Some(of.assisted.related_per_100), 1),
        decimal(Some(of.assisted.signals_per_100), 1),
    )
}

/// Width, in characters, of a table column that fits the longest of these names and the heading.
pub fn name_width<'a>(names: impl Iterator<Item = &'a str>) -> usize {
    names.map(|name| name.chars().count()).max().unwrap_or_default().max("cohort".len()) + 1
}

/// An explanation of the robustness table's columns, as text.
pub fn describe_end(table: &RobustnessTable) -> String {
    format!(
        "\n{} of seed {} for each cohort without signals, and the same with the assistant acting by itself; thresholds of \
         flags from as many trials of seed {}.\n\
         ROC: area under the curve, how well the estimate before each unassisted press finds false beliefs.\n\
         ECE: expected calibration error, how far its predicted probabilities of a false belief are off.\n\
         flagged: false belief episodes of two or more errors that are flagged before the third; the thresholds allow \
         {MOST_FALSE_FLAGS} false flags per 20 presses of the human.\n\
         gain: log likelihood per press beyond that of a human who knows everything, in nats.\n\
         errors, signals: belief related errors without and with the assistant, and signals, per 100 presses of the human.\n\
         saved: by how much fewer errors there are with the assistant (95 % interval by drawing trials, as all intervals).\n\
         orders/min: orders served a minute, without and with the assistant.\n",
        count(table.cohorts.first().map_or(0, |row| row.trials), "trial", "trials"),
        table.seed,
        table.choose_seed,
    )
}

/// Width of a cohort's column, and of the rest of the chart, in pixels.
const WIDTHS: [f64; 2] = [94.0, 230.0];
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
pub fn chart(table: &RobustnessTable) -> String {
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
    document(&chart.finish("Estimate and assistant for each cohort"))
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
