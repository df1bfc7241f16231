//! Messages between the participant's page and the program, one JSON object each. Times in messages are milliseconds on
//! the server's clock.

use std::collections::BTreeMap;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::page_server::PageMessage;
use crate::sight::{DisplayContent, DisplayScene, RobotHandPose};
use tomcom_session::questionnaire::AnswerValue;

/// Longest name or other text in a page's message, in bytes.
const MAX_TEXT: usize = 64;
/// Longest answer that a participant can type, in characters.
const MAX_ANSWER: usize = 500;
/// Largest page width or height that is accepted, in pixels.
const MAX_PIXELS: u32 = 100_000;

/// A message from the participant's page to the program.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum MessageFromPage {
    /// First message of a page, with which it identifies itself.
    Hello {
        page: String,
        width: u32,
        height: u32,
        #[serde(default)]
        upright: bool,
        code: Option<String>,
        /// Whether the page only watched before it was reconnected, so that it lets another page take part.
        #[serde(default)]
        waits: bool,
    },
    /// New size of the participant's page, after its window was resized.
    Size {
        width: u32,
        height: u32,
        #[serde(default)]
        upright: bool,
    },
    TakePart,
    Ping {
        /// Time on the page's clock, in milliseconds.
        t: f64,
        took: Option<f64>,
        #[serde(default)]
        hidden: bool,
    },
    Press {
        /// Number of the press among all presses on this page, counted from 1.
        number: u64,
        button: String,
        /// Time of the press, in milliseconds on the server's clock.
        at: f64,
    },
    Pointer {
        /// Horizontal position of the pointer, as a fraction of the display's width.
        x: f64,
        /// Vertical position of the pointer, as a fraction of the display's height, downwards.
        y: f64,
    },
    Drawn {
        /// Sequence number of the event that was drawn.
        cue: u64,
        /// Time of the drawing, in milliseconds on the server's clock.
        at: f64,
    },
    /// Whether the browser can speak the session's language, where the session wants that.
    Voice {
        there: bool,
    },
    Redrawn {
        /// Time from the press until its effect was drawn, in milliseconds.
        took: f64,
    },
    #[serde(untagged)]
    Reply(ParticipantResponse),
}

/// A message to the participant's page.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(super) enum MessageToPage<'a> {
    Words {
        words: &'a BTreeMap<String, String>,
    },
    /// The static scene (layout of the kitchen on the display).
    Scene {
        scene: &'a DisplayScene,
    },
    /// What the display shows now; during a probe, or with the trial's clock, also with the seconds that are left, and
    /// the time on the server's clock at which they were left.
    Sight {
        sight: &'a DisplayContent,
        #[serde(skip_serializing_if = "Option::is_none")]
        at: Option<f64>,
        #[serde(skip_serializing_if = "Option::is_none")]
        left_s: Option<f64>,
    },
    Robot {
        robot: &'a RobotHandPose,
    },
    /// Role of the page: taking part, watching while another page takes part, or watching while it could take part.
    Role {
        acts: bool,
        free: bool,
    },
}

impl PageMessage for MessageFromPage {
    fn read(text: &str) -> Option<MessageFromPage> {
        read(text)
    }

    fn hello(&self) -> Option<(&str, Option<&str>)> {
        match self {
            MessageFromPage::Hello { page, code, .. } => Some((page, code.as_deref())),
            _ => None,
        }
    }

    fn ping(&self) -> Option<(f64, bool)> {
        match self {
            MessageFromPage::Ping { t, hidden, .. } => Some((*t, *hidden)),
            _ => None,
        }
    }
}

/// Parses a message of the page; `None` if the message is malformed.
pub fn read(text: &str) -> Option<MessageFromPage> {
    let message: MessageFromPage = serde_json::from_str(text).ok()?;
    let is_time = |ms: &f64| ms.is_finite() && ms.abs() < 1e13;
    let is_size = |width: u32, height: u32| (1..=MAX_PIXELS).contains(&width) && (1..=MAX_PIXELS).contains(&height);
    let is_fine = match &message {
        MessageFromPage::Hello { page, width, height, code, .. } => {
            is_text(page) && is_size(*width, *height) && code.as_ref().is_none_or(|code| code.len() <= MAX_TEXT)
        }
        MessageFromPage::Ping { t, took, .. } => is_time(t) && took.is_none_or(|took| (0.0..1e6).contains(&took)),
        MessageFromPage::Press { button, at, .. } => is_text(button) && is_time(at),
        MessageFromPage::Pointer { x, y } => (-1.0..=2.0).contains(x) && (-1.0..=2.0).contains(y),
        MessageFromPage::Reply(reply) => is_reply(reply),
        MessageFromPage::Drawn { at, .. } => is_time(at),
        MessageFromPage::Redrawn { took } => (0.0..1e6).contains(took),
        MessageFromPage::Size { width, height, .. } => is_size(*width, *height),
        MessageFromPage::TakePart | MessageFromPage::Voice { .. } => true,
    };
    is_fine.then_some(message)
}

/// Whether a text can be a name: not empty, short, and without control characters.
fn is_text(text: &str) -> bool {
    !text.is_empty() && text.len() <= MAX_TEXT && !text.chars().any(char::is_control)
}

