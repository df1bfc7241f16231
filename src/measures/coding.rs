//! What raters say about errors: why each press was one. For people nobody knows what they believed, so two raters code the
//! errors of a trial, each for oneself, and Cohen's kappa (1960, "A coefficient of agreement for nominal scales") says how far
//! they agree.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::attribution::{Cause, Target};
use super::judged_press::JudgedPress;
use super::matching::kappa;
use crate::kitchen::{Kitchen, LocationKind, OrderContent, State};

/// Why a press was an error, in a rater's eyes.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Code {
    /// Something was believed wrong: an order and the recipe of its dish, or a place, by the location's name.
    Belief(String),
    /// Nothing was; the hand or the attention slipped.
    Slip,
    /// The robot was quicker.
    Race,
    Other,
}

/// The kinds of causes, without what is believed wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CauseKind {
    Belief,
    Slip,
    Race,
    Other,
}

impl CauseKind {
    /// All of them, in the order of the keys that code them.
    pub const ALL: [CauseKind; 4] = [CauseKind::Belief, CauseKind::Slip, CauseKind::Race, CauseKind::Other];

    /// As it stands in files.
    pub fn name(self) -> &'static str {
        match self {
            CauseKind::Belief => "belief",
            CauseKind::Slip => "slip",
            CauseKind::Race => "race",
            CauseKind::Other => "other",
        }
    }

    /// The kind of this name.
    pub fn named(name: &str) -> Option<CauseKind> {
        CauseKind::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

impl Code {
    /// The code of a kind; `aspect` is what is believed wrong, of beliefs alone.
    pub fn new(kind: CauseKind, aspect: Option<&str>) -> Option<Code> {
        match (kind, aspect) {
            (CauseKind::Belief, Some(aspect)) => Some(Code::Belief(aspect.to_string())),
            (CauseKind::Slip, None) => Some(Code::Slip),
            (CauseKind::Race, None) => Some(Code::Race),
            (CauseKind::Other, None) => Some(Code::Other),
            _ => None,
        }
    }

    pub fn kind(&self) -> CauseKind {
        match self {
            Code::Belief(_) => CauseKind::Belief,
            Code::Slip => CauseKind::Slip,
            Code::Race => CauseKind::Race,
            Code::Other => CauseKind::Other,
        }
    }

    /// The name of the location that was believed wrong.
    pub fn aspect(&self) -> Option<&str> {
        match self {
            Code::Belief(aspect) => Some(aspect),
            _ => None,
        }
    }

    /// What was believed wrong, in the state that the press met; none where nothing was.
    pub fn target(&self, kitchen: &Kitchen, state: State) -> Option<Target> {
        let location = kitchen.location_named(self.aspect()?)?;
        Some(match (kitchen.location(location).kind, state.order(location)) {
            (LocationKind::Order, OrderContent::Dish(dish)) => Target::Order(location, Some(dish)),
            (LocationKind::Order, _) => Target::Order(location, None),
            _ => Target::Place(location),
        })
    }
}

/// What codes of a recording can be about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Codable {
    /// The numbers of the presses that were errors, in order.
    pub errors: Vec<u64>,
    /// The names of the kitchen's locations.
    pub places: Vec<String>,
}

impl Codable {
    /// The errors among these presses, and the locations of their kitchen.
    pub fn from_presses(kitchen: &Kitchen, presses: &[JudgedPress]) -> Codable {
        Codable {
            errors: presses.iter().filter(|press| press.verdict.error).map(|press| press.seq).collect(),
            places: kitchen.locations.iter().map(|location| location.name.clone()).collect(),
        }
    }

    /// What cannot be of a code for the press with this number, and what would be right.
    pub fn fault(&self, press: u64, code: &Code) -> Option<(String, String)> {
        if !self.errors.contains(&press) {
            return Some((format!("press {press}, which was no error"), self.nearest(press)));
        }
        let aspect = code.aspect().filter(|aspect| !self.places.iter().any(|place| place == aspect))?;
        Some((format!("the aspect \"{aspect}\""), format!("one of {}", self.places.join(", "))))
    }

