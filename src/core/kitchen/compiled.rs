//! The compiled kitchen: its tables, and look-ups of its parts by name and id.

use super::parts::{
    Agent, AspectId, AspectKind, Button, ButtonAction, ButtonId, Content, ContentId, Dish, DishId, IngredientStorage,
    KitchenWords, Location, LocationId, LocationKind, ProcessingStep, StateAspect,
};
use super::state::{OrderContent, Recipes, State};

/// A compiled kitchen: tables over contents, locations, buttons and dishes, which never change after loading.
#[derive(Clone, Debug, PartialEq)]
pub struct Kitchen {
    /// Identifier of the kitchen, from the layout file.
    pub name: String,
    /// Title of the kitchen on screens.
    pub title: String,
    /// Width and height of the wall display in metres.
    pub display_m: [f64; 2],
    /// Height of the table in the frame of the robot's base, in metres.
    pub table_height_m: f64,
    /// Time for which an order is shown as served, in seconds.
    pub served_shown_s: f64,
    /// Time from serving an order to the appearance of the next order, in seconds.
    pub new_order_after_s: f64,
    /// Every content that a location can hold; index 0 is "empty", then the items, then the stacks by size.
    pub contents: Vec<Content>,
    /// Words of screens for contents, by language.
    pub words: KitchenWords,
    /// The kitchen's locations in the order of the layout file, orders first.
    pub locations: Vec<Location>,
    /// The buttons of the human and of the robot, indexed by [`Agent::index`] and [`ButtonId`].
    pub buttons: [Vec<Button>; 2],
    /// The storages: endless supplies of one ingredient each.
    pub storages: Vec<IngredientStorage>,
    /// The dishes of the menu.
    pub dishes: Vec<Dish>,
    /// The state aspects, about which beliefs can be false: one per location (its content) and one per dish (its
    /// recipe).
    pub aspects: Vec<StateAspect>,
    /// The processing steps, such as cutting and cooking.
    pub processes: Vec<ProcessingStep>,
    /// The locations that show orders.
    pub orders: Vec<LocationId>,
    /// The hand of each agent, indexed by [`Agent::index`].
    pub hands: [LocationId; 2],
    /// The location (board) where items are stacked to a dish.
    pub board: LocationId,
    /// The location (plate) from which orders are served.
    pub plate: LocationId,
    pub(super) tables: TransitionTables,
}

impl Kitchen {
    /// The state of the kitchen with empty locations and no orders.
    pub fn empty_state(&self) -> State {
        State::default()
    }

    /// The true recipes of all dishes.
    pub fn true_recipes(&self) -> Recipes {
        let mut recipes = Recipes::default();
        for (index, dish) in self.dishes.iter().enumerate() {
            recipes.set(DishId(index as u8), dish.variants[0]);
        }
        recipes
    }

    /// The number of joint values of all state aspects, called |S| in the paper.
    pub fn state_count(&self) -> u128 {
        self.aspects.iter().map(|aspect| aspect.values.len() as u128).product()
    }

    /// The locations whose contents differ between two states.
    pub fn changed(&self, before: State, after: State) -> impl Iterator<Item = LocationId> + use<> {
        let locations = self.location_ids();
        locations.filter(move |&location| before.code(location) != after.code(location))
    }

    /// The state aspects of this kitchen.
    pub fn aspect_ids(&self) -> impl Iterator<Item = AspectId> + Clone + use<> {
        (0..self.aspects.len()).map(|index| AspectId(index as u8))
    }

    /// The locations of this kitchen.
    pub fn location_ids(&self) -> impl Iterator<Item = LocationId> + Clone + use<> {
        (0..self.locations.len()).map(|index| LocationId(index as u8))
    }

    /// The buttons of this agent.
    pub fn button_ids(&self, agent: Agent) -> impl Iterator<Item = ButtonId> + Clone + use<> {
        (0..self.buttons[agent.index()].len()).map(|index| ButtonId(index as u8))
    }

    /// The location of this kitchen with this id.
    pub fn location(&self, id: LocationId) -> &Location {
        &self.locations[id.index()]
    }

    /// The content of this kitchen with this id.
    pub fn content(&self, id: ContentId) -> &Content {
        &self.contents[id.index()]
    }

    /// The button of this agent with this id.
    pub fn button(&self, agent: Agent, id: ButtonId) -> &Button {
        &self.buttons[agent.index()][id.index()]
    }

    /// The dish of this kitchen with this id.
    pub fn dish(&self, id: DishId) -> &Dish {
        &self.dishes[id.index()]
    }

    /// The state aspect with this name: that of a location, or "recipe of DISH".
    pub fn aspect_named(&self, name: &str) -> Option<AspectId> {
        self.aspects.iter().position(|aspect| aspect.name == name).map(|index| AspectId(index as u8))
    }

    /// The location with this name in the layout file.
    pub fn location_named(&self, name: &str) -> Option<LocationId> {
        self.locations.iter().position(|location| location.name == name).map(|index| LocationId(index as u8))
    }

    /// The dish with this name in the recipe file.
    pub fn dish_named(&self, name: &str) -> Option<DishId> {
        self.dishes.iter().position(|dish| dish.name == name).map(|index| DishId(index as u8))
    }

