//! Asks the wizard a question before a recording begins.

use std::time::{Duration, Instant};

use crossterm::event::KeyCode;

use super::error::LiveError;
use super::event_loop::{self, ConsoleShell, FRAME, LoopEvent, ShellDeadlines, ShellView};
use super::operator_station::{OperatorStation, take_consent_input};
use crate::console::ConsoleMessage;
use crate::console::lists::{ListChoice, StartPrompt};
use crate::console::text_input::refusal_of_paste;
use crate::console::view::theme::Theme;
use tomcom_core::base::time::SessionTime;
use tomcom_devices::sight::ConsentHold;
use tomcom_session::wall_display::AnswerDevice;

/// Period of redrawing a question on the screen.
const REDRAW: Duration = Duration::from_millis(100);

/// Asks the wizard a question; returns the index of the chosen answer, or `None` if the wizard quits the program.
pub(super) async fn ask(station: &mut OperatorStation, question: StartPrompt) -> Result<Option<usize>, LiveError> {
    Ok(ask_consent(station, question, false).await?.map(|(index, _)| index))
}

/// Asks the wizard a question that, with `on_display`, the participant's page can answer, too, by choosing the first
/// answer. Returns the answer and where the answer was given.
pub(super) async fn ask_consent(
    station: &mut OperatorStation,
    question: StartPrompt,
    on_display: bool,
) -> Result<Option<(usize, AnswerDevice)>, LiveError> {
    let (theme, asked, button) = (station.theme, Instant::now(), ConsentHold::default());
    let missing_page = station.display.missing_page();
    let mut shell =
        OpenQuestion { question, on_display, missing_page, asked, button, theme, notice: None, dirty: true };
    let reply = event_loop::run(&mut shell, station).await?;
    Ok(match reply {
        Some((ListChoice::Chosen(index), on)) => Some((index, on)),
        Some((ListChoice::Leave, _)) | None => None,
    })
}

/// A question to the wizard that has not been answered.
struct OpenQuestion {
    question: StartPrompt,
    on_display: bool,
    /// Says what is to be opened while the participant's page is wanted and none is connected.
    missing_page: Box<dyn Fn() -> Option<String>>,
    /// When the question was asked: the time with which the hold of the page's button is measured begins here.
    asked: Instant,
    button: ConsentHold,
    theme: Theme,
    /// Why the last input had no effect.
    notice: Option<&'static str>,
    dirty: bool,
}

impl ConsoleShell for OpenQuestion {
    type Outcome = (ListChoice, AnswerDevice);
    type Error = LiveError;

    fn deadlines(&mut self) -> ShellDeadlines {
        ShellDeadlines { frame_after: if self.dirty { FRAME } else { REDRAW }, ..ShellDeadlines::default() }
    }

    /// Handles an event. Gaze and other page inputs are discarded during a question; otherwise they would be processed
    /// later as if they were new inputs.
    fn take(&mut self, event: LoopEvent) -> Result<Option<(ListChoice, AnswerDevice)>, LiveError> {
        let now = SessionTime(self.asked.elapsed().as_nanos() as u64);
        let message = match event {
            LoopEvent::Page(input) if self.on_display => {
                if let Some(notice) = take_consent_input(&input, &mut self.button, now) {
                    self.notice = Some(notice);
                    self.dirty = true;
                }
                None
            }
            LoopEvent::Terminal(message) => Some(message),
            _ => None,
        };
        if self.button.is_given(now) {
            return Ok(Some((ListChoice::Chosen(0), AnswerDevice::Display)));
        }
        let Some(message) = message else { return Ok(None) };
        self.dirty = true;
        Ok(match message {
            ConsoleMessage::Key(key) => {
                let is_open = key.code == KeyCode::Enter && self.question.chosen.is_none();
                self.notice = is_open.then_some("choose an answer by its digit, then press enter");
                self.question.reply(&key).map(|reply| (reply, AnswerDevice::Console))
            }
            ConsoleMessage::Paste(text) => {
                self.notice = Some(refusal_of_paste(text.as_deref()));
                None
            }
            _ => None,
        })
    }

    fn prepare(&mut self) {
        self.question.missing_page = (self.missing_page)();
    }

    fn view(&self) -> ShellView<'_> {
        ShellView::Question(&self.question, self.notice, self.theme)
    }

    fn drawn(&mut self) {
        self.dirty = false;
    }
}
