//! The report: one page that needs nothing beside it, for screen and paper.

pub mod page_head;
mod results;
mod robot;
mod sections;

use super::facts::Facts;
use super::figures::StudySummary;
use super::svg::{escaped, minus};
use super::tables::Table;
use super::trial::Trial;

/// How the page looks.
const STYLE: &str = include_str!("style.css");

/// The page, as HTML. Beside it are files of these tables.
pub fn page(figures: &StudySummary, trials: &[Trial], facts: &Facts, tables: &[Table]) -> String {
    let body = [
        sections::summary(figures),
        results::beside_the_paper(figures),
        results::assistance(figures, trials),
        results::concepts(figures),
        results::similarity(figures),
        robot::robot(figures),
        results::people(figures),
        sections::trials(figures, trials),
        sections::methods(figures, facts),
        sections::definitions(),
        sections::files(tables),
    ];
    let title = escaped(&figures.title);
    let about = page_head::about(trials.iter().map(|trial| trial.participant.as_str()));
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n{about}\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <main>\n<h1>{title}</h1>\n{}</main>\n</body>\n</html>\n",
        numbered(&numbered(&body.concat(), "<figcaption>", "Figure"), "<caption>", "Table")
    )
}

/// Gives what follows each of these tags a number. Texts from outside are escaped, and hold none.
fn numbered(page: &str, tag: &str, name: &str) -> String {
    let mut parts = page.split(tag);
    let first = parts.next().unwrap_or_default().to_string();
    parts.enumerate().fold(first, |page, (index, part)| format!("{page}{tag}<b>{name}\u{a0}{}.</b> {part}", index + 1))
}

/// A section with a heading; nothing without content.
fn section(heading: &str, content: &str) -> String {
    if content.is_empty() {
        return String::new();
    }
    format!("<section>\n<h2>{heading}</h2>\n{content}</section>\n")
}

/// A picture with what it shows; nothing where there is none.
fn figure(picture: Option<String>, class: &str, caption: &str) -> String {
    picture.map_or(String::new(), |picture| {
        format!("<figure class=\"{class}\">\n{picture}<figcaption>{caption}</figcaption>\n</figure>\n")
    })
}

/// A table with what it shows; the first column is text, all others are figures. What is to be said of it stands in its
/// caption, which no page parts from it.
fn table(caption: &str, heads: &[&str], rows: &[Vec<String>]) -> String {
    let head: Vec<String> = heads.iter().map(|head| format!("<th>{head}</th>")).collect();
    let row = |row: &Vec<String>| {
        let cells: Vec<String> = row.iter().map(|cell| format!("<td>{cell}</td>")).collect();
        format!("<tr>{}</tr>\n", cells.concat())
    };
    let rows: Vec<String> = rows.iter().map(row).collect();
    format!(
        "<table>\n<caption>{caption}</caption>\n<thead><tr>{}</tr></thead>\n<tbody>\n{}</tbody>\n</table>\n",
        head.concat(),
        rows.concat()
    )
}

/// What colours mean: classes with words.
fn keys(keys: &[(&str, &str)]) -> String {
    let key = |(class, word): &(&str, &str)| format!(" <span class=\"of\"><i class=\"key {class}\"></i>{word}</span>");
    keys.iter().map(key).collect()
}

/// A number with so many digits behind the point; a dash for nothing.
fn number(value: Option<f64>, digits: usize) -> String {
    value.filter(|value| value.is_finite()).map_or("\u{2013}".to_string(), |value| minus(&format!("{value:.digits$}")))
}

fn percent(value: Option<f64>) -> String {
    value.map_or("\u{2013}".to_string(), |value| format!("{:.1} %", 100.0 * value))
}

/// A probability of a test, as journals want it.
fn p_value(p: Option<f64>) -> String {
    match p {
        None => "\u{2013}".to_string(),
        Some(p) if p < 0.001 => "&lt; 0.001".to_string(),
        Some(p) => format!("{p:.3}"),
    }
}

/// The same in a sentence, with its sign; no line breaks in it.
fn p_sentence(p: Option<f64>) -> String {
    match p {
        Some(p) if p < 0.001 => "p\u{a0}&lt;\u{a0}0.001".to_string(),
        p => format!("p\u{a0}=\u{a0}{}", p_value(p)),
    }
}

/// From … to …; words where that is not bounded, a dash where it is unknown.
fn range(low: Option<f64>, high: Option<f64>, digits: usize) -> String {
    match low.zip(high) {
        None => "\u{2013}".to_string(),
        Some((low, high)) if low.is_infinite() && high.is_infinite() => "no interval: too few".to_string(),
        Some((low, high)) => {
            let end = |value: f64| match value {
                f64::INFINITY => "\u{221e}".to_string(),
                f64::NEG_INFINITY => "\u{2212}\u{221e}".to_string(),
                value => minus(&format!("{value:.digits$}")),
            };
            format!("{} to {}", end(low), end(high))
        }
    }
}

fn count(value: Option<u64>) -> String {
    value.map_or("\u{2013}".to_string(), |value| value.to_string())
}
