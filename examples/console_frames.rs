//! Draws still frames of the wizard's console from simulated shadow trials, with a key file: for measuring how well somebody
//! reads the console who sees nothing but a frame.
//!
//! `cargo run --example console_frames -- FRAMES KEYS.csv` writes every situation at 80x24 and 120x40 into the folder FRAMES,
//! as text with ANSI colours, and what is right about it into KEYS.csv. Half of the situations have a recommendation
//! that has stood for a while; the others have none, and some of these have a belief that is uncertain but right.
//!
//! A frame shows the moment before a press of the participant, because the participant's belief is recorded at this moment.

use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::{Buffer, Cell};
use ratatui::style::{Color, Modifier};
use tomcom::console::console_model::RecordingStatus;
use tomcom::console::view::theme::{TerminalBackground, Theme};
use tomcom::console::{ConsoleModel, KeyBindings, KeyFileBindings, view};
use tomcom::run::options::session_or_default;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::kitchen::AspectId;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::mind::RecordedBelief;
use tomcom_session::engine::SessionEngine;
use tomcom_session::history::belief_track::BeliefSnapshot;
use tomcom_session::history::error_reasons::ExplainedError;
use tomcom_session::{Event, Session, TimestampedEvent};

const SIZES: [(u16, u16); 2] = [(80, 24), (120, 40)];
const SESSIONS: [&str; 2] = ["sessions/default.toml", "sessions/burger.toml"];
const FIRST_SEED: u64 = 20_261;
/// Number of situations of each kind: with a recommendation, with a distractor, without both.
const WANTED: [usize; 3] = [20, 10, 10];
/// Number of situations of each kind from one trial.
const OF_TRIAL: usize = 3;
/// A recommendation counts if it has stood for this long with this net benefit, and silence if it has lasted this long.
const STANDS_S: f64 = 1.5;
const NET: f64 = 1.0;
/// Least time between situations of one trial, in seconds.
const APART_S: f64 = 5.0;

/// What kind of situation a frame shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Recommended,
    Distractor,
    Silent,
}

/// A trial that runs, with the console of its wizard.
struct Stage {
    engine: SessionEngine,
    model: ConsoleModel,
    judged: usize,
    /// The recommended signal, and since when.
    best: (Option<Signal>, SessionTime),
}

/// A still frame at each size, with what is right about it.
struct Situation {
    frames: Vec<String>,
    row: String,
}

/// Runs the example.
fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let (Some(frames), Some(keys)) = (args.next().map(PathBuf::from), args.next().map(PathBuf::from)) else {
        return Err("usage: console_frames FRAMES KEYS.csv".into());
    };
    std::fs::create_dir_all(&frames)?;
    let mut situations = Vec::new();
    let mut left = WANTED;
    let seeds = (FIRST_SEED..).flat_map(|seed| SESSIONS.map(|session| (session, seed)));
    for (session, seed) in seeds {
        if left == [0; 3] {
            break;
        }
        situations.extend(situations_of_trial(Path::new(session), seed, &mut left)?);
    }
    // A reader shall not learn from the order: a fixed permutation mixes trials and kinds.
    let count = situations.len();
    let mut table = "frame,kind,key,signal,net,stood_s,falsely_believed\n".to_string();
    for place in 0..count {
        let situation = &situations[(place * 23 + 5) % count];
        for ((columns, rows), frame) in SIZES.iter().zip(&situation.frames) {
            std::fs::write(frames.join(format!("{:02}-{columns}x{rows}.ansi", place + 1)), frame)?;
        }
        let _ = writeln!(table, "{:02},{}", place + 1, situation.row);
    }
    std::fs::write(keys, table)?;
    println!("{count} situations, {} frames", count * SIZES.len());
    Ok(())
}

fn situations_of_trial(session: &Path, seed: u64, wanted: &mut [usize; 3]) -> Result<Vec<Situation>, Box<dyn Error>> {
    let mut stage = Stage::new(session, seed)?;
    let mut advisor = stage.engine.advisor();
    let mut left = wanted.map(|wanted| wanted.min(OF_TRIAL));
    let mut last = SessionTime::ZERO;
    let mut found = Vec::new();
    let started = stage.engine.input(SessionTime::ZERO, Event::TrialStarted).events;
    stage.follow(&started);
    while stage.engine.session().is_running() && left.iter().any(|left| *left > 0) {
        for question in stage.engine.take_questions() {
            let advice = Event::Advised(advisor.answer(&question));
            let told = stage.engine.input(stage.engine.session().time, advice).events;
            stage.follow(&told);
        }
        // The participant's belief is recorded together with the press: the frame shows the moment before.
        let before = stage.engine.session().clone();
        let events = stage.engine.fire();
        let witness = events.iter().find_map(|stamped| match &stamped.event {
            Event::ParticipantBelieves(witness) => Some(witness),
            _ => None,
        });
        let now = events.last().map_or(before.time, |stamped| stamped.time);
        if let Some(witness) = witness.filter(|_| now.secs_since(last) >= APART_S)
            && let Some(kind) = stage.kind(&before, now)
            && left[kind as usize] > 0
        {
            (stage.model.now, stage.model.clock) = (now, now);
            left[kind as usize] -= 1;
            wanted[kind as usize] -= 1;
            last = now;
            found.push(stage.situation(&before, kind, witness)?);
        }
        stage.follow(&events);
    }
    Ok(found)
}