    /// The errors around a press, in words.
    fn nearest(&self, press: u64) -> String {
        let after = self.errors.partition_point(|&error| error < press);
        let around = [after.checked_sub(1).map(|before| self.errors[before]), self.errors.get(after).copied()];
        let around: Vec<String> = around.iter().flatten().map(u64::to_string).collect();
        match around.is_empty() {
            true => "no code: nothing in this recording was an error".to_string(),
            false => format!("the number of an error in its log; the nearest: {}", around.join(" and ")),
        }
    }
}

/// What one rater says about the errors of a recording, by the numbers of their presses in its log.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Codes(pub BTreeMap<u64, Code>);

impl Codes {
    /// What somebody would say who knows what was believed: of simulated participants, to try raters on.
    pub fn known(kitchen: &Kitchen, presses: &[JudgedPress]) -> Codes {
        let code = |press: &JudgedPress| {
            Some(match press.cause? {
                Cause::Slip => Code::Slip,
                Cause::Belief { target: Target::Order(location, _) | Target::Place(location), .. } => {
                    Code::Belief(kitchen.location(location).name.clone())
                }
                // The recipe of a dish that no order wants has no place.
                Cause::Belief { target: Target::Recipe(_), .. } => Code::Other,
            })
        };
        Codes(presses.iter().filter_map(|press| Some((press.seq, code(press)?))).collect())
    }

    /// The errors about which both say the same, as they say it.
    pub fn agreed(&self, other: &Codes) -> Codes {
        let same = self.0.iter().filter(|(press, code)| other.0.get(press) == Some(code));
        Codes(same.map(|(press, code)| (*press, code.clone())).collect())
    }
}

/// How far two raters agree, over the errors that both have coded; of several recordings add them up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AgreementTable {
    kinds: BTreeMap<(CauseKind, CauseKind), u64>,
    /// By numbers, of the errors that both put down to a belief: each different location has one.
    aspects: BTreeMap<(usize, usize), u64>,
    names: Vec<String>,
}

/// The agreement of two raters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Agreement {
    /// Errors that both have coded, and those about which they say the same cause.
    pub errors: u64,
    pub same_cause: u64,
    /// Cohen's kappa of the cause over {belief, slip, race, other}; null: nothing was coded, or always the same.
    pub kappa_cause: Option<f64>,
    /// Errors that both put down to a belief, and those where they say the same is believed wrong.
    pub beliefs: u64,
    pub same_aspect: u64,
    /// Cohen's kappa of what is believed wrong, over the locations.
    pub kappa_aspect: Option<f64>,
}

impl AgreementTable {
    /// Adds a recording that both have coded.
    pub fn add(&mut self, one: &Codes, other: &Codes) {
        for (press, a) in &one.0 {
            let Some(b) = other.0.get(press) else { continue };
            *self.kinds.entry((a.kind(), b.kind())).or_default() += 1;
            if let (Some(a), Some(b)) = (a.aspect(), b.aspect()) {
                let pair = (self.number(a), self.number(b));
                *self.aspects.entry(pair).or_default() += 1;
            }
        }
    }

    fn number(&mut self, name: &str) -> usize {
        match self.names.iter().position(|known| known == name) {
            Some(number) => number,
            None => {
                self.names.push(name.to_string());
                self.names.len() - 1
            }
        }
    }

    /// What comes of it.
    pub fn agreement(&self) -> Agreement {
        Agreement {
            errors: self.kinds.values().sum(),
            same_cause: same(&self.kinds),
            kappa_cause: kappa(&self.kinds),
            beliefs: self.aspects.values().sum(),
            same_aspect: same(&self.aspects),
            kappa_aspect: kappa(&self.aspects),
        }
    }
}

fn same<T: Ord>(pairs: &BTreeMap<(T, T), u64>) -> u64 {
    pairs.iter().filter(|((a, b), _)| a == b).map(|(_, number)| number).sum()
}
