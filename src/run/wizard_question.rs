//! A question to the wizard before a recording begins.

use std::time::Duration;

use super::desk::OperatorDesk;
use super::error::LiveError;
use super::event_loop::{self, ConsoleShell, FRAME, LoopEvent, ShellDeadlines, ShellView};
use crate::console::ConsoleMessage;
use crate::console::question::{QuestionPage, QuestionReply};
use crate::console::view::theme::Theme;

/// Period of redrawing a question.
const REDRAW: Duration = Duration::from_millis(100);

/// Asks a question; returns the index of the answer, or `None` to quit the program.
///
/// # Errors
/// The terminal is gone.
pub(super) async fn ask(desk: &mut OperatorDesk, question: &QuestionPage) -> Result<Option<usize>, LiveError> {
    let mut shell = OpenQuestion { question, theme: desk.theme, dirty: true };
    let reply = event_loop::run(&mut shell, desk).await?;
    Ok(match reply {
        Some(QuestionReply::Answer(index)) => Some(index),
        Some(QuestionReply::Leave) | None => None,
    })
}

/// A question without an answer yet.
struct OpenQuestion<'a> {
    question: &'a QuestionPage,
    theme: Theme,
    /// Whether the screen must be redrawn.
    dirty: bool,
}

impl ConsoleShell for OpenQuestion<'_> {
    type Outcome = QuestionReply;
    type Error = LiveError;

    fn deadlines(&mut self) -> ShellDeadlines {
        ShellDeadlines { frame_after: if self.dirty { FRAME } else { REDRAW }, ..ShellDeadlines::default() }
    }

    /// Gaze and page inputs are consumed during a question; otherwise they would be processed later as if they were new.
    fn take(&mut self, event: LoopEvent) -> Result<Option<QuestionReply>, LiveError> {
        let LoopEvent::Terminal(message) = event else { return Ok(None) };
        self.dirty = true;
        Ok(match message {
            ConsoleMessage::Key(key) => self.question.reply(&key),
            _ => None,
        })
    }

    fn view(&self) -> ShellView<'_> {
        ShellView::Question(self.question, self.theme)
    }

    fn drawn(&mut self) {
        self.dirty = false;
    }
}
