//! Panels of the console: which has the focus, which is shown alone at full size, scrolling back in time, and what the log records of them.
//! Neither affects the participant.

use super::actions::differ;
use super::beliefs::{BeliefCorrectness, beliefs, visibility};
use super::console_model::{ComparisonAction, ConsoleModel, Dialog};
use super::form::sheet;
use super::key_action::ViewAction;
use super::lists::{PickerKind, ReasonFor};
use super::text_columns::wrap;
use super::view::help::help_pages;
use super::view::regions::{LEAST, PanelAreas, ScreenSize};
use tomcom_session::Session;
use tomcom_session::event::WizardScreenContent;
use tomcom_session::settings::WizardVisibility;

/// One scroll step: seconds in the timeline, entries in the list of events.
const STEP: (u32, usize) = (5, 1);

/// Carries out a key that changes which panels or which time the screen shows.
pub fn look(model: &mut ConsoleModel, session: &Session, look: ViewAction) {
    match look {
        ViewAction::All => {
            (model.alone, model.focus, model.events_back, model.timeline_back_s) = (None, None, 0, 0);
            (model.belief_focus, model.beliefs_from) = (None, 0);
            if let Some(coding) = &mut model.coding {
                coding.chosen = None;
            }
        }
        ViewAction::Next => step(model, session, true),
        ViewAction::Last => step(model, session, false),
        ViewAction::Open if opens_difference(model) => differ(model, session, ComparisonAction::Open),
        ViewAction::Open if let Some(words) = cut_landmark(model, session) => {
            let lines = words.split("; ").map(str::to_string).collect();
            model.dialog = Some(Dialog::Details("Where the recording stands", lines));
        }
        ViewAction::Open => {
            model.alone = match model.alone {
                Some(_) => None,
                None => model.focus.or(focusable(model, session).first().copied()),
            };
            model.focus = model.alone.or(model.focus);
        }
        ViewAction::Back => scroll(model, session, model.alone.or(model.focus), 1),
        ViewAction::Forward => scroll(model, session, model.alone.or(model.focus), -1),
        ViewAction::Earlier => scroll(model, session, Some(Panel::Timeline), 1),
        ViewAction::Later => scroll(model, session, Some(Panel::Timeline), -1),
    }
}

/// Whether a panel is at full size, or an earlier time shown: what the key of one step back undoes.
pub(super) fn is_away(model: &ConsoleModel) -> bool {
    let has_chosen = model.coding.as_ref().is_some_and(|coding| coding.chosen.is_some());
    model.alone.is_some()
        || model.focus.is_some()
        || model.events_back > 0
        || model.beliefs_from > 0
        || model.timeline_back_s > 0
        || has_chosen
}

/// Whether the key that opens a panel opens the selected difference of a comparison: while no other panel has the focus.
pub(super) fn opens_difference(model: &ConsoleModel) -> bool {
    model.comparison.is_some() && matches!((model.alone, model.focus), (Some(Panel::Comparison), _) | (None, None))
}

/// The words of the landmark or event at which a replay stands, if the line of messages is too short for them: while no
/// panel has the focus, the key that opens a panel shows all of them.
pub(super) fn cut_landmark<'a>(model: &'a ConsoleModel, session: &Session) -> Option<&'a str> {
    let (_, words) = model.playback.as_ref()?.stands_at()?;
    let is_free = model.alone.is_none() && model.focus.is_none() && model.comparison.is_none();
    let area = PanelAreas::showing(model.size, session, model).message;
    let is_cut = wrap(words, area.width.saturating_sub(3)).len() > usize::from(area.height);
    (is_free && is_cut).then_some(words)
}

/// The panels that can get the focus: those on the screen or, while one is shown alone, all that may be seen.
fn focusable(model: &ConsoleModel, session: &Session) -> Vec<Panel> {
    let visibility = visibility(session, model);
    let regions = PanelAreas::showing(model.size, session, model);
    let is_there = |panel: &Panel| model.alone.is_some() || regions.panel_area(*panel).area() > 0;
    let may_be_seen = |panel: &Panel| panel.may_be_seen(visibility, model.comparison.is_some());
    Panel::ALL.into_iter().filter(may_be_seen).filter(is_there).collect()
}

/// Gives the focus to the next or the previous panel. At full size that panel is shown instead; after the last one, all
/// panels are.
fn step(model: &mut ConsoleModel, session: &Session, is_forward: bool) {
    let panels = focusable(model, session);
    let at = model.alone.or(model.focus).and_then(|focus| panels.iter().position(|panel| *panel == focus));
    let to = match (at, is_forward) {
        (None, true) => Some(0),
        (None, false) => panels.len().checked_sub(1),
        (Some(at), true) => Some(at + 1),
        (Some(at), false) => at.checked_sub(1),
    };
    model.focus = to.and_then(|to| panels.get(to)).copied();
    if model.alone.is_some() {
        model.alone = model.focus;
    }
}

