//! The console: what is drawn at three sizes, what the keys do, and where the pointer is on the display.

use std::path::Path;
use std::sync::Arc;

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::Cell;
use ratatui::style::{Color, Modifier};
use tomcom::base::time::SessionTime;
use tomcom::communication::concept::ConceptName;
use tomcom::communication::recommendation::{Reason, Recommendation, SignalOption};
use tomcom::communication::settings::Shadow;
use tomcom::communication::{Sender, Signal};
use tomcom::console::arrange::{KitchenMap, MapElement};
use tomcom::console::calibration::CalibrationAdvice;
use tomcom::console::compared::ComparisonView;
use tomcom::console::key_action::{KeyLayer, KeyPlace};
use tomcom::console::lesson::{TrainingFeedback, TrainingPanel};
use tomcom::console::model::{Dialog, RecordingStatus};
use tomcom::console::notice::NoticeLevel;
use tomcom::console::panel::Panel;
use tomcom::console::picker::{Picker, PickerQuestion};
use tomcom::console::playback::Playback;
use tomcom::console::preflight::checks;
use tomcom::console::screen::screen;
use tomcom::console::view::regions::Regions;
use tomcom::console::view::theme::{TerminalBackground, TextRole, Theme};
use tomcom::console::{ConsoleCommand, ConsoleMessage, ConsoleModel, KeyBindings, KeyMap, update, view};
use tomcom::edge::files::{read_kitchen, read_session};
use tomcom::gaze::GazeSample;
use tomcom::gaze::calibration::{GazeAccuracy, TargetAccuracy};
use tomcom::history::belief_track::{self, BeliefSnapshot};
use tomcom::history::comparison::{
    Communication, CommunicationContent, CommunicationContext, CommunicationLane, LaneComparison,
};
use tomcom::kitchen::{Agent, Kitchen, LocationKind};
use tomcom::measures::matching::CommunicationEvent;
use tomcom::mind::dirichlet::{Dirichlet, DirichletBelief};
use tomcom::mind::model::PriorModel;
use tomcom::session::calibration::CalibrationEvent;
use tomcom::session::event::{EndReason, Event, SignalEnd, Stamped};
use tomcom::session::plan::WantedRecording;
use tomcom::session::preflight::PreflightVerdict;
use tomcom::session::protocol::ProtocolEvent;
use tomcom::session::settings::{GazeSource, ParticipantKind, Visibility};
use tomcom::session::{Phase, Session, SessionSpec, apply};

use crate::check_snapshot;

const SIZES: [(u16, u16); 3] = [(80, 24), (120, 40), (200, 60)];

fn kitchen(name: &str) -> Arc<Kitchen> {
    Arc::new(read_kitchen(Path::new(&format!("layouts/{name}.toml"))).expect("the kitchen loads").kitchen)
}

/// A session with its console, fed with events.
struct Stage {
    session: Session,
    model: ConsoleModel,
    seq: u64,
    belief: DirichletBelief,
}

impl Stage {
    fn new(kitchen_name: &str, participant: ParticipantKind) -> Stage {
        let mut spec: SessionSpec = toml::from_str("layout = \"\"").expect("the settings have defaults");
        spec.participant.kind = participant;
        if participant == ParticipantKind::Keyboard {
            spec.participant.gaze = GazeSource::Mouse;
        }
        let kitchen = kitchen(kitchen_name);
        let keys = KeyBindings::live(&kitchen, &spec, &KeyMap::default()).expect("the layout's keys are free");
        let theme = Theme { colour: true, unicode: true, ground: TerminalBackground::Dark };
        let mut model = ConsoleModel::new(keys, theme, (120, 40));
        model.recording = RecordingStatus::On("sessions/2026-03-14-P01-1".to_string());
        model.free_bytes = Some(1 << 40);
        let belief = DirichletBelief::prior(&kitchen, &PriorModel::default(), kitchen.empty_state());
        Stage { session: Session::new(kitchen, spec, 0), model, seq: 0, belief }
    }

    fn at(&mut self, seconds: f64, event: Event) {
        self.model.now = SessionTime::from_secs_f64(seconds);
        self.model.clock = self.model.now;
        let stamped = Stamped { seq: self.seq, time: self.model.now, event };
        apply(&mut self.session, &stamped).expect("the event fits");
        self.seq += 1;
    }

    fn press(&mut self, seconds: f64, agent: Agent, button: &str) {
        self.at(seconds, Event::Press { agent, button: button.to_string(), at_ns: None });
    }

    fn look(&mut self, seconds: f64, x: f64, y: f64) {
        self.at(seconds, Event::Gaze(GazeSample::new(x, y, 0.97)));
    }

    /// The estimate from now on: these aspects are held for these values, so surely.
    fn estimate(&mut self, held: &[(&str, &str, f64)], by_gaze: bool) {
        let kitchen = self.session.kitchen.clone();
        for (name, label, p) in held {
            let index = kitchen.aspects.iter().position(|aspect| aspect.name == *name).expect("an aspect");
            let labels = &kitchen.aspects[index].labels;
            let others = (1.0 - p) / (labels.len() - 1) as f64;
            let mean = labels.iter().map(|other| if other == label { *p } else { others });
            self.belief.aspects[index] = Dirichlet::new(mean.collect(), 2.0);
        }
        let moment = BeliefSnapshot::new(&kitchen, self.session.state, &self.belief, self.model.now, by_gaze);
        self.model.belief.note(moment);
    }

    /// A sushi kitchen in the middle of a trial: the wizard has just shown a recipe.
    fn sushi(participant: ParticipantKind) -> Stage {
        let mut stage = Stage::new("sushi", participant);
        stage.at(3.0, Event::TrialStarted);
        for (order, dish) in [("order_1", "tuna nigiri"), ("order_2", "crab maki")] {
            stage.at(3.0, Event::OrderShown { order: order.to_string(), dish: dish.to_string() });
        }
        stage.estimate(&[], false);
        stage.press(4.9, Agent::Human, "take rice");
        stage.press(5.4, Agent::Robot, "take tuna");
        stage.press(7.1, Agent::Human, "cooking_pot");
        stage.press(8.0, Agent::Robot, "cutting_board");
        stage.look(9.0, 0.40, 0.64);
        stage.estimate(&[("order_1", "tuna nigiri", 0.97), ("cooking_pot", "rice raw", 0.99)], true);
        stage.press(9.2, Agent::Human, "cook");
        stage.press(10.3, Agent::Robot, "cut");
        stage.press(11.4, Agent::Human, "take nori");
        stage.at(
            12.0,
            Event::SignalShown {
                by: Sender::Wizard,
                signal: Signal::Highlight("cutting_board".to_string()),
                accepted: None,
            },
        );
        stage.press(13.2, Agent::Human, "assembly_board");
        stage.at(13.5, Event::SignalEnded { reason: SignalEnd::TakenBack });
        stage.estimate(&[("recipe of tuna nigiri", "salmon nigiri", 0.61), ("assembly_board", "nori", 0.98)], false);
        stage.press(15.0, Agent::Human, "trash");
        stage.at(15.5, Event::Marker { note: "slip".to_string() });
        stage.press(16.1, Agent::Robot, "cutting_board");
        stage.press(17.0, Agent::Human, "cooking_pot");
        stage.press(19.2, Agent::Human, "assembly_board");
        stage.press(21.0, Agent::Human, "take salmon");
        stage.estimate(
            &[
                ("human_hand", "salmon raw", 0.99),
                ("recipe of tuna nigiri", "salmon nigiri", 0.83),
                ("cooking_pot", "empty", 0.97),
                ("robot_hand", "tuna raw", 0.52),
            ],
            false,
        );
        let until_ns = SessionTime::from_secs_f64(24.0);
        stage.at(21.2, Event::RobotIntends { button: "counter".to_string(), until_ns });
        for step in 0..12 {
            stage.look(21.3 + 0.01 * f64::from(step), 0.36 + 0.004 * f64::from(step), 0.35);
        }
        stage.estimate(&[("assembly_board", "rice cooked + nori", 0.96)], true);
        stage.at(
            21.8,
            Event::SignalShown {
                by: Sender::Wizard,
                signal: Signal::ShowRecipe("order_1".to_string()),
                accepted: None,
            },
        );
        stage.model.errors = [15.0, 21.0].map(SessionTime::from_secs_f64).to_vec();
        stage.model.now = SessionTime::from_secs_f64(22.6);
        stage
    }

