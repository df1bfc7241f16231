//! What a recording shows of its participant: gaze, presses and the display, cut into the intervals between presses.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use tomcom::base::time::SessionTime;
use tomcom::edge::log::LogReader;
use tomcom::gaze::GazeSample;
use tomcom::kitchen::{Kitchen, KitchenChange, LocationId, Press, State};
use tomcom::measures::belief_detection::EstimateBeforePress;
use tomcom::participant::population::Population;
use tomcom::participant::recorded_eyes::{RecordedFixation, fixations};
use tomcom::session::settings::ParticipantKind;
use tomcom::session::{Event, Session, TimestampedEvent, apply};

/// Something that a recording shows, which a simulated participant can follow.
#[derive(Clone, Debug)]
pub enum Shown {
    /// A fixation begins at a point of the display, and at a location if one is there.
    Fixation([f64; 2], Option<LocationId>),
    /// The fixated location is read.
    Reading,
    /// An order appeared or disappeared.
    Order,
    /// The robot pressed a button.
    RobotPress(Press),
}

/// Something that a recording shows, with its time and the state of the kitchen from then on.
#[derive(Clone, Debug)]
pub struct Clue {
    /// Session time.
    pub time: SessionTime,
    /// What the recording shows.
    pub shown: Shown,
    /// State of the kitchen after it.
    pub state: State,
}

/// The time from one press of the human to the next, with what is recorded of the belief at its end.
#[derive(Clone, Debug)]
pub struct Interval {
    /// What the recording shows before the press, in order.
    pub clues: Vec<Clue>,
    /// Session time of the press.
    pub time: SessionTime,
    /// The press at the end of the interval.
    pub press: Press,
    /// Truth, for the scores only: for each aspect, the participant's own P(truth) before the press.
    pub held: Vec<f64>,
    /// The program's estimate before the press.
    pub estimate: EstimateBeforePress,
    /// For each location, the time since somebody else last changed it, in seconds; `None` if that was the human, or
    /// nobody.
    pub since_change_s: Vec<Option<f64>>,
}

/// What a recording shows of its participant.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// The recorded kitchen.
    pub kitchen: Arc<Kitchen>,
    /// The population from which the participant was drawn.
    pub population: Population,
    /// Session time at which the trial started, with the state of the kitchen.
    pub started: (SessionTime, State),
    /// The intervals between presses of the human.
    pub intervals: Vec<Interval>,
}

/// Changes and presses of a recording while it is being read.
#[derive(Default)]
struct Reading {
    samples: Vec<(SessionTime, GazeSample)>,
    clues: Vec<Clue>,
    started: Option<(SessionTime, State)>,
    held: Option<Vec<f64>>,
    changed: Vec<Option<SessionTime>>,
    /// Presses of the human with their sequence numbers; the estimate comes after its press.
    presses: Vec<(u64, Interval)>,
    estimates: Vec<(u64, EstimateBeforePress)>,
}

/// Reads a recording of an unassisted trial.
///
/// # Errors
/// It cannot be read; it is no trial of a simulated participant with gaze; it was interrupted or has signals.
pub fn read(recording: &Path) -> Result<Evidence, Box<dyn Error + Send + Sync>> {
    let wrong = |found: &str| format!("{}: {found}; record trials with --condition none", recording.display());
    let mut log = LogReader::open(recording).map_err(|error| wrong(&error.to_string()))?;
    let mut session = log.session();
    let mut reading = Reading { changed: vec![None; log.kitchen.locations.len()], ..Reading::default() };
    if session.spec.participant.kind != ParticipantKind::Simulated {
        return Err(wrong("the participant is not simulated").into());
    }
    while let Some(line) = log.next_line().map_err(|error| wrong(&error.to_string()))? {
        let applied = apply(&mut session, &line.stamped).map_err(|error| wrong(&error.to_string()))?;
        reading.take(&session, &line.stamped, &applied.change).map_err(wrong)?;
    }
    let population = session.spec.participant.population.clone().unwrap_or_default();
    let kitchen = session.kitchen.clone();
    let started = reading.started.ok_or_else(|| wrong("no trial"))?;
    let fixations = fixations(&kitchen, &reading.samples);
    if fixations.is_empty() {
        return Err(wrong("no gaze").into());
    }
    let intervals = reading.intervals(&fixations, started.1).ok_or_else(|| wrong("presses without beliefs"))?;
    Ok(Evidence { kitchen, population, started, intervals })
}

