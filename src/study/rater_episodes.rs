//! False beliefs of participants: known from the recorded beliefs of simulated participants, or, of people, derived
//! from the causes that raters gave to errors. `RULE` states the rule of this derivation, and the report prints it.
//!
//! Presses are judged by the rules of the kitchen and the cost to go, as errors are. The assistant's estimate is not
//! used, so that the estimate can be evaluated against these episodes.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use crate::analysis::seen_contents::LocationDwells;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::recommendation::aspects_told;
use tomcom_core::gaze::MIN_CONFIDENCE;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{
    Agent, AspectId, AspectKind, ButtonAction, ButtonId, ContentId, Kitchen, KitchenChange, LocationId, OrderContent,
    Press, State, World,
};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::{ErrorCause, FalseBeliefTarget};
use tomcom_core::measures::raters::{BeliefSource, RaterCodes};
use tomcom_core::measures::sequences::FalseBeliefEpisode;
use tomcom_session::{Event, Session, TimestampedEvent};

/// The rule by which false belief episodes follow from raters' codes, as printed in the report.
pub(crate) const RULE: &str = "Of people, from the codes of two raters: their consensus, else only the false beliefs that both gave to an error \
     alike; what one of them coded alone is counted beside it. The aspect of an error about a place is its content. An error about an order is \
     about what the order shows, if it had changed and not been looked at since, else about the recipe of its dish (without any gaze always \
     about the recipe). The belief is false from the last press, look or signal before the error that shows it right; if the place was changed \
     by somebody else since, from the first such change; from the start of the trial where there is neither. It lasts until the first press, look \
     or signal after the error that shows it right, or until the place is again as it was last known. What shows it right: a press that changes the \
     place and was not coded as an error about it; a press that is no error and would not have helped with the wrong belief; a look of 0.1 s \
     at the place or a signal about it, unless the next error about it is coded before the place changes and before a press shows the belief right. The \
     wrong belief is what was last known of the place; of a recipe, every confusion of it that \
     explains a coded error, and only a press tells them apart that serves or holds what they differ in (if none does, any press that is no error and brings an order of the dish nearer shows it right). An error \
     coded after the belief was shown right begins another episode. False beliefs without an error are not known.";

/// False belief episodes that caused the errors with these coded targets (by sequence number of the press), ordered by
/// the episodes' beginnings. `judged` are all presses of the participant.
pub fn rater_episodes(
    kitchen: &Kitchen,
    cost: &mut CostToGo,
    trace: &BeliefEvidence,
    judged: &[JudgedPress],
    coded: &[(u64, FalseBeliefTarget)],
) -> Vec<FalseBeliefEpisode> {
    let targets: BTreeMap<u64, FalseBeliefTarget> = coded.iter().copied().collect();
    let correct = judged.iter().filter(|press| !press.verdict.error && !press.verdict.race);
    let mut rule = EpisodeRule { kitchen, cost, trace, correct: correct.map(|press| press.seq).collect() };
    let mut episodes = Vec::new();
    for (aspect, errors) in rule.by_aspect(&targets) {
        episodes.extend(rule.episodes(aspect, &errors));
    }
    episodes.sort_by_key(|episode: &FalseBeliefEpisode| (episode.began, episode.aspect));
    episodes
}

struct EpisodeRule<'a> {
    kitchen: &'a Kitchen,
    cost: &'a mut CostToGo,
    trace: &'a BeliefEvidence,
    /// Sequence numbers of the presses that are neither errors nor races.
    correct: BTreeSet<u64>,
}

/// The participant's belief about one state aspect, followed through a trial.
struct BeliefCourse {
    aspect: AspectId,
    since: SessionTime,
    value: usize,
    /// Session time after `since` at which somebody else first changed the location; `None` if nobody did.
    changed: Option<SessionTime>,
    /// First look or signal since the last error, change or press; later events decide whether it corrected.
    mended: Option<(SessionTime, usize)>,
    open: Option<FalseBeliefEpisode>,
    done: Vec<FalseBeliefEpisode>,
}

