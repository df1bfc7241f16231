//! Entities of beliefs: curves and lanes of what is believed wrong, and the page that tells in words what was pressed,
//! shown and believed.

use super::entity_content::{
    self, CURVES, EntityData, EntityUpdate, MarkShape, SceneColour, SceneLogLevel, SeriesStyle, slug,
};
use super::happenings::{self, JudgedPressShown};
use super::{SceneInputs, SceneUpdate, moment_on_clock};
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Agent, AspectId, Kitchen, StateAspect};
use tomcom_core::measures::sequences::FALSE_BELOW;
use tomcom_core::mind::RecordedBelief;
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_session::follower::SessionFollower;
use tomcom_session::history::false_beliefs::{EstimatedFalseBelief, HeldFalseBelief};
use tomcom_session::history::wording;
use tomcom_session::{Event, Session, TimelineEntry, TimelineEvent, TimestampedEvent};

/// Period of updates of the belief estimate between presses, in nanoseconds.
const EVERY_NS: u64 = 200_000_000;
/// State aspects with at least this P(truth), the estimated probability of the true value, are not listed on the page.
const KNOWN: f64 = 0.95;
/// A belief that is false for so long gets a curve, which begins where it turned false.
const LASTING: SessionTime = SessionTime(1_000_000_000);
/// Path of the page in words.
const PAGE: &str = "human/now";
/// Path of the lane with the human's errors, each until the next press.
pub const ERRORS: &str = "error";
/// Path of the lane with the present signal.
pub const SIGNALS: &str = "signal";
/// Beginning of the paths of lanes with what is believed falsely, by the estimate.
pub const WRONG_BELIEFS: &str = "wrong_belief/";

/// A belief about one state aspect.
#[derive(Clone, Copy)]
struct Held {
    aspect: usize,
    p_truth: f64,
}

/// The curve of one state aspect: of what is believed wrong for a while, until it is known.
#[derive(Clone, Debug, Default)]
struct BeliefCurve {
    is_open: bool,
    /// When the last false belief began that it shows or showed.
    drawn: Option<SessionTime>,
    /// Before it begins: the rows of the last time before the belief turned false, and all since.
    past: Vec<SceneUpdate>,
}

/// State of the Rerun entities that show beliefs.
#[derive(Clone, Debug, Default)]
pub struct BeliefScene {
    tick: Option<u64>,
    /// For each state aspect, when the false belief began whose bar is drawn.
    drawn_since: Vec<Option<SessionTime>>,
    curves: Vec<BeliefCurve>,
    /// Past rows of curves that have just begun.
    pub begun: Vec<SceneUpdate>,
    /// Parts of the page: the last press of the human with the false beliefs before it, the signal, what the assistant
    /// advises, and the estimate after all events so far.
    press: String,
    is_error: bool,
    signal: String,
    /// Since when the signal is shown: the next one may have the same words.
    signal_since: Option<SessionTime>,
    pub advice: String,
    estimate: String,
    /// What the robot does, and where the participant looks.
    pub robot: String,
    pub gaze: String,
    page: String,
}

fn estimated(aspect: &str) -> String {
    format!("human/belief/estimated/{}", slug(aspect))
}

/// Path of the marks at presses before which a simulated participant's belief about an aspect is false.
fn held_truly(aspect: &str) -> String {
    format!("human/belief/true/{}", slug(aspect))
}

fn wrong(aspect: &str) -> String {
    format!("{WRONG_BELIEFS}{}", slug(aspect))
}

/// Entity updates with the names and colours of the curves and marks.
pub fn fixed_beliefs(kitchen: &Kitchen) -> Vec<EntityUpdate> {
    let of_aspect = |(aspect, colour): (&StateAspect, SceneColour)| {
        // The marks of the participant's own belief have the colour and name of the curve: one line of the legend.
        let series = SeriesStyle { name: wording::location(&aspect.name), colour };
        [
            EntityUpdate::new(estimated(&aspect.name), EntityData::Line(series.clone())),
            EntityUpdate::new(held_truly(&aspect.name), EntityData::Marks(series, MarkShape::Diamond)),
        ]
    };
    kitchen.aspects.iter().zip(CURVES.into_iter().cycle()).flat_map(of_aspect).collect()
}

