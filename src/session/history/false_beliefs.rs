//! False beliefs: those of the estimate as intervals of time, and all before an error. The one source for replays, the review
//! and exports.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::history::wording;
use crate::{Event, Session, TimestampedEvent, TrialPhase};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::recommendation::aspects_told;
use tomcom_core::kitchen::{Agent, AspectId, Kitchen, Press, State};
use tomcom_core::measures::attribution::ErrorCause;
use tomcom_core::measures::sequences::{FALSE_BELOW, FalseBeliefEpisode, FalseBeliefTracker};
use tomcom_core::mind::belief::Belief;
use tomcom_core::mind::dirichlet::DirichletBelief;

/// Where only gaze changes the estimate, false beliefs begin and end at the first sample of such a period, in nanoseconds;
/// other events count at once.
const EVERY_NS: u64 = 200_000_000;

/// Least duration of a false belief that lasts, in seconds.
const LEAST_S: f64 = 1.0;

/// What ended a false belief.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FalseBeliefEnd {
    /// The true value became another one: the one that was believed, or one that is known.
    KitchenChange,
    /// A signal about the state aspect was on the participant's display.
    Signal,
    Look,
    Press(Agent),
    AnotherValue,
    TrialEnd,
}

impl FalseBeliefEnd {
    /// "until a look".
    pub fn words(self) -> &'static str {
        match self {
            FalseBeliefEnd::KitchenChange => "until the kitchen changed",
            FalseBeliefEnd::Signal => "until a signal told it",
            FalseBeliefEnd::Look => "until a look",
            FalseBeliefEnd::Press(Agent::Human) => "until a press of the human",
            FalseBeliefEnd::Press(Agent::Robot) => "until a press of the robot",
            FalseBeliefEnd::AnotherValue => "until another wrong value was believed",
            FalseBeliefEnd::TrialEnd => "until the trial ended",
        }
    }
}

/// One false belief about one state aspect, by the estimate. Another truth, or another wrong value that is believed most, is
/// another false belief.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EstimatedFalseBelief {
    pub aspect: AspectId,
    /// Session time.
    pub began: SessionTime,
    /// Session time; `None` while it is held.
    pub ended: Option<SessionTime>,
    /// `None` while it is held.
    pub end: Option<FalseBeliefEnd>,
    /// Index of the wrong value that is most probably believed.
    pub thinks: usize,
    /// Index of the true value.
    pub truth: usize,
    /// What it is about, in words: "recipe of tuna maki (order 1)".
    pub about: String,
}

impl EstimatedFalseBelief {
    /// How long it lasted, or has lasted so far, on the trial's clock.
    pub fn lasted_s(&self, session: &Session) -> f64 {
        session.age(self.began, self.ended.unwrap_or(session.time)).as_secs_f64()
    }

    /// Whether it lasts: half of all are looks that nobody has taken yet.
    pub fn lasts(&self, session: &Session) -> bool {
        self.lasted_s(session) >= LEAST_S
    }

    /// What is believed and what is true, in words: "thinks empty, is nori".
    pub fn told(&self, kitchen: &Kitchen) -> String {
        let (thinks, truth) = wording::contrast(kitchen, self.aspect, self.thinks, self.truth);
        format!("thinks {thinks}, {truth}")
    }

    /// The same, with the duration and what ended it: "cooking pot: thinks empty, is nori; for 2.3 s, until a look".
    pub fn whole(&self, session: &Session) -> String {
        let (told, lasted) = (self.told(&session.kitchen), wording::seconds(self.lasted_s(session)));
        let end = self.end.map_or(String::new(), |end| format!(", {}", end.words()));
        format!("{}: {told}; for {lasted}{end}", self.about)
    }
}

/// The false beliefs of a trial so far, in the order of their beginnings.
#[derive(Clone, Debug, Default)]
pub struct EstimatedFalseBeliefs {
    all: Vec<EstimatedFalseBelief>,
    /// For each state aspect, the index of its last false belief.
    last: Vec<Option<usize>>,
    tick: Option<u64>,
}

