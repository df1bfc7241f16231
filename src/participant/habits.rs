//! Habits and lapses: the order in which a participant gets parts, and what goes wrong in one decision.

use rand::RngExt;

use super::population::{Individual, chance};
use crate::base::rng::Stream;
use crate::kitchen::{ButtonId, ContentId, Kitchen};

/// Habits of one participant, and of its last dish.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Habits {
    /// Rank of each content as ingredient: those of lower rank are got first.
    ranks: Vec<u8>,
    /// The stack that was served last, if habit takes it for the present one in this decision.
    last: Option<ContentId>,
}

impl Habits {
    /// Draws the order of the ingredients.
    pub fn draw(kitchen: &Kitchen, random: &mut Stream) -> Habits {
        Habits { ranks: kitchen.contents.iter().map(|_| random.random_range(0..=u8::MAX)).collect(), last: None }
    }

    /// The same habits in a decision that the last dish gets into, or not.
    pub fn with_last(&self, last: Option<ContentId>) -> Habits {
        Habits { last, ..self.clone() }
    }

    /// The place of an ingredient in the habitual order.
    pub fn rank(&self, ingredient: ContentId) -> u8 {
        self.ranks[ingredient.index()]
    }

    /// The last dish's part that habit takes for a part of the present one: of the same slot, so that the two do not stack.
    pub fn part_instead(&self, kitchen: &Kitchen, stack: ContentId, part: ContentId) -> Option<ContentId> {
        let last = &kitchen.content(self.last?).items;
        let own = &kitchen.content(stack).items;
        if last.contains(&part) {
            return None;
        }
        last.iter().copied().find(|&other| !own.contains(&other) && kitchen.stacked(part, other).is_none())
    }
}

/// What happens to go wrong, or to come to mind, in the decisions until the next press. A repeated decision has the same.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lapses {
    /// Preconditions of later presses are not checked.
    pub skips_check: bool,
    /// The last dish gets into the present one.
    pub follows_habit: bool,
    /// Parts at parking places do not come to mind.
    pub forgets_parked: bool,
    /// What is at hand for another order is done first.
    pub takes_along: bool,
    /// Decides between equal choices, 0 to 1.
    pub whim: f64,
    /// The press that just did nothing, if it is tried again.
    pub insists_on: Option<ButtonId>,
}

impl Lapses {
    /// Draws the lapses until the next press.
    pub fn draw(person: &Individual, random: &mut Stream) -> Lapses {
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
