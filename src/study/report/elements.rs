//! Elements of the study report's page: sections, charts, tables, and formatted numbers.

use maud::{Markup, PreEscaped, Render, html};

use crate::charts::minus;
use tomcom_session::settings::ArmKind;

pub(super) const DASH: &str = "\u{2013}";
/// What stands around the reason in a value that is not known.
const UNKNOWN: [&str; 2] = ["<span class=\"unknown\" title=\"", "\">\u{2013}"];

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

    /// First column text, all others numbers. The caption ends with the reasons of what is not known. Notes belong in the caption: page breaks never separate the two.
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
        let reasons = reasons(rows);
        let rows =
            &rows.iter().map(|row| row.iter().map(|cell| lettered(cell, &reasons)).collect()).collect::<Vec<_>>();
        let words: Vec<Option<&str>> =
            (0..heads.len()).map(|column| (column > 0 && are_words(rows, column)).then_some("word")).collect();
        html! {
            figure class="table" {
                figcaption { b { "Table\u{a0}" (self.tables) "." } " " (caption) (reasons_in_words(&reasons)) } "\n"
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

/// What is not known in a table: a dash, whose reason the caption gives.
pub(super) fn unknown(why: &str) -> Markup {
    html! { span class="unknown" title=(why) { (DASH) } }
}

/// The reasons of what is not known in these rows, each once.
fn reasons(rows: &[Vec<Markup>]) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for cell in rows.iter().flatten() {
        for (why, _) in cell.0.split(UNKNOWN[0]).skip(1).filter_map(|rest| rest.split_once(UNKNOWN[1])) {
            if !found.iter().any(|known| known == why) {
                found.push(why.to_string());
            }
        }
    }
    found
}

fn letter(index: usize) -> char {
    char::from(b'a' + index.min(25) as u8)
}

/// A cell with the letter of its reason, if there are several reasons.
fn lettered(cell: &Markup, reasons: &[String]) -> Markup {
    let mut text = cell.0.clone();
    for (index, why) in reasons.iter().enumerate().filter(|_| reasons.len() > 1) {
        let dash = UNKNOWN.join(why.as_str());
        text = text.replace(&dash, &format!("{dash}<sup>{}</sup>", letter(index)));
    }
    PreEscaped(text)
}

fn reasons_in_words(reasons: &[String]) -> Markup {
    html! {
        @for (index, why) in reasons.iter().enumerate() {
            " " (DASH) @if reasons.len() > 1 { sup { (letter(index)) } } ":\u{a0}" (PreEscaped(why)) "."
        }
    }
}

/// A number with this many decimals as text.
pub(super) fn fixed(value: f64, digits: usize) -> String {
    minus(&format!("{value:.digits$}"))
}

/// A number in a sentence, or that it is not known, and why.
pub(super) fn told(value: Option<f64>, digits: usize, why: &str) -> String {
    value.filter(|value| value.is_finite()).map_or(format!("not known ({why})"), |value| fixed(value, digits))
}

/// A value of a table, or why it is not known.
pub(super) fn known<T>(value: Option<T>, why: &str, text: impl FnOnce(T) -> String) -> Markup {
    value.map_or_else(|| unknown(why), |value| text(value).render())
}

pub(super) fn number(value: Option<f64>, digits: usize, why: &str) -> Markup {
    known(value.filter(|value| value.is_finite()), why, |value| fixed(value, digits))
}

pub(super) fn with_interval(value: Option<f64>, interval: Option<[f64; 2]>, digits: usize, why: &str) -> Markup {
    html! { (number(value, digits, why)) @if let Some(ends) = interval { small { (range(ends, digits)) } } }
}

pub(super) fn percent(value: Option<f64>, why: &str) -> Markup {
    known(value, why, in_percent)
}

pub(super) fn in_percent(value: f64) -> String {
    format!("{:.1} %", 100.0 * value)
}

pub(super) fn p_value(p: Option<f64>, why: &str) -> Markup {
    known(p, why, p_words)
}

pub(super) fn p_words(p: f64) -> String {
    // Without the no-break space, a line could break between sign and number.
    if p < 0.001 { "<\u{a0}0.001".to_string() } else { format!("{p:.3}") }
}

/// The p value of a test with its relational sign, for sentences; without line breaks.
pub(super) fn p_sentence(p: f64) -> String {
    if p < 0.001 { format!("p\u{a0}{}", p_words(p)) } else { format!("p\u{a0}=\u{a0}{}", p_words(p)) }
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

pub(super) fn count(value: Option<u64>, why: &str) -> Markup {
    known(value, why, |value| value.to_string())
}

pub(super) fn arm(kind: ArmKind) -> &'static str {
    match kind {
        ArmKind::Timed => "timed",
        ArmKind::Physics => "simulated with contact forces",
        ArmKind::Ur(_) => "a real UR5",
    }
}
