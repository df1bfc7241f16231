//! Wizard and assistants side by side: what each said, what of it matches, and where they differ with what was known then.

use std::sync::Arc;

use super::belief_track::AspectSnapshot;
use crate::base::time::SessionTime;
use crate::base::words::count;
use crate::communication::Signal;
use crate::communication::concept::ConceptName;
use crate::communication::recommendation::{Recommendation, SignalOption};
use crate::history::wording;
use crate::kitchen::{AspectId, Kitchen, LocationId, LocationKind, OrderContent, State};
use crate::measures::matching::{
    CommunicationEvent, CommunicationKind, CommunicationTarget, MatchCounts, MatchCriterion, Similarity, matched,
};
use crate::measures::sequences::FALSE_BELOW;
use crate::session::screen::VisibleScreen;

/// What is known at least so well is no doubt.
const SURE: f64 = 0.9;

/// What was known when something could be said.
#[derive(Clone, Debug, PartialEq)]
pub struct CommunicationContext {
    /// The number of the event that brought it about.
    pub seq: u64,
    pub state: State,
    /// By aspect; the estimate leaves out what was sent within the window.
    pub held: Vec<AspectSnapshot>,
    /// Of each assistant, in the order of their lanes.
    pub advice: Vec<Recommendation>,
    /// What was on the wizard's screen; none before the first frame, and without a wizard.
    pub screen: Option<VisibleScreen>,
}

/// What was said.
#[derive(Clone, Debug, PartialEq)]
pub enum CommunicationContent {
    Signal(Signal),
    /// Presses by the names of their buttons.
    Proposal(Vec<String>),
}

impl CommunicationContent {
    /// For the matching.
    pub fn content(&self, kitchen: &Kitchen) -> CommunicationTarget {
        let kind = match self {
            CommunicationContent::Signal(Signal::ShowRecipe(_)) => CommunicationKind::Recipe,
            CommunicationContent::Signal(Signal::Highlight(_)) => CommunicationKind::Highlight,
            CommunicationContent::Proposal(_) => CommunicationKind::Proposal,
        };
        CommunicationTarget { kind, target: self.target(kitchen) }
    }

    fn target(&self, kitchen: &Kitchen) -> Option<LocationId> {
        match self {
            CommunicationContent::Signal(signal) => kitchen.location_named(signal.target()),
            CommunicationContent::Proposal(_) => None,
        }
    }

    /// In words.
    pub fn words(&self) -> String {
        match self {
            CommunicationContent::Signal(signal) => wording::signal(signal),
            CommunicationContent::Proposal(presses) => {
                let presses: Vec<String> = presses.iter().map(|press| wording::location(press)).collect();
                format!("press {}", presses.join(", then "))
            }
        }
    }
}

/// A communication in its lane.
#[derive(Clone, Debug, PartialEq)]
pub struct Communication {
    pub said: CommunicationEvent,
    /// In the session's time.
    pub time: SessionTime,
    pub what: CommunicationContent,
    /// The last moment until then at which the assistants were asked.
    pub known: Option<Arc<CommunicationContext>>,
}

/// Everything that one side said in a trial.
#[derive(Clone, Debug, PartialEq)]
pub struct CommunicationLane {
    /// "wizard", "tom-com".
    pub name: String,
    /// What decides; none: who sent the signals that the participant saw.
    pub concept: Option<ConceptName>,
    pub spoken: Vec<Communication>,
}

impl CommunicationLane {
    pub fn said(&self) -> Vec<CommunicationEvent> {
        self.spoken.iter().map(|spoken| spoken.said).collect()
    }
}

/// A communication that has no match in another lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnmatchedCommunication {
    /// The lane and its communication.
    pub lane: usize,
    pub index: usize,
    /// The lane that did not say it.
    pub not: usize,
}

/// The first lane against another one.
#[derive(Clone, Debug, PartialEq)]
pub struct LanePair {
    /// Strict pairs, as indices into both lanes.
    pub matched: Vec<(usize, usize)>,
    pub similarity: Similarity,
}

