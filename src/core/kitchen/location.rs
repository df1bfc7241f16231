//! Locations and storages, with their areas on the wall display.

use serde::{Deserialize, Serialize};

use super::agent::Agent;
use super::content::ContentId;
use super::look::Appearance;

/// Identifies a location: an index into [`super::Kitchen::locations`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct LocationId(pub u8);

impl LocationId {
    /// The location's place in [`Kitchen::locations`](super::Kitchen::locations).
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// An area of the wall display, in fractions of its width and height; the origin is at the top left, y points down.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DisplayArea {
    /// Left edge of the area, as a fraction of the display's width.
    pub x: f64,
    /// Upper edge of the area, as a fraction of the display's height.
    pub y: f64,
    /// Width of the area, as a fraction of the display's width.
    pub w: f64,
    /// Height of the area, as a fraction of the display's height.
    pub h: f64,
}

impl DisplayArea {
    /// The centre of the area, in fractions of the display's width and height.
    pub fn centre(self) -> [f64; 2] {
        [self.x + self.w / 2.0, self.y + self.h / 2.0]
    }

    /// The distance in metres from a point of the display (in fractions) to this area, 0 inside the area; `display_m`
    /// is the size of the display.
    pub fn distance_m(self, point: [f64; 2], display_m: [f64; 2]) -> f64 {
        let outside = |low: f64, length: f64, value: f64| (low - value).max(value - low - length).max(0.0);
        let dx = outside(self.x, self.w, point[0]) * display_m[0];
        let dy = outside(self.y, self.h, point[1]) * display_m[1];
        dx.hypot(dy)
    }

    /// The least distance in metres between two areas of the display; 0 if the areas touch.
    pub fn gap_m(self, other: DisplayArea, display_m: [f64; 2]) -> f64 {
        let gap = |a: f64, a_len: f64, b: f64, b_len: f64| (b - a - a_len).max(a - b - b_len).max(0.0);
        let dx = gap(self.x, self.w, other.x, other.w) * display_m[0];
        let dy = gap(self.y, self.h, other.y, other.h) * display_m[1];
        dx.hypot(dy)
    }
}

/// The kind of a location: order, hand or place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LocationKind {
    /// An order location, which shows the ordered dish.
    Order,
    /// The hand of an agent, which holds one content.
    Hand(Agent),
    /// A place that holds one content; at the board, items are stacked.
    Place,
}

/// A location of the kitchen, about whose content a person can have a false belief.
#[derive(Clone, Debug, PartialEq)]
pub struct Location {
    /// Identifier of the location from the layout file: "cooking_pot".
    pub name: String,
    /// Whether the location is an order, a hand or a place.
    pub kind: LocationKind,
    /// The location's area on the wall display.
    pub display: DisplayArea,
    /// The wizard's key for the signal about this location.
    pub signal_key: Option<char>,
    /// How the participant's display draws the location, if the layout file says so.
    pub look: Option<Appearance>,
}

impl Location {
    /// The location's name as screens show it: "assembly board".
    pub fn label(&self) -> String {
        self.name.replace('_', " ")
    }
}

/// An endless supply of one ingredient, within reach of one agent.
#[derive(Clone, Debug, PartialEq)]
pub struct IngredientStorage {
    /// The agent who can take from the storage.
    pub agent: Agent,
    /// The item that the storage supplies: the ingredient in its first state.
    pub item: ContentId,
    /// The ingredient's name on screens.
    pub label: String,
    /// The storage's area on the wall display.
    pub display: DisplayArea,
}