    /// The content with this name.
    pub fn content_named(&self, name: &str) -> Option<ContentId> {
        self.contents.iter().position(|content| content.name == name).map(|index| ContentId(index as u8))
    }

    /// The agent's button with this name.
    pub fn button_named(&self, agent: Agent, name: &str) -> Option<ButtonId> {
        self.buttons[agent.index()].iter().position(|button| button.name == name).map(|index| ButtonId(index as u8))
    }

    /// Words of screens for a content, from the content's name in logs; an unknown name is returned as it is.
    pub fn worded<'a>(&'a self, name: &'a str) -> &'a str {
        self.content_named(name).map_or(name, |content| &self.content(content).wording)
    }

    /// What a location shows, in words: its content, or for an order the ordered dish, `none` or `served`.
    pub fn content_label(&self, state: State, location: LocationId) -> &str {
        match self.location(location).kind {
            LocationKind::Order => match state.order(location) {
                OrderContent::None => "none",
                OrderContent::Served => "served",
                OrderContent::Dish(dish) => &self.content(self.dish(dish).stack()).wording,
            },
            _ => &self.content(state.content(location)).wording,
        }
    }

    /// The agent's button that is nearest to this button on the table.
    pub fn nearest_button(&self, agent: Agent, button: ButtonId) -> Option<ButtonId> {
        let buttons = &self.buttons[agent.index()];
        let own = buttons[button.index()].at_m;
        let distance = |index: usize| (buttons[index].at_m[0] - own[0]).hypot(buttons[index].at_m[1] - own[1]);
        let others = (0..buttons.len()).filter(|&index| index != button.index());
        others.min_by(|&a, &b| distance(a).total_cmp(&distance(b))).map(|index| ButtonId(index as u8))
    }

    /// The agent's storage button whose item looks like the item of this button; `None` if there is none.
    pub fn look_alike_button(&self, agent: Agent, button: ButtonId) -> Option<ButtonId> {
        let ButtonAction::Take(item) = self.button(agent, button).action else { return None };
        let alike = &self.content(item).look_alikes;
        let is_alike = |action| matches!(action, ButtonAction::Take(other) if alike.contains(&other));
        let buttons = &self.buttons[agent.index()];
        buttons.iter().position(|other| is_alike(other.action)).map(|index| ButtonId(index as u8))
    }

    /// Codes of the contents that look like the content with this code at a location or, at an order, of the dishes that
    /// look like the ordered one.
    pub fn look_alike_codes(&self, location: LocationId, code: u8) -> Vec<u8> {
        if self.location(location).kind != LocationKind::Order {
            return self.content(ContentId(code)).look_alikes.iter().map(|alike| alike.0).collect();
        }
        let OrderContent::Dish(dish) = OrderContent::from_code(code) else { return Vec::new() };
        let alike = &self.content(self.dish(dish).stack()).look_alikes;
        let dishes = self.dishes.iter().enumerate().filter(|(_, other)| alike.contains(&other.stack()));
        dishes.map(|(index, _)| OrderContent::Dish(DishId(index as u8)).code()).collect()
    }

    /// Index of the true value of a state aspect; 0 if the location holds a content that is not allowed there.
    pub fn true_value(&self, state: State, aspect: AspectId) -> usize {
        let aspect = &self.aspects[aspect.index()];
        match aspect.kind {
            AspectKind::Location(location) => aspect.index_of(state.code(location)).unwrap_or(0),
            AspectKind::Recipe(_) => 0,
        }
    }

    /// Sets a state aspect to the value with this index, in the state or in the recipes.
    #[inline]
    pub fn set_value(&self, state: &mut State, recipes: &mut Recipes, aspect: AspectId, value: usize) {
        let aspect = &self.aspects[aspect.index()];
        match aspect.kind {
            AspectKind::Location(location) => state.set_code(location, aspect.values[value]),
            AspectKind::Recipe(dish) => recipes.set(dish, ContentId(aspect.values[value])),
        }
    }

    /// The state aspect that is the recipe of this dish: recipes follow the locations.
    pub fn aspect_of_dish(&self, dish: DishId) -> AspectId {
        AspectId((self.locations.len() + dish.index()) as u8)
    }

    /// The state aspects that showing a location reveals: its content, or an order and the recipe of the ordered dish.
    pub fn aspects_at(&self, state: State, location: LocationId) -> Vec<AspectId> {
        let mut aspects = vec![AspectId::of_location(location)];
        if let (LocationKind::Order, OrderContent::Dish(dish)) = (self.location(location).kind, state.order(location)) {
            aspects.push(self.aspect_of_dish(dish));
        }
        aspects
    }
}

/// Transition tables over contents, computed once for each kitchen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TransitionTables {
    pub(super) width: usize,
    /// `accepts[location * width + content]`: whether the location, when empty, accepts the content.
    pub(super) accepts: Vec<bool>,
    /// `stacks[a * width + b]`: the stack of contents a and b; 0 if these contents cannot be stacked.
    pub(super) stacks: Vec<ContentId>,
    /// `becomes[process * width + content]`: the result of the processing step; 0 if the step does not apply to the
    /// content.
    pub(super) becomes: Vec<ContentId>,
}