    fn screen(&self, size: (u16, u16)) -> String {
        let mut terminal = Terminal::new(TestBackend::new(size.0, size.1)).expect("a test terminal");
        terminal.draw(|frame| view(&self.session, &self.model, frame)).expect("drawn");
        terminal.backend().to_string()
    }

    fn key(&mut self, code: KeyCode) -> Option<ConsoleCommand> {
        self.key_event(KeyEvent::new(code, KeyModifiers::NONE))
    }

    fn control(&mut self, key: char) -> Option<ConsoleCommand> {
        self.key_event(KeyEvent::new(KeyCode::Char(key), KeyModifiers::CONTROL))
    }

    /// A key of a terminal that also reports releases.
    fn kind(&mut self, code: KeyCode, kind: KeyEventKind) -> Option<ConsoleCommand> {
        self.key_event(KeyEvent::new_with_kind(code, KeyModifiers::NONE, kind))
    }

    fn key_event(&mut self, key: KeyEvent) -> Option<ConsoleCommand> {
        update(&mut self.model, &self.session, ConsoleMessage::Key(key))
    }

    fn wait(&mut self, seconds: f64) {
        self.model.now = self.model.now + SessionTime::from_secs_f64(seconds);
        self.model.clock = self.model.now;
    }

    fn notice(&self) -> &str {
        self.model.notice.as_ref().map_or("", |notice| &notice.text)
    }
}

fn input(command: Option<ConsoleCommand>) -> Option<Event> {
    match command {
        Some(ConsoleCommand::Input(event)) => Some(event),
        Some(ConsoleCommand::Start(_)) => Some(Event::TrialStarted),
        _ => None,
    }
}

#[test]
fn a_running_session_at_three_sizes() {
    let stage = Stage::sushi(ParticipantKind::Simulated);
    for size in SIZES {
        check_snapshot("console", format!("running_{}x{}", size.0, size.1), stage.screen(size));
    }
}

#[test]
fn one_belief_is_looked_at_over_time_and_then_the_next() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let ranked = belief_track::ranked(stage.model.belief.until(stage.model.now));
    let name = |index: usize| stage.session.kitchen.aspects[index].name.clone();
    let wrong: Vec<String> = ranked.iter().take(3).map(|&index| name(index)).collect();
    assert_eq!(wrong, ["order_2", "recipe of tuna nigiri", "robot_hand"], "the longest first");
    stage.control('b');
    assert_eq!(stage.model.belief_focus.map(|aspect| aspect.index()), ranked.first().copied());
    stage.wait(1.0);
    stage.control('b');
    stage.wait(1.0);
    stage.control('b');
    for size in SIZES {
        check_snapshot("console", format!("belief_over_time_{}x{}", size.0, size.1), stage.screen(size));
    }
    for _ in 0..ranked.len() - 2 {
        stage.wait(1.0);
        stage.control('b');
    }
    assert_eq!(stage.model.belief_focus, None, "after the last one none");
}

#[test]
fn the_belief_has_the_room_of_the_recommendation_where_there_is_none() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.console.visibility = Visibility::Belief;
    check_snapshot("console", "belief_120x40", stage.screen((120, 40)));
}

#[test]
fn the_participants_keys_stand_at_their_places() {
    for name in ["sushi", "burger"] {
        let mut stage = match name {
            "sushi" => Stage::sushi(ParticipantKind::Keyboard),
            _ => Stage::new(name, ParticipantKind::Keyboard),
        };
        assert_eq!(stage.key(KeyCode::Tab), None);
        assert_eq!(stage.model.layer, KeyLayer::Participant);
        check_snapshot("console", format!("participant_{name}_120x40"), stage.screen((120, 40)));
        check_snapshot("console", format!("participant_{name}_80x24"), stage.screen((80, 24)));
    }
}

#[test]
fn a_gaze_map_fills_the_room_of_what_the_wizard_may_not_see() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.console.visibility = Visibility::State;
    stage.model.see(stage.model.now, GazeSample::new(0.30, 0.4, 0.97));
    check_snapshot("console", "gaze_map_120x40", stage.screen((120, 40)));
}

#[test]
fn a_training_says_what_to_do_keeps_what_it_said_and_ends_when_that_is_read() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.console.visibility = Visibility::State;
    stage.model.playback = Some(Playback::new("seed1-S001".to_string()));
    let task = ["Press . to start.", "A hit is the first signal about a false belief that leads to an error."];
    let lesson = TrainingPanel {
        task: task.map(str::to_string).to_vec(),
        score: "0 hit".to_string(),
        ..TrainingPanel::default()
    };
    stage.model.lesson = Some(lesson.clone());
    assert!(stage.screen((120, 40)).contains("A hit is the first signal"));
    let said = |seconds: f64, level: NoticeLevel, text: &str| {
        let clock = SessionTime::from_secs_f64(seconds);
        TrainingFeedback { clock, level, text: text.to_string() }
    };
    let long = "missed, with 2 errors: recipe of tuna nigiri: believed salmon nigiri, truly tuna nigiri; right would have been: recipe of order 1";
    let feedback = vec![
        said(4.0, NoticeLevel::Done, "highlight plate: told already"),
        said(9.0, NoticeLevel::Refused, long),
        said(12.0, NoticeLevel::Done, "recipe of order 1: hit: believed wrong for 3.1 s"),
    ];
    stage.model.lesson = Some(TrainingPanel { feedback, begun: true, ..lesson });
    for size in SIZES {
        check_snapshot("console", format!("training_{}x{}", size.0, size.1), stage.screen(size));
    }
    stage.control('b');
    assert!(stage.notice().contains("not shown in this session"), "{}", stage.notice());
    stage.model.dialog = Some(Dialog::Report(vec!["1 of 2 hit".to_string(), "    missed; ".to_string() + long]));
    check_snapshot("console", "training_over_120x40", stage.screen((120, 40)));
    stage.wait(1.0);
    stage.key(KeyCode::Char('q'));
    assert!(stage.model.dialog.is_some(), "a signal that came too late closes nothing");
    stage.key(KeyCode::Enter);
    assert_eq!(stage.model.dialog, None);
}

#[test]
fn help_and_questions_and_the_ascii_fallback() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.key(KeyCode::Char('?'));
    assert_eq!(stage.model.dialog, Some(Dialog::Help));
    check_snapshot("console", "help_80x24", stage.screen((80, 24)));
    check_snapshot("console", "help_120x40", stage.screen((120, 40)));
    stage.wait(1.0);
    stage.key(KeyCode::Down);
    assert_eq!(stage.model.dialog, None, "all of it is seen: every key closes");
    stage.control('c');
    check_snapshot("console", "quit_80x24", stage.screen((80, 24)));
    stage.model.dialog = None;
    stage.model.theme = Theme { colour: false, unicode: false, ground: TerminalBackground::Dark };
    let screen = stage.screen((120, 40));
    assert!(screen.is_ascii(), "only ASCII");
}

/// Every state that a wizard has to recognise at a glance, at each size.
#[test]
fn what_a_wizard_sees_at_each_size() {
    let mut ready = Stage::new("sushi", ParticipantKind::Simulated);
    ready.wait(1.0);
    let mut paused = Stage::sushi(ParticipantKind::Simulated);
    paused.at(22.6, Event::TrialPaused);
    let mut stopped = Stage::sushi(ParticipantKind::Simulated);
    stopped.at(22.6, Event::RobotStopped);
    let mut highlight = Stage::sushi(ParticipantKind::Simulated);
    highlight.at(
        22.6,
        Event::SignalShown {
            by: Sender::Wizard,
            signal: Signal::Highlight("cutting_board".to_string()),
            accepted: None,
        },
    );
    let mut alarm = Stage::sushi(ParticipantKind::Simulated);
    alarm.at(22.6, Event::RobotStopped);
    alarm.at(22.6, Event::SessionEnded);
    alarm.model.recording = RecordingStatus::Lost;
    alarm.model.say(NoticeLevel::Alarm, "session over, the recording ends here: no space left on the device");
    let mut away = Stage::sushi(ParticipantKind::Simulated);
    away.model.focused = false;
    let mut replay = Stage::sushi(ParticipantKind::Simulated);
    replay.model.keys = KeyBindings::replay(&replay.session.kitchen, &KeyMap::default()).expect("the keys are free");
    let mut playback = Playback::new("2026-03-14-P01-1".to_string());
    (playback.playing, playback.event, playback.events) = (true, 43210, 59289);
    replay.model.playback = Some(playback);
    let mut state = Stage::sushi(ParticipantKind::Simulated);
    state.session.spec.console.visibility = Visibility::State;
    let mut ascii = Stage::sushi(ParticipantKind::Simulated);
    ascii.model.theme = Theme { colour: false, unicode: false, ground: TerminalBackground::Light };
    let stages = [
        ("ready", ready),
        ("paused", paused),
        ("robot_stopped", stopped),
        ("highlight", highlight),
        ("alarm", alarm),
        ("away", away),
        ("replay", replay),
        ("state", state),
        ("ascii", ascii),
    ];
    for (name, stage) in stages {
        for size in SIZES {
            check_snapshot("console", format!("{name}_{}x{}", size.0, size.1), stage.screen(size));
        }
    }
}

