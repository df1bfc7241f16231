//! Summary cards before and after a trial: whether everything is ready and how to start; the trial's results and the
//! next step.

use ratatui::layout::Rect;

use super::dialog::open;
use super::footer::{onward, repeats};
use super::head;
use super::paint::Painter;
use super::regions::PanelAreas;
use super::theme::TextRole;
use crate::console::chord::KeyChord;
use crate::console::console_model::ConsoleModel;
use crate::console::form::sheet;
use crate::console::key_action::{KeyAction, KeyLayer, ManualAction};
use crate::console::preflight::{ParticipantDisplayHealth, is_wanted};
use crate::console::text_columns::{width, wrap};
use tomcom_core::base::text::count;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Sender;
use tomcom_core::kitchen::{Agent, Dish};
use tomcom_core::robot::SafetyMode;
use tomcom_session::event::Event;
use tomcom_session::history::{event_words, wording};
use tomcom_session::settings::{Condition, GazeSource};
use tomcom_session::{Session, TimelineEvent, TrialPhase};

/// Width of a card, and least width of the names in its left column.
const COLUMNS: u16 = 76;
const NAMES: u16 = 15;
/// Columns between two keys.
const GAP: u16 = 3;

/// A line of a summary card: name, text, and the text's style.
type Fact = (String, String, TextRole);

fn fact(name: &str, text: String, role: TextRole) -> Fact {
    (name.to_string(), text, role)
}

/// A summary card: named facts, and the keys for the next step.
struct Card {
    title: String,
    facts: Vec<Fact>,
    keys: Vec<(KeyChord, String)>,
}

/// Draws the card of the trial's start or end, unless a dialog or sheet covers the console.
pub fn draw(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    // The results of a trial are shown even while a single panel is at full size.
    let is_alone = model.alone.is_some() && !matches!(session.phase, TrialPhase::Over(_));
    let is_covered = model.dialog.is_some() || is_alone || sheet(session).is_some();
    let has_trial = session.study_phase().is_none_or(|phase| phase.phase().has_trial());
    if is_covered || !has_trial || model.playback.is_some() || model.lesson.is_some() || session.is_calibrating() {
        return;
    }
    let card = match session.phase {
        TrialPhase::Ready => before(session, model),
        TrialPhase::Paused if model.layer == KeyLayer::Participant => recipes(session, model),
        TrialPhase::Over(_) => after(session, model),
        _ => return,
    };
    card.draw(brush, regions.middle());
}

/// The trial's position in the study, and its condition: "P07, trial 2/2, wizard".
fn place(session: &Session) -> String {
    let step = session.step().map_or(String::new(), |(step, _)| format!(", {}", step.label()));
    format!("{}{step}, {}", session.spec.participant.code, head::condition(session))
}

/// Who plays, in the largest letters that a terminal has.
fn who_plays(session: &Session) -> String {
    let who = session.spec.participant.kind.words().to_uppercase();
    who.chars().flat_map(|letter| [letter, ' ']).collect::<String>().trim_end().to_string()
}