impl BeliefCourse {
    fn new(aspect: AspectId) -> BeliefCourse {
        let (since, value, done) = (SessionTime::ZERO, 0, Vec::new());
        BeliefCourse { aspect, since, value, changed: None, mended: None, open: None, done }
    }

    fn right(&mut self, time: SessionTime, value: usize) {
        (self.since, self.value, self.changed, self.mended) = (time, value, None, None);
        self.done.extend(self.open.take().map(|episode| FalseBeliefEpisode { corrected: Some(time), ..episode }));
    }

    /// Notes a look or signal; the next error or press tells whether the participant understood it.
    fn told(&mut self, time: SessionTime, value: usize) {
        self.mended = self.mended.or(Some((time, value)));
    }

    /// Accepts the noted look or signal as a correction, since no error has contradicted it.
    fn uphold(&mut self) {
        if let Some((time, value)) = self.mended {
            self.right(time, value);
        }
    }

    fn changed(&mut self, time: SessionTime, value: usize) {
        match value == self.value {
            true => self.right(time, value),
            false => self.changed = self.changed.or(Some(time)),
        }
    }

    fn erred(&mut self) {
        self.mended = None;
        let (aspect, began) = (self.aspect, self.changed.unwrap_or(self.since));
        self.open.get_or_insert(FalseBeliefEpisode { aspect, began, corrected: None, errors: 0 }).errors += 1;
    }
}

/// Whether a press concerns the difference between a recipe and its confusion with this value: the press serves the
/// difference, or has it in hand before or after. Other presses can help with one recipe and not the other only because
/// of contents elsewhere, which the participant need not have seen.
fn is_about_difference(kitchen: &Kitchen, press: &Press, recipe: AspectId, value: usize) -> bool {
    let values = &kitchen.aspects[recipe.index()].values;
    let items = |content: ContentId| match kitchen.content(content).is_stack() {
        true => kitchen.content(content).items.clone(),
        false => vec![content],
    };
    let [right, wrong] = [values[0], values[value]].map(|code| items(ContentId(code)));
    let has =
        |of: &[ContentId], ingredient| of.iter().any(|&item| kitchen.content(item).ingredient == Some(ingredient));
    let differs = |item: ContentId| {
        let ingredient = kitchen.content(item).ingredient;
        right.contains(&item) != wrong.contains(&item)
            || ingredient.is_some_and(|one| has(&right, one) != has(&wrong, one))
    };
    let hand = kitchen.hands[Agent::Human.index()];
    let in_hand = [press.before, press.after].map(|state| items(state.content(hand)));
    matches!(kitchen.button(Agent::Human, press.button).action, ButtonAction::Serve(_))
        || in_hand.into_iter().flatten().any(|item| !item.is_empty() && differs(item))
}

/// The time directly after a signal, since the signal itself still lies within the false belief that it corrects.
fn after(signal: SessionTime) -> SessionTime {
    signal + SessionTime(1)
}