/// What the cells look like, a line for each row, a letter for each style: without colour nothing may rest on colour.
#[test]
fn without_colour_every_meaning_has_a_sign_or_a_weight() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.model.theme = Theme { colour: false, unicode: true, ground: TerminalBackground::Dark };
    for (columns, rows) in SIZES {
        let mut terminal = Terminal::new(TestBackend::new(columns, rows)).expect("a test terminal");
        terminal.draw(|frame| view(&stage.session, &stage.model, frame)).expect("drawn");
        let buffer = terminal.backend().buffer();
        assert!(buffer.content.iter().all(|cell| cell.fg == Color::Reset && cell.bg == Color::Reset));
        let weights = |cell: &Cell| match cell.modifier {
            m if m.contains(Modifier::REVERSED) => '#',
            m if m.contains(Modifier::BOLD) => '*',
            m if m.contains(Modifier::DIM) => '-',
            _ if cell.symbol() == " " => ' ',
            _ => '.',
        };
        let lines: Vec<String> =
            buffer.content.chunks(usize::from(columns)).map(|row| row.iter().map(weights).collect()).collect();
        check_snapshot("console", format!("no_color_{columns}x{rows}"), lines.join("\n"));
    }
}

#[test]
fn a_stopped_robot_is_seen_and_every_size_can_be_drawn() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.at(22.7, Event::RobotStopped);
    for columns in (1..220).step_by(7) {
        for rows in (1..70).step_by(3) {
            stage.screen((columns, rows));
        }
    }
}

#[test]
fn each_signal_has_a_key_that_sends_it_once() {
    for name in ["sushi", "burger"] {
        let mut stage = Stage::new(name, ParticipantKind::Simulated);
        let kitchen = stage.session.kitchen.clone();
        stage.at(1.0, Event::TrialStarted);
        for &order in &kitchen.orders {
            let order = kitchen.location(order).name.clone();
            stage.at(1.0, Event::OrderShown { order, dish: kitchen.dishes[0].name.clone() });
        }
        let mut sent = Vec::new();
        for location in &kitchen.locations {
            stage.wait(5.0);
            let key = location.signal_key.expect("every location of the shipped kitchens has a key");
            let Some(Event::SignalShown { signal, .. }) = input(stage.key(KeyCode::Char(key))) else {
                assert_eq!(location.kind, LocationKind::Hand(Agent::Human), "{}: {}", location.name, stage.notice());
                continue;
            };
            assert_eq!(signal.target(), location.name);
            sent.push(signal);
            for _ in 0..40 {
                stage.wait(0.03);
                assert_eq!(stage.key(KeyCode::Char(key)), None, "a held key repeats");
            }
        }
        assert_eq!(sent.len(), kitchen.locations.len() - 1);
    }
}

#[test]
fn a_terminal_that_reports_repeats_lets_the_same_key_be_pressed_twice() {
    let mut stage = Stage::new("sushi", ParticipantKind::Keyboard);
    stage.at(1.0, Event::TrialStarted);
    stage.kind(KeyCode::Tab, KeyEventKind::Press);
    stage.kind(KeyCode::Tab, KeyEventKind::Release);
    let key = KeyCode::Char('a');
    for _ in 0..3 {
        assert!(input(stage.kind(key, KeyEventKind::Press)).is_some());
        assert_eq!(stage.kind(key, KeyEventKind::Repeat), None);
        assert_eq!(stage.kind(key, KeyEventKind::Release), None);
        stage.wait(0.05);
    }
}

#[test]
fn without_key_releases_two_presses_count_twice_and_a_held_key_once() {
    let mut stage = Stage::new("sushi", ParticipantKind::Keyboard);
    stage.at(1.0, Event::TrialStarted);
    stage.key(KeyCode::Tab);
    let key = KeyCode::Char('a');
    for _ in 0..3 {
        stage.wait(0.2);
        assert!(input(stage.key(key)).is_some(), "a second press: {}", stage.notice());
    }
    for _ in 0..20 {
        stage.wait(0.03);
        assert_eq!(stage.key(key), None);
        assert!(stage.notice().contains("held down"), "{}", stage.notice());
    }
    stage.wait(0.5);
    stage.key(KeyCode::Char('?'));
    stage.wait(0.2);
    stage.key(KeyCode::Char('?'));
    assert_eq!(stage.model.dialog, None, "help opens and closes");
    stage.control('c');
    for gap_s in [0.5, 0.03, 0.03] {
        stage.wait(gap_s);
        assert_eq!(stage.control('c'), None, "a held key does not answer its own question");
        assert_eq!(stage.model.dialog, Some(Dialog::Quit));
    }
    stage.wait(1.0);
    assert_eq!(stage.control('c'), None, "a nervous second press ends no trial");
    assert_eq!(stage.model.dialog, Some(Dialog::Quit));
    assert_eq!(stage.key(KeyCode::Enter), None, "only y does");
    assert_eq!(stage.model.dialog, None);
    stage.at(stage.model.now.as_secs_f64(), Event::TrialEnded { reason: EndReason::Time });
    stage.control('c');
    stage.wait(1.0);
    assert_eq!(stage.control('c'), Some(ConsoleCommand::Quit), "after the trial it does");
}

#[test]
fn a_signal_is_not_sent_again_while_it_is_shown() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    stage.at(1.0, Event::TrialStarted);
    let signal = input(stage.key(KeyCode::Char('a'))).expect("sent");
    stage.at(1.1, signal.clone());
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Char('a')), None);
    assert!(stage.notice().contains("shown already"), "{}", stage.notice());
    stage.at(3.0, Event::SignalEnded { reason: SignalEnd::TakenBack });
    assert_eq!(input(stage.key(KeyCode::Char('a'))), Some(signal));
}

#[test]
fn ages_stand_still_in_a_pause_and_after_the_end() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    stage.at(1.0, Event::TrialStarted);
    let shown = SessionTime::from_secs_f64(2.0);
    stage.at(2.0, Event::OrderShown { order: "order_1".to_string(), dish: "tuna nigiri".to_string() });
    stage.at(5.0, Event::TrialPaused);
    let age_s = |stage: &Stage, now_s: f64| stage.session.age(shown, SessionTime::from_secs_f64(now_s)).as_secs_f64();
    assert_eq!(age_s(&stage, 100.0), 3.0);
    stage.at(105.0, Event::TrialResumed);
    assert_eq!(age_s(&stage, 106.0), 4.0);
    stage.at(107.0, Event::TrialEnded { reason: EndReason::Wizard });
    assert_eq!(age_s(&stage, 200.0), 5.0);
    let screen = stage.screen((120, 40));
    assert!(screen.contains("^c closes the session"), "{screen}");
    assert!(!screen.contains("STOP ROBOT"), "{screen}");
}

#[test]
fn the_rate_of_the_gaze_begins_anew_after_a_gap() {
    let mut stage = Stage::new("sushi", ParticipantKind::Keyboard);
    stage.at(1.0, Event::TrialStarted);
    for start_s in [2.0, 7.0] {
        for step in 0..24 {
            stage.look(start_s + f64::from(step) / 120.0, 0.5, 0.5);
        }
        let hz = stage.session.gaze_hz(stage.model.now).expect("samples come");
        assert!((hz - 120.0).abs() < 1.0, "{hz} Hz");
        stage.wait(1.5);
        assert_eq!(stage.session.gaze_hz(stage.model.now), None);
        let screen = stage.screen((120, 40));
        assert!(screen.contains("NO GAZE") && screen.contains("0 Hz, conf -"), "{screen}");
    }
}

#[test]
fn a_question_is_seen_in_the_smallest_window() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.control('c');
    let screen = stage.screen((50, 12));
    assert!(screen.contains("Quit tomcom? y yes, any other key no"), "{screen}");
}

