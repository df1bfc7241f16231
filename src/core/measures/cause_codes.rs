//! Raters' codes of error causes. The beliefs of people are unknown, so two raters independently code the errors of a
//! trial, and Cohen's kappa (1960, "A coefficient of agreement for nominal scales") measures the agreement of their
//! codes.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::attribution::{ErrorCause, FalseBeliefTarget};
use super::judged_press::JudgedPress;
use super::matching::kappa;
use crate::kitchen::{Kitchen, LocationKind, OrderContent, State};

/// Cause of an error as coded by a rater.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum ErrorCauseCode {
    /// A false belief caused the error; contains the location's name. An order location stands for the recipe of its
    /// dish.
    Belief(String),
    /// A slip of hand or attention, without a false belief, caused the error.
    Slip,
    /// A race caused the error: the robot changed the location shortly before the press, too late for the participant
    /// to react.
    Race,
    /// Another cause of the error than those with a code of their own.
    Other,
    /// Confused buttons: the participant wanted to press another button.
    Buttons,
}

/// Kinds of causes of an error, without what a false belief is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ErrorCauseKind {
    /// A false belief of the participant caused the error.
    Belief,
    /// A slip of hand or attention caused the error.
    Slip,
    /// A race caused the error: the robot changed the location before the participant could react.
    Race,
    /// Another cause of the error than the kinds listed here.
    Other,
    /// Confused buttons: the participant wanted to press another button.
    Buttons,
}

impl ErrorCauseKind {
    /// All kinds of error causes, in the order of the keys that code them.
    pub const ALL: [ErrorCauseKind; 5] = [
        ErrorCauseKind::Belief,
        ErrorCauseKind::Slip,
        ErrorCauseKind::Race,
        ErrorCauseKind::Other,
        ErrorCauseKind::Buttons,
    ];

    /// Name of the cause kind in files.
    pub fn name(self) -> &'static str {
        match self {
            ErrorCauseKind::Belief => "belief",
            ErrorCauseKind::Slip => "slip",
            ErrorCauseKind::Race => "race",
            ErrorCauseKind::Other => "other",
            ErrorCauseKind::Buttons => "buttons",
        }
    }

    /// Name of the cause kind in the raters' codebook.
    pub fn title(self) -> &'static str {
        match self {
            ErrorCauseKind::Belief => "wrong about",
            ErrorCauseKind::Slip => "slip",
            ErrorCauseKind::Race => "race",
            ErrorCauseKind::Other => "other cause",
            ErrorCauseKind::Buttons => "mixed up buttons",
        }
    }

    /// Definition of the cause kind in the raters' codebook, in one line.
    pub fn definition(self) -> &'static str {
        match self {
            ErrorCauseKind::Belief => "order: or its recipe",
            ErrorCauseKind::Slip => "nothing was believed wrong",
            ErrorCauseKind::Race => "the robot was quicker",
            ErrorCauseKind::Other => "none of these causes",
            ErrorCauseKind::Buttons => "wanted another",
        }
    }

    /// The definition of the cause kind in two words, for narrow screens; `None` where the title suffices.
    pub fn short_definition(self) -> Option<&'static str> {
        match self {
            ErrorCauseKind::Slip => Some("belief right"),
            ErrorCauseKind::Race => Some("robot first"),
            ErrorCauseKind::Belief | ErrorCauseKind::Other | ErrorCauseKind::Buttons => None,
        }
    }

    /// The kind of error cause with this name.
    pub fn named(name: &str) -> Option<ErrorCauseKind> {
        ErrorCauseKind::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

impl ErrorCauseCode {
    /// The code for a kind of error cause; `aspect` names the location of a false belief and is given for false beliefs
    /// only.
    pub fn new(kind: ErrorCauseKind, aspect: Option<&str>) -> Option<ErrorCauseCode> {
        match (kind, aspect) {
            (ErrorCauseKind::Belief, Some(aspect)) => Some(ErrorCauseCode::Belief(aspect.to_string())),
            (ErrorCauseKind::Slip, None) => Some(ErrorCauseCode::Slip),
            (ErrorCauseKind::Race, None) => Some(ErrorCauseCode::Race),
            (ErrorCauseKind::Other, None) => Some(ErrorCauseCode::Other),
            (ErrorCauseKind::Buttons, None) => Some(ErrorCauseCode::Buttons),
            _ => None,
        }
    }

    /// The kind of the coded cause, without what a false belief is about.
    pub fn kind(&self) -> ErrorCauseKind {
        match self {
            ErrorCauseCode::Belief(_) => ErrorCauseKind::Belief,
            ErrorCauseCode::Slip => ErrorCauseKind::Slip,
            ErrorCauseCode::Race => ErrorCauseKind::Race,
            ErrorCauseCode::Other => ErrorCauseKind::Other,
            ErrorCauseCode::Buttons => ErrorCauseKind::Buttons,
        }
    }

    /// Name of the location that the coded false belief is about; `None` for other causes.
    pub fn aspect(&self) -> Option<&str> {
        match self {
            ErrorCauseCode::Belief(aspect) => Some(aspect),
            _ => None,
        }
    }

    /// Target of the coded false belief, in the state before the press; `None` for other causes.
    pub fn target(&self, kitchen: &Kitchen, state: State) -> Option<FalseBeliefTarget> {
        let location = kitchen.location_named(self.aspect()?)?;
        Some(match (kitchen.location(location).kind, state.order(location)) {
            (LocationKind::Order, OrderContent::Dish(dish)) => FalseBeliefTarget::Order(location, Some(dish)),
            (LocationKind::Order, _) => FalseBeliefTarget::Order(location, None),
            _ => FalseBeliefTarget::Place(location),
        })
    }
}

/// Errors and locations to which the raters' codes of one recording can refer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CodableErrors {
    /// Log numbers of the presses that were errors, in ascending order.
    pub errors: Vec<u64>,
    /// Names of the kitchen's locations.
    pub places: Vec<String>,
}

