//! Consent on the participant's display: what the display shows, and whether the consent button was held long enough.

use super::content::{DisplayContent, DisplayStage, sight};
use super::displayed_item::{DisplayedAnswerForm, DisplayedQuestionnaireItem};
use super::page_language::DisplayWords;
use tomcom_core::base::time::SessionTime;
use tomcom_session::Session;

/// Time for which the participant holds the consent button, in seconds; long enough to rule out accidental touches.
const HOLD_S: f64 = 3.0;
/// Time by which a page can say too early that the button was held, in seconds: its first message can be late.
const EARLY_S: f64 = 0.25;

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
        skipped: false,
        before: None,
        given: Vec::new(),
    };
    DisplayContent { stage: DisplayStage::Questionnaire, question: Some(question), ..sight(session) }
}

/// The consent button of the participant's page, as the page tells of it. Consent counts once the program has seen the
/// button held for the whole time by its own clock, whatever the page says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ConsentHold {
    /// Time since which the button is held.
    since: Option<SessionTime>,
    is_told: bool,
}

impl ConsentHold {
    /// The button is pressed or released.
    pub fn hold(&mut self, held: bool, now: SessionTime) {
        if !self.is_told {
            self.since = self.since.or(Some(now)).filter(|_| held);
        }
    }

    /// The page says that the participant consented. Returns false, and forgets the hold, if the button was not held for
    /// about that long.
    pub fn tell(&mut self, now: SessionTime) -> bool {
        self.is_told = self.since.is_some_and(|since| now.secs_since(since) >= HOLD_S - EARLY_S);
        self.since = self.since.filter(|_| self.is_told);
        self.is_told
    }

    /// Whether the participant has consented: the page says so, and the button was held for the whole time.
    pub fn is_given(&self, now: SessionTime) -> bool {
        self.is_told && self.since.is_some_and(|since| now.secs_since(since) >= HOLD_S)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consent_needs_the_whole_hold_by_the_programs_clock() {
        let at = SessionTime::from_secs_f64;
        let mut button = ConsentHold::default();
        assert!(!button.tell(at(9.0)) && !button.is_given(at(99.0)), "without a hold");
        button.hold(true, at(10.0));
        assert!(!button.tell(at(12.0)) && !button.is_given(at(13.1)), "too early, and the hold is forgotten");
        button.hold(true, at(20.0));
        button.hold(false, at(22.0));
        button.hold(true, at(22.5));
        assert!(!button.tell(at(23.1)), "an interrupted hold begins anew");
        button.hold(true, at(30.0));
        button.hold(true, at(31.0));
        assert!(!button.is_given(at(34.0)), "the page has to say it");
        assert!(button.tell(at(33.0)) && button.is_given(at(33.0)));
        // The first message was late: the last moments are waited for, also if the button is released in them.
        let mut late = ConsentHold::default();
        late.hold(true, at(40.2));
        assert!(late.tell(at(43.0)) && !late.is_given(at(43.0)));
        late.hold(false, at(43.1));
        assert!(late.is_given(at(43.2)));
    }
}