impl Reading {
    fn take(
        &mut self,
        session: &Session,
        stamped: &TimestampedEvent,
        change: &KitchenChange,
    ) -> Result<(), &'static str> {
        let (time, state) = (stamped.time, session.state);
        match &stamped.event {
            Event::TrialPaused | Event::Probe(_) => return Err("an interrupted trial"),
            Event::SignalShown { .. } => return Err("a trial with signals"),
            Event::Gaze(sample) if session.is_running() => self.samples.push((time, session.corrected(*sample))),
            Event::ParticipantBelieves(witness) => {
                self.held = Some(witness.aspects.iter().map(|aspect| aspect.p_truth).collect());
            }
            Event::BeliefEstimated(estimate) => {
                self.estimates.push((estimate.press, EstimateBeforePress::from_witness(estimate)));
            }
            _ => {}
        }
        match *change {
            KitchenChange::TrialStarted { after, .. } => self.started = Some((time, after)),
            KitchenChange::Order { .. } => self.clues.push(Clue { time, shown: Shown::Order, state }),
            KitchenChange::Press { press, .. } if change.human_press().is_none() => {
                self.clues.push(Clue { time, shown: Shown::RobotPress(press), state });
            }
            KitchenChange::Press { press, .. } => {
                let since_change_s = self.changed.iter().map(|at| at.map(|at| time.secs_since(at))).collect();
                let held = self.held.take().ok_or("a press without a recorded belief")?;
                let estimate = EstimateBeforePress { p_false: Vec::new(), log_p: 0.0 };
                let interval = Interval { clues: Vec::new(), time, press, held, estimate, since_change_s };
                self.presses.push((stamped.seq, interval));
            }
            _ => {}
        }
        if let Some((before, after)) = change.states() {
            for (index, at) in self.changed.iter_mut().enumerate() {
                if before.code(LocationId(index as u8)) != after.code(LocationId(index as u8)) {
                    *at = change.human_press().is_none().then_some(time);
                }
            }
        }
        Ok(())
    }

    /// Sorts fixations, readings and changes into the intervals between presses; `None` if an estimate is missing.
    fn intervals(self, fixations: &[RecordedFixation], start: State) -> Option<Vec<Interval>> {
        let mut states: Vec<(SessionTime, State)> = self.clues.iter().map(|clue| (clue.time, clue.state)).collect();
        states.extend(self.presses.iter().map(|(_, interval)| (interval.time, interval.press.after)));
        states.sort_by_key(|(time, _)| *time);
        let state_at = |time: SessionTime| {
            let passed = states.partition_point(|(at, _)| *at <= time);
            passed.checked_sub(1).map_or(start, |last| states[last].1)
        };
        let mut clues = self.clues;
        for fixation in fixations {
            let clue = |time, shown| Clue { time, shown, state: state_at(time) };
            clues.push(clue(fixation.begin, Shown::Fixation(fixation.point, fixation.location)));
            let Some(location) = fixation.location else { continue };
            let mut shown = vec![fixation.begin];
            let within = states.iter().filter(|(at, _)| (fixation.begin..=fixation.end).contains(at));
            let mut code = state_at(fixation.begin).code(location);
            for (at, state) in within {
                if state.code(location) != code {
                    code = state.code(location);
                    shown.push(*at);
                }
            }
            for (index, &from) in shown.iter().enumerate() {
                let next = shown.get(index + 1);
                // A change before the reading makes the eyes begin again.
                let read = fixation.reads(from).filter(|read| next.is_none_or(|next| read < next));
                clues.extend(read.map(|read| clue(read, Shown::Reading)));
            }
        }
        clues.sort_by_key(|clue| clue.time);
        let (mut clues, mut estimates) = (clues.into_iter().peekable(), self.estimates.into_iter().peekable());
        let mut intervals = Vec::with_capacity(self.presses.len());
        for (seq, mut interval) in self.presses {
            interval.clues.extend(std::iter::from_fn(|| clues.next_if(|clue| clue.time < interval.time)));
            interval.estimate = estimates.next_if(|(press, _)| *press == seq)?.1;
            intervals.push(interval);
        }
        Some(intervals)
    }
}