impl EpisodeRule<'_> {
    fn by_aspect(&mut self, targets: &BTreeMap<u64, FalseBeliefTarget>) -> BTreeMap<AspectId, BTreeSet<u64>> {
        let (trace, has_looks) = (self.trace, self.trace.has_looks());
        let mut unseen: BTreeSet<LocationId> = BTreeSet::new();
        let mut errors: BTreeMap<AspectId, BTreeSet<u64>> = BTreeMap::new();
        for (_, event) in &trace.events {
            match event {
                BeliefEvidenceEvent::Started { .. } => unseen.clear(),
                BeliefEvidenceEvent::Changed { before, after } => unseen.extend(self.kitchen.changed(*before, *after)),
                BeliefEvidenceEvent::Looked { location } => {
                    unseen.remove(location);
                }
                BeliefEvidenceEvent::Told { aspects } => {
                    unseen.retain(|one| !aspects.contains(&AspectId::of_location(*one)))
                }
                BeliefEvidenceEvent::Pressed { seq, press } => {
                    if let Some(&target) = targets.get(seq) {
                        let aspect = match target {
                            FalseBeliefTarget::Order(order, Some(dish)) if !(has_looks && unseen.contains(&order)) => {
                                self.kitchen.aspect_of_dish(dish)
                            }
                            FalseBeliefTarget::Order(location, _) | FalseBeliefTarget::Place(location) => {
                                AspectId::of_location(location)
                            }
                            FalseBeliefTarget::Recipe(dish) => self.kitchen.aspect_of_dish(dish),
                        };
                        errors.entry(aspect).or_default().insert(*seq);
                    } else if self.correct.contains(seq) {
                        let nearer = self.nearer(press);
                        unseen.retain(|one| !nearer.contains(one));
                    }
                }
            }
        }
        errors
    }

    fn nearer(&mut self, press: &Press) -> Vec<LocationId> {
        let recipes = self.kitchen.true_recipes();
        let wanted: Vec<LocationId> = self.kitchen.wanted(press.before).map(|(order, _)| order).collect();
        let mut costs = |state: State, order| self.cost.order(state, &recipes, order);
        wanted.into_iter().filter(|&order| costs(press.after, order) < costs(press.before, order)).collect()
    }

    fn episodes(&mut self, aspect: AspectId, errors: &BTreeSet<u64>) -> Vec<FalseBeliefEpisode> {
        let (kitchen, trace, wrong) = (self.kitchen, self.trace, self.confusions(aspect, errors));
        let value = |state: State| kitchen.true_value(state, aspect);
        let mut now = kitchen.empty_state();
        let mut course = BeliefCourse::new(aspect);
        for (time, event) in &trace.events {
            match event {
                BeliefEvidenceEvent::Started { state } => {
                    now = *state;
                    course.right(*time, value(now));
                }
                BeliefEvidenceEvent::Changed { before, after } => {
                    now = *after;
                    if value(*before) != value(now) {
                        course.uphold();
                        course.changed(*time, value(now));
                    }
                }
                BeliefEvidenceEvent::Looked { location } if AspectId::of_location(*location) == aspect => {
                    course.told(*time, value(now));
                }
                BeliefEvidenceEvent::Told { aspects } if aspects.contains(&aspect) => {
                    course.told(after(*time), value(now))
                }
                BeliefEvidenceEvent::Looked { .. } | BeliefEvidenceEvent::Told { .. } => {}
                BeliefEvidenceEvent::Pressed { seq, press } => {
                    now = press.after;
                    if errors.contains(seq) {
                        course.erred();
                    } else if value(press.before) != value(now)
                        || (self.correct.contains(seq) && self.shows(press, &course, &wrong))
                    {
                        course.uphold();
                        course.right(*time, value(now));
                    }
                }
            }
        }
        course.uphold();
        course.done.extend(course.open);
        course.done
    }

    /// Whether a press that is no error shows that the participant's belief about the state aspect is right.
    fn shows(&mut self, press: &Press, known: &BeliefCourse, wrong: &[usize]) -> bool {
        let (kitchen, aspect) = (self.kitchen, known.aspect);
        match kitchen.aspects[aspect.index()].kind {
            AspectKind::Location(_) => {
                known.value != kitchen.true_value(press.before, aspect)
                    && self.helps(press.before, press.button, None)
                    && !self.helps(press.before, press.button, Some((aspect, known.value)))
            }
            AspectKind::Recipe(dish) => {
                let nearer = self.nearer(press);
                nearer.iter().any(|&order| press.before.order(order) == OrderContent::Dish(dish))
                    && wrong.iter().all(|&value| {
                        is_about_difference(kitchen, press, aspect, value)
                            && !self.helps(press.before, press.button, Some((aspect, value)))
                    })
            }
        }
    }

    /// The recipes whose confusion with this recipe explains any of these errors; empty for aspects that are no recipe.
    /// A press shows a right belief only if the press fits none of these confusions.
    fn confusions(&mut self, aspect: AspectId, errors: &BTreeSet<u64>) -> Vec<usize> {
        let (kitchen, trace) = (self.kitchen, self.trace);
        let one = &kitchen.aspects[aspect.index()];
        let AspectKind::Recipe(_) = one.kind else { return Vec::new() };
        let of_error = |(_, event): &'_ (SessionTime, BeliefEvidenceEvent)| match event {
            BeliefEvidenceEvent::Pressed { seq, press } if errors.contains(seq) => Some(*press),
            _ => None,
        };
        let presses: Vec<Press> = trace.events.iter().filter_map(of_error).collect();
        let mut explains =
            |value: &usize| presses.iter().any(|press| self.helps(press.before, press.button, Some((aspect, *value))));
        (1..one.values.len()).filter(|value| explains(value)).collect()
    }

    /// Whether it reduces the cost to go of all orders, in the true state with this aspect believed otherwise.
    fn helps(&mut self, state: State, button: ButtonId, otherwise: Option<(AspectId, usize)>) -> bool {
        let kitchen = self.kitchen;
        let mut world = World::with_true_recipes(kitchen, state);
        if let Some((aspect, value)) = otherwise {
            world.set_value(kitchen, aspect, value);
        }
        let next = kitchen.press(world.state, &world.recipes, Agent::Human, button);
        next.is_some_and(|next| {
            self.cost.all_orders(next, &world.recipes) < self.cost.all_orders(world.state, &world.recipes)
        })
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct KnownFalseBeliefs {
    pub basis: BeliefSource,
    pub targets: BTreeMap<u64, FalseBeliefTarget>,
    /// False belief episodes of the trial; for people, only episodes that led to errors.
    pub episodes: Vec<FalseBeliefEpisode>,
}

/// Agreement of two raters about the false beliefs behind the errors of a trial, by the codes that each gave alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RaterFalseBeliefAgreement {
    pub same: u64,
    pub differing: u64,
    pub of_one: u64,
}