/// Whether a participant's reply has plausible lengths, names and numbers.
fn is_reply(reply: &ParticipantResponse) -> bool {
    match reply {
        ParticipantResponse::Answer { item, answer } => is_text(item) && answer.as_ref().is_none_or(is_answer),
        ParticipantResponse::Back { item: name }
        | ParticipantResponse::Turn { step: name, .. }
        | ParticipantResponse::Choose { step: name, .. }
        | ParticipantResponse::CardsShown { step: name } => is_text(name),
        ParticipantResponse::Believe { choice, sure, .. } => {
            *choice != Some(0) && sure.is_none_or(|sure| (1..=3).contains(&sure))
        }
        ParticipantResponse::Next
        | ParticipantResponse::Hold { .. }
        | ParticipantResponse::Consent
        | ParticipantResponse::Decline
        | ParticipantResponse::Confirm => true,
    }
}

/// Whether an answer is short enough to be handled. The session decides whether the answer fits its questionnaire item.
fn is_answer(answer: &AnswerValue) -> bool {
    let is_short = |text: &String| text.chars().count() <= MAX_ANSWER && !text.chars().any(char::is_control);
    match answer {
        AnswerValue::Number(_) => true,
        AnswerValue::Text(text) => is_short(text),
        AnswerValue::Options(options) => options.len() <= 9 && options.iter().all(is_short),
    }
}

/// An input to the session from the participant page that takes part.
#[derive(Clone, Debug, PartialEq)]
pub enum PageInput {
    Connected {
        width_px: u32,
        height_px: u32,
    },
    Lost {
        /// When the page was last heard of.
        since: Instant,
    },
    Press {
        button: String,
        at: Instant,
    },
    Pointer {
        /// Horizontal position of the pointer, as a fraction of the display's width.
        x: f64,
        /// Vertical position of the pointer, as a fraction of the display's height, downwards.
        y: f64,
    },
    Reply(ParticipantResponse),
    Drawn {
        /// Sequence number of the event that was drawn.
        cue: u64,
        /// Time of the drawing, on this computer's clock.
        at: Instant,
    },
}

/// What the participant does on the page apart from the task: consents, answers a questionnaire or a freeze probe,
/// reads the tutorial.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum ParticipantResponse {
    Answer {
        item: String,
        /// The answer to the questionnaire item; `None` leaves the item unanswered.
        answer: Option<AnswerValue>,
    },
    Next,
    Back {
        item: String,
    },
    Hold {
        held: bool,
    },
    /// Consent of the participant, who held the consent button for as long as the page asks. It counts if the program
    /// was told of the hold, and it lasted that long.
    Consent,
    /// The participant does not consent, which the wizard is told.
    Decline,
    Confirm,
    Turn {
        step: String,
        /// Whether the participant turns to the next tutorial step; false: to the previous one.
        forward: bool,
    },
    Choose {
        step: String,
        /// Number of the chosen answer to the tutorial's question, counted from 1.
        choice: u8,
    },
    CardsShown {
        step: String,
    },
    /// Answer to a freeze probe's question: a choice; without one, "I don't know".
    Believe {
        probe: u32,
        /// Number of the question in the freeze probe, counted from 1.
        question: u32,
        /// Number of the chosen answer to the probe's question, counted from 1.
        choice: Option<u16>,
        /// How sure the participant is of the answer, from 1 to 3; `None` if that is not asked.
        sure: Option<u8>,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_message_is_refused() {
        assert!(read(r#"{"kind": "press", "number": 1, "button": "cut", "at": 12.5}"#).is_some());
        assert!(read(r#"{"kind": "confirm"}"#).is_some());
        assert!(read(r#"{"kind": "size", "width": 1170, "height": 2532, "upright": true}"#).is_some());
        assert!(read(r#"{"kind": "answer", "item": "age", "answer": 31}"#).is_some());
        assert!(read(r#"{"kind": "answer", "item": "remarks", "answer": "Too fast."}"#).is_some());
        assert!(read(r#"{"kind": "answer", "item": "aids", "answer": ["glasses"]}"#).is_some());
        let belief = r#"{"kind": "believe", "probe": 1, "question": 2, "choice": 12, "sure": 3}"#;
        assert!(read(belief).is_some());
        for wrong in [
            "",
            "nonsense",
            "[]",
            r#"{"kind": "press"}"#,
            r#"{"kind": "press", "number": -1, "button": "cut", "at": 1}"#,
            r#"{"kind": "press", "number": 1, "button": "", "at": 1}"#,
            r#"{"kind": "press", "number": 1, "button": "cut", "at": 1e300}"#,
            r#"{"kind": "press", "number": 1, "button": "cut", "at": 1, "agent": "robot"}"#,
            r#"{"kind": "trial_ended", "reason": "time"}"#,
            r#"{"kind": "answer", "item": "age", "answer": 31.5}"#,
            r#"{"kind": "answer", "item": "remarks", "answer": "two\nlines"}"#,
            r#"{"kind": "answer", "item": "aids", "answer": {"glasses": true}}"#,
            r#"{"kind": "believe", "probe": 1, "question": 1, "choice": 0, "sure": null}"#,
            r#"{"kind": "believe", "probe": 1, "question": 1, "choice": 1, "sure": 4}"#,
            r#"{"kind": "believe", "probe": -1, "question": 1, "choice": 1, "sure": null}"#,
            r#"{"kind": "believe", "probe": 1, "question": 1, "choice": 1, "sure": null, "right": true}"#,
            r#"{"kind": "pointer", "x": 1e9, "y": 0}"#,
            r#"{"kind": "hello", "page": "a", "width": 0, "height": 1, "code": null}"#,
            r#"{"kind": "size", "width": 1920, "height": 200000}"#,
        ] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }
}