#[test]
fn the_timeline_loses_no_signal_no_note_and_no_error() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    for note in ["wrong recipe", "overlooked a change", "slip"] {
        stage.at(22.6, Event::Marker { note: note.to_string() });
    }
    for size in SIZES {
        assert!(stage.screen(size).contains("123"), "{}", stage.screen(size));
    }
}

#[test]
fn the_keys_of_a_replay_and_the_served_orders_fit_the_smallest_console() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.model.keys = KeyBindings::replay(&stage.session.kitchen, &KeyMap::default()).expect("the keys are free");
    let mut playback = Playback::new("2026-03-14-P01-1".to_string());
    (playback.playing, playback.event, playback.events) = (true, 43210, 59289);
    stage.model.playback = Some(playback);
    for size in SIZES {
        let screen = stage.screen(size);
        for words in ["q quit", "? help", "left/right step", "0 served", "play 1x"] {
            assert!(screen.contains(words), "{words} is missing:\n{screen}");
        }
    }
}

#[test]
fn the_space_bar_stops_the_robot_in_every_view() {
    let mut stage = Stage::sushi(ParticipantKind::Keyboard);
    let list = Some(Dialog::Pick(Picker::new(PickerQuestion::Place)));
    for dialog in [None, Some(Dialog::Help), Some(Dialog::Quit), Some(Dialog::EndTrial), list] {
        for layer in [KeyLayer::Wizard, KeyLayer::Participant] {
            stage.model.dialog = dialog.clone();
            stage.model.layer = layer;
            assert_eq!(input(stage.key(KeyCode::Char(' '))), Some(Event::RobotStopped));
        }
    }
    stage.at(23.0, Event::RobotStopped);
    assert_eq!(stage.key(KeyCode::Char(' ')), None, "it is stopped already");
    stage.model.dialog = None;
    assert_eq!(input(stage.control('r')), Some(Event::RobotResumed));
}

#[test]
fn whoever_wants_to_quit_is_asked_in_whatever_list_they_are() {
    let mut stage = Stage::sushi(ParticipantKind::Keyboard);
    for dialog in [Dialog::Help, Dialog::Preflight, Dialog::Pick(Picker::new(PickerQuestion::Place))] {
        stage.model.dialog = Some(dialog);
        stage.wait(1.0);
        assert_eq!(stage.control('c'), None);
        assert_eq!(stage.model.dialog, Some(Dialog::Quit));
    }
}

#[test]
fn the_trial_is_started_paused_and_ended_by_keys() {
    let mut stage = Stage::new("burger", ParticipantKind::Simulated);
    assert_eq!(input(stage.key(KeyCode::Char('a'))), None, "no signal before the trial");
    assert!(stage.notice().contains("while the trial runs"), "{}", stage.notice());
    assert_eq!(input(stage.key(KeyCode::Char('.'))), Some(Event::TrialStarted));
    stage.at(1.0, Event::TrialStarted);
    assert_eq!(input(stage.key(KeyCode::Char('.'))), Some(Event::TrialPaused));
    stage.at(2.0, Event::TrialPaused);
    assert_eq!(stage.session.phase, Phase::Paused);
    assert_eq!(input(stage.key(KeyCode::Char('.'))), Some(Event::TrialResumed));
    stage.at(3.0, Event::TrialResumed);
    assert_eq!(input(stage.key(KeyCode::Char('3'))), Some(Event::Marker { note: "slip".to_string() }));
    assert_eq!(stage.control('e'), None);
    assert_eq!(stage.model.dialog, Some(Dialog::EndTrial));
    stage.wait(1.0);
    assert!(matches!(input(stage.key(KeyCode::Char('y'))), Some(Event::TrialEnded { .. })));
    assert_eq!(stage.control('c'), None);
    assert_eq!(stage.model.dialog, Some(Dialog::Quit));
    assert_eq!(stage.key(KeyCode::Char('n')), None);
    assert_eq!(stage.model.dialog, None);
    stage.wait(1.0);
    stage.control('c');
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Char('y')), Some(ConsoleCommand::Quit));
}

#[test]
fn every_place_of_the_panel_is_its_place_on_the_display_and_back() {
    for name in ["sushi", "burger"] {
        let kitchen = kitchen(name);
        for size in SIZES {
            let panel = Regions::new(size, Visibility::Recommendation, None).kitchen_inside();
            let plan = KitchenMap::new(&kitchen, panel, size.0 == 120);
            assert_eq!(plan.spots.len(), kitchen.locations.len() + kitchen.storages.len());
            for spot in &plan.spots {
                let area = match spot.thing {
                    MapElement::Location(id) => kitchen.location(id).display,
                    MapElement::Storage(index) => kitchen.storages[index].display,
                };
                assert_eq!(panel.union(spot.cells), panel, "{name} {size:?}: inside of the panel");
                for (x, y) in [(spot.cells.x, spot.cells.y), (spot.cells.right() - 1, spot.cells.bottom() - 1)] {
                    let point = plan.display_point(x, y);
                    let distance_m = area.distance_m(point, kitchen.display_m);
                    assert_eq!(distance_m, 0.0, "{name} {size:?} {:?} {point:?} {area:?}", spot.thing);
                    assert_eq!(plan.cell(point), Some((x, y)), "{name} {size:?}");
                }
            }
            for (index, spot) in plan.spots.iter().enumerate() {
                let others = plan.spots[index + 1..].iter();
                assert!(others.clone().all(|other| !spot.cells.intersects(other.cells)), "{name} {size:?}: apart");
            }
        }
    }
}

#[test]
fn a_layout_cannot_take_a_key_twice() {
    let mut kitchen = Kitchen::clone(&kitchen("sushi"));
    let spec: SessionSpec = toml::from_str("layout = \"\"").expect("the settings have defaults");
    kitchen.locations[0].signal_key = Some('3');
    let clash = KeyBindings::live(&kitchen, &spec, &KeyMap::default()).expect_err("3 is a marker");
    assert_eq!(clash.place, KeyPlace::Layout(KeyLayer::Wizard, '3'));
}

/// Types a word into an open list.
fn type_in(stage: &mut Stage, word: &str) {
    for letter in word.chars() {
        stage.wait(0.05);
        assert_eq!(stage.key(KeyCode::Char(letter)), None);
    }
}

#[test]
fn the_kitchen_is_corrected_from_two_lists() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.control('k');
    for size in SIZES {
        check_snapshot("console", format!("correct_{}x{}", size.0, size.1), stage.screen(size));
    }
    type_in(&mut stage, "pot");
    stage.wait(0.05);
    assert_eq!(stage.key(KeyCode::Enter), None);
    check_snapshot("console", "correct_content_80x24", stage.screen((80, 24)));
    for _ in 0..20 {
        stage.wait(0.03);
        assert_eq!(stage.key(KeyCode::Enter), None, "a held enter answers one question");
    }
    type_in(&mut stage, "riceco");
    stage.wait(0.05);
    let corrected = Event::KitchenCorrected { location: "cooking_pot".to_string(), content: "rice cooked".to_string() };
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(corrected.clone()), "{}", stage.notice());
    assert_eq!(stage.model.dialog, None);
    stage.at(23.0, corrected);
    assert!(stage.screen((120, 40)).contains("rice cooked"));
    // Esc goes back a step, then leaves; what nothing is called leads nowhere.
    stage.wait(1.0);
    stage.control('k');
    type_in(&mut stage, "zzz");
    assert_eq!(stage.key(KeyCode::Enter), None);
    for left in [3, 2, 1] {
        assert!(matches!(&stage.model.dialog, Some(Dialog::Pick(list)) if list.filter.len() == left));
        stage.key(KeyCode::Backspace);
    }
    stage.key(KeyCode::Down);
    stage.wait(1.0);
    stage.key(KeyCode::Enter);
    stage.key(KeyCode::Esc);
    assert_eq!(stage.model.dialog, Some(Dialog::Pick(Picker::new(PickerQuestion::Place))));
    stage.key(KeyCode::Esc);
    assert_eq!(stage.model.dialog, None);
}

