//! A list from which the wizard chooses the answer to a question: which place, which content, which press, which
//! reason. Its keys are those of every list ([`super::list_cursor`]).

use crossterm::event::KeyCode;

use super::list_cursor::{ListCursor, ListReply};
use tomcom_core::kitchen::{Agent, ButtonId, ContentId, LocationId, LocationKind};
use tomcom_session::Session;
use tomcom_session::history::wording;

/// Question that a list of answers asks the wizard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PickerQuestion {
    /// Which location has another content than the program assumes?
    Place,
    /// What is the content of this location?
    Content(LocationId),
    /// Which button shall the robot press next?
    Button,
    /// Why is the trial aborted?
    Abort,
    /// Why is the trial excluded from the analysis?
    Exclude,
    /// Why are the remaining questions of the freeze probe with this number skipped?
    SkipProbe(u32),
}

/// Answer that the wizard chose from a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PickerAnswer {
    /// Location whose content is to be corrected.
    Place(LocationId),
    /// True content of the location.
    Content(ContentId),
    /// Button that the robot shall press next.
    Button(ButtonId),
    /// Reason for aborting or excluding the trial, or for skipping the probe.
    Reason(String),
}

/// An entry of a list from which the wizard chooses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PickerEntry {
    /// Answer that choosing the entry gives.
    pub answer: PickerAnswer,
    /// Text of the entry, which is shown and searched.
    pub label: String,
    /// Further information, shown at the right of the entry.
    pub remark: String,
}

/// An open list from which the wizard chooses the answer to a question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picker {
    /// Question that the list asks the wizard.
    pub question: PickerQuestion,
    /// Filter and cursor of the list.
    pub cursor: ListCursor,
}

/// Result of a key in a list of answers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PickerOutcome {
    /// The list stays open.
    Nothing,
    /// The list was closed without an answer.
    Left,
    /// The wizard chose this answer from the list.
    This(PickerAnswer),
}

impl Picker {
    /// An open list without a filter, with the cursor on the first entry.
    pub fn new(question: PickerQuestion) -> Picker {
        Picker { question, cursor: ListCursor::default() }
    }

    /// The list's question in words.
    pub fn title(&self, session: &Session) -> String {
        match self.question {
            PickerQuestion::Place => "Correct the kitchen: which place?".to_string(),
            PickerQuestion::Content(place) => format!("What is really at {}?", session.kitchen.location(place).label()),
            PickerQuestion::Button => "The robot's next press".to_string(),
            PickerQuestion::Abort => "Abort the trial: why?".to_string(),
            PickerQuestion::Exclude => "Exclude the trial from the analysis: why?".to_string(),
            PickerQuestion::SkipProbe(probe) => format!("Skip the rest of probe {probe}: why?"),
        }
    }

    /// Entries of the list that match the filter.
    pub fn choices(&self, session: &Session) -> Vec<PickerEntry> {
        let mut choices = self.all(session);
        choices.retain(|choice| self.cursor.keeps(&choice.label));
        choices
    }

    fn all(&self, session: &Session) -> Vec<PickerEntry> {
        match self.question {
            PickerQuestion::Place => places(session),
            PickerQuestion::Content(place) => contents(session, place),
            PickerQuestion::Button => buttons(session),
            PickerQuestion::Abort | PickerQuestion::Exclude | PickerQuestion::SkipProbe(_) => reasons(session),
        }
    }

    /// Handles a key in the open list of answers.
    pub fn key(&mut self, session: &Session, code: KeyCode) -> PickerOutcome {
        let mut choices = self.choices(session);
        match self.cursor.key(choices.len(), code) {
            ListReply::Open => PickerOutcome::Nothing,
            ListReply::Left => PickerOutcome::Left,
            ListReply::Taken => PickerOutcome::This(choices.swap_remove(self.cursor.at).answer),
        }
    }
}

fn places(session: &Session) -> Vec<PickerEntry> {
    let kitchen = &session.kitchen;
    let places = kitchen.locations.iter().enumerate().filter(|(_, location)| location.kind != LocationKind::Order);
    let choice = |(index, location): (usize, &tomcom_core::kitchen::Location)| {
        let id = LocationId(index as u8);
        let remark = kitchen.content_label(session.state, id).to_string();
        PickerEntry { answer: PickerAnswer::Place(id), label: location.label().to_string(), remark }
    };
    places.map(choice).collect()
}

/// Contents that the location can have, except the one that the program assumes.
fn contents(session: &Session, place: LocationId) -> Vec<PickerEntry> {
    let kitchen = &session.kitchen;
    let can_be = |id: ContentId| id.is_empty() || kitchen.accepts(place, id);
    let ids = (0..kitchen.contents.len()).map(|index| ContentId(index as u8));
    let left = ids.filter(|&id| can_be(id) && id != session.state.content(place));
    let choice = |id: ContentId| {
        let label = kitchen.content(id).wording.clone();
        PickerEntry { answer: PickerAnswer::Content(id), label, remark: String::new() }
    };
    left.map(choice).collect()
}

fn buttons(session: &Session) -> Vec<PickerEntry> {
    let (kitchen, recipes) = (&session.kitchen, session.kitchen.true_recipes());
    let ids = (0..kitchen.buttons[Agent::Robot.index()].len()).map(|index| ButtonId(index as u8));
    let choice = |id: ButtonId| {
        let does = kitchen.press(session.state, &recipes, Agent::Robot, id).is_some();
        let remark = if does { "" } else { "press has no effect now" }.to_string();
        PickerEntry { answer: PickerAnswer::Button(id), label: wording::button(kitchen, Agent::Robot, id), remark }
    };
    let mut choices: Vec<PickerEntry> = ids.map(choice).collect();
    // Buttons that have an effect now come first.
    choices.sort_by_key(|choice| !choice.remark.is_empty());
    choices
}

fn reasons(session: &Session) -> Vec<PickerEntry> {
    let choice = |reason: &String| PickerEntry {
        answer: PickerAnswer::Reason(reason.clone()),
        label: reason.clone(),
        remark: String::new(),
    };
    session.spec.console.reasons.iter().map(choice).collect()
}
