//! The study report: one self-contained HTML page for screen and print.

mod arm_section;
mod assistance;
mod awareness;
mod concept_comparison;
mod elements;
mod methods;
pub mod page_head;
mod results;
mod robot_counts;
mod sections;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use self::elements::Captions;
use super::column::CsvTable;
use super::facts::RecordingFacts;
use super::figures::StudySummary;
use super::trial_statistics::TrialStatistics;

/// Style sheet of the report's page and its charts.
pub const STYLE: &str = include_str!("style.css");

/// The study report as an HTML page, with links to the files of these tables.
pub fn page(figures: &StudySummary, trials: &[TrialStatistics], facts: &RecordingFacts, tables: &[CsvTable]) -> String {
    let captions = &mut Captions::default();
    let sections = [
        sections::summary(figures),
        results::beside_the_paper(captions, figures),
        assistance::assistance(captions, figures, trials),
        awareness::awareness(captions, figures),
        arm_section::arms(captions, figures),
        concept_comparison::concepts(captions, figures),
        results::similarity(captions, figures),
        robot_counts::robot(captions, figures),
        results::people(captions, figures),
        sections::trials(captions, figures, trials),
        methods::methods(figures, facts),
        sections::definitions(),
        sections::files(tables),
    ];
    let page = html! {
        (DOCTYPE) "\n"
        html lang="en" {
            (head(figures, trials))
            body {
                main { h1 { (figures.title) } "\n" @for section in sections { (section) } }
            }
        }
        "\n"
    };
    page.into_string()
}

/// HTML head of the report's page.
fn head(figures: &StudySummary, trials: &[TrialStatistics]) -> Markup {
    html! {
        head {
            meta charset="utf-8"; "\n"
            title { (figures.title) } "\n"
            @for (name, content) in metadata(trials) { meta name=(name) content=(content); "\n" }
            style { "\n" (PreEscaped(STYLE)) }
        }
        "\n"
    }
}

/// Metadata of the report's page as (name, content).
fn metadata(trials: &[TrialStatistics]) -> [(&'static str, String); 3] {
    let [generator, participants] = page_head::about(trials.iter().map(|trial| trial.participant.as_str()));
    [generator, participants, ("viewport", "width=device-width, initial-scale=1".to_string())]
}