/// A comparison, as far as it has come.
#[derive(Clone, Debug, PartialEq)]
pub struct LaneComparison {
    /// Presses of the human within which communications match.
    pub window: u32,
    /// The first is what the participant was shown.
    pub lanes: Vec<CommunicationLane>,
    /// The first lane with each of the others.
    pub pairs: Vec<LanePair>,
    /// In the order of time. What may still be matched is none.
    pub differences: Vec<UnmatchedCommunication>,
}

impl LaneComparison {
    /// Compares lanes of a trial that has had so many presses of the human; `over`: there will be no more.
    pub fn new(lanes: Vec<CommunicationLane>, window: u32, presses: u32, over: bool) -> LaneComparison {
        let said: Vec<Vec<CommunicationEvent>> = lanes.iter().map(CommunicationLane::said).collect();
        let pair = |with: &Vec<CommunicationEvent>| {
            let mut tally = MatchCounts::default();
            tally.add(&said[0], with, presses, window);
            let matched = matched(&said[0], with, window, MatchCriterion::Strict);
            LanePair { matched, similarity: tally.similarity() }
        };
        let pairs: Vec<LanePair> = said.iter().skip(1).map(pair).collect();
        let mut differences = Vec::new();
        for (not, pair) in pairs.iter().enumerate() {
            let other = not + 1;
            let alone = |lane: usize, index: usize| {
                !pair.matched.iter().any(|&(a, b)| if lane == 0 { a == index } else { b == index })
            };
            for (lane, not) in [(0, other), (other, 0)] {
                let settled = |index: &usize| over || said[lane][*index].press + window < presses;
                let indices = (0..said[lane].len()).filter(|&index| alone(lane, index)).filter(settled);
                differences.extend(indices.map(|index| UnmatchedCommunication { lane, index, not }));
            }
        }
        let time = |one: &UnmatchedCommunication| lanes[one.lane].spoken[one.index].time;
        differences.sort_by_key(|one| (time(one), one.lane, one.not));
        LaneComparison { window, lanes, pairs, differences }
    }

    /// What was said in a difference.
    pub fn spoken(&self, difference: &UnmatchedCommunication) -> &Communication {
        &self.lanes[difference.lane].spoken[difference.index]
    }

    /// The assistant's lane that a difference is about.
    fn assistant(&self, difference: &UnmatchedCommunication) -> usize {
        difference.lane.max(difference.not)
    }

    /// What that assistant thought then.
    pub fn advice(&self, difference: &UnmatchedCommunication) -> Option<&Recommendation> {
        self.spoken(difference).known.as_ref()?.advice.get(self.assistant(difference) - 1)
    }

    /// A difference in one line: "4:32  only tom-com: recipe of order 1".
    pub fn headline(&self, difference: &UnmatchedCommunication) -> String {
        let (spoken, by) = (self.spoken(difference), &self.lanes[difference.lane].name);
        let not = match self.lanes.len() {
            0..=2 => String::new(),
            _ => format!(", not {}", self.lanes[difference.not].name),
        };
        let only = if not.is_empty() { "only " } else { "" };
        format!("{}  {only}{by}{not}: {}", spoken.said.clock, spoken.what.words())
    }

    /// What each knew then, in lines.
    pub fn opened(&self, kitchen: &Kitchen, difference: &UnmatchedCommunication) -> Vec<String> {
        let spoken = self.spoken(difference);
        let other = &self.lanes[difference.not];
        let apart = |near: &&Communication| near.said.press.abs_diff(spoken.said.press);
        let near = match other.spoken.iter().min_by_key(apart) {
            Some(near) => {
                let presses = count(apart(&near), "press", "presses");
                format!("whose nearest is {} at {}, {presses} away", near.what.words(), near.said.clock)
            }
            None => "which said nothing in this trial".to_string(),
        };
        let mut lines = vec![
            self.headline(difference),
            format!("after press {}; not said by {}, {near}", spoken.said.press, other.name),
        ];
        let Some(known) = &spoken.known else {
            lines.push("nothing was asked yet: before the first press or order".to_string());
            return lines;
        };
        if let Some(advice) = self.advice(difference) {
            let lane = &self.lanes[self.assistant(difference)];
            lines.push(format!("{} then: {}", lane.name, thought(advice, lane.concept == Some(ConceptName::Tom))));
        }
        lines.extend(believed(kitchen, known));
        lines.push(format!("truly: {}", truly(kitchen, known.state)));
        lines.push(format!("on the wizard's screen: {}", seen(known.screen.as_ref())));
        lines
    }
}