#[test]
fn the_robot_is_held_skipped_and_driven_by_keys() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let by = Sender::Wizard;
    assert_eq!(input(stage.control('p')), Some(Event::RobotHeld { by }));
    stage.at(22.7, Event::RobotHeld { by });
    check_snapshot("console", "held_80x24", stage.screen((80, 24)));
    let screen = stage.screen((120, 40));
    assert!(screen.contains("HELD") && screen.contains("^p releases it"), "{screen}");
    stage.wait(1.0);
    assert_eq!(input(stage.control('s')), Some(Event::RobotSkipped { by }));
    assert_eq!(stage.control('d'), None);
    check_snapshot("console", "drive_120x40", stage.screen((120, 40)));
    type_in(&mut stage, "counter");
    let driven = Event::RobotDriven { by, button: "counter".to_string() };
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(driven));
    stage.wait(1.0);
    assert_eq!(input(stage.control('p')), Some(Event::RobotReleased { by }));
    stage.at(30.0, Event::TrialEnded { reason: EndReason::Wizard });
    assert_eq!(stage.control('d'), None);
    assert!(stage.notice().contains("while the trial runs"), "{}", stage.notice());
}

#[test]
fn a_held_key_that_toggles_counts_once_also_where_no_release_is_reported() {
    for (key, control, event) in
        [('.', false, Event::TrialStarted), ('p', true, Event::RobotHeld { by: Sender::Wizard })]
    {
        let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
        let press = |stage: &mut Stage| input(if control { stage.control(key) } else { stage.key(KeyCode::Char(key)) });
        assert_eq!(press(&mut stage), Some(event.clone()));
        stage.at(0.01, event);
        // The delay of key repeat, then the repeats themselves.
        for gap_s in [0.5, 0.03, 0.03, 0.03] {
            stage.wait(gap_s);
            assert_eq!(press(&mut stage), None);
            assert!(stage.notice().contains("held down"), "{}", stage.notice());
        }
        stage.wait(0.8);
        assert!(press(&mut stage).is_some(), "{}", stage.notice());
    }
}

#[test]
fn a_trial_is_aborted_with_a_reason_and_done_again() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    assert_eq!(stage.control('n'), None);
    assert!(stage.notice().contains("abort the trial first"), "{}", stage.notice());
    assert_eq!(stage.control('x'), None);
    check_snapshot("console", "abort_80x24", stage.screen((80, 24)));
    stage.key(KeyCode::Down);
    let aborted = Event::TrialAborted { reason: "technical failure".to_string() };
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(aborted.clone()));
    stage.at(30.0, aborted);
    for size in SIZES {
        let screen = stage.screen(size);
        assert!(screen.contains("ABORTED") && screen.contains("^n do it again"), "{screen}");
    }
    assert_eq!(stage.control('n'), Some(ConsoleCommand::Redo));
}

#[test]
fn a_trial_is_excluded_and_included_by_one_key() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.control('l');
    type_in(&mut stage, "inter");
    let excluded = Event::TrialExcluded { reason: "interrupted".to_string() };
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(excluded.clone()));
    stage.at(23.0, excluded);
    assert!(stage.screen((120, 40)).contains("EXCLUDED"));
    stage.wait(1.0);
    assert_eq!(input(stage.control('l')), Some(Event::TrialIncluded));
}

#[test]
fn a_lost_keyboard_is_an_alarm_and_an_event() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let mut focus = |focused| input(update(&mut stage.model, &stage.session, ConsoleMessage::Focus(focused)));
    assert_eq!(focus(true), None, "it has it already");
    assert_eq!(focus(false), Some(Event::FocusLost));
    assert_eq!(focus(false), None);
    for size in SIZES {
        let screen = stage.screen(size);
        assert!(screen.contains("NO KEYBOARD") && screen.contains("THE KEYBOARD IS ELSEWHERE"), "{screen}");
    }
    assert_eq!(
        input(update(&mut stage.model, &stage.session, ConsoleMessage::Focus(true))),
        Some(Event::FocusRegained)
    );
}

#[test]
fn what_mends_is_told_with_the_keys_that_hold() {
    let mut stage = Stage::new("sushi", ParticipantKind::Display);
    stage.session.spec.participant.gaze = GazeSource::Pupil;
    let remedy = |stage: &Stage| {
        let checks = checks(&stage.session, &stage.model);
        checks.into_iter().find(|check| check.name == "calibration").and_then(|check| check.remedy).unwrap_or_default()
    };
    assert!(remedy(&stage).starts_with("^v checks the gaze"), "{}", remedy(&stage));
    let map: KeyMap = toml::from_str("[console]\ncheck_gaze = \"f9\"\n").expect("a key file");
    stage.model.keys = KeyBindings::live(&stage.session.kitchen, &stage.session.spec, &map).expect("f9 is free");
    assert!(remedy(&stage).starts_with("F9 checks the gaze"), "{}", remedy(&stage));
}

#[test]
fn the_notes_are_those_of_the_session() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    stage.session.spec.console.notes = vec!["asked for help".to_string()];
    stage.model.keys =
        KeyBindings::live(&stage.session.kitchen, &stage.session.spec, &KeyMap::default()).expect("free keys");
    assert_eq!(input(stage.key(KeyCode::Char('1'))), Some(Event::Marker { note: "asked for help".to_string() }));
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Char('2')), None);
    stage.key(KeyCode::Char('?'));
    let screen = stage.screen((120, 40));
    assert!(screen.contains("asked for help") && !screen.contains("wrong recipe"), "{screen}");
}

/// The panels that the record says are on the screen.
fn panels(stage: &Stage) -> Vec<String> {
    screen(&stage.session, &stage.model).panels
}

#[test]
fn each_panel_can_be_looked_at_alone() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.model.size = (80, 24);
    let all = panels(&stage);
    let mut seen = Vec::new();
    for _ in 0..6 {
        stage.wait(0.2);
        assert_eq!(stage.key(KeyCode::Right), None);
        let screen = stage.screen((80, 24));
        assert!(screen.contains("STOP ROBOT") && screen.contains("esc all panels"), "{screen}");
        seen.extend(panels(&stage));
    }
    assert_eq!(seen, ["kitchen", "belief", "recommendation", "gaze_map", "events", "timeline"]);
    stage.wait(0.2);
    stage.key(KeyCode::Up);
    assert!(stage.screen((80, 24)).contains("-5 s"), "further back in time: {}", stage.screen((80, 24)));
    stage.key(KeyCode::Esc);
    assert_eq!((panels(&stage), stage.model.timeline_back_s), (all, 0));
    stage.session.spec.console.visibility = Visibility::State;
    for _ in 0..2 {
        stage.wait(0.2);
        stage.key(KeyCode::Right);
    }
    assert_eq!(panels(&stage), ["gaze_map"], "what may not be seen is left out");
    stage.wait(0.2);
    stage.key(KeyCode::Up);
    update(&mut stage.model, &stage.session, ConsoleMessage::Wheel(40, 12, 1));
    assert_eq!(stage.model.events_back, 0, "what is not seen does not move");
}

#[test]
fn a_click_sends_no_signal_and_the_wheel_goes_back_in_time() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let regions = Regions::new((120, 40), Visibility::Recommendation, None);
    let plan = KitchenMap::new(&stage.session.kitchen, regions.kitchen_inside(), false);
    for spot in &plan.spots {
        let MapElement::Location(location) = spot.thing else { continue };
        let click = ConsoleMessage::Click(spot.cells.x + 1, spot.cells.y);
        assert_eq!(update(&mut stage.model, &stage.session, click), None);
        let label = stage.session.kitchen.location(location).label();
        assert!(stage.notice().contains(&label), "{label}: {}", stage.notice());
    }
    let all = panels(&stage);
    let (column, row) = (regions.belief.x + 1, regions.belief.y);
    for expected in [vec!["belief".to_string()], all] {
        assert_eq!(update(&mut stage.model, &stage.session, ConsoleMessage::Click(column, row)), None);
        assert_eq!(panels(&stage), expected);
    }
    let (column, row) = (regions.timeline.x + 1, regions.timeline.y);
    for (steps, back_s) in [(1, 5), (-3, 0)] {
        assert_eq!(update(&mut stage.model, &stage.session, ConsoleMessage::Wheel(column, row, steps)), None);
        assert_eq!(stage.model.timeline_back_s, back_s, "back, and not into the future");
    }
}

/// The relative luminance of a colour (WCAG 2.1).
fn luminance(rgb: [u8; 3]) -> f64 {
    let linear = rgb.map(|value| match f64::from(value) / 255.0 {
        low if low <= 0.04045 => low / 12.92,
        high => ((high + 0.055) / 1.055).powf(2.4),
    });
    0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
}