impl BeliefScene {
    /// Whether the estimate is shown at this time, if nobody presses then.
    pub fn is_due(&self, now: SessionTime) -> bool {
        self.tick.is_none_or(|last| last < now.0 / EVERY_NS)
    }

    /// Entity updates from an event that has just been applied to the session, with the entries of the timeline that it
    /// made; `belief` is the estimate after the event.
    pub fn follow(
        &mut self,
        session: &Session,
        stamped: &TimestampedEvent,
        new: &[TimelineEntry],
        pressed: Option<JudgedPressShown<'_>>,
        inputs: SceneInputs<'_>,
    ) -> Vec<EntityUpdate> {
        let (mut rows, follower) = (Vec::new(), inputs.follower);
        for entry in new {
            if let TimelineEvent::Press { agent, .. } = entry.what {
                if agent == Agent::Human {
                    rows.extend(self.pressed(session, entry, pressed, follower));
                }
                // The estimate after the press is shown at the press's time.
                self.tick = None;
            }
        }
        match &stamped.event {
            Event::ParticipantBelieves(witness) => rows.extend(truly(&session.kitchen, witness)),
            Event::BeliefEstimated(witness) => {
                // What was shown at the press's time so far is before it.
                self.tick = None;
                let told = witness.aspects.iter().enumerate();
                let held: Vec<Held> = told.map(|(aspect, told)| Held { aspect, p_truth: told.p_truth }).collect();
                rows.extend(self.drawn(session, stamped.seq, &held, follower));
            }
            _ => {}
        }
        let due = inputs.belief.filter(|_| self.is_due(stamped.time));
        rows.extend(due.map(|belief| self.now(session, stamped.seq, belief, follower)).unwrap_or_default());
        rows.extend(self.bars(session, follower));
        let shown = session.shown.as_ref();
        if shown.map(|shown| shown.since) != self.signal_since {
            self.signal_since = shown.map(|shown| shown.since);
            self.signal = shown.and_then(|shown| happenings::numbered(follower, shown.since)).unwrap_or_default();
            rows.push(EntityUpdate::new(SIGNALS, EntityData::State(self.signal.clone(), entity_content::SIGNAL)));
        }
        let page = self.page();
        if page != self.page {
            self.page.clone_from(&page);
            rows.push(EntityUpdate::new(PAGE, EntityData::Page(page)));
        }
        rows
    }

    fn pressed(
        &mut self,
        session: &Session,
        entry: &TimelineEntry,
        judged: Option<JudgedPressShown<'_>>,
        follower: &SessionFollower,
    ) -> Option<EntityUpdate> {
        let at = in_both_clocks(session.trial_clock(entry.time));
        let error = judged.filter(|judged| judged.press.verdict.error);
        let (_, pressed) = happenings::told(session, entry, error.is_some());
        let was_error = std::mem::replace(&mut self.is_error, error.is_some());
        let Some(error) = error else {
            let verdict = match judged {
                Some(judged) if judged.press.verdict.race => {
                    "No error, but a race with the robot: it changed this place just before"
                }
                Some(_) => "No error",
                None => "It does not count",
            };
            self.press = format!("**Last press**, {at}: {pressed}. {verdict}.\n");
            return was_error
                .then(|| EntityUpdate::new(ERRORS, EntityData::State(String::new(), entity_content::ERROR)));
        };
        let why = error.why(session);
        self.press = format!("## Error {} at {at}: {pressed}\n\n**Why an error**: {why}.\n", error.number);
        if let Some(before) = follower.believed_wrong(error.press.time) {
            self.press += &listed("Believed wrong before it, by the simulated participant", &before.participant);
            self.press += &listed("Believed wrong before it, by the estimate", &before.estimate);
        }
        let words = format!("{}: {pressed}: {why}", error.number);
        Some(EntityUpdate::new(ERRORS, EntityData::State(words, entity_content::ERROR)))
    }

