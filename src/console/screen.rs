//! What the wizard's screen shows, as recorded in the log.

use super::beliefs::visibility;
use super::console_model::{ConsoleModel, Dialog};
use super::form::sheet;
use super::picker::PickerQuestion;
use super::view::regions::{LEAST, PanelAreas, ScreenSize};
use tomcom_session::Session;
use tomcom_session::event::WizardScreenContent;

/// What the wizard's screen shows now: its panels and the open dialog or sheet.
pub fn screen(session: &Session, model: &ConsoleModel) -> WizardScreenContent {
    let visibility = visibility(session, model);
    let fits = model.size.0 >= LEAST.0 && model.size.1 >= LEAST.1;
    let regions = PanelAreas::showing(model.size, session, model);
    let room = match regions.room {
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
        Dialog::Palette(_) => "palette",
        Dialog::Send(_) => "send_signal",
        Dialog::Preflight => "preflight",
        Dialog::Calibration => "calibration",
        Dialog::Note(_) => "note",
        Dialog::Answer(_) => "answer",
        Dialog::Difference(_) => "difference",
        Dialog::Report(_) => "report",
        Dialog::Pick(list) => match list.question {
            PickerQuestion::Place => "correct_place",
            PickerQuestion::Content(_) => "correct_content",
            PickerQuestion::Button => "drive_robot",
            PickerQuestion::Abort => "abort_trial",
            PickerQuestion::Exclude => "exclude_trial",
            PickerQuestion::SkipProbe(_) => "skip_probe",
        },
    }
}