/// The contrast ratio of two colours, 1 to 21 (WCAG 2.1).
fn contrast(a: [u8; 3], b: [u8; 3]) -> f64 {
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

/// A colour of the cube or the greys of xterm's 256, which are the same in every terminal.
fn xterm(index: u8) -> [u8; 3] {
    match index {
        0..=15 => panic!("{index} is one of the colours that everybody sets otherwise"),
        16..=231 => [36, 6, 1].map(|step| [0, 95, 135, 175, 215, 255][usize::from((index - 16) / step % 6)]),
        grey => [8 + 10 * (grey - 232); 3],
    }
}

#[test]
fn colours_keep_their_contrast_on_dark_and_light_terminals() {
    use TextRole::{Alarm, FalseBelief, Gaze, Human, Quiet, Robot, Signal};
    // Black, and the backgrounds of VS Code, One Dark and Solarized; white, and those of Solarized and GitHub's code.
    let dark = [[0, 0, 0], [0x1e, 0x1e, 0x1e], [0x28, 0x2c, 0x34], [0x00, 0x2b, 0x36]];
    let light = [[255, 255, 255], [0xfd, 0xf6, 0xe3], [0xf6, 0xf8, 0xfa]];
    for (ground, backgrounds) in [(TerminalBackground::Dark, &dark[..]), (TerminalBackground::Light, &light[..])] {
        let colour = |role| xterm(Theme::colour(ground, role).expect("a colour of its own"));
        for background in backgrounds {
            for role in [Quiet, Human, Robot, Signal, Gaze, Alarm, FalseBelief] {
                let ratio = contrast(colour(role), *background);
                assert!(ratio >= 4.5, "{role:?} on {background:02x?}: {ratio:.2}");
            }
            let ratio = contrast(colour(TextRole::Frame), *background);
            assert!(
                (1.5..4.5).contains(&ratio),
                "lines are there, and quieter than text, on {background:02x?}: {ratio:.2}"
            );
        }
        for other in [Quiet, Human, Robot, Signal, Gaze, Alarm] {
            assert_ne!(colour(other), colour(FalseBelief), "one colour is that of false beliefs alone");
        }
    }
}

#[test]
fn a_trial_starts_at_once_if_all_is_ok_and_what_was_found_is_recorded() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    let Some(ConsoleCommand::Start(Event::Preflight { checks, overridden })) = stage.key(KeyCode::Char('.')) else {
        panic!("{}", stage.notice());
    };
    let names: Vec<&str> = checks.iter().map(|check| check.name.as_str()).collect();
    assert_eq!(names, ["participant", "gaze", "robot", "recording", "free space", "keyboard"]);
    assert!(!overridden && checks.iter().all(|check| check.verdict == PreflightVerdict::Ok), "{checks:?}");
    stage.at(0.0, Event::Preflight { checks, overridden });
    stage.at(0.0, Event::TrialStarted);
    stage.wait(1.0);
    stage.control('f');
    assert!(stage.notice().contains("started already"), "{}", stage.notice());
}

#[test]
fn what_is_not_ok_before_a_trial_is_listed_mended_or_overridden() {
    let mut stage = Stage::new("sushi", ParticipantKind::Keyboard);
    stage.session.spec.participant.gaze = GazeSource::Json;
    stage.at(0.1, Event::RobotStopped);
    stage.model.free_bytes = Some(100 << 20);
    assert_eq!(stage.key(KeyCode::Char('.')), None);
    assert_eq!(stage.model.dialog, Some(Dialog::Preflight));
    for size in SIZES {
        check_snapshot("console", format!("preflight_{}x{}", size.0, size.1), stage.screen(size));
    }
    // The key that opened the list does not start the trial, held or pressed again.
    for gap_s in [0.5, 0.03, 1.0] {
        stage.wait(gap_s);
        assert_eq!(stage.key(KeyCode::Char('.')), None);
    }
    assert_eq!(input(stage.control('r')), Some(Event::RobotResumed));
    stage.at(3.0, Event::RobotResumed);
    let started = stage.key(KeyCode::Char('o'));
    let Some(ConsoleCommand::Start(Event::Preflight { checks, overridden: true })) = started else {
        panic!("{started:?}")
    };
    let verdict = |name: &str| checks.iter().find(|check| check.name == name).map(|check| check.verdict);
    assert_eq!(verdict("gaze"), Some(PreflightVerdict::Failed));
    assert_eq!(verdict("free space"), Some(PreflightVerdict::Warning));
    assert_eq!(verdict("robot"), Some(PreflightVerdict::Ok));
    // As soon as all is mended, the key that starts a trial starts it.
    stage.key(KeyCode::Char('.'));
    stage.model.free_bytes = Some(1 << 40);
    for step in 0..120 {
        stage.look(4.0 + f64::from(step) / 120.0, 0.5, 0.5);
    }
    stage.wait(0.01);
    stage.model.dialog = Some(Dialog::Preflight);
    assert!(stage.screen((80, 24)).contains("usable, confidence 0.97"), "{}", stage.screen((80, 24)));
    assert!(matches!(
        stage.key(KeyCode::Char('.')),
        Some(ConsoleCommand::Start(Event::Preflight { overridden: false, .. }))
    ));
}

#[test]
fn notes_in_words_are_written_when_paused_and_only_there_the_space_bar_types() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    assert_eq!(stage.key(KeyCode::Char('0')), None);
    assert!(stage.notice().contains("only when paused"), "{}", stage.notice());
    stage.at(23.0, Event::TrialPaused);
    stage.wait(1.0);
    stage.key(KeyCode::Char('0'));
    for letter in "Asks fhr  help".chars() {
        stage.wait(0.05);
        assert_eq!(stage.key(KeyCode::Char(letter)), None, "a space is typed, and stops nothing");
    }
    for _ in 0..7 {
        stage.key(KeyCode::Left);
    }
    stage.key(KeyCode::Backspace);
    stage.key(KeyCode::Char('o'));
    stage.key(KeyCode::End);
    for size in [(80, 24), (200, 60)] {
        check_snapshot("console", format!("note_{}x{}", size.0, size.1), stage.screen(size));
    }
    let note = Event::Marker { note: "Asks for  help".to_string() };
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(note));
    assert_eq!(input(stage.key(KeyCode::Char(' '))), Some(Event::RobotStopped));
    stage.wait(1.0);
    stage.key(KeyCode::Char('0'));
    assert_eq!(stage.key(KeyCode::Esc), None);
    assert_eq!(stage.model.dialog, None);
}

#[test]
fn what_the_wizard_sees_is_told_by_size_visibility_and_dialog() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let mut rooms = Vec::new();
    for size in [(50, 12), (80, 24), (120, 40), (200, 60)] {
        stage.model.size = size;
        let seen = screen(&stage.session, &stage.model);
        assert_eq!(seen.panels.iter().any(|panel| panel == "belief"), seen.room != "too_small", "{seen:?}");
        rooms.push(seen.room);
    }
    assert_eq!(rooms, ["too_small", "small", "medium", "large"]);
    stage.session.spec.console.visibility = Visibility::State;
    stage.control('k');
    let seen = screen(&stage.session, &stage.model);
    assert!(!seen.panels.iter().any(|panel| panel == "belief" || panel == "recommendation"), "{seen:?}");
    assert_eq!((seen.visibility, seen.dialog.as_deref()), (Visibility::State, Some("correct_place")));
}

/// The console of a recording of the study's first participant.
fn planned(slot: usize, instructed: bool) -> Stage {
    let study = read_session(Path::new("sessions/study.toml")).expect("the study").study().expect("a plan");
    let (spec, _) = study.settings(WantedRecording { participant: 0, slot, attempt: 1, instructed });
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    stage.session = Session::new(kitchen("sushi"), spec, 0);
    stage.next_phase();
    stage
}

impl Stage {
    fn next_phase(&mut self) {
        let (phase, number) = (self.session.next_phase(), self.session.protocol.as_ref().map(|it| it.number + 1));
        let (phase, number) = phase.zip(number).expect("one more phase");
        self.at(0.0, Event::Protocol(ProtocolEvent::PhaseStarted { phase, number }));
    }
}