impl EstimatedFalseBeliefs {
    /// Takes the estimate after an event that was just applied. Before the trial and after it nothing is believed falsely;
    /// in a pause beliefs last.
    pub(crate) fn note(&mut self, session: &Session, belief: &DirichletBelief, stamped: &TimestampedEvent) {
        let (kitchen, state, now) = (&session.kitchen, session.state, stamped.time);
        let tick = Some(now.0 / EVERY_NS);
        if stamped.event.is_sample() && self.tick == tick {
            return;
        }
        self.tick = tick;
        self.last.resize(kitchen.aspects.len(), None);
        let is_trial = matches!(session.phase, TrialPhase::Running | TrialPhase::Paused);
        for index in 0..kitchen.aspects.len() {
            let aspect = AspectId(index as u8);
            let is_false = is_trial && belief.p_truth(kitchen, state, aspect) < FALSE_BELOW;
            let held = is_false.then(|| {
                let (mean, truth) = (belief.aspects[index].mean(), kitchen.true_value(state, aspect));
                (likeliest_wrong(mean, truth), truth)
            });
            let open = self.last[index].map(|last| &mut self.all[last]).filter(|last| last.ended.is_none());
            if open.as_ref().map(|open| (open.thinks, open.truth)) == held {
                continue;
            }
            if let Some(open) = open {
                open.ended = Some(now);
                open.end = Some(match held {
                    _ if !is_trial => FalseBeliefEnd::TrialEnd,
                    _ if open.truth != kitchen.true_value(state, aspect) => FalseBeliefEnd::KitchenChange,
                    Some(_) => FalseBeliefEnd::AnotherValue,
                    None => corrected_by(session, aspect, &stamped.event),
                });
            }
            if let Some((thinks, truth)) = held {
                self.last[index] = Some(self.all.len());
                let about = wording::aspect(kitchen, state, aspect);
                self.all.push(EstimatedFalseBelief {
                    aspect,
                    began: now,
                    ended: None,
                    end: None,
                    thinks,
                    truth,
                    about,
                });
            }
        }
    }

    /// All but those that were over when other events of the same time had been applied.
    pub fn all(&self) -> impl DoubleEndedIterator<Item = &EstimatedFalseBelief> {
        self.all.iter().filter(|one| one.ended != Some(one.began))
    }

    /// The last false belief about an aspect of which `begun` holds, unless `over` holds of its end.
    fn last(
        &self,
        aspect: AspectId,
        begun: impl Fn(SessionTime) -> bool,
        over: impl Fn(SessionTime) -> bool,
    ) -> Option<&EstimatedFalseBelief> {
        let last = self.last.get(aspect.index()).copied().flatten()?;
        let mut those = self.all[..=last].iter().rev().filter(|one| one.aspect == aspect);
        let found = those.find(|one| one.ended != Some(one.began) && begun(one.began))?;
        found.ended.is_none_or(|ended| !over(ended)).then_some(found)
    }

    /// The false belief about an aspect that is held at a time.
    pub fn at(&self, aspect: AspectId, time: SessionTime) -> Option<&EstimatedFalseBelief> {
        self.last(aspect, |began| began <= time, |ended| ended <= time)
    }

    /// The false belief about an aspect that was held just before a time.
    pub fn before(&self, aspect: AspectId, time: SessionTime) -> Option<&EstimatedFalseBelief> {
        self.last(aspect, |began| began < time, |ended| ended < time)
    }

    /// The false belief about an aspect that is held at a time, or ends then.
    pub fn until(&self, aspect: AspectId, time: SessionTime) -> Option<&EstimatedFalseBelief> {
        self.last(aspect, |began| began <= time, |ended| ended < time)
    }

    /// When the belief about an aspect that is false at a time became right; `None` if it has not.
    pub fn corrected(&self, aspect: AspectId, time: SessionTime) -> Option<SessionTime> {
        let mut until = time;
        let later = self.all().filter(|one| one.aspect == aspect && one.ended.is_none_or(|ended| ended > time));
        for one in later {
            if one.began > until {
                break;
            }
            until = one.ended?;
        }
        Some(until)
    }
}

/// A belief about a state aspect that is false at one moment. Values have the names of the log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeldFalseBelief {
    pub aspect: String,
    /// The wrong value that is most probably believed.
    pub believes: String,
    pub p_believes: f64,
    pub truth: String,
    pub p_truth: f64,
    /// On the trial's clock; `None` if it began with that moment.
    pub since_s: Option<f64>,
    /// In words: "recipe of tuna maki (order 1)".
    #[serde(skip)]
    pub about: String,
    /// In words: "thinks empty, is nori".
    #[serde(skip)]
    pub told: String,
}

impl HeldFalseBelief {
    /// The false ones among beliefs about all state aspects, those about `first` before the others, then the most certain
    /// first. `values`: the belief about an aspect; `since`: when a false belief began, in session time.
    pub fn among<'a>(
        session: &Session,
        state: State,
        first: &[AspectId],
        values: impl Fn(AspectId) -> &'a [f64],
        since: impl Fn(AspectId) -> Option<SessionTime>,
    ) -> Vec<HeldFalseBelief> {
        let kitchen = &session.kitchen;
        let p_truth = |aspect: AspectId| values(aspect)[kitchen.true_value(state, aspect)];
        let mut held: Vec<AspectId> = kitchen.aspect_ids().filter(|&aspect| p_truth(aspect) < FALSE_BELOW).collect();
        held.sort_by(|a, b| {
            first.contains(b).cmp(&first.contains(a)).then_with(|| p_truth(*a).total_cmp(&p_truth(*b)))
        });
        let told = |aspect: AspectId| {
            let (values, truth) = (values(aspect), kitchen.true_value(state, aspect));
            let (wrong, names) = (likeliest_wrong(values, truth), &kitchen.aspects[aspect.index()]);
            HeldFalseBelief {
                aspect: names.name.clone(),
                believes: names.labels[wrong].clone(),
                p_believes: values[wrong],
                truth: names.labels[truth].clone(),
                p_truth: values[truth],
                since_s: since(aspect).map(|since| session.trial_clock_at(since).as_secs_f64()),
                about: wording::aspect(kitchen, state, aspect),
                told: wording::false_belief(kitchen, aspect, (wrong, values[wrong]), truth),
            }
        };
        held.into_iter().map(told).collect()
    }

    pub fn since(&self) -> Option<SessionTime> {
        self.since_s.map(SessionTime::from_secs_f64)
    }
}