/// What an assistant thought, in words; ToM thinks of deviations.
fn thought(advice: &Recommendation, is_tom: bool) -> String {
    if let Some(proposal) = &advice.proposal {
        return CommunicationContent::Proposal(proposal.presses.clone()).words();
    }
    let option = |option: &SignalOption| {
        let (signal, SignalOption { benefit, standard_error, net, .. }) = (wording::signal(&option.signal), option);
        match is_tom {
            true => format!("{signal} {benefit:.2} (above threshold {net:+.2})"),
            false => format!("{signal} {benefit:.2} ±{standard_error:.2} (net {net:+.2})"),
        }
    };
    let options: Vec<String> = advice.options.iter().take(3).map(option).collect();
    let best = advice.best.as_ref().map_or("say nothing".to_string(), wording::signal);
    let reason = advice.reason.as_ref().map_or(String::new(), |reason| format!("; the human {}", reason.words()));
    match options.is_empty() {
        true => best,
        false if is_tom => format!("{best}{reason}; deviations: {}", options.join(", ")),
        false => format!("{best}{reason}; presses saved: {}", options.join(", ")),
    }
}

/// What is believed wrong, the wrongest first, and what is right but not sure.
fn believed(kitchen: &Kitchen, known: &CommunicationContext) -> [String; 2] {
    let mut doubtful: Vec<(usize, &AspectSnapshot)> =
        known.held.iter().enumerate().filter(|(_, held)| f64::from(held.p_truth) < SURE).collect();
    doubtful.sort_by(|a, b| a.1.p_truth.total_cmp(&b.1.p_truth));
    let (wrong, unsure): (Vec<_>, Vec<_>) =
        doubtful.into_iter().partition(|(_, held)| f64::from(held.p_truth) < FALSE_BELOW);
    let told = |&(index, held): &(usize, &AspectSnapshot)| {
        let aspect = &kitchen.aspects[index];
        let truth = kitchen.true_value(known.state, AspectId(index as u8));
        let name = wording::location(&aspect.name);
        let (believes, truth_label) = (&aspect.labels[usize::from(held.believes)], &aspect.labels[truth]);
        match usize::from(held.believes) == truth {
            true => format!("{name}: most likely {truth_label}, but only {:.2}", held.p_truth),
            false => format!("{name}: {believes} {:.2}, truly {truth_label} {:.2}", held.p, held.p_truth),
        }
    };
    let doubted = |&(index, held): &(usize, &AspectSnapshot)| {
        format!("{} {:.2}", wording::location(&kitchen.aspects[index].name), held.p_truth)
    };
    let list = |told: Vec<String>| if told.is_empty() { "nothing".to_string() } else { told.join("; ") };
    [
        format!(
            "believed wrong, by the estimate without what was just sent: {}",
            list(wrong.iter().take(4).map(told).collect())
        ),
        format!("right, but less than {SURE} sure: {}", list(unsure.iter().take(6).map(doubted).collect())),
    ]
}

/// What lay where, without what is empty.
fn truly(kitchen: &Kitchen, state: State) -> String {
    let location = |index: usize| {
        let (id, location) = (LocationId(index as u8), &kitchen.locations[index]);
        let is_there = match location.kind {
            LocationKind::Order => matches!(state.order(id), OrderContent::Dish(_)),
            _ => state.content(id) != crate::kitchen::ContentId::EMPTY,
        };
        is_there.then(|| format!("{} {}", location.label(), kitchen.content_label(state, id)))
    };
    let there: Vec<String> = (0..kitchen.locations.len()).filter_map(location).collect();
    if there.is_empty() { "an empty kitchen".to_string() } else { there.join(", ") }
}

fn seen(screen: Option<&VisibleScreen>) -> String {
    match screen {
        Some(screen) => {
            let dialog = screen.dialog.as_ref().map_or(String::new(), |dialog| format!(", {dialog} open"));
            format!("{} ({}{dialog})", screen.panels.join(", "), screen.room)
        }
        None => "not known: no console was open".to_string(),
    }
}
