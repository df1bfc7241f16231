//! The participant's estimated beliefs as the console shows them: same names, certainties and order in every view.

use super::console_model::ConsoleModel;
use super::key_action::KeyLayer;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::recommendation::aspects_told;
use tomcom_core::kitchen::{AspectId, AspectKind, LocationId};
use tomcom_core::measures::sequences::THINKS;
use tomcom_session::history::belief_track;
use tomcom_session::settings::WizardVisibility;
use tomcom_session::{Session, TrialPhase};

/// Whether an estimated belief of the participant is probably false, unsure or right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BeliefCorrectness {
    False,
    /// The true value is improbable and so is every other value; or the true value is probable, but a signal about the
    /// aspect is on offer.
    Unsure,
    Right,
}

/// Estimated belief of the participant about one state aspect (a location's content or a recipe).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatedBelief {
    pub aspect: AspectId,
    pub standing: BeliefCorrectness,
    /// Index of the value that the participant most probably believes; for an unsure belief of the wrong values only,
    /// since the true value would tell nothing.
    pub thinks: usize,
    pub truth: usize,
    /// Expected probability that the participant gives to the value [`EstimatedBelief::thinks`].
    pub p: f32,
    /// Session time since which the true value has been improbable in the estimate; `None` while it is not.
    pub since: Option<SessionTime>,
    /// Expected number of presses that the best signal about this aspect saves; 0 where the wizard sees no
    /// recommendations.
    pub cost: f64,
}

/// The participant's estimated beliefs at the drawn session time, sorted: first those that the open offer would
/// correct, then false ones, then unsure ones; among equals by expected saving of a signal (presses), then by age.
/// Empty before the trial's first estimate, and where the wizard may not see the estimate.
pub fn beliefs(session: &Session, model: &ConsoleModel) -> Vec<EstimatedBelief> {
    let moments = model.belief.until(model.now);
    let may_see = visibility(session, model) >= WizardVisibility::Belief && session.phase != TrialPhase::Ready;
    let Some(last) = moments.last().filter(|_| may_see) else { return Vec::new() };
    let (costs, offered) = (costs(session), offered(session));
    let told = last.held.iter().enumerate().map(|(index, held)| {
        let aspect = AspectId(index as u8);
        let (thinks, truth) = (usize::from(held.believes), session.kitchen.true_value(session.state, aspect));
        let standing = match held.is_false() {
            true if thinks != truth && f64::from(held.p) >= THINKS => BeliefCorrectness::False,
            true => BeliefCorrectness::Unsure,
            // A belief that an offered signal is about counts as unsure even if its most probable value is true.
            false if offered.contains(&aspect) => BeliefCorrectness::Unsure,
            false => BeliefCorrectness::Right,
        };
        let (thinks, p) = match standing {
            BeliefCorrectness::Unsure => (usize::from(held.wrong), held.p_wrong),
            BeliefCorrectness::False | BeliefCorrectness::Right => (thinks, held.p),
        };
        let since = belief_track::wrong_since(moments, index);
        EstimatedBelief { aspect, standing, thinks, truth, p, since, cost: costs[index] }
    });
    // A recipe that nobody ordered matters only once it is ordered.
    let mut beliefs: Vec<EstimatedBelief> = told.filter(|belief| place(session, belief.aspect).is_some()).collect();
    beliefs.sort_by(|a, b| {
        let is_told = |belief: &EstimatedBelief| offered.contains(&belief.aspect);
        let by_cost = || b.cost.total_cmp(&a.cost);
        is_told(b).cmp(&is_told(a)).then(a.standing.cmp(&b.standing)).then_with(by_cost).then(a.since.cmp(&b.since))
    });
    beliefs
}

/// What the console may show of the assistant's estimate and advice, as the session's settings allow. A person who
/// presses the participant's buttons at this keyboard sees neither the estimate nor offers.
pub fn visibility(session: &Session, model: &ConsoleModel) -> WizardVisibility {
    match model.layer {
        KeyLayer::Wizard => session.spec.console.visibility,
        KeyLayer::Participant => WizardVisibility::State,
    }
}

/// The state aspects that the open offer is about: that of the offer's reason or, without a reason, all aspects that
/// the offered signal tells.
fn offered(session: &Session) -> Vec<AspectId> {
    let Some(offer) = session.offers.open().filter(|offer| offer.advice.visible) else { return Vec::new() };
    let kitchen = &session.kitchen;
    match (&offer.advice.reason, offer.signal()) {
        (Some(reason), _) => kitchen.aspect_named(&reason.aspect).into_iter().collect(),
        (None, Some(signal)) => aspects_told(kitchen, session.state, signal),
        (None, None) => Vec::new(),
    }
}

/// Whether beliefs are ordered by the presses that a signal would save: only if the wizard sees recommendations, and
/// the concept (TomCom) counts presses.
pub fn are_by_cost(session: &Session) -> bool {
    session.spec.console.visibility == WizardVisibility::Recommendation
        && session.spec.assistant.concept == ConceptName::TomCom
        && session.advice.is_some()
}

/// For each state aspect, the expected saving (in presses) of the best signal that tells it.
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

/// The kitchen location at which the belief is shown: the location itself or, for a recipe, the order on offer or else the
/// first order of its dish. The signal about this location tells the aspect.
pub fn place(session: &Session, aspect: AspectId) -> Option<LocationId> {
    match session.kitchen.aspects[aspect.index()].kind {
        AspectKind::Location(location) => Some(location),
        AspectKind::Recipe(dish) => {
            let orders = || session.kitchen.wanted(session.state).filter(|(_, wanted)| *wanted == dish);
            let offered = session.offers.open().and_then(|offer| offer.signal()?.location(&session.kitchen));
            let found = orders().find(|(order, _)| Some(*order) == offered).or(orders().next());
            found.map(|(order, _)| order)
        }
    }
}

/// Name of the state aspect that a belief is about: "cooking pot", "recipe of order 1"; for a dish that nobody ordered,
/// with the dish's name.
pub fn name(session: &Session, aspect: AspectId) -> String {
    let kitchen = &session.kitchen;
    match (kitchen.aspects[aspect.index()].kind, place(session, aspect)) {
        (AspectKind::Recipe(_), Some(order)) => format!("recipe of {}", kitchen.location(order).label()),
        (AspectKind::Recipe(dish), None) => format!("recipe of {}", kitchen.dish(dish).name),
        (AspectKind::Location(location), _) => kitchen.location(location).label(),
    }
}

/// A probability as the console shows it: "83 %".
pub fn percent(p: f64) -> String {
    format!("{:.0} %", 100.0 * p)
}