pub fn leaf(model: &mut ConsoleModel, look: ViewAction) {
    let is_forward = matches!(look, ViewAction::Next | ViewAction::Forward | ViewAction::Later);
    model.help_from = match is_forward {
        true => (model.help_from + 1).min(help_pages(model)),
        false => model.help_from.saturating_sub(1),
    };
}

/// Scrolls a panel that has a time axis, the beliefs, or else the list of events if it is visible.
pub(super) fn scroll(model: &mut ConsoleModel, session: &Session, panel: Option<Panel>, steps: i64) {
    if matches!(panel, Some(Panel::Timeline | Panel::Comparison)) {
        let back_s = i64::from(model.timeline_back_s) + steps * i64::from(STEP.0);
        let most_s = model.now.secs_since(session.trial_start).max(0.0) as i64;
        model.timeline_back_s = back_s.clamp(0, most_s) as u32;
    } else if panel == Some(Panel::Belief) {
        let told = beliefs(session, model).iter().filter(|belief| belief.standing != BeliefCorrectness::Right).count();
        let from = model.beliefs_from as i64 - steps;
        model.beliefs_from = from.clamp(0, told.saturating_sub(1) as i64) as usize;
    } else if matches!(model.alone, None | Some(Panel::Events | Panel::Presses)) {
        let back = model.events_back as i64 + steps * STEP.1 as i64;
        model.events_back = back.clamp(0, session.timeline.len().saturating_sub(1) as i64) as usize;
    }
}

/// A panel of the console that can be shown alone at full size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panel {
    Orders,
    Kitchen,
    Belief,
    /// The last presses, with the reasons of errors.
    Presses,
    Recommendation,
    /// Map of the places where the participant looked lately; shown at full size only.
    GazeMap,
    Events,
    Timeline,
    Comparison,
}

impl Panel {
    /// All panels, in the order in which the keys go through them.
    pub(super) const ALL: [Panel; 9] = [
        Panel::Comparison,
        Panel::Orders,
        Panel::Kitchen,
        Panel::Belief,
        Panel::Presses,
        Panel::Recommendation,
        Panel::GazeMap,
        Panel::Events,
        Panel::Timeline,
    ];

    pub(super) fn may_be_seen(self, visibility: WizardVisibility, compares: bool) -> bool {
        match self {
            Panel::Comparison => compares,
            Panel::Belief => visibility >= WizardVisibility::Belief,
            Panel::Recommendation => visibility >= WizardVisibility::Recommendation,
            _ => true,
        }
    }
}

/// What the wizard's screen shows now: its panels and the open dialog or sheet.
pub fn screen(session: &Session, model: &ConsoleModel) -> WizardScreenContent {
    let visibility = visibility(session, model);
    let fits = model.size.0 >= LEAST.0 && model.size.1 >= LEAST.1;
    let regions = PanelAreas::showing(model.size, session, model);
    let room = match regions.screen_size {
        _ if !fits => "too_small",
        ScreenSize::Small => "small",
        ScreenSize::Medium => "medium",
        ScreenSize::Large => "large",
    };
    let dialog = model.dialog.as_ref().map(name);
    let sheet = sheet(session).map(|sheet| sheet.name());
    let panels = if fits { regions.panels() } else { Vec::new() };
    WizardScreenContent {
        visibility,
        room: room.to_string(),
        panels: panels.into_iter().map(str::to_string).collect(),
        dialog: dialog.or(sheet).map(str::to_string),
    }
}

fn name(dialog: &Dialog) -> &'static str {
    match dialog {
        Dialog::Help(_) => "help",
        Dialog::Quit => "quit",
        Dialog::EndTrial => "end_trial",
        Dialog::EndTutorial => "end_tutorial",
        Dialog::Palette(_) => "palette",
        Dialog::Send(_) => "send_signal",
        Dialog::Preflight => "preflight",
        Dialog::Calibration => "calibration",
        Dialog::Note(_) => "note",
        Dialog::Reason(..) => "reason",
        Dialog::Answer(_) => "answer",
        Dialog::Details(..) => "difference",
        Dialog::Report(_) => "report",
        Dialog::Pick(list) => match list.kind {
            PickerKind::Place => "correct_place",
            PickerKind::Content(_) => "correct_content",
            PickerKind::Button => "drive_robot",
            PickerKind::Reason(ReasonFor::Abort) => "abort_trial",
            PickerKind::Reason(ReasonFor::Exclude) => "exclude_trial",
            PickerKind::Reason(ReasonFor::SkipProbe(_)) => "skip_probe",
            PickerKind::Reason(ReasonFor::Waive) => "waive_criterion",
        },
    }
}
