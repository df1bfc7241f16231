//! A question to the wizard before a recording begins.

use std::time::Duration;

use super::desk::OperatorDesk;
use super::error::LiveError;
use super::event_loop::{self, ConsoleShell, FRAME, LoopEvent, ShellDeadlines, ShellView};
use crate::console::ConsoleMessage;
use crate::console::question::{QuestionPage, QuestionReply};
use crate::console::view::theme::Theme;

/// A question is drawn so often.
const REDRAW: Duration = Duration::from_millis(100);

/// Asks; the place of the answer, none if the program is to be left.
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

/// A question that is not answered yet.
struct OpenQuestion<'a> {
    question: &'a QuestionPage,
    theme: Theme,
    /// The terminal changed since the last frame.
    dirty: bool,
}

impl ConsoleShell for OpenQuestion<'_> {
    type Outcome = QuestionReply;
    type Error = LiveError;

    fn deadlines(&mut self) -> ShellDeadlines {
        ShellDeadlines { frame_after: if self.dirty { FRAME } else { REDRAW }, ..ShellDeadlines::default() }
    }

    /// Gaze and what the page says are taken all the same, or they would be read later as if they had just come.
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