#[test]
fn the_sheets_around_a_trial_fit_every_size() {
    for size in SIZES {
        let mut stage = planned(0, false);
        stage.model.size = size;
        let screen = stage.screen(size);
        for text in ["INSTRUCTION", "P01 familiarisation", "Ask for questions.", "this step is done"] {
            assert!(screen.contains(text), "{text:?} at {size:?} in\n{screen}");
        }
        let mut stage = planned(2, true);
        stage.model.size = size;
        assert!(stage.screen(size).contains("P01 trial 2/2 wizard"), "{}", stage.screen(size));
        stage.at(0.0, Event::TrialStarted);
        assert!(stage.screen(size).contains("P01 trial 2/2 wizard"), "{}", stage.screen(size));
        stage.at(9.0, Event::TrialEnded { reason: EndReason::Wizard });
        assert!(stage.screen(size).contains(". questionnaire"), "{}", stage.screen(size));
        stage.at(
            9.0,
            Event::Protocol(ProtocolEvent::PhaseStarted {
                phase: tomcom::session::protocol::StudyPhase::Questionnaire,
                number: 2,
            }),
        );
        stage.at(9.0, Event::Protocol(ProtocolEvent::ItemAnswered { item: "too_often".to_string(), answer: 6 }));
        stage.at(9.0, Event::Protocol(ProtocolEvent::ItemShown { item: "too_often".to_string() }));
        let screen = stage.screen(size);
        for text in ["QUESTIONNAIRE", "The signals were given too often.", "[6]", "strongly agree", "0 no answer"] {
            assert!(screen.contains(text), "{text:?} at {size:?} in\n{screen}");
        }
        stage.at(9.0, Event::Protocol(ProtocolEvent::AnswersShown));
        let screen = stage.screen(size);
        assert!(screen.contains("6 The signals were given too often."), "{screen}");
        assert!(screen.contains("to the item without an answer"), "{screen}");
    }
}

#[test]
fn the_keys_of_a_sheet_make_events_and_a_held_one_answers_once() {
    let mut stage = planned(0, false);
    let told = |command: Option<ConsoleCommand>| match command {
        Some(ConsoleCommand::Input(Event::Protocol(event))) => event,
        other => panic!("{other:?}"),
    };
    let first = told(stage.key(KeyCode::Enter));
    assert_eq!(first, ProtocolEvent::Ticked { step: 1, done: true });
    stage.at(0.0, Event::Protocol(first));
    // The key is still down: nothing more is ticked.
    assert_eq!(stage.key(KeyCode::Enter), None);
    stage.model.clock = SessionTime::from_secs_f64(2.0);
    assert_eq!(told(stage.key(KeyCode::Left)), ProtocolEvent::Ticked { step: 1, done: false });
    // Signals, markers and the kitchen wait for the trial; the robot stop does not.
    assert_eq!(stage.key(KeyCode::Char('q')), None);
    assert_eq!(stage.key(KeyCode::Char('1')), None);
    assert_eq!(stage.key(KeyCode::Char(' ')), Some(ConsoleCommand::Input(Event::RobotStopped)));
}

/// The sushi kitchen with an assistant that advises beside the wizard, and its advice.
fn advised(best: bool) -> Stage {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.assistant.shadow = Shadow::On;
    stage.at(21.85, Event::SignalEnded { reason: SignalEnd::TakenBack });
    let option = |signal, benefit: f64, standard_error| SignalOption {
        signal,
        benefit,
        standard_error,
        net: benefit - 1.5,
        rollouts: 256,
    };
    let recipe = |order: &str| Signal::ShowRecipe(order.to_string());
    let highlight = |place: &str| Signal::Highlight(place.to_string());
    let options = vec![
        option(recipe("order_1"), if best { 4.2 } else { 1.2 }, 0.2),
        option(highlight("cooking_pot"), 1.1, 0.15),
        option(recipe("order_2"), 0.3, 0.1),
        option(highlight("robot_hand"), 0.0, 0.0),
    ];
    let reason = Reason {
        aspect: "recipe of tuna nigiri".to_string(),
        believes: "salmon nigiri".to_string(),
        truth: "tuna nigiri".to_string(),
        p_believes: 0.83,
        prevents: Some("take salmon".to_string()),
        instead: None,
    };
    let best = best.then(|| recipe("order_1"));
    let for_ns = SessionTime::from_secs_f64(21.9);
    let advice = Recommendation { options, best, reason: Some(reason), ..Recommendation::silent(17, for_ns) };
    stage.at(21.9, Event::Advised(advice));
    stage.model.now = SessionTime::from_secs_f64(22.6);
    stage
}

#[test]
fn advice_is_ranked_with_its_errors_against_the_cost_of_a_signal() {
    check_snapshot("console", "advised_80x24", advised(true).screen((80, 24)));
    check_snapshot("console", "advised_120x40", advised(true).screen((120, 40)));
    check_snapshot("console", "advised_200x60", advised(true).screen((200, 60)));
    check_snapshot("console", "advised_silence_120x40", advised(false).screen((120, 40)));
}

#[test]
fn enter_accepts_what_is_recommended_and_says_so() {
    let mut seen = advised(true);
    // Signals keep apart.
    seen.model.now = SessionTime::from_secs_f64(30.0);
    let accepted = input(seen.key(KeyCode::Enter));
    let Some(Event::SignalShown { by: Sender::Wizard, signal, accepted: Some(17) }) = accepted else {
        panic!("not accepted: {accepted:?}");
    };
    assert_eq!(signal, Signal::ShowRecipe("order_1".to_string()));
    assert_eq!(input(advised(false).key(KeyCode::Enter)), None, "there is nothing to accept");
    let mut unseen = advised(true);
    unseen.session.spec.console.visibility = Visibility::State;
    assert_eq!(input(unseen.key(KeyCode::Enter)), None, "what is not shown is not accepted");
}

#[test]
fn what_was_sent_is_not_offered_again_before_there_is_newer_advice() {
    let mut stage = advised(true);
    let advice = stage.session.advice.clone().expect("advice");
    let sent = advice.best.clone().expect("a recommendation");
    stage.at(22.6, Event::SignalShown { by: Sender::Wizard, signal: sent, accepted: Some(17) });
    stage.model.now = SessionTime::from_secs_f64(23.2);
    assert_eq!(input(stage.key(KeyCode::Enter)), None);
    // The answer to what was asked before comes late, and does not know of it.
    let late = |at| Recommendation { for_ns: SessionTime::from_secs_f64(at), ..advice.clone() };
    stage.at(23.2, Event::Advised(late(22.5)));
    assert_eq!(input(stage.key(KeyCode::Enter)), None);
    stage.at(26.6, Event::SignalEnded { reason: SignalEnd::TakenBack });
    stage.at(30.0, Event::Advised(late(30.0)));
    stage.model.now = SessionTime::from_secs_f64(30.0);
    assert!(input(stage.key(KeyCode::Enter)).is_some(), "that is newer");
}

/// A long session needs no more memory than a short one, and still knows since when what is believed wrong.
#[test]
fn the_belief_forgets_what_no_panel_shows() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    stage.at(1.0, Event::TrialStarted);
    stage.estimate(&[("cooking_pot", "rice raw", 0.9)], false);
    let aspect = stage.session.kitchen.location_named("cooking_pot").expect("a pot").index();
    for second in 2..3600 {
        stage.model.now = SessionTime::from_secs_f64(f64::from(second));
        let p = if second % 2 == 0 { 0.8 } else { 0.9 };
        stage.estimate(&[("cooking_pot", "rice raw", p)], false);
        stage.model.belief.forget(stage.model.now, belief_track::SHOWN_S);
        let moments = stage.model.belief.until(stage.model.now);
        assert!(moments.len() <= 200, "{} moments", moments.len());
        assert!(second < 70 || moments[0].time.as_secs_f64() <= f64::from(second) - belief_track::SHOWN_S);
        assert_eq!(belief_track::wrong_since(moments, aspect), Some(SessionTime::from_secs_f64(1.0)));
    }
    stage.model.now = SessionTime::from_secs_f64(3700.0);
    stage.estimate(&[("cooking_pot", "empty", 0.9)], true);
    assert_eq!(belief_track::wrong_since(stage.model.belief.until(stage.model.now), aspect), None);
}

