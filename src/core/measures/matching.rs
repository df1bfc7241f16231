//! Similarity of two lists of communications (lanes), a wizard's and an assistant's: one-to-one matching in time, with
//! recall, precision and kappa.
//!
//! Two communications can match if at most a window of human presses lies between them and their contents agree: the
//! same signal and target, the same kind of signal, or any content. Among all one-to-one matchings, those with the most
//! pairs are considered, and of these one with the fewest presses between the communications of its pairs is used. The
//! paper's 74 % is the recall of "a similar decision" in "nearby time steps", which the paper does not define further;
//! therefore all three levels of agreement are reported, each with its chance level.
//!
//! Kappa (Cohen 1960) is over human presses and {none, each signal and target}. A pair with the same signal and target
//! counts as agreement at the press of its first lane, as when events are aligned within a tolerance (Quera, Bakeman
//! and Gnisci 2007); all other communications count at their own press. The chance level is the mean over all circular
//! shifts of the second lane by more than the window.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::median;
use crate::base::time::SessionTime;
use crate::kitchen::LocationId;

/// Default window within which two communications can match, in presses of the human.
pub const WINDOW: u32 = 3;

/// The kind of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum SignalKind {
    /// Shows an order's recipe.
    Recipe,
    /// Highlights a location.
    Highlight,
    /// Proposes presses.
    Proposal,
}

impl SignalKind {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            SignalKind::Recipe => "recipe",
            SignalKind::Highlight => "highlight",
            SignalKind::Proposal => "proposal",
        }
    }

    /// Name in the log.
    pub fn tag(self) -> &'static str {
        match self {
            SignalKind::Recipe => "show_recipe",
            SignalKind::Highlight => "highlight",
            SignalKind::Proposal => "propose",
        }
    }
}

/// Content of a communication, as far as the matching compares it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ComparedContent {
    /// The kind of the communication.
    pub kind: SignalKind,
    /// Location that the communication is about; `None` for a communication without a location.
    pub target: Option<LocationId>,
}

/// A communication of wizard or assistant, with its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CommunicationEvent {
    /// Number of presses of the human in the trial before the communication.
    pub press: u32,
    /// Time of the communication on the trial's clock.
    pub clock: SessionTime,
    /// The content of the communication.
    pub content: ComparedContent,
}

/// Which part of the content of two communications must agree for a match.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatchCriterion {
    /// Signal and target location of two communications must agree.
    Signal,
    /// The kinds of two communications must agree.
    Kind,
    /// The contents of two communications may differ: only their times have to match.
    Any,
}

impl MatchCriterion {
    /// All match criteria, the strictest first.
    pub const ALL: [MatchCriterion; 3] = [MatchCriterion::Signal, MatchCriterion::Kind, MatchCriterion::Any];

    fn class(self, content: ComparedContent) -> Option<ComparedContent> {
        match self {
            MatchCriterion::Signal => Some(content),
            MatchCriterion::Kind => Some(ComparedContent { target: None, ..content }),
            MatchCriterion::Any => None,
        }
    }
}

/// Pairs of an optimal one-to-one matching of two lists of communications, as indices into both lists, in the order of
/// the first list. Both lists must be sorted by time.
pub fn matched(
    of: &[CommunicationEvent],
    with: &[CommunicationEvent],
    window: u32,
    likeness: MatchCriterion,
) -> Vec<(usize, usize)> {
    let mut classes: BTreeMap<Option<ComparedContent>, [Vec<usize>; 2]> = BTreeMap::new();
    for (lane, said) in [of, with].into_iter().enumerate() {
        for (index, said) in said.iter().enumerate() {
            classes.entry(likeness.class(said.content)).or_default()[lane].push(index);
        }
    }
    let mut pairs: Vec<(usize, usize)> = classes.values().flat_map(|[a, b]| aligned(of, with, a, b, window)).collect();
    pairs.sort_unstable();
    pairs
}