fn before(session: &Session, model: &ConsoleModel) -> Card {
    let trial = &session.spec.trial;
    let orders = trial.orders.map(|orders| count(u64::from(orders), "served order", "served orders"));
    let presses = count(trial.presses, "press", "presses");
    let counts = orders.into_iter().chain([presses]).collect::<Vec<_>>().join(", ");
    let length = format!("ends after {counts} or {}", SessionTime::from_secs_f64(trial.seconds));
    let mut facts =
        vec![fact("", who_plays(session), TextRole::Strong), fact("participant", place(session), TextRole::Strong)];
    facts.extend(missing_page(session, model));
    facts.extend(model.participants_done.map(|(done, all)| {
        fact("study", format!("{done} of {} done", count(all as u64, "participant", "participants")), TextRole::Text)
    }));
    facts.extend([
        fact("kitchen", session.kitchen.title.clone(), TextRole::Text),
        fact("trial length", length, TextRole::Text),
    ]);
    for (index, (text, role)) in head::healths(session, model).into_iter().enumerate() {
        let name = if index == 0 { "devices" } else { "" };
        facts.push(fact(name, text.trim().to_string(), role));
    }
    // The card covers the gaze's panel, and who starts the sender needs the code.
    let pairing = model.gaze_pairing.as_ref().and_then(|pairing| pairing.line(session, model.now));
    facts.extend(pairing.map(|code| fact("gaze sender", code, TextRole::Strong)));
    let mut keys = Vec::new();
    keys.extend(model.keys.chord_for(&KeyAction::Advance).map(|key| (key, "start the trial".to_string())));
    let preflight = KeyAction::Manual(ManualAction::Preflight);
    keys.extend(model.keys.chord_for(&preflight).map(|key| (key, "show all preflight checks".to_string())));
    let is_tracked = matches!(session.spec.participant.gaze, GazeSource::Json | GazeSource::Lsl | GazeSource::Pupil);
    let is_open = session.calibrated.is_none() && is_tracked;
    let check = model.keys.chord_for(&KeyAction::Manual(ManualAction::Calibrate)).filter(|_| is_open);
    keys.extend(check.map(|key| (key, "check the accuracy of gaze, which is not checked yet".to_string())));
    Card { title: "Ready to start".to_string(), facts, keys }
}

/// Line of a card with what is to be opened while the participant's page is wanted and none is connected.
fn missing_page(session: &Session, model: &ConsoleModel) -> Option<Fact> {
    let display = model.display.as_ref().filter(|_| is_wanted(session));
    display.and_then(ParticipantDisplayHealth::missing).map(|missing| fact("display", missing, TextRole::Alarm))
}

/// Card with the recipes of all dishes during a pause, for the person who plays the participant at this keyboard. As in
/// a study, the recipes have to be remembered while the trial runs.
fn recipes(session: &Session, model: &ConsoleModel) -> Card {
    let kitchen = &session.kitchen;
    let recipe = |dish: &Dish| (dish.name.clone(), wording::dish(kitchen, dish), TextRole::Text);
    let on = model.keys.chord_for(&KeyAction::Advance).map(|key| (key, "resume the trial".to_string()));
    Card {
        title: "Trial paused: the recipes of all dishes".to_string(),
        facts: kitchen.dishes.iter().map(recipe).collect(),
        keys: on.into_iter().collect(),
    }
}

