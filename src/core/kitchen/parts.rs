//! The parts of a kitchen: agents, contents and their words, locations, dishes, processing steps, buttons and state
//! aspects, and how the participant's display draws them.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// An agent: human or robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Agent {
    /// The human participant.
    Human,
    /// The robot that cooks with the participant.
    Robot,
}

impl Agent {
    /// Both agents, in the order of [`Agent::index`].
    pub const BOTH: [Agent; 2] = [Agent::Human, Agent::Robot];

    /// The agent's place in arrays of both agents: 0 for the human, 1 for the robot.
    #[inline]
    pub fn index(self) -> usize {
        self as usize
    }

    /// The other agent: the robot for the human, the human for the robot.
    pub fn other(self) -> Agent {
        match self {
            Agent::Human => Agent::Robot,
            Agent::Robot => Agent::Human,
        }
    }

    /// The agent's name in logs and tables: "human" or "robot".
    pub fn name(self) -> &'static str {
        match self {
            Agent::Human => "human",
            Agent::Robot => "robot",
        }
    }
}

/// The shapes that the page of the participant's display can draw: of ingredients, of dishes, of places.
pub const SHAPES: [&str; 32] = [
    "grains", "heap", "block", "sheet", "fillet", "slices", "prawn", "claw", "morsels", "bun", "cheese", "patty",
    "grilled", "round", "bell", "rings", "leaf", "jar", "nigiri", "roll", "burger", "toast", "bowl", "board", "plate",
    "counter", "cutting", "pot", "mat", "grill", "shelf", "tray",
];

/// The appearance of an ingredient, dish or place on the display: "fillet #f58a5f".
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Appearance {
    /// Name of the shape: one of [`SHAPES`].
    pub shape: String,
    /// The colours of the shape as "#rrggbb"; if the list is empty, the shape has its default colours.
    pub colours: Vec<String>,
}

impl Appearance {
    /// Reads an appearance (a shape and up to four colours) from text.
    ///
    /// # Errors
    /// What the text would have to contain.
    pub fn read(text: &str) -> Result<Appearance, String> {
        let mut words = text.split_whitespace();
        let shape = words.next().unwrap_or_default().to_string();
        let colours: Vec<String> = words.map(str::to_string).collect();
        if !SHAPES.contains(&shape.as_str()) {
            return Err(format!("a shape, one of {}, and colours: \"fillet #f58a5f\"", SHAPES.join(", ")));
        }
        let is_colour = |word: &String| {
            let digits = word.strip_prefix('#').unwrap_or_default();
            digits.len() == 6 && digits.bytes().all(|byte| byte.is_ascii_hexdigit())
        };
        match colours.len() <= 4 && colours.iter().all(is_colour) {
            true => Ok(Appearance { shape, colours }),
            false => Err("up to four colours of six hexadecimal digits: \"fillet #f58a5f\"".to_string()),
        }
    }
}