impl Stage {
    fn new(session: &Path, seed: u64) -> Result<Stage, Box<dyn Error>> {
        let mut files = session_or_default(Some(session))?;
        files.spec.seed = seed;
        let kitchen = Arc::new(files.kitchen.kitchen);
        let keys = KeyBindings::live(&kitchen, &files.spec, &KeyFileBindings::default())?;
        let theme = Theme { colour: true, unicode: true, ground: TerminalBackground::Dark };
        let mut model = ConsoleModel::new(keys, theme, SIZES[0]);
        model.recording = RecordingStatus::On("recordings/P01-1".to_string());
        model.free_bytes = Some(1 << 40);
        let engine = SessionEngine::new(kitchen.clone(), files.spec, 0, CostToGo::new(kitchen)).without_causes();
        Ok(Stage { engine, model, judged: 0, best: (None, SessionTime::ZERO) })
    }

    /// Tells the console what has happened, as a live session does.
    fn follow(&mut self, events: &[TimestampedEvent]) {
        for stamped in events {
            if let Event::Gaze(sample) = stamped.event {
                self.model.see(stamped.time, sample);
            }
        }
        let Some(last) = events.last() else { return };
        let session = self.engine.session();
        let by_gaze = matches!(last.event, Event::Gaze(_));
        let belief = self.engine.belief();
        self.model.belief.note(BeliefSnapshot::new(&session.kitchen, session.state, belief, last.time, by_gaze));
        let judged = self.engine.judged();
        self.model.errors.extend(ExplainedError::among(session, &judged[self.judged..]));
        self.judged = judged.len();
        let best = session.advice.as_ref().and_then(|advice| advice.best.clone());
        if best != self.best.0 {
            self.best = (best, last.time);
        }
    }

    /// The kind of the present situation; `None` if it is not clear enough for a question with one right answer.
    fn kind(&self, session: &Session, now: SessionTime) -> Option<Kind> {
        if now.secs_since(self.best.1) < STANDS_S {
            return None;
        }
        let advice = session.advice.as_ref()?;
        if self.best.0.is_some() {
            return (advice.top()?.net >= NET).then_some(Kind::Recommended);
        }
        let unsure = self.model.belief.until(now).last()?.held.iter().enumerate().any(|(aspect, held)| {
            let truth = session.kitchen.true_value(session.state, AspectId(aspect as u8));
            held.is_false() && usize::from(held.believes) == truth
        });
        Some(if unsure { Kind::Distractor } else { Kind::Silent })
    }

    fn situation(&self, session: &Session, kind: Kind, witness: &RecordedBelief) -> Result<Situation, Box<dyn Error>> {
        let kitchen = &session.kitchen;
        let mut frames = Vec::new();
        for size in SIZES {
            let mut model = self.model.clone();
            model.size = size;
            let mut terminal = Terminal::new(TestBackend::new(size.0, size.1))?;
            terminal.draw(|frame| view(session, &model, frame))?;
            frames.push(ansi(terminal.backend().buffer()));
        }
        let recommended = session.advice.as_ref().and_then(|advice| advice.best.as_ref().and(advice.top()));
        let location = self.best.0.as_ref().and_then(|signal| signal.location(kitchen));
        let key = location.and_then(|location| self.model.keys.mark(location));
        let really_false =
            kitchen.aspects.iter().zip(&witness.aspects).enumerate().filter_map(|(index, (aspect, held))| {
                let truth = &aspect.labels[kitchen.true_value(session.state, AspectId(index as u8))];
                (held.believes != *truth).then(|| format!("{} believed {} is {truth}", aspect.name, held.believes))
            });
        let row = format!(
            "{kind:?},{},{},{},{:.1},{}",
            key.map_or("none".to_string(), |key| format!("{key} or enter")),
            self.best.0.as_ref().and_then(Signal::target).unwrap_or("none"),
            recommended.map_or(String::new(), |option| format!("{:.1}", option.net)),
            self.model.now.secs_since(self.best.1),
            really_false.collect::<Vec<_>>().join("; "),
        );
        Ok(Situation { frames, row })
    }
}

/// The screen as text, with ANSI sequences where the style changes.
fn ansi(buffer: &Buffer) -> String {
    let mut text = String::new();
    for y in 0..buffer.area.height {
        let mut style = String::new();
        for x in 0..buffer.area.width {
            let cell = &buffer[(x, y)];
            let next = sequence(cell);
            if next != style {
                let _ = write!(text, "\u{1b}[0{next}m");
                style = next;
            }
            text.push_str(cell.symbol());
        }
        text.push_str(if style.is_empty() { "\n" } else { "\u{1b}[0m\n" });
    }
    text
}

/// Parameters of the ANSI sequence of a cell's style.
fn sequence(cell: &Cell) -> String {
    let marks = [(Modifier::BOLD, ";1"), (Modifier::DIM, ";2"), (Modifier::REVERSED, ";7")];
    let mut sequence: String =
        marks.iter().filter(|(mark, _)| cell.modifier.contains(*mark)).map(|(_, code)| *code).collect();
    if let Color::Indexed(index) = cell.fg {
        let _ = write!(sequence, ";38;5;{index}");
    }
    sequence
}