fn after(session: &Session, model: &ConsoleModel) -> Card {
    let [human, robot] = [Agent::Human, Agent::Robot].map(|agent| session.presses[agent.index()]);
    let errors = model.errors.len() as u64;
    let share = 100.0 * errors as f64 / f64::from(human.max(1));
    let unproven = match model.unproven {
        0 => String::new(),
        unproven => format!(", {unproven} not proven"),
    };
    let presses = count(u64::from(human), "press", "presses");
    let errors = format!("{errors} in {presses} of the human ({share:.0} %){unproven}");
    let clock = session.trial_clock(model.now);
    let paused = if session.paused_total > SessionTime::ZERO {
        format!(", plus {} of pauses", session.paused_total)
    } else {
        String::new()
    };
    let mut facts = vec![fact("participant", place(session), TextRole::Strong)];
    facts.extend(left_out(session, model));
    facts.extend(missing_page(session, model));
    facts.extend([
        fact("orders", format!("{} served", session.served.len()), TextRole::Text),
        fact("presses", format!("{human} by the human, {robot} by the robot"), TextRole::Text),
        fact("errors", errors, TextRole::Text),
    ]);
    facts.extend(signals(session, model));
    facts.extend(stops(session));
    facts.push(fact("time", format!("{clock}{paused}"), TextRole::Text));
    if let Some(practice) = session.protocol.as_ref().and_then(|protocol| protocol.practice.as_ref()) {
        let met = if practice.met { "met" } else { "not met, waived" };
        facts.push(fact("criterion", met.to_string(), TextRole::Strong));
    }
    if !session.open_marks.is_empty() {
        let clocks: Vec<String> =
            session.open_marks.iter().map(|(_, at)| session.trial_clock_at(*at).to_string()).collect();
        facts.push(fact("time marks", format!("without words at {}", clocks.join(", ")), TextRole::Strong));
    }
    let mut keys = Vec::new();
    let on = onward(session, model);
    keys.extend(on.and_then(|on| Some((model.keys.chord_for(&KeyAction::Advance)?, on))));
    let repeat =
        repeats(session).filter(|action| *action != KeyAction::Advance).map(|action| (action, "repeat the trial"));
    let exclude = KeyAction::Manual(ManualAction::Exclude);
    // An aborted trial is left out already.
    let exclude = match (&session.excluded, &session.aborted) {
        (Some(_), _) => Some((exclude, "include it again")),
        (None, Some(_)) => None,
        (None, None) => Some((exclude, "exclude the trial")),
    };
    let note = if session.open_marks.is_empty() { "type note" } else { "word the time marks" };
    let note = (KeyAction::Manual(ManualAction::NoteInWords), note);
    for (action, words) in repeat.into_iter().chain([(KeyAction::Quit, "close the session"), note]).chain(exclude) {
        keys.extend(model.keys.chord_for(&action).map(|key| (key, words.to_string())));
    }
    Card { title: format!("Trial {}", event_words::trial(session.phase)), facts, keys }
}

/// Lines of the card about stops of an arm with joints, in ISO's words; the timed arm cannot touch anybody.
fn stops(session: &Session) -> Vec<Fact> {
    if !session.spec.robot.arm.has_joints() {
        return Vec::new();
    }
    let number = |is_it: &dyn Fn(&TimelineEvent) -> bool| {
        session.timeline.iter().filter(|entry| is_it(&entry.what)).count() as u64
    };
    let of_mode = |wanted| {
        number(&|what| matches!(what, TimelineEvent::Noted(Event::RobotSafety { mode, .. }) if *mode == wanted))
    };
    let protective = count(of_mode(SafetyMode::ProtectiveStop), "protective stop", "protective stops");
    let emergency = number(&|what| *what == TimelineEvent::Noted(Event::RobotStopped));
    let emergency = count(emergency, "emergency stop", "emergency stops");
    let mut facts = vec![fact("robot", format!("{protective}, {emergency}"), TextRole::Text)];
    let faults = of_mode(SafetyMode::Fault);
    if faults > 0 {
        facts.push(fact("", count(faults, "fault", "faults"), TextRole::Text));
    }
    facts
}

/// Lines of the card about signals: how many each sender sent, and how the study judges the wizard's, in the words of
/// `tomcom compare`. Of a person's beliefs nothing is known before raters have coded the errors.
fn signals(session: &Session, model: &ConsoleModel) -> Vec<Fact> {
    let mut facts: Vec<Fact> = Vec::new();
    for by in [Sender::Wizard, Sender::Assistant] {
        let (mut sent, mut back, mut last) = (0u64, 0u64, None);
        for entry in &session.timeline {
            match &entry.what {
                TimelineEvent::Noted(Event::SignalShown { by: sender, .. }) => {
                    last = Some(*sender);
                    sent += u64::from(*sender == by);
                }
                TimelineEvent::Noted(Event::SignalEnded { .. }) => back += u64::from(last == Some(by)),
                _ => {}
            }
        }
        if sent > 0 {
            let back = if back > 0 { format!(", {back} taken back") } else { String::new() };
            let sent = format!("{sent} by the {}{back}", wording::sender(by));
            facts.push(fact(if facts.is_empty() { "signals" } else { "" }, sent, TextRole::Text));
        }
    }
    if facts.is_empty() {
        facts.push(fact("signals", "none".to_string(), TextRole::Text));
    }
    if session.spec.trial.condition == Condition::Wizard {
        let judged = model.wizard.words().into_iter().flatten().map(|words| fact("", words, TextRole::Text));
        let each = fact("", "each signal's verdict: tomcom review RECORDING --signals".to_string(), TextRole::Quiet);
        facts.extend(judged.chain(Some(each).filter(|_| model.wizard.hits.is_some() && model.wizard.signals > 0)));
    }
    facts
}