/// Declares the types that identify the parts of a kitchen by their place in its lists.
macro_rules! ids {
    ($($(#[$about:meta])* $id:ident,)*) => {
        $(
            $(#[$about])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
            pub struct $id(pub u8);

            impl $id {
                /// The part's place in its list.
                #[inline]
                pub fn index(self) -> usize {
                    usize::from(self.0)
                }
            }
        )*
    };
}

ids! {
    /// Identifies a content: an index into [`super::Kitchen::contents`]; 0 is "empty".
    #[derive(Default)]
    ContentId,
    /// Identifies a location: an index into [`super::Kitchen::locations`].
    #[derive(Serialize, Deserialize)]
    LocationId,
    /// Identifies a dish: an index into [`super::Kitchen::dishes`].
    #[derive(Serialize, Deserialize)]
    DishId,
    /// Identifies a button: an index into the list of one agent's buttons, [`super::Kitchen::buttons`].
    ButtonId,
    /// Identifies a state aspect: an index into [`super::Kitchen::aspects`].
    AspectId,
}

impl ContentId {
    /// The empty content: the location holds nothing.
    pub const EMPTY: ContentId = ContentId(0);

    /// Whether this is the empty content (nothing).
    #[inline]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

impl AspectId {
    /// The state aspect that is the content of this location; locations come first in the list of aspects.
    pub fn of_location(location: LocationId) -> AspectId {
        AspectId(location.0)
    }
}

/// Something that a location can hold: nothing, an item, or a stack of items.
#[derive(Clone, Debug, PartialEq)]
pub struct Content {
    /// The content's name in logs and tables: "rice cooked", "nori + rice cooked", "empty"; a stack that is a dish of
    /// the menu has the dish's name.
    pub name: String,
    /// Words of screens and reports for the content: "cooked rice", "nori + cooked rice".
    pub wording: String,
    /// The items in the content, in the order of the recipe file; one for a single item, none for "empty".
    pub items: Vec<ContentId>,
    /// Whether the content is a stack that is a dish of the menu, and has the dish's name.
    pub is_dish: bool,
    /// The ingredient of a single item, as an index into the recipe file's list; `None` for a stack.
    pub ingredient: Option<usize>,
    /// The contents that look similar: the same content with one ingredient replaced by a look-alike.
    pub look_alikes: Vec<ContentId>,
    /// How the participant's display draws a single item, if the recipe file says so.
    pub look: Option<Appearance>,
}

impl Content {
    /// Whether the content is a stack: several items that are carried as one.
    pub fn is_stack(&self) -> bool {
        self.items.len() > 1
    }
}

/// The language of the console, of Rerun and of reports.
pub const SCREEN_LANGUAGE: &str = "en";

/// Words for items, ingredients and dishes, by language, then by name in logs. The table has a word for every item in
/// the screens' language, in other languages only the words that the recipe file gives.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KitchenWords(pub(super) BTreeMap<String, BTreeMap<String, String>>);

impl KitchenWords {
    /// All languages with words, and these.
    pub fn languages(&self) -> impl Iterator<Item = (&str, &BTreeMap<String, String>)> {
        self.0.iter().map(|(language, words)| (language.as_str(), words))
    }

    /// The words for names in this language; empty if the recipe file has no words in the language.
    pub fn in_language(&self, language: &str) -> &BTreeMap<String, String> {
        static NONE: BTreeMap<String, String> = BTreeMap::new();
        self.0.get(language).unwrap_or(&NONE)
    }

    /// The wording of a content in this language: "cooked rice", "nori + cooked rice". A name without a word in the
    /// language is returned as it is. `contents` are all contents of the kitchen.
    pub fn content(&self, language: &str, content: &Content, contents: &[Content]) -> String {
        let words = self.in_language(language);
        let word = |name: &str| words.get(name).map_or(name, String::as_str).to_string();
        if !content.is_stack() || content.is_dish {
            return word(&content.name);
        }
        let items = content.items.iter().map(|item| word(&contents[item.index()].name));
        items.collect::<Vec<_>>().join(" + ")
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
        self.gap_m(DisplayArea { x: point[0], y: point[1], w: 0.0, h: 0.0 }, display_m)
    }

    /// The least distance in metres between two areas of the display; 0 if the areas touch.
    pub(crate) fn gap_m(self, other: DisplayArea, display_m: [f64; 2]) -> f64 {
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

/// A dish of the menu.
#[derive(Clone, Debug, PartialEq)]
pub struct Dish {
    /// The dish's name from the recipe file, which orders and screens show.
    pub name: String,
    /// Variants of the dish's recipe that people may believe in: stacks of items, the true recipe first.
    pub variants: Vec<ContentId>,
    /// How the participant's display draws the finished dish, if the recipe file says so.
    pub look: Option<Appearance>,
}

impl Dish {
    /// The true recipe of the dish, as a stack of items.
    pub fn stack(&self) -> ContentId {
        self.variants[0]
    }
}

/// A processing step of the compiled kitchen.
#[derive(Clone, Debug, PartialEq)]
pub struct ProcessingStep {
    /// The name of the processing step from the recipe file: "cut".
    pub name: String,
    /// Location of the processing step; `None` for the hand of the agent who presses.
    pub place: Option<LocationId>,
    /// Which agents can do the processing step, indexed by [`super::Agent::index`].
    pub agents: [bool; 2],
    /// Pairs of input item and output item: what the processing step makes of each item.
    pub steps: Vec<(ContentId, ContentId)>,
}

/// The action that a press of a button performs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ButtonAction {
    /// Take this item from the agent's own storage into the agent's empty hand.
    Take(ContentId),
    /// Pick up, put down or stack: exchange contents between the agent's hand and this location.
    Use(LocationId),
    /// Apply the processing step with this index: to the content of the hand if the step has no place of its own, else
    /// to the content of the step's place.
    Process(u8),
    /// Throw away the content of the agent's hand.
    Trash,
    /// Serve the order at this location from the plate.
    Serve(LocationId),
}

/// A physical button of one agent.
#[derive(Clone, Debug, PartialEq)]
pub struct Button {
    /// Name of the button: "take rice", "cutting_board", "cut", "trash", "serve 1".
    pub name: String,
    /// What a press of the button does.
    pub action: ButtonAction,
    /// Position of the button on the table in metres, in the frame of the robot's base.
    pub at_m: [f64; 2],
    /// The key on the human's keyboard that presses this button.
    pub key: Option<char>,
    /// Number of the button on the human's gamepad that presses this button.
    pub gamepad: Option<u8>,
    /// The colour of the button's cap, which the participant's display shows, too.
    pub colour: Option<ButtonColour>,
    /// The name of the button's area on the table; buttons of one area stand together, as on the display.
    pub area: Option<String>,
}

/// Colour of a button's cap: one of the colours in which arcade buttons are sold.
#[allow(missing_docs, reason = "the names say it")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ButtonColour {
    Red,
    Yellow,
    Green,
    Blue,
    White,
    Black,
}

/// What a state aspect is about: a location's content or a dish's recipe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AspectKind {
    /// The content of a location; possible values of this aspect are the bytes of [`super::State::code`].
    Location(LocationId),
    /// The recipe of a dish; possible values of this aspect are stacks of ingredients, the true recipe first.
    Recipe(DishId),
}

/// One state aspect and its possible values.
#[derive(Clone, Debug, PartialEq)]
pub struct StateAspect {
    /// Name of the state aspect: the name of its location, or "recipe of DISH".
    pub name: String,
    /// The location or the dish that the state aspect is about.
    pub kind: AspectKind,
    /// The possible values of the state aspect, as byte codes (see [`AspectKind`]).
    pub values: Vec<u8>,
    /// The name of each possible value in logs and tables: "rice cooked".
    pub labels: Vec<String>,
    /// Words of screens and reports for each possible value: "cooked rice".
    pub wordings: Vec<String>,
}

impl StateAspect {
    /// The index of a possible value of the aspect, from the value's code.
    pub fn index_of(&self, code: u8) -> Option<usize> {
        self.values.iter().position(|&value| value == code)
    }

    /// The index of a possible value of the aspect, from the value's name in logs and tables.
    pub fn value_named(&self, label: &str) -> Option<usize> {
        self.labels.iter().position(|known| known == label)
    }
}
