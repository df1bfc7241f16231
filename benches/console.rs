//! Speed of the console: a redraw of a running session, from the session to the bytes for the terminal, at three sizes.
//! Prints percentiles (`cargo bench --bench console`).

use std::cell::Cell;
use std::io::{self, Write};
use std::rc::Rc;
use std::sync::Arc;
use std::time::{Duration, Instant};

use ratatui::backend::CrosstermBackend;
use ratatui::layout::Rect;
use ratatui::{Terminal, TerminalOptions, Viewport};
use tomcom::console::console_model::RecordingStatus;
use tomcom::console::view::theme::{TerminalBackground, Theme};
use tomcom::console::{ConsoleModel, KeyBindings, KeyFileBindings, view};
use tomcom::run::options::session_or_default;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_session::Event;
use tomcom_session::engine::SessionEngine;
use tomcom_session::history::belief_track::BeliefSnapshot;
use tomcom_session::history::error_reasons::ExplainedError;

/// Every redraw is one step of the console's clock later: at most 30 a second.
const STEP_S: f64 = 1.0 / 30.0;
/// Redraws that are measured, and how long the trial has run before.
const REDRAWS: usize = 3000;
const BEFORE_S: f64 = 300.0;

/// Counts bytes and forgets them.
#[derive(Clone, Default)]
struct Count(Rc<Cell<usize>>);

impl Write for Count {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.set(self.0.get() + bytes.len());
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A session that runs, with its console.
struct Stage {
    engine: SessionEngine,
    model: ConsoleModel,
    judged: usize,
}

impl Stage {
    fn new(size: (u16, u16)) -> Stage {
        let files = session_or_default(None).expect("the default session");
        let kitchen = Arc::new(files.kitchen.kitchen);
        let keys = KeyBindings::live(&kitchen, &files.spec, &KeyFileBindings::default()).expect("the keys are free");
        let mut model =
            ConsoleModel::new(keys, Theme { colour: true, unicode: true, ground: TerminalBackground::Dark }, size);
        model.recording = RecordingStatus::On("sessions/2026-03-14-P01-1".to_string());
        let mut engine = SessionEngine::new(kitchen.clone(), files.spec, 0, CostToGo::new(kitchen));
        let _ = engine.input(SessionTime::ZERO, Event::TrialStarted);
        Stage { engine, model, judged: 0 }
    }

    /// Lets everything happen until then, and tells the console as a live session does.
    fn run_until(&mut self, now: SessionTime) {
        while self.engine.next_due().is_some_and(|due| due <= now) {
            let events = self.engine.fire();
            for stamped in &events {
                if let Event::Gaze(sample) = stamped.event {
                    self.model.see(stamped.time, sample);
                }
            }
            if let Some(last) = events.last() {
                let by_gaze = matches!(last.event, Event::Gaze(_));
                let session = self.engine.session();
                let belief = self.engine.belief();
                self.model.belief.note(BeliefSnapshot::new(
                    &session.kitchen,
                    session.state,
                    belief,
                    last.time,
                    by_gaze,
                ));
            }
        }
        let judged = self.engine.judged();
        self.model.errors.extend(ExplainedError::among(self.engine.session(), &judged[self.judged..]));
        self.judged = judged.len();
        (self.model.now, self.model.clock) = (now, now);
    }
}

fn measure(size: (u16, u16)) {
    let mut stage = Stage::new(size);
    let viewport = Viewport::Fixed(Rect::new(0, 0, size.0, size.1));
    let written = Count::default();
    let mut terminal = Terminal::with_options(CrosstermBackend::new(written.clone()), TerminalOptions { viewport })
        .expect("a terminal of a fixed size");
    stage.run_until(SessionTime::from_secs_f64(BEFORE_S));
    let mut times: Vec<Duration> = (0..REDRAWS)
        .map(|redraw| {
            stage.run_until(SessionTime::from_secs_f64(BEFORE_S + STEP_S * redraw as f64));
            let began = Instant::now();
            terminal.draw(|frame| view(stage.engine.session(), &stage.model, frame)).expect("drawn");
            began.elapsed()
        })
        .collect();
    times.sort();
    let at = |share: f64| times[((REDRAWS as f64 * share) as usize).min(REDRAWS - 1)].as_secs_f64() * 1e3;
    let bytes = written.0.get() / REDRAWS;
    println!(
        "redraw at {}x{}: p50 {:.2} ms, p90 {:.2} ms, p99 {:.2} ms, max {:.2} ms; {bytes} bytes each",
        size.0,
        size.1,
        at(0.5),
        at(0.9),
        at(0.99),
        at(1.0)
    );
}

fn main() {
    for size in [(80, 24), (120, 40), (200, 60)] {
        measure(size);
    }
}