impl KnownFalseBeliefs {
    pub fn recorded(judged: &[JudgedPress], episodes: Vec<FalseBeliefEpisode>) -> KnownFalseBeliefs {
        let target = |press: &JudgedPress| match press.cause {
            Some(ErrorCause::Belief { target, .. }) => Some((press.seq, target)),
            _ => None,
        };
        let targets = judged.iter().filter_map(target).collect();
        KnownFalseBeliefs { basis: BeliefSource::Recorded, targets, episodes }
    }

    /// The false beliefs that follow from codes on which two raters agree (see `super::rater_episodes::RULE`).
    pub fn coded(
        basis: BeliefSource,
        kitchen: &Kitchen,
        cost: &mut CostToGo,
        trace: &BeliefEvidence,
        judged: &[JudgedPress],
        codes: &RaterCodes,
    ) -> KnownFalseBeliefs {
        let errors = judged.iter().filter(|press| press.verdict.error);
        let target = |press: &JudgedPress| Some((press.seq, codes.0.get(&press.seq)?.target(kitchen, press.before)?));
        let targets: Vec<(u64, FalseBeliefTarget)> = errors.filter_map(target).collect();
        let episodes = rater_episodes(kitchen, cost, trace, judged, &targets);
        KnownFalseBeliefs { basis, targets: targets.into_iter().collect(), episodes }
    }

    pub fn episode(&self, kitchen: &Kitchen, press: &JudgedPress) -> Option<&FalseBeliefEpisode> {
        let target = self.targets.get(&press.seq)?;
        let is_in =
            |one: &FalseBeliefEpisode| one.began <= press.time && one.corrected.is_none_or(|end| press.time <= end);
        self.episodes
            .iter()
            .find(|one| one.errors > 0 && is_in(one) && target.aspects(kitchen).any(|aspect| aspect == one.aspect))
    }
}