/// Lines of the card about an abort or an exclusion: its reason, what follows from it, and the key that takes it back.
fn left_out(session: &Session, model: &ConsoleModel) -> Vec<Fact> {
    let mut facts = Vec::new();
    let mut told = |name: &str, reason: &String, action: Option<KeyAction>, does: &str| {
        facts.push(fact(name, reason.clone(), TextRole::Strong));
        let key = action.and_then(|action| model.keys.chord_for(&action));
        let key = key.map_or(String::new(), |key| format!("; {key} {does}"));
        facts.push(fact("", format!("left out of the analysis{key}"), TextRole::Text));
    };
    if let Some(reason) = &session.aborted {
        told("aborted", reason, repeats(session), "repeats the trial");
    }
    if let Some(reason) = &session.excluded {
        told("excluded", reason, Some(KeyAction::Manual(ManualAction::Exclude)), "includes it again");
    }
    facts
}

fn key_width(chord: KeyChord, words: &str) -> u16 {
    width(&chord.to_string()) + 1 + width(words)
}

impl Card {
    fn draw(&self, brush: &mut Painter, screen: Rect) {
        let names = self.facts.iter().map(|(name, ..)| width(name) + 2).max().unwrap_or(0).max(NAMES);
        let columns = COLUMNS.min(screen.width);
        let room = columns.saturating_sub(names + 5);
        let facts: Vec<(&str, String, TextRole)> = self
            .facts
            .iter()
            .flat_map(|(name, text, role)| {
                let names = std::iter::once(name.as_str()).chain(std::iter::repeat(""));
                // Wrapping would close up the spaced letters of who plays.
                let lines = if width(text) <= room { vec![text.clone()] } else { wrap(text, room) };
                names.zip(lines).map(move |(name, line)| (name, line, *role))
            })
            .collect();
        let lines = self.key_lines(columns.saturating_sub(4));
        let rows = (facts.len() + lines.len()) as u16 + 4;
        let inside = open(brush, screen, (columns, rows), &self.title, "");
        let x = inside.x + 2;
        for (row, (name, text, role)) in facts.iter().enumerate() {
            let y = inside.y + 1 + row as u16;
            if y + (lines.len() as u16) >= inside.bottom() {
                break;
            }
            brush.text(x, y, names, name, TextRole::Quiet);
            brush.text(x + names, y, room, text, *role);
        }
        for (line, y) in lines.iter().rev().zip((inside.y..inside.bottom()).rev()) {
            let mut at = x;
            for (chord, words) in *line {
                let key = chord.to_string();
                let parts =
                    [(key.as_str(), TextRole::Signal), (" ", TextRole::Text), (words.as_str(), TextRole::Strong)];
                let end = brush.parts(at, y, key_width(*chord, words), &parts);
                brush.key_target(at, y, end, *chord);
                at = end + GAP;
            }
        }
    }

    /// The keys, wrapped to this width in columns.
    fn key_lines(&self, columns: u16) -> Vec<&[(KeyChord, String)]> {
        let (mut lines, mut first, mut taken) = (Vec::new(), 0, 0);
        for (index, (chord, words)) in self.keys.iter().enumerate() {
            let needed = key_width(*chord, words) + GAP;
            if taken + needed > columns + GAP && index > first {
                lines.push(&self.keys[first..index]);
                (first, taken) = (index, 0);
            }
            taken += needed;
        }
        lines.push(&self.keys[first..]);
        lines
    }
}