impl CodableErrors {
    /// Collects the errors among these presses, and the locations of the kitchen.
    pub fn from_presses(kitchen: &Kitchen, presses: &[JudgedPress]) -> CodableErrors {
        CodableErrors {
            errors: presses.iter().filter(|press| press.verdict.error).map(|press| press.seq).collect(),
            places: kitchen.locations.iter().map(|location| location.name.clone()).collect(),
        }
    }

    /// Explains what is wrong with a code for the press with this log number, and the remedy; `None` for a valid code.
    pub fn fault(&self, press: u64, code: &ErrorCauseCode) -> Option<(String, String)> {
        if !self.errors.contains(&press) {
            return Some((format!("press {press}, which was no error"), self.nearest(press)));
        }
        let aspect = code.aspect().filter(|aspect| !self.places.iter().any(|place| place == aspect))?;
        Some((format!("the aspect \"{aspect}\""), format!("one of {}", self.places.join(", "))))
    }

    /// Log numbers of the errors closest to a press, as text.
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

/// Codes of one rater for one recording, by log number of the erroneous press.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RaterCodes(pub BTreeMap<u64, ErrorCauseCode>);

impl RaterCodes {
    /// The true codes of a simulated participant's errors, for comparison with raters.
    pub fn known(kitchen: &Kitchen, presses: &[JudgedPress]) -> RaterCodes {
        let code = |press: &JudgedPress| {
            Some(match press.cause? {
                ErrorCause::Slip => ErrorCauseCode::Slip,
                ErrorCause::Planning => ErrorCauseCode::Other,
                ErrorCause::Belief {
                    target: FalseBeliefTarget::Order(location, _) | FalseBeliefTarget::Place(location),
                    ..
                } => ErrorCauseCode::Belief(kitchen.location(location).name.clone()),
                // A false belief about a recipe has no location if no order requests the dish.
                ErrorCause::Belief { target: FalseBeliefTarget::Recipe(_), .. } => ErrorCauseCode::Other,
            })
        };
        RaterCodes(presses.iter().filter_map(|press| Some((press.seq, code(press)?))).collect())
    }

    /// The errors to which both raters gave the same code, with that code.
    pub fn agreed(&self, other: &RaterCodes) -> RaterCodes {
        let same = self.0.iter().filter(|(press, code)| other.0.get(press) == Some(code));
        RaterCodes(same.map(|(press, code)| (*press, code.clone())).collect())
    }
}

/// Contingency table of two raters' codes over the errors that both raters coded; recordings are added to the table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AgreementTable {
    kinds: BTreeMap<(ErrorCauseKind, ErrorCauseKind), u64>,
    /// Counts of location pairs (as indices of location names) for errors that both raters coded as false beliefs.
    aspects: BTreeMap<(usize, usize), u64>,
    names: Vec<String>,
}

/// Agreement of two raters on the causes of errors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RaterAgreement {
    /// Number of errors that both raters coded.
    pub errors: u64,
    /// Number of errors to which both raters gave the same kind of cause.
    pub same_cause: u64,
    /// Cohen's kappa of the kind of cause over {belief, slip, race, other, buttons}; null without codes, or if all
    /// codes are equal.
    pub kappa_cause: Option<f64>,
    /// Number of errors that both raters attributed to a false belief.
    pub beliefs: u64,
    /// Number of errors that both raters attributed to a false belief about the same location.
    pub same_aspect: u64,
    /// Cohen's kappa of the location that the false belief is about.
    pub kappa_aspect: Option<f64>,
}

impl AgreementTable {
    /// Adds the codes of one recording by both raters to the table.
    pub fn add(&mut self, one: &RaterCodes, other: &RaterCodes) {
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

    /// Computes the agreement of the two raters from the table.
    pub fn agreement(&self) -> RaterAgreement {
        RaterAgreement {
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