    /// Entity updates of the estimate after all events so far: the curves, and what is believed now, in words.
    fn now(
        &mut self,
        session: &Session,
        step: u64,
        belief: &DirichletBelief,
        follower: &SessionFollower,
    ) -> Vec<EntityUpdate> {
        self.tick = Some(session.time.0 / EVERY_NS);
        let kitchen = &session.kitchen;
        let of_aspect =
            |aspect: AspectId| Held { aspect: aspect.index(), p_truth: belief.p_truth(kitchen, session.state, aspect) };
        let held: Vec<Held> = kitchen.aspect_ids().map(of_aspect).collect();
        self.estimate = told_now(session, belief, &held, follower);
        self.drawn(session, step, &held, follower)
    }

    /// Bars of false beliefs that begin or end.
    fn bars(&mut self, session: &Session, follower: &SessionFollower) -> Vec<EntityUpdate> {
        let kitchen = &session.kitchen;
        self.drawn_since.resize(kitchen.aspects.len(), None);
        let mut rows = Vec::new();
        for (index, drawn) in self.drawn_since.iter_mut().enumerate() {
            let aspect = AspectId(index as u8);
            let held = follower.false_beliefs.at(aspect, session.time);
            if held.map(|held| held.began) == *drawn {
                continue;
            }
            let over = drawn.and_then(|_| follower.false_beliefs.before(aspect, session.time));
            rows.extend(over.filter(|over| over.lasts(session)).map(|over| {
                let text = format!("estimated false belief: {}", over.whole(session));
                let (level, colour) = (SceneLogLevel::Info, entity_content::FALSE);
                EntityUpdate::new("human/false_beliefs", EntityData::Words { level, text, colour })
            }));
            *drawn = held.map(|held| held.began);
            let words = held.map_or_else(String::new, |held| held.told(kitchen));
            let data = EntityData::State(words, entity_content::FALSE);
            rows.push(EntityUpdate::new(wrong(&kitchen.aspects[index].name), data));
        }
        rows
    }

    /// The trial is over, and with it the last error and advice.
    pub fn ended(&mut self) -> Option<EntityUpdate> {
        self.advice.clear();
        let was_error = std::mem::take(&mut self.is_error);
        was_error.then(|| EntityUpdate::new(ERRORS, EntityData::State(String::new(), entity_content::ERROR)))
    }

    /// Rows of the curves: of aspects that are believed wrong for a while, until they are known.
    fn drawn(&mut self, session: &Session, step: u64, held: &[Held], follower: &SessionFollower) -> Vec<EntityUpdate> {
        let kitchen = &session.kitchen;
        let mut rows = Vec::new();
        let now = session.time;
        self.curves.resize(kitchen.aspects.len(), BeliefCurve::default());
        for (one, curve) in held.iter().zip(&mut self.curves) {
            let entity = estimated(&kitchen.aspects[one.aspect].name);
            let value = EntityUpdate::new(&entity, EntityData::Value(one.p_truth));
            let moment = SceneUpdate { time: now, trial: session.trial_clock(now), step, rows: vec![value.clone()] };
            let (aspect, is_wrong) = (AspectId(one.aspect as u8), one.p_truth < FALSE_BELOW);
            let present = follower.false_beliefs.until(aspect, now);
            if curve.is_open {
                curve.drawn = present.filter(|_| is_wrong).map(|held| held.began).or(curve.drawn);
            } else {
                // Also one that is over: nothing may have been drawn between its first second and its end.
                let lasts = |held: &&EstimatedFalseBelief| {
                    let until = held.ended.map_or(now, |ended| ended.min(now));
                    held.aspect == aspect && until - held.began >= LASTING
                };
                let is_new = |held: &&EstimatedFalseBelief| curve.drawn.is_none_or(|drawn| held.began > drawn);
                let Some(lasting) = follower.false_beliefs.all().rev().take_while(is_new).find(lasts) else {
                    if present.is_none() || !is_wrong {
                        // A press has two rows.
                        curve.past.retain(|moment| moment.time == now);
                    }
                    curve.past.push(moment);
                    continue;
                };
                curve.drawn = Some(lasting.began);
                self.begun.append(&mut curve.past);
            }
            curve.is_open = one.p_truth < KNOWN;
            rows.push(value);
            if !curve.is_open {
                rows.push(EntityUpdate::new(entity, EntityData::NoValue));
                curve.past.push(moment);
            }
        }
        rows
    }