/// Optimal matching of communications within one class of content. Since costs are distances on a line, some optimal
/// matching has no crossings and is found by sequence alignment.
fn aligned(
    of: &[CommunicationEvent],
    with: &[CommunicationEvent],
    a: &[usize],
    b: &[usize],
    window: u32,
) -> Vec<(usize, usize)> {
    // Objective: the number of pairs first, then the negative number of presses between the communications of a pair.
    let mut best = vec![vec![(0i64, 0i64); b.len() + 1]; a.len() + 1];
    let apart = |i: usize, j: usize| of[a[i]].press.abs_diff(with[b[j]].press);
    for i in (0..a.len()).rev() {
        for j in (0..b.len()).rev() {
            let (pairs, nearness) = best[i + 1][j + 1];
            let taken = (apart(i, j) <= window).then(|| (pairs + 1, nearness - i64::from(apart(i, j))));
            best[i][j] = best[i + 1][j].max(best[i][j + 1]).max(taken.unwrap_or((0, i64::MIN)));
        }
    }
    let (mut i, mut j) = (0, 0);
    let mut pairs = Vec::new();
    while i < a.len() && j < b.len() {
        if best[i][j] == best[i + 1][j] {
            i += 1;
        } else if best[i][j] == best[i][j + 1] {
            j += 1;
        } else {
            pairs.push((a[i], b[j]));
            (i, j) = (i + 1, j + 1);
        }
    }
    pairs
}

/// Running counts of matches between two lists of communications over trials.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MatchCounts {
    of: u64,
    with: u64,
    /// Number of matched pairs at each level of [`MatchCriterion::ALL`].
    pairs: [u64; 3],
    /// Mean number of matched pairs over circular shifts of the second list, at each level: the chance level.
    chance: [f64; 3],
    /// Number of communications of the first list in trials that are long enough for circular shifts.
    shifted_of: u64,
    /// Time from the second list's communication to the first list's communication, in seconds, by matched pair.
    leads_s: Vec<f64>,
    /// Contingency table of communication contents per press, first list by second list.
    units: Units,
}

impl MatchCounts {
    /// Adds the two lists of a trial with `presses` presses of the human.
    pub fn add(&mut self, of: &[CommunicationEvent], with: &[CommunicationEvent], presses: u32, window: u32) {
        self.of += of.len() as u64;
        self.with += with.len() as u64;
        let strict = matched(of, with, window, MatchCriterion::Signal);
        for (pairs, likeness) in self.pairs.iter_mut().zip(MatchCriterion::ALL) {
            *pairs += matched(of, with, window, likeness).len() as u64;
        }
        let lead = |&(a, b): &(usize, usize)| of[a].clock.as_secs_f64() - with[b].clock.as_secs_f64();
        self.leads_s.extend(strict.iter().map(lead));
        if let Some(chance) = chance(of, with, presses, window) {
            self.chance.iter_mut().zip(chance).for_each(|(sum, one)| *sum += one);
            self.shifted_of += of.len() as u64;
        }
        for (unit, number) in units(of, with, &strict, presses) {
            *self.units.entry(unit).or_default() += number;
        }
    }

    /// The similarity of the two lists over all added trials.
    pub fn similarity(&self) -> Similarity {
        let share = |part: f64, all: u64| (all > 0).then(|| part / all as f64);
        let level = |index: usize| {
            let pairs = self.pairs[index] as f64;
            MatchShares {
                recall: share(pairs, self.of),
                chance_recall: share(self.chance[index], self.shifted_of),
                precision: share(pairs, self.with),
                f1: share(2.0 * pairs, self.of + self.with),
            }
        };
        Similarity {
            headline: level(0),
            kappa: kappa(&self.units),
            median_lead_s: median(self.leads_s.clone()),
            of_n: self.of,
            with_n: self.with,
            matched: self.pairs[0],
            signal: level(0),
            kind: level(1),
            any: level(2),
        }
    }
}

/// Shares of matched communications of two lists; null without communications.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct MatchShares {
    /// Share of the first list's communications that are matched.
    pub recall: Option<f64>,
    /// Chance level of recall: mean over circular shifts of the second list.
    pub chance_recall: Option<f64>,
    /// Share of the second list's communications that are matched.
    pub precision: Option<f64>,
    /// The harmonic mean of recall and precision (F1 score).
    pub f1: Option<f64>,
}

