//! Content of the participant's display while the participant is asked for consent.

use super::displayed_item::{DisplayedAnswerForm, DisplayedQuestionnaireItem};
use super::page_language::DisplayWords;
use super::sight::{DisplayContent, DisplayStage, sight};
use crate::session::Session;

/// Time for which the participant holds the consent button, in seconds; long enough to rule out accidental touches.
const HOLD_S: f64 = 3.0;

/// The display's content while the participant is asked to consent to this text, before anything is recorded.
pub fn consent_sight(session: &Session, text: &str) -> DisplayContent {
    let words = DisplayWords::for_display(&session.spec.display);
    let question = DisplayedQuestionnaireItem {
        title: words.of_name("consent title"),
        item: Some("consent".to_string()),
        text: text.to_string(),
        number: 1,
        of: 1,
        form: Some(DisplayedAnswerForm::Consent { hold_s: HOLD_S }),
        answer: None,
        before: None,
        given: Vec::new(),
    };
    DisplayContent { stage: DisplayStage::Questionnaire, question: Some(question), ..sight(session) }
}
