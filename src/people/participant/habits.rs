//! Habits and lapses of a simulated participant: the habitual order of fetching parts, and the omissions in one
//! decision.

use rand::RngExt;

use super::draws::chance;
use super::population::ParticipantTraits;
use tomcom_core::base::rng::Stream;
use tomcom_core::kitchen::{ButtonId, ContentId, Kitchen};

/// Habits of one simulated participant, including the dish that the participant made last.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Habits {
    /// Rank of each content as an ingredient: the participant fetches ingredients of lower rank first.
    ranks: Vec<u8>,
    /// The stack that the participant served last, if the participant confuses it with the present dish in this
    /// decision.
    last: Option<ContentId>,
}

impl Habits {
    /// Draws the order in which the participant fetches ingredients.
    pub fn draw(kitchen: &Kitchen, random: &mut Stream) -> Habits {
        Habits { ranks: kitchen.contents.iter().map(|_| random.random_range(0..=u8::MAX)).collect(), last: None }
    }

    /// The same habits for a decision in which the participant confuses the present dish with the last one; with
    /// `None`, for a decision without such a confusion.
    pub fn with_last(&self, last: Option<ContentId>) -> Habits {
        Habits { last, ..self.clone() }
    }

    /// The rank of an ingredient in the participant's habitual order.
    pub fn rank(&self, ingredient: ContentId) -> u8 {
        self.ranks[ingredient.index()]
    }

    /// The part of the last dish that the participant takes by habit instead of a part of the present dish. Both parts
    /// belong in the same slot of a dish, so that they do not stack.
    pub fn part_instead(&self, kitchen: &Kitchen, stack: ContentId, part: ContentId) -> Option<ContentId> {
        let last = &kitchen.content(self.last?).items;
        let own = &kitchen.content(stack).items;
        if last.contains(&part) {
            return None;
        }
        last.iter().copied().find(|&other| !own.contains(&other) && kitchen.stacked(part, other).is_none())
    }
}

/// Lapses of a simulated participant (omissions, habits and chance) in the decisions until the next press. A repeated
/// decision has the same lapses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lapses {
    /// Lapse: the participant does not check the preconditions of presses after the next one.
    pub skips_check: bool,
    /// Lapse: the participant confuses the present dish with the last one.
    pub follows_habit: bool,
    /// Lapse: the participant forgets parts that lie at parking places.
    pub forgets_parked: bool,
    /// Lapse: the participant first does what is within reach for another order.
    pub takes_along: bool,
    /// Random number from 0 to 1 that decides between equally good choices.
    pub whim: f64,
    /// The button of the press that just had no effect, if the participant tries that press again.
    pub insists_on: Option<ButtonId>,
}

impl Lapses {
    /// Draws the participant's lapses until the next press.
    pub fn draw(person: &ParticipantTraits, random: &mut Stream) -> Lapses {
        Lapses {
            skips_check: chance(random, person.skips_check),
            follows_habit: chance(random, person.follows_habit),
            forgets_parked: chance(random, person.forgets_parked),
            takes_along: chance(random, person.takes_along),
            whim: random.random::<f64>(),
            insists_on: None,
        }
    }
}