/// The sushi kitchen, compared: the wizard with so many assistants.
fn compared(assistants: usize) -> Stage {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.model.keys = stage.model.keys.clone().with_comparison();
    let kitchen = stage.session.kitchen.clone();
    let recipe = |order: &str| CommunicationContent::Signal(Signal::ShowRecipe(order.to_string()));
    let highlight = |place: &str| CommunicationContent::Signal(Signal::Highlight(place.to_string()));
    let held = BeliefSnapshot::new(&kitchen, stage.session.state, &stage.belief, stage.model.now, false).held;
    let said = |press: u32, seconds: f64, what: CommunicationContent| {
        let best = if let CommunicationContent::Signal(signal) = &what { Some(signal.clone()) } else { None };
        let option = |signal: &Signal| SignalOption {
            signal: signal.clone(),
            benefit: 4.2,
            standard_error: 0.2,
            net: 2.7,
            rollouts: 256,
        };
        let options = best.iter().map(option).collect();
        let advice = Recommendation { options, best, ..Recommendation::silent(7, stage.model.now) };
        let (state, screen) = (stage.session.state, Some(screen(&stage.session, &stage.model)));
        let known = CommunicationContext { seq: 7, state, held: held.clone(), advice: vec![advice; 3], screen };
        let clock = SessionTime::from_secs_f64(seconds - 3.0);
        let said = CommunicationEvent { press, clock, content: what.content(&kitchen) };
        Communication { said, time: SessionTime::from_secs_f64(seconds), what, known: Some(Arc::new(known)) }
    };
    let lane = |name: &str, concept, spoken| CommunicationLane { name: name.to_string(), concept, spoken };
    let sent = vec![said(5, 12.0, highlight("cutting_board")), said(9, 21.8, recipe("order_1"))];
    let planned = vec![
        said(2, 8.2, highlight("cooking_pot")),
        said(5, 10.6, highlight("cutting_board")),
        said(9, 21.1, recipe("order_1")),
    ];
    let proposed = CommunicationContent::Proposal(vec!["take_nori".to_string(), "assembly_board".to_string()]);
    let mut lanes = vec![
        lane("wizard", None, sent),
        lane("tom-com", Some(ConceptName::TomCom), planned),
        lane("tom", Some(ConceptName::Tom), vec![said(4, 9.3, recipe("order_1")), said(9, 22.1, recipe("order_1"))]),
        lane("dev", Some(ConceptName::Dev), vec![said(6, 15.0, proposed)]),
    ];
    lanes.truncate(assistants + 1);
    let mut comparison = ComparisonView::default();
    comparison.show(LaneComparison::new(lanes, 3, 10, false));
    stage.model.comparison = Some(comparison);
    stage
}

#[test]
fn wizard_and_assistant_stand_side_by_side_at_every_size() {
    for (columns, rows) in SIZES {
        check_snapshot("console", format!("compared_{columns}x{rows}"), compared(1).screen((columns, rows)));
    }
    check_snapshot("console", "compared_all_80x24", compared(3).screen((80, 24)));
    check_snapshot("console", "compared_all_120x40", compared(3).screen((120, 40)));
    let mut plain = compared(3);
    plain.model.theme = Theme { colour: false, unicode: false, ground: TerminalBackground::Dark };
    check_snapshot("console", "compared_all_ascii_120x40", plain.screen((120, 40)));
}

#[test]
fn a_difference_is_chosen_and_opened_by_keys_and_the_screen_says_what_was_seen() {
    let mut stage = compared(1);
    let panels = screen(&stage.session, &stage.model).panels;
    assert!(panels.iter().any(|panel| panel == "comparison"), "{panels:?}");
    assert_eq!(
        stage.model.comparison.as_ref().and_then(|one| one.seen.as_ref()).map(|one| one.differences.len()),
        Some(1)
    );
    let mut stage_of_all = compared(3);
    for (stage, words) in
        [(&mut stage, "0:05  only tom-com: highlight cooking pot"), (&mut stage_of_all, "dev, not wizard")]
    {
        assert!(stage.screen((120, 40)).contains(words), "{}", stage.screen((120, 40)));
        stage.control('o');
        assert_eq!(screen(&stage.session, &stage.model).dialog.as_deref(), Some("difference"));
        let opened = stage.screen((120, 40));
        for told in ["What each knew", "truly:", "on the wizard's screen: kitchen"] {
            assert!(opened.contains(told), "{told} in\n{opened}");
        }
    }
    check_snapshot("console", "compared_opened_120x40", stage.screen((120, 40)));
    // The one before, without closing; then any key closes.
    stage_of_all.control('t');
    assert!(matches!(stage_of_all.model.dialog, Some(Dialog::Difference(_))));
    assert!(!stage_of_all.screen((120, 40)).contains("dev, not wizard: press take nori, then assembly board\npress"));
    stage_of_all.key(KeyCode::Char('x'));
    assert_eq!(stage_of_all.model.dialog, None);
    // Without a comparison the keys have no meaning.
    let mut alone = Stage::sushi(ParticipantKind::Simulated);
    alone.control('o');
    assert_eq!(alone.model.dialog, None);
}

#[test]
fn every_lane_of_a_comparison_fits_the_smallest_console() {
    let small = compared(3).screen((80, 24));
    for lane in ["wizard", "tom-com", "tom ", "dev"] {
        assert!(small.contains(lane), "{lane} in\n{small}");
    }
    let alone = {
        let mut stage = compared(3);
        stage.model.alone = Some(Panel::Comparison);
        stage.screen((80, 24))
    };
    for figure in ["recall", "kappa", "lead", "1/"] {
        assert!(alone.contains(figure), "{figure} in\n{alone}");
    }
}

#[test]
fn the_gaze_is_checked_by_targets_and_the_wizard_decides() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    let begun = input(stage.control('v')).expect("a check begins");
    assert_eq!(begun, Event::Calibration(CalibrationEvent::begin()));
    stage.at(1.0, begun);
    stage.at(2.0, Event::Calibration(CalibrationEvent::TargetShown { target: 1 }));
    check_snapshot("console", "calibration_target_120x40", stage.screen((120, 40)));
    assert!(stage.screen((80, 24)).contains("look here: 2 of 5"));
    let target = |samples, accuracy_deg| TargetAccuracy { samples, accuracy_deg };
    let found = GazeAccuracy {
        accuracy_deg: 2.31,
        corrected_deg: 0.42,
        precision_deg: 0.19,
        offset: [0.02, -0.01],
        targets: vec![target(130, Some(2.1)), target(2, None), target(131, Some(2.6))],
    };
    stage.at(3.0, Event::Calibration(CalibrationEvent::TargetsHidden));
    stage.at(3.0, Event::Calibration(CalibrationEvent::Measured { found: Some(found) }));
    for size in SIZES {
        check_snapshot("console", format!("calibration_{}x{}", size.0, size.1), stage.screen(size));
    }
    stage.wait(1.0);
    let accepted = input(stage.key(KeyCode::Enter));
    assert_eq!(accepted, Some(Event::Calibration(CalibrationEvent::Accepted { corrected: true })));
    assert_eq!(stage.model.dialog, None);
}

#[test]
fn enter_takes_the_better_gaze_and_none_that_is_too_far_off() {
    let best = |accuracy_deg, corrected_deg| {
        let found =
            GazeAccuracy { accuracy_deg, corrected_deg, precision_deg: 0.2, offset: [0.0, 0.0], targets: Vec::new() };
        CalibrationAdvice::for_result(Some(&found))
    };
    assert_eq!(best(2.0, 0.5), CalibrationAdvice::Corrected);
    assert_eq!(best(1.0, 1.4), CalibrationAdvice::AsItIs);
    assert_eq!(best(8.5, 9.7), CalibrationAdvice::Repeat);
    assert_eq!(CalibrationAdvice::for_result(None), CalibrationAdvice::Repeat);
}

#[test]
fn a_check_without_enough_samples_can_be_repeated_or_left_and_not_accepted() {
    let mut stage = Stage::new("burger", ParticipantKind::Simulated);
    let begun = input(stage.control('v')).expect("a check begins");
    stage.at(1.0, begun);
    stage.at(2.0, Event::Calibration(CalibrationEvent::TargetShown { target: 4 }));
    stage.at(3.0, Event::Calibration(CalibrationEvent::TargetsHidden));
    stage.at(3.0, Event::Calibration(CalibrationEvent::Measured { found: None }));
    assert!(stage.screen((120, 40)).contains("too few usable samples"));
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Char('o')), None);
    for key in [KeyCode::Char('r'), KeyCode::Enter] {
        assert_eq!(input(stage.key(key)), Some(Event::Calibration(CalibrationEvent::begin())));
        assert_eq!(stage.model.dialog, Some(Dialog::Calibration));
    }
    let left = input(stage.key(KeyCode::Esc));
    assert_eq!(left, Some(Event::Calibration(CalibrationEvent::Dismissed)));
    assert_eq!(stage.model.dialog, None);
}
