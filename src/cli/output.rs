//! Output of commands: summaries, errors and progress bars. Control characters are escaped, since texts also come from
//! files.

use std::error::Error;
use std::fmt::{self, Display, Formatter};
use std::io::{self, IsTerminal};

use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressStyle};
use miette::{Diagnostic, LabeledSpan, Report, Severity, SourceCode};
use serde::Serialize;

use super::failure::Failure;
use crate::run::terminal;
use tomcom_core::base::text::printable_lines;

/// Format of a command's output: text or JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum OutputFormat {
    /// Text for people.
    Text,
    /// One JSON object for programs.
    Json,
}

/// Prints a summary as one JSON object or as text.
pub(super) fn print(
    format: OutputFormat,
    figures: &impl Serialize,
    text: impl FnOnce() -> String,
) -> Result<(), Failure> {
    let text = match format {
        OutputFormat::Json => serde_json::to_string_pretty(figures).map_err(io::Error::other)? + "\n",
        OutputFormat::Text => text(),
    };
    Ok(put(&text)?)
}

/// Prints a text on standard output.
pub(super) fn put(text: &str) -> io::Result<()> {
    terminal::print(false, printable_lines(text).into_owned().into_bytes())
}

/// Prints a text on standard error.
pub(super) fn put_aside(text: &str) {
    // If standard error cannot be written, nobody can be told about it.
    let _ = terminal::print(true, printable_lines(text).into_owned().into_bytes());
}

/// Prints an error report on standard error.
pub(super) fn put_error(report: Report) {
    let report = Report::new(PrintableReport(report));
    // If standard error cannot be written, nobody can be told about it.
    let _ = terminal::print(true, format!("{report:?}\n").into_bytes());
}

/// An error report whose control characters are escaped when it is printed; excerpts of files are escaped already.
#[derive(Debug)]
struct PrintableReport(Report);

impl Display for PrintableReport {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        out.write_str(&printable_lines(&self.0.to_string()))
    }
}

impl Error for PrintableReport {}

impl Diagnostic for PrintableReport {
    fn severity(&self) -> Option<Severity> {
        self.0.severity()
    }

    fn help<'a>(&'a self) -> Option<Box<dyn Display + 'a>> {
        self.0.help().map(|help| Box::new(printable_lines(&help.to_string()).into_owned()) as Box<dyn Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.0.source_code()
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.0.labels()
    }
}

/// A progress bar on standard error; hidden if standard error is not a terminal.
pub(super) fn progress(of: u64, what: &str) -> ProgressBar {
    let bar = ProgressBar::new(of);
    if io::stderr().is_terminal()
        && let Ok(style) = ProgressStyle::with_template(&format!("{{bar:40}} {{pos}}/{{len}} {what}, {{eta}} left"))
    {
        bar.set_style(style);
        // Else nothing is seen until the first step is done.
        bar.tick();
    }
    bar
}