/// Similarity of two lists of communications, for instance a wizard's and an assistant's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Similarity {
    /// The shares for the same signal and target; a file has these shares beside the numbers of both lists.
    #[serde(flatten)]
    pub headline: MatchShares,
    /// Cohen's kappa of both lists per human press; null where agreement by chance is 1.
    pub kappa: Option<f64>,
    /// Median time by which the second list's communications are earlier than the first list's, in seconds; negative if
    /// they are later.
    pub median_lead_s: Option<f64>,
    /// Number of communications in the first list, sent or recommended.
    pub of_n: u64,
    /// Number of communications in the second list, sent or recommended.
    pub with_n: u64,
    /// Number of matched pairs with the same signal and target.
    pub matched: u64,
    /// Shares of matches with the same signal and target.
    pub signal: MatchShares,
    /// Shares of matches with the same kind of signal.
    pub kind: MatchShares,
    /// Shares of matches with any content.
    pub any: MatchShares,
}

impl Similarity {
    /// The median lead of the second list as text: "+1.5 s"; "-" if it is not known.
    pub fn lead(&self) -> String {
        self.median_lead_s.map_or("-".to_string(), |lead| format!("{lead:+.1} s"))
    }
}

/// Mean number of matched pairs at each level over circular shifts of the second list by more than the window; `None`
/// if the trial is too short for such a shift.
fn chance(of: &[CommunicationEvent], with: &[CommunicationEvent], presses: u32, window: u32) -> Option<[f64; 3]> {
    // Positions before, between and after the presses of the trial.
    let places = presses + 1;
    let shifts = window + 1..places.saturating_sub(window);
    let pairs = |shift: u32| {
        let shifted = |said: &CommunicationEvent| CommunicationEvent { press: (said.press + shift) % places, ..*said };
        let mut shifted: Vec<CommunicationEvent> = with.iter().map(shifted).collect();
        shifted.sort_by_key(|said| said.press);
        MatchCriterion::ALL.map(|likeness| matched(of, &shifted, window, likeness).len() as u64)
    };
    let (mut count, mut sums) = (0u32, [0u64; 3]);
    for shift in shifts {
        count += 1;
        sums.iter_mut().zip(pairs(shift)).for_each(|(sum, pairs)| *sum += pairs);
    }
    (count > 0).then(|| sums.map(|sum| sum as f64 / f64::from(count)))
}

type Units = BTreeMap<(Option<ComparedContent>, Option<ComparedContent>), u64>;

/// Contingency table of both lists per press of the human; several communications at one press give several units.
fn units(of: &[CommunicationEvent], with: &[CommunicationEvent], pairs: &[(usize, usize)], presses: u32) -> Units {
    let mut units = Units::new();
    let mut spoken = vec![[Vec::new(), Vec::new()]; presses as usize + 1];
    let mut is_silent = vec![true; presses as usize + 1];
    let place = |said: &CommunicationEvent| said.press.min(presses) as usize;
    for &(a, _) in pairs {
        *units.entry((Some(of[a].content), Some(of[a].content))).or_default() += 1;
        is_silent[place(&of[a])] = false;
    }
    let is_paired = |lane: usize, index: usize| pairs.iter().any(|&(a, b)| [a, b][lane] == index);
    for (lane, said) in [of, with].into_iter().enumerate() {
        for (_, said) in said.iter().enumerate().filter(|(index, _)| !is_paired(lane, *index)) {
            spoken[place(said)][lane].push(said.content);
            is_silent[place(said)] = false;
        }
    }
    for [a, b] in &spoken {
        for index in 0..a.len().max(b.len()) {
            *units.entry((a.get(index).copied(), b.get(index).copied())).or_default() += 1;
        }
    }
    let silent = is_silent.iter().filter(|&&silent| silent).count() as u64;
    if silent > 0 {
        *units.entry((None, None)).or_default() += silent;
    }
    units
}

/// Cohen's kappa of a contingency table of two raters or lists.
pub fn kappa<T: Ord + Copy>(units: &BTreeMap<(T, T), u64>) -> Option<f64> {
    let all: u64 = units.values().sum();
    let mut margins: BTreeMap<T, [u64; 2]> = BTreeMap::new();
    for (&(a, b), &number) in units {
        margins.entry(a).or_default()[0] += number;
        margins.entry(b).or_default()[1] += number;
    }
    let squared = (all as f64) * (all as f64);
    let expected: f64 = margins.values().map(|[a, b]| *a as f64 * *b as f64 / squared).sum();
    let agreed: u64 = units.iter().filter(|((a, b), _)| a == b).map(|(_, number)| number).sum();
    (all > 0 && expected < 1.0).then(|| (agreed as f64 / all as f64 - expected) / (1.0 - expected))
}
