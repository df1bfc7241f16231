//! Output of commands: summaries and progress bars.

use std::io::{IsTerminal, Write};

use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use super::failure::Failure;

/// Output format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum OutputFormat {
    /// Text.
    Text,
    /// One JSON object.
    Json,
}

/// Prints a summary as one JSON object or as text.
pub(super) fn print(
    format: OutputFormat,
    figures: &impl Serialize,
    text: impl FnOnce() -> String,
) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match format {
        OutputFormat::Json => {
            writeln!(out, "{}", serde_json::to_string_pretty(figures).map_err(std::io::Error::other)?)?
        }
        OutputFormat::Text => write!(out, "{}", text())?,
    }
    Ok(out.flush()?)
}

/// A progress bar on stderr; hidden if stderr is not a terminal.
pub(super) fn progress(of: u64, what: &str) -> ProgressBar {
    let bar = ProgressBar::new(of);
    if std::io::stderr().is_terminal()
        && let Ok(style) = ProgressStyle::with_template(&format!("{{bar:40}} {{pos}}/{{len}} {what}, {{eta}} left"))
    {
        bar.set_style(style);
    }
    bar
}
