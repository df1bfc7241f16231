//! Elements of the study report's page: sections, charts, tables, and formatted numbers.

use maud::{Markup, PreEscaped, Render, html};

use crate::charts::minus;
use tomcom_session::settings::ArmKind;

pub(super) const UNKNOWN: &str = "\u{2013}";

#[derive(Debug, Default)]
pub(super) struct Captions {
    figures: u32,
    tables: u32,
    /// Headings of the sections, in their order.
    sections: Vec<String>,
}

impl Captions {
    /// A numbered chart with its caption; empty if there is no chart.
    pub(super) fn figure(&mut self, picture: Option<Markup>, caption: impl Render) -> Markup {
        let Some(picture) = picture else { return nothing() };
        self.figures += 1;
        html! {
            figure { (picture) figcaption { b { "Figure\u{a0}" (self.figures) "." } " " (caption) } }
            "\n"
        }
    }

    /// First column text, all others numbers. Notes belong in the caption: page breaks never separate the two.
    pub(super) fn table(&mut self, caption: impl Render, heads: &[impl Render], rows: &[Vec<Markup>]) -> Markup {
        self.table_of_class(None, caption, heads, rows)
    }

    /// One row per element of `rows`.
    pub(super) fn table_of_columns<'r, Row: 'r>(
        &mut self,
        caption: impl Render,
        columns: &[PageColumn<Row>],
        rows: impl Iterator<Item = &'r Row>,
    ) -> Markup {
        let heads: Vec<&str> = columns.iter().map(|(head, _)| *head).collect();
        let rows: Vec<Vec<Markup>> = rows.map(|row| columns.iter().map(|(_, value)| value(row)).collect()).collect();
        self.table(caption, &heads, &rows)
    }

    pub(super) fn table_of_text(
        &mut self,
        caption: impl Render,
        heads: &[impl Render],
        rows: &[Vec<Markup>],
    ) -> Markup {
        self.table_of_class(Some("text"), caption, heads, rows)
    }

    fn table_of_class(
        &mut self,
        class: Option<&str>,
        caption: impl Render,
        heads: &[impl Render],
        rows: &[Vec<Markup>],
    ) -> Markup {
        self.tables += 1;
        let words: Vec<Option<&str>> =
            (0..heads.len()).map(|column| (column > 0 && are_words(rows, column)).then_some("word")).collect();
        html! {
            figure class="table" {
                figcaption { b { "Table\u{a0}" (self.tables) "." } " " (caption) } "\n"
                div class="scroll" {
                    table class=[class] {
                        thead { tr { @for (head, class) in heads.iter().zip(&words) { th class=[class] { (head) } } } }
                        tbody {
                            @for row in rows {
                                "\n" tr { @for (cell, class) in row.iter().zip(&words) { td class=[class] { (cell) } } }
                            }
                        }
                    }
                }
            }
            "\n"
        }
    }

    /// A section of the report with a heading; empty if the section has no content.
    pub(super) fn section(&mut self, heading: &str, content: Markup) -> Markup {
        if content.0.is_empty() {
            return nothing();
        }
        self.sections.push(heading.to_string());
        html! { section id=(place(heading)) { h2 { (heading) } "\n" (content) } "\n" }
    }

    /// Links to all sections so far.
    pub(super) fn contents(&self) -> Markup {
        html! {
            nav { @for heading in &self.sections { a href={ "#" (place(heading)) } { (heading) } " " } }
            "\n"
        }
    }
}

/// Name of a section within the page.
fn place(heading: &str) -> String {
    heading
        .to_lowercase()
        .chars()
        .filter(|sign| sign.is_alphanumeric() || *sign == ' ')
        .collect::<String>()
        .replace(' ', "-")
}

/// Whether a column has words, which stand to the left, and no numbers.
fn are_words(rows: &[Vec<Markup>], column: usize) -> bool {
    let begins = |row: &Vec<Markup>| row.get(column).and_then(|cell| cell.0.chars().next());
    rows.iter().filter_map(begins).all(char::is_alphabetic) && rows.iter().any(|row| begins(row).is_some())
}

pub(super) type PageColumn<Row> = (&'static str, fn(&Row) -> Markup);

pub(super) fn nothing() -> Markup {
    PreEscaped(String::new())
}

pub(super) fn cells<const N: usize>(cells: [&dyn Render; N]) -> Vec<Markup> {
    cells.into_iter().map(Render::render).collect()
}

/// Legend of a chart: pairs of CSS class and label.
pub(super) fn keys(keys: &[(&str, &str)]) -> Markup {
    html! {
        @for (class, word) in keys { " " span class="of" { i class={ "key " (class) } {} (word) } }
    }
}

/// A number with this many decimals as text; a dash for `None`.
pub(super) fn number(value: Option<f64>, digits: usize) -> String {
    value.filter(|value| value.is_finite()).map_or(UNKNOWN.to_string(), |value| minus(&format!("{value:.digits$}")))
}

pub(super) fn with_interval(value: Option<f64>, interval: Option<[f64; 2]>, digits: usize) -> Markup {
    html! { (number(value, digits)) @if let Some(ends) = interval { small { (range(ends, digits)) } } }
}

pub(super) fn percent(value: Option<f64>) -> String {
    value.map_or(UNKNOWN.to_string(), |value| format!("{:.1} %", 100.0 * value))
}

pub(super) fn p_value(p: Option<f64>) -> String {
    match p {
        None => UNKNOWN.to_string(),
        // Without the no-break space, a line could break between sign and number.
        Some(p) if p < 0.001 => "<\u{a0}0.001".to_string(),
        Some(p) => format!("{p:.3}"),
    }
}

/// The p value of a test with its relational sign, for sentences; without line breaks.
pub(super) fn p_sentence(p: Option<f64>) -> String {
    match p {
        Some(p) if p < 0.001 => "p\u{a0}<\u{a0}0.001".to_string(),
        p => format!("p\u{a0}=\u{a0}{}", p_value(p)),
    }
}

/// A range of numbers as "low to high"; another text if a bound is infinite.
pub(super) fn range([low, high]: [f64; 2], digits: usize) -> String {
    if low.is_infinite() && high.is_infinite() {
        return "no interval: too few values".to_string();
    }
    let end = |value: f64| match value {
        f64::INFINITY => "\u{221e}".to_string(),
        f64::NEG_INFINITY => "\u{2212}\u{221e}".to_string(),
        value => minus(&format!("{value:.digits$}")),
    };
    format!("{} to {}", end(low), end(high))
}

pub(super) fn count(value: Option<u64>) -> String {
    value.map_or(UNKNOWN.to_string(), |value| value.to_string())
}

pub(super) fn arm(kind: ArmKind) -> &'static str {
    match kind {
        ArmKind::Timed => "timed",
        ArmKind::Physics => "simulated with contact forces",
        ArmKind::Ur(_) => "a real UR5",
    }
}