impl RaterFalseBeliefAgreement {
    pub fn count([one, other]: &[RaterCodes; 2]) -> RaterFalseBeliefAgreement {
        let mut shared = RaterFalseBeliefAgreement::default();
        for (press, code) in &one.0 {
            let Some(of_other) = other.0.get(press) else { continue };
            match (code.aspect(), of_other.aspect()) {
                (Some(one), Some(other)) if one == other => shared.same += 1,
                (Some(_), Some(_)) => shared.differing += 1,
                (Some(_), None) | (None, Some(_)) => shared.of_one += 1,
                (None, None) => {}
            }
        }
        shared
    }

    pub fn plus(self, other: RaterFalseBeliefAgreement) -> RaterFalseBeliefAgreement {
        RaterFalseBeliefAgreement {
            same: self.same + other.same,
            differing: self.differing + other.differing,
            of_one: self.of_one + other.of_one,
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum BeliefEvidenceEvent {
    Started {
        state: State,
    },
    /// Somebody other than the participant changes the kitchen: the robot, a new order, or the wizard's correction.
    Changed {
        before: State,
        after: State,
    },
    /// The gaze has rested on a location long enough to read its present content; noted once for each look and content.
    Looked {
        location: LocationId,
    },
    Told {
        aspects: Vec<AspectId>,
    },
    Pressed {
        seq: u64,
        press: Press,
    },
}

/// Everything in a trial that can change or show the participant's beliefs, in order: changes of the kitchen, looks,
/// signals and the participant's presses. Neither estimates nor recorded beliefs are part of it.
#[derive(Clone, Debug, Default)]
pub struct BeliefEvidence {
    pub events: Vec<(SessionTime, BeliefEvidenceEvent)>,
    looks: LocationDwells,
    /// For each location, whether the present look at its present content is already in `events`.
    is_noted: Vec<bool>,
}

impl BeliefEvidence {
    pub fn note(&mut self, stamped: &TimestampedEvent, change: &KitchenChange, session: &Session) {
        if !session.is_running() && change.states().is_none() {
            // Participants do not read the display during a pause, so looks end.
            self.looks.interrupted();
            return;
        }
        if let Some((before, after)) = change.states() {
            self.is_noted.resize(session.kitchen.locations.len(), false);
            for location in session.kitchen.changed(before, after) {
                self.looks.changed(location);
                self.is_noted[location.index()] = false;
            }
        }
        let traced = match (*change, &stamped.event) {
            (KitchenChange::TrialStarted { after, .. }, _) => Some(BeliefEvidenceEvent::Started { state: after }),
            (KitchenChange::Press { press, .. }, _) if press.agent == Agent::Human => {
                Some(BeliefEvidenceEvent::Pressed { seq: stamped.seq, press })
            }
            (_, Event::SignalShown { signal, .. }) => {
                Some(BeliefEvidenceEvent::Told { aspects: aspects_told(&session.kitchen, session.state, signal) })
            }
            (_, Event::Gaze(sample)) if sample.confidence >= MIN_CONFIDENCE && session.gaze.fault.is_none() => {
                self.looked(stamped.time, session);
                None
            }
            _ => change.states().map(|(before, after)| BeliefEvidenceEvent::Changed { before, after }),
        };
        self.events.extend(traced.map(|event| (stamped.time, event)));
    }

    fn looked(&mut self, now: SessionTime, session: &Session) {
        self.is_noted.resize(session.kitchen.locations.len(), false);
        for (index, is_noted) in self.is_noted.iter_mut().enumerate() {
            let location = LocationId(index as u8);
            let is_seen = self.looks.sampled(session, location);
            if is_seen && !*is_noted {
                self.events.push((now, BeliefEvidenceEvent::Looked { location }));
            }
            *is_noted = is_seen;
        }
    }

    /// Whether the trial has any look of the participant; without gaze data it is unknown what the participant saw.
    fn has_looks(&self) -> bool {
        self.events.iter().any(|(_, event)| matches!(event, BeliefEvidenceEvent::Looked { .. }))
    }
}