/// The participant's own false beliefs by state aspect, as far as it records them: the wrong value that is most probably
/// believed, the true value, and when this began. As in the estimate, another wrong value or truth is another false belief.
#[derive(Clone, Debug, Default)]
pub(crate) struct OwnFalseBeliefs(BTreeMap<AspectId, (usize, usize, SessionTime)>);

impl OwnFalseBeliefs {
    /// Takes a recorded belief, which `episodes` have taken.
    pub(crate) fn note(&mut self, session: &Session, now: SessionTime, belief: &Belief, episodes: &FalseBeliefTracker) {
        let kitchen = &session.kitchen;
        for aspect in kitchen.aspect_ids() {
            let (values, truth) = (belief.distribution(aspect), kitchen.true_value(session.state, aspect));
            if values[truth] >= FALSE_BELOW {
                self.0.remove(&aspect);
                continue;
            }
            let wrong = likeliest_wrong(values, truth);
            let began = match self.0.get(&aspect) {
                Some(&(believed, was, began)) if (believed, was) == (wrong, truth) => began,
                // Only a location's truth changes.
                Some(&(_, was, _)) if was != truth => session.changed_at[aspect.index()],
                Some(_) => now,
                None => {
                    let is_it = |one: &&FalseBeliefEpisode| one.aspect == aspect && one.corrected.is_none();
                    episodes.all().find(is_it).map_or(now, |one| one.began)
                }
            };
            self.0.insert(aspect, (wrong, truth, began));
        }
    }

    /// When the false belief about an aspect that is held began.
    pub(crate) fn began(&self, aspect: AspectId) -> Option<SessionTime> {
        self.0.get(&aspect).map(|(.., began)| *began)
    }
}

/// What was believed wrong just before an error, and advised then.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FalseBeliefsBefore {
    /// The participant's own, as far as it records them.
    pub participant: Vec<HeldFalseBelief>,
    pub estimate: Vec<HeldFalseBelief>,
    /// Why nothing was advised, in words.
    #[serde(skip)]
    pub none_advised: Option<String>,
}

impl FalseBeliefsBefore {
    /// "believed wrong before it, by the participant: cooking pot: thinks empty, is nori since 1:15; by the estimate: …;
    /// advice before it: no signal".
    pub fn told(&self) -> Option<String> {
        let one = |held: &HeldFalseBelief| {
            let since = held.since().map_or(String::new(), |since| format!(" since {since}"));
            format!("{}: {}{since}", held.about, held.told)
        };
        let parts = [("participant", &self.participant), ("estimate", &self.estimate)].into_iter();
        let told = parts
            .filter(|(_, held)| !held.is_empty())
            .map(|(by, held)| format!("by the {by}: {}", held.iter().map(one).collect::<Vec<_>>().join("; ")));
        let told: Vec<String> = told.collect();
        let believed = (!told.is_empty()).then(|| format!("believed wrong before it, {}", told.join("; ")));
        let advice = self.none_advised.as_ref().map(|why| format!("advice before it: {why}"));
        let parts: Vec<String> = believed.into_iter().chain(advice).collect();
        (!parts.is_empty()).then(|| parts.join("; "))
    }
}

/// The state aspects that an error is about: those of the false belief that caused it, and the places of the press.
pub(crate) fn aspects_of(kitchen: &Kitchen, press: &Press, cause: Option<ErrorCause>) -> Vec<AspectId> {
    let targets = cause.into_iter().flat_map(ErrorCause::targets);
    let caused = targets.flat_map(|target| target.aspects(kitchen));
    let places = kitchen.involved(press.agent, press.button).into_iter().map(AspectId::of_location);
    caused.chain(places).collect()
}

/// The most probable of the wrong values; of equally probable ones the first.
fn likeliest_wrong(values: &[f64], truth: usize) -> usize {
    let others = (0..values.len()).filter(|&value| value != truth);
    others.reduce(|best, value| if values[value] > values[best] { value } else { best }).unwrap_or(truth)
}

/// What corrected a belief about an aspect whose true value stayed, at this event. Events that are no evidence come after
/// samples of gaze that were.
fn corrected_by(session: &Session, aspect: AspectId, event: &Event) -> FalseBeliefEnd {
    let is_told = session
        .shown
        .as_ref()
        .is_some_and(|shown| aspects_told(&session.kitchen, session.state, &shown.signal).contains(&aspect));
    match event {
        Event::Press { agent, .. } => FalseBeliefEnd::Press(*agent),
        _ if is_told => FalseBeliefEnd::Signal,
        _ => FalseBeliefEnd::Look,
    }
}
