//! The console: what is drawn at three sizes, what the keys do, and where the pointer is on the display.

mod advice;
mod clicks;
mod coding;
mod keys;
mod notices;
mod palette;
mod screens;
mod sheets;
mod trial;

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use tomcom::console::console_model::{Playback, RecordingStatus};
use tomcom::console::panels::screen;
use tomcom::console::{ConsoleCommand, ConsoleMessage, ConsoleModel, KeyBindings, KeyFileBindings, update, view};
use tomcom_core::mind::dirichlet::{Dirichlet, DirichletBelief};
use tomcom_core::mind::model::PriorModel;
use tomcom_session::history::belief_track::BeliefSnapshot;
use tomcom_session::history::error_reasons::ExplainedError;
use tomcom_session::{apply, offers};

use crate::support::*;

const SIZES: [(u16, u16); 3] = [(80, 24), (120, 40), (200, 60)];

/// A session with its console, fed with events.
struct Stage {
    session: Session,
    model: ConsoleModel,
    seq: u64,
    belief: DirichletBelief,
}

impl Stage {
    fn new(kitchen_name: &str, participant: ParticipantKind) -> Stage {
        let mut spec = default_settings();
        spec.participant.kind = participant;
        if participant == ParticipantKind::Keyboard {
            spec.participant.gaze = GazeSource::Mouse;
        }
        let kitchen = kitchen(kitchen_name);
        let mut model = console_model(&kitchen, &spec, (120, 40));
        model.recording = RecordingStatus::On("sessions/2026-03-14-P01-1".to_string());
        model.free_bytes = Some(1 << 40);
        let belief = DirichletBelief::prior(&kitchen, &PriorModel::default(), kitchen.empty_state());
        let mut session = Session::new(kitchen, spec, 0);
        session.has_console = true;
        Stage { session, model, seq: 0, belief }
    }

    fn at(&mut self, seconds: f64, event: Event) {
        self.model.now = at(seconds);
        self.model.clock = self.model.now;
        let stamped = TimestampedEvent { seq: self.seq, time: self.model.now, event };
        apply(&mut self.session, &stamped).expect("the event fits");
        self.seq += 1;
    }

    /// Opens or closes the offer that is due, as a running session does.
    fn offer(&mut self, seconds: f64) {
        while let Some(event) = offers::due(&self.session, at(seconds)) {
            self.at(seconds, event);
        }
    }

    fn press(&mut self, seconds: f64, agent: Agent, button: &str) {
        self.at(seconds, Event::Press { agent, button: button.to_string(), at_ns: None, button_box: false });
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
        let shown = |signal| Event::SignalShown { by: Sender::Wizard, signal, offer: None };
        stage.at(12.0, shown(Signal::Highlight("cutting_board".to_string())));
        stage.press(13.2, Agent::Human, "assembly_board");
        stage.at(13.5, Event::SignalEnded { reason: SignalEndReason::TakenBack });
        stage.estimate(&[("recipe of tuna nigiri", "salmon nigiri", 0.61), ("assembly_board", "nori", 0.98)], false);
        stage.press(15.0, Agent::Human, "trash");
        stage.at(15.5, Event::Marker { note: "slip".to_string(), observer: None });
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
        let until_ns = at(24.0);
        stage.at(21.2, Event::RobotIntends { button: "counter".to_string(), until_ns, initiative: false });
        for step in 0..12 {
            stage.look(21.3 + 0.01 * f64::from(step), 0.36 + 0.004 * f64::from(step), 0.35);
        }
        stage.estimate(&[("assembly_board", "rice cooked + nori", 0.96)], true);
        stage.at(21.8, shown(Signal::ShowRecipe("order_1".to_string())));
        let error = |seconds, press: &str, why: &str| ExplainedError {
            time: at(seconds),
            press: press.to_string(),
            why: why.to_string(),
            cause: None,
            cost: "costs 1 press".to_string(),
        };
        stage.model.errors =
            vec![error(15.0, "trash", "the hand is empty"), error(21.0, "take salmon", "order 1 needs tuna")];
        stage.model.now = at(22.6);
        stage
    }

    fn drawn(&self, size: (u16, u16)) -> TestBackend {
        let mut terminal = Terminal::new(TestBackend::new(size.0, size.1)).expect("a test terminal");
        terminal.draw(|frame| view(&self.session, &self.model, frame)).expect("drawn");
        terminal.backend().clone()
    }

    fn screen(&self, size: (u16, u16)) -> String {
        self.drawn(size).to_string()
    }

    /// The screen, which has to say all of this.
    fn shows(&self, size: (u16, u16), words: &[&str]) -> String {
        let screen = self.screen(size);
        for words in words {
            assert!(screen.contains(words), "{words:?} at {size:?} in\n{screen}");
        }
        screen
    }

    /// The screens of all sizes, which have to say all of this.
    fn shows_everywhere(&self, words: &[&str]) {
        for size in SIZES {
            self.shows(size, words);
        }
    }

    /// The screen must not say any of this.
    fn hides(&self, size: (u16, u16), words: &[&str]) {
        let screen = self.screen(size);
        for words in words {
            assert!(!screen.contains(words), "{words:?} at {size:?} in\n{screen}");
        }
    }

    /// From now on a replay, with its keys.
    fn replays(&mut self, playback: Playback) {
        let keys = KeyBindings::replay(&self.session.kitchen, &KeyFileBindings::default());
        self.model.keys = keys.expect("the keys are free");
        self.model.playback = Some(playback);
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
        self.model.now = self.model.now + at(seconds);
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

/// Types a word into an open list.
fn type_in(stage: &mut Stage, word: &str) {
    for letter in word.chars() {
        stage.wait(0.05);
        assert_eq!(stage.key(KeyCode::Char(letter)), None);
    }
}

/// The panels that the record says are on the screen.
fn panels(stage: &Stage) -> Vec<String> {
    screen(&stage.session, &stage.model).panels
}
