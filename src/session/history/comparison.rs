//! Comparison of wizard and assistants: the communications of each sender in a lane, the matches between lanes, and the
//! differences with context.

use std::sync::Arc;

use crate::event::WizardScreenContent;
use crate::history::belief_track::AspectBeliefSnapshot;
use crate::history::wording;
use tomcom_core::base::text::count;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::communication::concept::{BenefitUnit, ConceptName};
use tomcom_core::communication::recommendation::{Recommendation, SignalOption};
use tomcom_core::kitchen::{AspectId, Kitchen, LocationId, LocationKind, OrderContent, State};
use tomcom_core::measures::matching::{CommunicationEvent, MatchCounts, MatchCriterion, Similarity, matched};
use tomcom_core::measures::sequences::FALSE_BELOW;

/// A P(truth) of at least this counts as certain.
const SURE: f64 = 0.9;

/// What was known when the assistants were asked for advice.
#[derive(Clone, Debug, PartialEq)]
pub struct CommunicationContext {
    /// Event after which they were asked.
    pub seq: u64,
    pub state: State,
    /// By state aspect, without the effect of signals sent within the matching window.
    pub held: Arc<[AspectBeliefSnapshot]>,
    /// Of each assistant, in the order of lanes.
    pub advice: Vec<Recommendation>,
    /// `None` before the screen was first drawn, and without a wizard.
    pub screen: Option<WizardScreenContent>,
}

/// Of the wizard or of an assistant.
#[derive(Clone, Debug, PartialEq)]
pub struct Communication {
    /// In the form that the matching compares.
    pub said: CommunicationEvent,
    pub time: SessionTime,
    pub what: Signal,
    /// When the assistants were last asked before it.
    pub known: Option<Arc<CommunicationContext>>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct SenderCommunications {
    /// "wizard", "tom-com".
    pub name: String,
    /// `None` for the signals that the participant saw.
    pub concept: Option<ConceptName>,
    /// In the order of time.
    pub spoken: Vec<Communication>,
}

impl SenderCommunications {
    /// In the form that the matching takes.
    pub fn said(&self) -> Vec<CommunicationEvent> {
        self.spoken.iter().map(|spoken| spoken.said).collect()
    }
}

/// A communication in one lane without a match in another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnmatchedCommunication {
    pub lane: usize,
    /// Index in its lane.
    pub index: usize,
    /// The lane that has no match.
    pub not: usize,
}

/// The first lane, which the participant saw, compared with an assistant's.
#[derive(Clone, Debug, PartialEq)]
pub struct SenderMatches {
    /// Strict matches: indices into the first and the other lane.
    pub matched: Vec<(usize, usize)>,
    pub similarity: Similarity,
}

/// The wizard's and the assistants' communications in a trial so far.
#[derive(Clone, Debug, PartialEq)]
pub struct SenderComparison {
    /// Two communications can match if at most this many presses of the human lie between them.
    pub window: u32,
    /// One for each sender; the first holds the signals that the participant saw.
    pub lanes: Vec<SenderCommunications>,
    /// The first lane with each assistant's.
    pub pairs: Vec<SenderMatches>,
    /// In order of time; a communication that a later one can still match is left out.
    pub differences: Vec<UnmatchedCommunication>,
}

impl SenderComparison {
    /// `presses`: of the human so far; `over`: the trial has ended.
    pub fn new(lanes: Vec<SenderCommunications>, window: u32, presses: u32, over: bool) -> SenderComparison {
        let said: Vec<Vec<CommunicationEvent>> = lanes.iter().map(SenderCommunications::said).collect();
        let pair = |with: &Vec<CommunicationEvent>| {
            let mut tally = MatchCounts::default();
            tally.add(&said[0], with, presses, window);
            let matched = matched(&said[0], with, window, MatchCriterion::Signal);
            SenderMatches { matched, similarity: tally.similarity() }
        };
        let pairs: Vec<SenderMatches> = said.iter().skip(1).map(pair).collect();
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
        SenderComparison { window, lanes, pairs, differences }
    }

    pub fn spoken(&self, difference: &UnmatchedCommunication) -> &Communication {
        &self.lanes[difference.lane].spoken[difference.index]
    }

    /// Of the two lanes, the assistant's.
    fn assistant(&self, difference: &UnmatchedCommunication) -> usize {
        difference.lane.max(difference.not)
    }

    /// What that assistant recommended then.
    pub fn advice(&self, difference: &UnmatchedCommunication) -> Option<&Recommendation> {
        self.spoken(difference).known.as_ref()?.advice.get(self.assistant(difference) - 1)
    }

    /// "4:32  only tom-com: recipe of order 1".
    pub fn headline(&self, difference: &UnmatchedCommunication) -> String {
        let (spoken, by) = (self.spoken(difference), &self.lanes[difference.lane].name);
        let (clock, words) = (spoken.said.clock, wording::signal(&spoken.what));
        match self.lanes.len() {
            0..=2 => format!("{clock}  only {by}: {words}"),
            _ => format!("{clock}  {by}, not {}: {words}", self.lanes[difference.not].name),
        }
    }

