//! The estimated beliefs as the wizard is told of them: one name, one certainty and one order in every view.

use super::console_model::ConsoleModel;
use super::key_action::KeyLayer;
use crate::base::time::SessionTime;
use crate::communication::concept::ConceptName;
use crate::communication::recommendation::aspects_told;
use crate::history::belief_track;
use crate::kitchen::{AspectId, AspectKind, Kitchen, LocationId};
use crate::session::settings::Visibility;
use crate::session::{Phase, Session};

/// Least expected probability of a value that the participant is said to think.
const THINKS: f32 = 0.5;

/// Whether a belief is right, as far as the estimate can tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BeliefStanding {
    /// The participant probably thinks a wrong value.
    False,
    /// The truth is improbable, and so is every other value; or the truth is what is thought, and not surely enough.
    Unsure,
    /// The participant probably knows the truth.
    Right,
}

/// An estimated belief about one aspect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatedBelief {
    /// What the belief is about.
    pub aspect: AspectId,
    /// Whether it is right.
    pub standing: BeliefStanding,
    /// Index of the most probable value.
    pub thinks: usize,
    /// Index of the true value.
    pub truth: usize,
    /// Expected probability of the most probable value.
    pub p: f32,
    /// Since when the truth has been improbable; none: it is not.
    pub since: Option<SessionTime>,
    /// Presses that the best signal about it would save; 0 where the wizard sees no recommendations.
    pub cost: f64,
}

/// The beliefs at the drawn time: what the open offer is about, then false ones, then unsure ones, each by their cost in presses
/// and by their age. Empty before the trial's first estimate, and where the wizard may not see the estimate.
pub fn beliefs(session: &Session, model: &ConsoleModel) -> Vec<EstimatedBelief> {
    let moments = model.belief.until(model.now);
    let may_see = visibility(session, model) >= Visibility::Belief && session.phase != Phase::Ready;
    let Some(last) = moments.last().filter(|_| may_see) else { return Vec::new() };
    let (costs, offered) = (costs(session), offered(session));
    let told = last.held.iter().enumerate().map(|(index, held)| {
        let aspect = AspectId(index as u8);
        let (thinks, truth) = (usize::from(held.believes), session.kitchen.true_value(session.state, aspect));
        let standing = match held.is_false() {
            true if thinks != truth && held.p >= THINKS => BeliefStanding::False,
            true => BeliefStanding::Unsure,
            // A signal is offered only where the truth is not sure enough.
            false if offered.contains(&aspect) => BeliefStanding::Unsure,
            false => BeliefStanding::Right,
        };
        let since = belief_track::wrong_since(moments, index);
        EstimatedBelief { aspect, standing, thinks, truth, p: held.p, since, cost: costs[index] }
    });
    let mut beliefs: Vec<EstimatedBelief> = told.collect();
    beliefs.sort_by(|a, b| {
        let is_told = |belief: &EstimatedBelief| offered.contains(&belief.aspect);
        let by_cost = || b.cost.total_cmp(&a.cost);
        is_told(b).cmp(&is_told(a)).then(a.standing.cmp(&b.standing)).then_with(by_cost).then(a.since.cmp(&b.since))
    });
    beliefs
}

/// What the screen shows: what the settings allow to the wizard. Who presses the participant's buttons at this keyboard sees
/// neither the estimate nor offers.
pub fn visibility(session: &Session, model: &ConsoleModel) -> Visibility {
    match model.layer {
        KeyLayer::Wizard => session.spec.console.visibility,
        KeyLayer::Participant => Visibility::State,
    }
}

/// What the open offer is about; without a reason, all that its signal tells.
fn offered(session: &Session) -> Vec<AspectId> {
    let Some(offer) = session.offers.open().filter(|offer| offer.advice.visible) else { return Vec::new() };
    let kitchen = &session.kitchen;
    match (&offer.advice.reason, offer.signal()) {
        (Some(reason), _) => kitchen.aspect_named(&reason.aspect).into_iter().collect(),
        (None, Some(signal)) => aspects_told(kitchen, session.state, signal),
        (None, None) => Vec::new(),
    }
}

/// Whether beliefs are ordered by their cost: a concept that counts presses advises, and the wizard sees it.
pub fn are_by_cost(session: &Session) -> bool {
    session.spec.console.visibility == Visibility::Recommendation
        && session.spec.assistant.concept == ConceptName::TomCom
        && session.advice.is_some()
}

/// By aspect, the expected saving of the best signal that tells it.
fn costs(session: &Session) -> Vec<f64> {
    let mut costs = vec![0.0; session.kitchen.aspects.len()];
    let advice = session.advice.as_ref().filter(|_| are_by_cost(session));
    for option in advice.iter().flat_map(|advice| &advice.options) {
        for aspect in aspects_told(&session.kitchen, session.state, &option.signal) {
            costs[aspect.index()] = f64::max(costs[aspect.index()], option.benefit);
        }
    }
    costs
}

/// Where the belief is shown in the kitchen: at its location, or at an order of its dish; the signal about this place tells it.
pub fn place(session: &Session, aspect: AspectId) -> Option<LocationId> {
    match session.kitchen.aspects[aspect.index()].kind {
        AspectKind::Location(location) => Some(location),
        AspectKind::Recipe(dish) => {
            let mut orders = session.kitchen.wanted(session.state).filter(|(_, wanted)| *wanted == dish);
            orders.next().map(|(order, _)| order)
        }
    }
}

/// The name of what a belief is about: "cooking pot", "recipe of order 1"; a dish that no order wants is named itself.
pub fn name(session: &Session, aspect: AspectId) -> String {
    let kitchen = &session.kitchen;
    match (kitchen.aspects[aspect.index()].kind, place(session, aspect)) {
        (AspectKind::Recipe(_), Some(order)) => format!("recipe of {}", kitchen.location(order).label()),
        (AspectKind::Recipe(dish), None) => format!("recipe of {}", kitchen.dish(dish).name),
        (AspectKind::Location(location), _) => kitchen.location(location).label(),
    }
}

/// A value of an aspect in words.
pub fn value(kitchen: &Kitchen, aspect: AspectId, value: usize) -> &str {
    &kitchen.aspects[aspect.index()].wordings[value]
}

/// A probability as the screen shows it: "83 %".
pub fn percent(p: f64) -> String {
    format!("{:.0} %", 100.0 * p)
}