    fn page(&self) -> String {
        fn or<'a>(text: &'a str, without: &'a str) -> &'a str {
            if text.is_empty() { without } else { text }
        }
        let press = or(&self.press, "**Last press**: none so far\n");
        let (signal, advice) = (or(&self.signal, "no signal"), or(&self.advice, "no advice"));
        format!(
            "{press}\n**On the display**: {signal}\n\n**Assistant**: {advice}\n\n**Robot**: {}\n\n**Looks at**: {}\n{}",
            self.robot, self.gaze, self.estimate
        )
    }
}

/// Entity updates from the recorded belief of a simulated participant before its press.
fn truly(kitchen: &Kitchen, witness: &RecordedBelief) -> Vec<EntityUpdate> {
    let told = kitchen.aspects.iter().zip(&witness.aspects);
    let wrong = told.filter(|(_, told)| told.p_truth < FALSE_BELOW);
    wrong.map(|(about, told)| EntityUpdate::new(held_truly(&about.name), EntityData::Value(told.p_truth))).collect()
}

/// What is believed now, by the estimate, in Markdown.
fn told_now(session: &Session, belief: &DirichletBelief, held: &[Held], follower: &SessionFollower) -> String {
    let named = |held: &Held| wording::aspect(&session.kitchen, session.state, AspectId(held.aspect as u8));
    let unsure = held.iter().filter(|one| (FALSE_BELOW..KNOWN).contains(&one.p_truth));
    let unsure: Vec<String> = unsure.map(|one| format!("{} {}", named(one), percent(one.p_truth))).collect();
    let since = |aspect| follower.false_beliefs.at(aspect, session.time).map(|held| held.began);
    let values = |aspect| belief.aspect(aspect).mean();
    let wrong = HeldFalseBelief::among(session, session.state, &[], values, since);
    let mut told = match wrong.is_empty() {
        true => "\nNothing is believed wrong now, by the estimate.\n".to_string(),
        false => listed("Believed wrong now, by the estimate", &wrong),
    };
    if !unsure.is_empty() {
        let below = KNOWN * 100.0;
        told += &format!("\nRight, but with a P(truth) below {below:.0} %: {}.\n", unsure.join(", "));
    }
    told
}

/// False beliefs in Markdown, with a title; empty without any. A list, since the viewer breaks lines in lists, not in tables.
fn listed(title: &str, held: &[HeldFalseBelief]) -> String {
    let line = |one: &HeldFalseBelief| {
        let since = one.since().map_or_else(String::new, |since| format!("; since {}", moment_on_clock(since)));
        format!("- **{}**: {}; P(truth) {}{since}\n", one.about, one.told, percent(one.p_truth))
    };
    let lines: String = held.iter().map(line).collect();
    if lines.is_empty() { lines } else { format!("\n{title}:\n\n{lines}") }
}

fn percent(p: f64) -> String {
    format!("{:.0} %", 100.0 * p)
}

/// A time on the trial's clock as the console shows it, and as the viewer does: "1:25.6 (+85.619s)".
fn in_both_clocks(time: SessionTime) -> String {
    format!("{} (+{}s)", moment_on_clock(time), time.in_seconds())
}