    /// The context of an unmatched communication, as lines of text.
    pub fn opened(&self, kitchen: &Kitchen, difference: &UnmatchedCommunication) -> Vec<String> {
        let spoken = self.spoken(difference);
        let other = &self.lanes[difference.not];
        let apart = |near: &&Communication| near.said.press.abs_diff(spoken.said.press);
        let (press, name) = (spoken.said.press, &other.name);
        let lacks = match other.spoken.iter().min_by_key(apart) {
            Some(near) => {
                let (words, clock, presses) =
                    (wording::signal(&near.what), near.said.clock, count(apart(&near), "press", "presses"));
                format!(
                    "after press {press}; not sent by {name}, whose nearest signal is {words} at {clock}, {presses} away"
                )
            }
            None => format!("after press {press}; not sent by {name}, which sent no signal in this trial"),
        };
        let mut lines = vec![self.headline(difference), lacks];
        let Some(known) = &spoken.known else {
            lines.push("the assistant had not been asked: there was no press or order before".to_string());
            return lines;
        };
        if let Some(advice) = self.advice(difference) {
            let lane = &self.lanes[self.assistant(difference)];
            lines.push(format!(
                "recommendation of {} at this time: {}",
                lane.name,
                thought(kitchen, advice, lane.concept.map_or(BenefitUnit::None, ConceptName::unit))
            ));
        }
        lines.extend(believed(kitchen, known));
        lines.push(format!("true contents of the kitchen: {}", truly(kitchen, known.state)));
        lines.push(format!("panels on the wizard's screen: {}", seen(known.screen.as_ref())));
        lines
    }
}

fn thought(kitchen: &Kitchen, advice: &Recommendation, unit: BenefitUnit) -> String {
    if let Some(proposal) = &advice.proposal {
        return wording::proposal(&proposal.presses);
    }
    let option = |option: &SignalOption| {
        let (signal, SignalOption { benefit, standard_error, net, .. }) = (wording::signal(&option.signal), option);
        match unit {
            BenefitUnit::Deviation => format!("{signal} {benefit:.2} (above threshold {net:+.2})"),
            BenefitUnit::Presses | BenefitUnit::None => {
                format!("{signal} {benefit:.2} ±{standard_error:.2} (net benefit {net:+.2})")
            }
        }
    };
    let options: Vec<String> = advice.options.iter().take(3).map(option).collect();
    let best = advice.best.as_ref().map_or("send no signal".to_string(), wording::signal);
    let reason = advice.reason.as_ref().map(|reason| wording::reason(kitchen, reason));
    let reason = reason.map(|reason| format!("; the human {}", reason.words()));
    let reason = reason.or_else(|| advice.words.as_ref().map(|words| format!("; {words}"))).unwrap_or_default();
    match unit {
        _ if options.is_empty() => format!("{best}{reason}"),
        BenefitUnit::Deviation => format!("{best}{reason}; expected deviation of beliefs: {}", options.join(", ")),
        BenefitUnit::Presses | BenefitUnit::None => {
            format!("{best}{reason}; presses saved by each signal: {}", options.join(", "))
        }
    }
}

/// The aspects with false beliefs (lowest P(truth) first), and those with beliefs that are right but uncertain.
fn believed(kitchen: &Kitchen, known: &CommunicationContext) -> [String; 2] {
    let mut doubtful: Vec<(usize, &AspectBeliefSnapshot)> =
        known.held.iter().enumerate().filter(|(_, held)| f64::from(held.p_truth) < SURE).collect();
    doubtful.sort_by(|a, b| a.1.p_truth.total_cmp(&b.1.p_truth));
    let (wrong, unsure): (Vec<_>, Vec<_>) =
        doubtful.into_iter().partition(|(_, held)| f64::from(held.p_truth) < FALSE_BELOW);
    let told = |&(index, held): &(usize, &AspectBeliefSnapshot)| {
        let aspect = AspectId(index as u8);
        let name = wording::aspect(kitchen, known.state, aspect);
        let truth = kitchen.true_value(known.state, aspect);
        let (wrong, truth) = wording::contrast(kitchen, aspect, usize::from(held.wrong), truth);
        let thinks = wording::thinks(held.p_wrong.into());
        format!("{name}: {thinks} {wrong} (probability {:.2}), {truth} ({:.2})", held.p_wrong, held.p_truth)
    };
    let doubted = |&(index, held): &(usize, &AspectBeliefSnapshot)| {
        format!("{} {:.2}", wording::aspect(kitchen, known.state, AspectId(index as u8)), held.p_truth)
    };
    let list = |told: Vec<String>| if told.is_empty() { "none".to_string() } else { told.join("; ") };
    [
        format!(
            "false beliefs, by the estimate if that signal were not sent: {}",
            list(wrong.iter().take(4).map(told).collect())
        ),
        format!(
            "right beliefs with a probability below {SURE}: {}",
            list(unsure.iter().take(6).map(doubted).collect())
        ),
    ]
}

/// Contents of all locations that are not empty.
fn truly(kitchen: &Kitchen, state: State) -> String {
    let location = |index: usize| {
        let (id, location) = (LocationId(index as u8), &kitchen.locations[index]);
        let is_there = match location.kind {
            LocationKind::Order => matches!(state.order(id), OrderContent::Dish(_)),
            _ => state.content(id) != tomcom_core::kitchen::ContentId::EMPTY,
        };
        is_there.then(|| format!("{} {}", location.label(), kitchen.content_label(state, id)))
    };
    let there: Vec<String> = (0..kitchen.locations.len()).filter_map(location).collect();
    if there.is_empty() { "all places are empty".to_string() } else { there.join(", ") }
}

fn seen(screen: Option<&WizardScreenContent>) -> String {
    match screen {
        Some(screen) => {
            let dialog = screen.dialog.as_ref().map_or(String::new(), |dialog| format!(", with the dialog {dialog}"));
            format!("{} ({}{dialog})", screen.panels.join(", "), screen.room)
        }
        None => "unknown, since no console was open".to_string(),
    }
}
