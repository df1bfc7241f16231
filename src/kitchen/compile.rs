//! From the two files to a [`Kitchen`]: contents, buttons, recipe variants and state aspects are computed here.

use std::ops::Range;

use toml::Spanned;

use super::action::{Action, Agent, Button};
use super::aspect::{Aspect, AspectKind};
use super::content::{Content, ContentId};
use super::layout::{Area, ButtonSpec, LayoutSpec, Location, LocationId, LocationKind, Storage};
use super::recipe::{Combine, DeviationSpec, Dish, DishId, Process, RecipesSpec};
use super::rules::Tables;
use super::state::{MAX_DISHES, MAX_LOCATIONS, OrderContent};
use super::{Kitchen, recipe};

/// At most so many orders at a time; the cost to go is exact for one and for two.
pub const MAX_ORDERS: usize = 2;
/// Locations on the display keep at least this distance, so that gaze can tell them apart.
pub const MIN_GAP_M: f64 = 0.15;

/// Which of the two files an error is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpecFile {
    Layout,
    Recipes,
}

/// Something in a layout or recipe file that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{found}")]
pub struct SpecError {
    pub file: SpecFile,
    /// Where in the file's text, in bytes.
    pub span: Option<Range<usize>>,
    /// What was found.
    pub found: String,
    /// What would be right.
    pub remedy: String,
}

type Result<T> = std::result::Result<T, SpecError>;

fn wrong(file: SpecFile, span: Range<usize>, found: impl Into<String>, remedy: impl Into<String>) -> SpecError {
    SpecError { file, span: Some(span), found: found.into(), remedy: remedy.into() }
}

fn wrong_file(file: SpecFile, found: impl Into<String>, remedy: impl Into<String>) -> SpecError {
    SpecError { file, span: None, found: found.into(), remedy: remedy.into() }
}

impl Kitchen {
    /// Compiles a kitchen. Errors name the file, the place in it, what was found and what would be right.
    pub fn compile(layout: &LayoutSpec, recipes: &RecipesSpec) -> Result<Kitchen> {
        let items = Items::read(recipes)?;
        let contents = contents(recipes, &items)?;
        let locations = locations(layout)?;
        let (hands, board, plate) = roles(layout, &locations)?;
        let processes = processes(recipes, &items, &locations)?;
        let dishes = dishes(recipes, &items, &contents)?;
        let tables = tables(layout, recipes, &items, &contents, &locations, &processes)?;
        let orders: Vec<LocationId> = (0..layout.order.len()).map(|index| LocationId(index as u8)).collect();
        let buttons = buttons(layout, recipes, &items, &locations, &processes)?;
        let aspects = aspects(&contents, &locations, &dishes, &tables);
        for (value, name) in [(&layout.display.width_m, "width_m"), (&layout.display.height_m, "height_m")] {
            positive(value, name)?;
        }
        positive(&layout.table.served_shown_s, "served_shown_s")?;
        positive(&layout.table.new_order_after_s, "new_order_after_s")?;
        let display_m = [*layout.display.width_m.get_ref(), *layout.display.height_m.get_ref()];
        check_gaps(layout, &locations, display_m)?;
        check_signal_keys(layout)?;
        Ok(Kitchen {
            name: layout.name.clone(),
            title: layout.title.clone(),
            display_m,
            table_height_m: layout.table.height_m,
            served_shown_s: *layout.table.served_shown_s.get_ref(),
            new_order_after_s: *layout.table.new_order_after_s.get_ref(),
            storages: storages(layout, recipes, &items)?,
            contents,
            locations,
            buttons,
            dishes,
            aspects,
            processes,
            orders,
            hands,
            board,
            plate,
            tables,
        })
    }
}

fn positive(value: &Spanned<f64>, name: &str) -> Result<()> {
    if value.get_ref().is_finite() && *value.get_ref() > 0.0 {
        return Ok(());
    }
    Err(wrong(SpecFile::Layout, value.span(), format!("{name} = {}", value.get_ref()), "a number above 0"))
}

/// Names of the ingredient items ("rice cooked") and the ids that they get.
struct Items {
    names: Vec<String>,
    /// The ingredient of each item.
    ingredient: Vec<usize>,
    /// The state of each item, as index into its ingredient's states.
    state: Vec<usize>,
}

impl Items {
    fn read(spec: &RecipesSpec) -> Result<Items> {
        let mut items = Items { names: Vec::new(), ingredient: Vec::new(), state: Vec::new() };
        for (index, ingredient) in spec.ingredient.iter().enumerate() {
            let states: Vec<String> = match ingredient.states.is_empty() {
                true => vec![String::new()],
                false => ingredient.states.iter().map(|state| format!(" {}", state.get_ref())).collect(),
            };
            for (state, suffix) in states.iter().enumerate() {
                let name = format!("{}{suffix}", ingredient.name.get_ref());
                if items.names.contains(&name) {
                    let found = format!("the item \"{name}\" a second time");
                    return Err(wrong(SpecFile::Recipes, ingredient.name.span(), found, "each item once"));
                }
                items.names.push(name);
                items.ingredient.push(index);
                items.state.push(state);
            }
        }
        Ok(items)
    }

    fn find(&self, name: &Spanned<String>) -> Result<ContentId> {
        match self.names.iter().position(|item| item == name.get_ref()) {
            Some(index) => Ok(ContentId(index as u8 + 1)),
            None => Err(wrong(
                SpecFile::Recipes,
                name.span(),
                format!("\"{}\"", name.get_ref()),
                format!("one of the items {}", self.names.join(", ")),
            )),
        }
    }

    fn find_all(&self, names: &[Spanned<String>]) -> Result<Vec<ContentId>> {
        names.iter().map(|name| self.find(name)).collect()
    }
}

/// Empty, all items, all stacks: pairs first, then larger ones.
fn contents(spec: &RecipesSpec, items: &Items) -> Result<Vec<Content>> {
    let item_sets = (0..items.names.len()).map(|index| vec![ContentId(index as u8 + 1)]);
    let mut sets: Vec<Vec<ContentId>> = std::iter::once(Vec::new()).chain(item_sets).collect();
    let mut stacks: Vec<Vec<ContentId>> = vec![Vec::new()];
    for slot in &spec.slot {
        let choices = items.find_all(&slot.items)?;
        for below in stacks.clone() {
            for &item in &choices {
                let mut stack = below.clone();
                stack.push(item);
                stacks.push(stack);
            }
        }
    }
    for stack in &mut stacks {
        stack.sort_unstable();
    }
    stacks.retain(|stack| stack.len() > 1);
    stacks.sort_by_key(|stack| (stack.len(), stack.clone()));
    sets.extend(stacks);
    if sets.len() > 255 {
        let found = format!("{} different contents (items and stacks)", sets.len());
        return Err(wrong_file(SpecFile::Recipes, found, "at most 255: fewer ingredients, states or slots"));
    }
    let dish_names = dish_names(spec, items)?;
    let mut contents: Vec<Content> = sets.iter().map(|set| content(set, items, &dish_names)).collect();
    let look_alikes: Vec<Vec<ContentId>> =
        sets.iter().map(|set| look_alikes(spec, items, &sets, set)).collect::<Result<_>>()?;
    for (content, alike) in contents.iter_mut().zip(look_alikes) {
        content.look_alikes = alike;
    }
    Ok(contents)
}

fn content(set: &[ContentId], items: &Items, dish_names: &[(Vec<ContentId>, String)]) -> Content {
    let names: Vec<&str> = set.iter().map(|item| items.names[item.index() - 1].as_str()).collect();
    let name = match dish_names.iter().find(|(stack, _)| stack == set) {
        Some((_, dish)) => dish.clone(),
        None if set.is_empty() => "empty".to_string(),
        None => names.join(" + "),
    };
    let ingredient = (set.len() == 1).then(|| items.ingredient[set[0].index() - 1]);
    Content { name, items: set.to_vec(), ingredient, look_alikes: Vec::new() }
}

fn dish_names(spec: &RecipesSpec, items: &Items) -> Result<Vec<(Vec<ContentId>, String)>> {
    let one = |dish: &recipe::DishSpec| {
        let mut stack = items.find_all(dish.items.get_ref())?;
        stack.sort_unstable();
        Ok((stack, dish.name.get_ref().clone()))
    };
    spec.dish.iter().map(one).collect()
}

/// The same content with one ingredient exchanged for one that looks like it.
fn look_alikes(
    spec: &RecipesSpec,
    items: &Items,
    sets: &[Vec<ContentId>],
    set: &[ContentId],
) -> Result<Vec<ContentId>> {
    let mut alike = Vec::new();
    for (position, item) in set.iter().enumerate() {
        let state = items.state[item.index() - 1];
        for name in &spec.ingredient[items.ingredient[item.index() - 1]].looks_like {
            let other = spec.ingredient.iter().position(|ingredient| ingredient.name.get_ref() == name.get_ref());
            let Some(other) = other else {
                let found = format!("looks_like \"{}\"", name.get_ref());
                return Err(wrong(SpecFile::Recipes, name.span(), found, "the name of another ingredient"));
            };
            let twin =
                (0..items.names.len()).find(|&twin| items.ingredient[twin] == other && items.state[twin] == state);
            let Some(twin) = twin else { continue };
            let mut exchanged = set.to_vec();
            exchanged[position] = ContentId(twin as u8 + 1);
            exchanged.sort_unstable();
            alike.extend(sets.iter().position(|set| *set == exchanged).map(|index| ContentId(index as u8)));
        }
    }
    Ok(alike)
}

fn locations(layout: &LayoutSpec) -> Result<Vec<Location>> {
    let location = |name: &Spanned<String>, kind, display: &Spanned<Area>, signal: &Option<Spanned<char>>| Location {
        name: name.get_ref().clone(),
        kind,
        display: *display.get_ref(),
        signal_key: signal.as_ref().map(|key| *key.get_ref()),
    };
    let orders = layout.order.iter().map(|o| (&o.name, location(&o.name, LocationKind::Order, &o.display, &o.signal)));
    let hands = layout
        .hand
        .iter()
        .map(|h| (&h.name, location(&h.name, LocationKind::Hand(*h.agent.get_ref()), &h.display, &h.signal)));
    let places = layout.place.iter().map(|p| (&p.name, location(&p.name, LocationKind::Place, &p.display, &p.signal)));
    let mut locations: Vec<Location> = Vec::new();
    for (name, location) in orders.chain(hands).chain(places) {
        if locations.iter().any(|other| other.name == location.name) {
            let found = format!("the location \"{}\" a second time", location.name);
            return Err(wrong(SpecFile::Layout, name.span(), found, "each name once"));
        }
        locations.push(location);
    }
    if locations.len() > MAX_LOCATIONS {
        let found = format!("{} locations", locations.len());
        return Err(wrong_file(SpecFile::Layout, found, format!("at most {MAX_LOCATIONS}")));
    }
    if layout.order.is_empty() || layout.order.len() > MAX_ORDERS {
        let found = format!("{} orders", layout.order.len());
        return Err(wrong_file(SpecFile::Layout, found, format!("1 to {MAX_ORDERS} tables [[order]]")));
    }
    Ok(locations)
}

/// The hands, the board and the plate.
fn roles(layout: &LayoutSpec, locations: &[Location]) -> Result<([LocationId; 2], LocationId, LocationId)> {
    let find = |kind| locations.iter().position(|location| location.kind == kind).map(|index| LocationId(index as u8));
    let hand = |agent: Agent| {
        let count = layout.hand.iter().filter(|hand| *hand.agent.get_ref() == agent).count();
        match (find(LocationKind::Hand(agent)), count) {
            (Some(hand), 1) => Ok(hand),
            _ => {
                let found = format!("{count} hands of the {}", agent.name());
                Err(wrong_file(SpecFile::Layout, found, "one [[hand]] for the human and one for the robot"))
            }
        }
    };
    let only = |which: &str, is: fn(&super::layout::PlaceSpec) -> bool| {
        let first_place = layout.order.len() + layout.hand.len();
        let mut found = layout.place.iter().enumerate().filter(|(_, place)| is(place));
        match (found.next(), found.next()) {
            (Some((index, _)), None) => Ok(LocationId((first_place + index) as u8)),
            (Some(_), Some((_, second))) => {
                let found = format!("a second place with {which} = true, \"{}\"", second.name.get_ref());
                Err(wrong(SpecFile::Layout, second.name.span(), found, "one such place"))
            }
            (None, _) => {
                let found = format!("no place with {which} = true");
                Err(wrong_file(SpecFile::Layout, found, format!("{which} = true at one [[place]]")))
            }
        }
    };
    let hands = [hand(Agent::Human)?, hand(Agent::Robot)?];
    Ok((hands, only("stacks", |place| place.stacks)?, only("serves", |place| place.serves)?))
}

fn processes(spec: &RecipesSpec, items: &Items, locations: &[Location]) -> Result<Vec<Process>> {
    let one = |process: &recipe::ProcessSpec| {
        let place = match process.at.get_ref().as_str() {
            "hand" => None,
            name => match locations.iter().position(|l| l.name == name && l.kind == LocationKind::Place) {
                Some(index) => Some(LocationId(index as u8)),
                None => {
                    let found = format!("at = \"{name}\"");
                    return Err(wrong(
                        SpecFile::Recipes,
                        process.at.span(),
                        found,
                        "\"hand\" or a [[place]] of the layout",
                    ));
                }
            },
        };
        let steps = process.steps.iter().map(|step| Ok((items.find(&step.from)?, items.find(&step.to)?)));
        let agents = Agent::BOTH.map(|agent| process.agents.contains(&agent));
        Ok(Process { name: process.name.get_ref().clone(), place, agents, steps: steps.collect::<Result<_>>()? })
    };
    spec.process.iter().map(one).collect()
}

fn dishes(spec: &RecipesSpec, items: &Items, contents: &[Content]) -> Result<Vec<Dish>> {
    if spec.dish.is_empty() || spec.dish.len() > MAX_DISHES {
        let found = format!("{} dishes", spec.dish.len());
        return Err(wrong_file(SpecFile::Recipes, found, format!("1 to {MAX_DISHES} tables [[dish]]")));
    }
    let slots: Vec<Vec<ContentId>> = spec.slot.iter().map(|slot| items.find_all(&slot.items)).collect::<Result<_>>()?;
    let mut dishes: Vec<Dish> = Vec::new();
    for dish in &spec.dish {
        let parts = items.find_all(dish.items.get_ref())?;
        let by_slot: Option<Vec<ContentId>> =
            slots.iter().map(|slot| slot.iter().copied().find(|item| parts.contains(item))).collect();
        let Some(by_slot) = by_slot.filter(|by_slot| by_slot.len() == parts.len()) else {
            let found = format!("\"{}\" of {} items", dish.name.get_ref(), parts.len());
            return Err(wrong(SpecFile::Recipes, dish.items.span(), found, "one item of each [[slot]]"));
        };
        let deviation = spec.deviation.iter().find_map(|deviation| match items.find_all(&deviation.dishes_with) {
            Ok(with) => with.iter().any(|item| parts.contains(item)).then_some(Ok(deviation)),
            Err(error) => Some(Err(error)),
        });
        let sets = match deviation.transpose()? {
            Some(deviation) => variants(deviation, spec, items, &by_slot)?,
            None => vec![by_slot],
        };
        let find = |mut set: Vec<ContentId>| {
            set.sort_unstable();
            contents.iter().position(|content| content.items == set).map(|index| ContentId(index as u8))
        };
        let variants: Vec<ContentId> = sets.into_iter().filter_map(find).collect();
        if dishes.iter().any(|other| other.name == *dish.name.get_ref() || other.variants[0] == variants[0]) {
            let found = format!("the dish \"{}\" a second time", dish.name.get_ref());
            return Err(wrong(SpecFile::Recipes, dish.name.span(), found, "each name and each recipe once"));
        }
        dishes.push(Dish { name: dish.name.get_ref().clone(), variants });
    }
    Ok(dishes)
}

/// The recipes that a memory of `truth` (one item per slot) may take, the true one first.
fn variants(
    deviation: &DeviationSpec,
    spec: &RecipesSpec,
    items: &Items,
    truth: &[ContentId],
) -> Result<Vec<Vec<ContentId>>> {
    let mut sets = vec![truth.to_vec()];
    for vary in &deviation.slots {
        let Some(slot) = spec.slot.iter().position(|slot| slot.name.get_ref() == vary.slot.get_ref()) else {
            let found = format!("slot = \"{}\"", vary.slot.get_ref());
            return Err(wrong(SpecFile::Recipes, vary.slot.span(), found, "the name of a [[slot]]"));
        };
        let starts = match deviation.combine {
            Combine::OneAtATime => vec![truth.to_vec()],
            Combine::All => sets.clone(),
        };
        for start in starts {
            for item in items.find_all(&vary.items)? {
                let mut set = start.clone();
                set[slot] = item;
                if !sets.contains(&set) {
                    sets.push(set);
                }
            }
        }
    }
    Ok(sets)
}

fn tables(
    layout: &LayoutSpec,
    spec: &RecipesSpec,
    items: &Items,
    contents: &[Content],
    locations: &[Location],
    processes: &[Process],
) -> Result<Tables> {
    let width = contents.len();
    let mut accepts = vec![false; locations.len() * width];
    let first_place = locations.len() - layout.place.len();
    for (index, location) in locations.iter().enumerate() {
        let row = &mut accepts[index * width..][..width];
        match location.kind {
            LocationKind::Order => {}
            LocationKind::Hand(_) => row[1..].fill(true),
            LocationKind::Place => {
                for name in &layout.place[index - first_place].accepts {
                    accept(name, spec, items, contents, row)?;
                }
            }
        }
    }
    let by_items = |set: &[ContentId]| contents.iter().position(|content| content.items == set);
    let mut stacks = vec![ContentId::EMPTY; width * width];
    for below in 1..width {
        for above in 1..width {
            let mut set = [contents[below].items.as_slice(), contents[above].items.as_slice()].concat();
            set.sort_unstable();
            stacks[below * width + above] = ContentId(by_items(&set).unwrap_or(0) as u8);
        }
    }
    let mut becomes = vec![ContentId::EMPTY; processes.len() * width];
    for (index, process) in processes.iter().enumerate() {
        for (from, to) in &process.steps {
            becomes[index * width + from.index()] = *to;
        }
    }
    Ok(Tables { width, accepts, stacks, becomes })
}

/// Marks in `row` what a word of "accepts" lets in.
fn accept(
    name: &Spanned<String>,
    spec: &RecipesSpec,
    items: &Items,
    contents: &[Content],
    row: &mut [bool],
) -> Result<()> {
    let dishes = dish_names(spec, items)?;
    let group = spec.group.iter().find(|group| group.name.get_ref() == name.get_ref());
    let members = group.map(|group| items.find_all(&group.made_of)).transpose()?;
    for (content, accepted) in contents.iter().zip(row).skip(1) {
        *accepted |= match (name.get_ref().as_str(), &members) {
            ("anything", _) => true,
            ("ingredients", _) => !content.is_stack(),
            ("dishes", _) => dishes.iter().any(|(stack, _)| *stack == content.items),
            (_, Some(members)) => content.items.iter().all(|item| members.contains(item)),
            (other, None) => {
                let found = format!("accepts \"{other}\"");
                let remedy = "\"anything\", \"ingredients\", \"dishes\" or a [[group]] of the recipe file";
                return Err(wrong(SpecFile::Layout, name.span(), found, remedy));
            }
        };
    }
    Ok(())
}

fn storages(layout: &LayoutSpec, spec: &RecipesSpec, items: &Items) -> Result<Vec<Storage>> {
    let one = |storage: &super::layout::StorageSpec| {
        Ok(Storage {
            agent: storage.agent,
            item: stored(&storage.ingredient, spec, items)?,
            label: storage.ingredient.get_ref().clone(),
            display: *storage.display.get_ref(),
        })
    };
    layout.storage.iter().map(one).collect()
}

/// The item that a storage of this ingredient gives.
fn stored(name: &Spanned<String>, spec: &RecipesSpec, items: &Items) -> Result<ContentId> {
    let ingredient = spec.ingredient.iter().position(|ingredient| ingredient.name.get_ref() == name.get_ref());
    let item = ingredient.and_then(|ingredient| items.ingredient.iter().position(|&of| of == ingredient));
    item.map(|item| ContentId(item as u8 + 1)).ok_or_else(|| {
        let names: Vec<&str> = spec.ingredient.iter().map(|ingredient| ingredient.name.get_ref().as_str()).collect();
        let found = format!("ingredient = \"{}\"", name.get_ref());
        wrong(SpecFile::Layout, name.span(), found, format!("one of {}", names.join(", ")))
    })
}

/// The buttons of both agents: own storage, places, processes, own trash, orders.
fn buttons(
    layout: &LayoutSpec,
    spec: &RecipesSpec,
    items: &Items,
    locations: &[Location],
    processes: &[Process],
) -> Result<[Vec<Button>; 2]> {
    let located = |name: &Spanned<String>| {
        let index = locations.iter().position(|location| location.name == *name.get_ref());
        LocationId(index.unwrap_or_default() as u8)
    };
    let mut buttons = [Vec::new(), Vec::new()];
    for agent in Agent::BOTH {
        let mut list: Vec<(String, Action, &ButtonSpec)> = Vec::new();
        for storage in layout.storage.iter().filter(|storage| storage.agent == agent) {
            let item = stored(&storage.ingredient, spec, items)?;
            list.push((format!("take {}", storage.ingredient.get_ref()), Action::Take(item), &storage.button));
        }
        for place in &layout.place {
            list.push((place.name.get_ref().clone(), Action::Use(located(&place.name)), &place.button));
        }
        for (index, process) in processes.iter().enumerate().filter(|(_, process)| process.agents[agent.index()]) {
            let button = layout.process.iter().find(|button| *button.name.get_ref() == process.name);
            let Some(button) = button else {
                let found = format!("no button for the process \"{}\" of the recipe file", process.name);
                return Err(wrong_file(SpecFile::Layout, found, "a table [[process]] with this name and a button"));
            };
            list.push((process.name.clone(), Action::Process(index as u8), &button.button));
        }
        for hand in layout.hand.iter().filter(|hand| *hand.agent.get_ref() == agent) {
            list.push(("trash".to_string(), Action::Trash, &hand.trash));
        }
        for (index, order) in layout.order.iter().enumerate() {
            list.push((format!("serve {}", index + 1), Action::Serve(located(&order.name)), &order.serve));
        }
        for (name, action, spec) in list {
            buttons[agent.index()].push(button(agent, name, action, spec, &buttons[agent.index()])?);
        }
    }
    for process in &layout.process {
        if !processes.iter().any(|known| known.name == *process.name.get_ref()) {
            let found = format!("a button for the process \"{}\"", process.name.get_ref());
            return Err(wrong(SpecFile::Layout, process.name.span(), found, "a [[process]] of the recipe file"));
        }
    }
    Ok(buttons)
}

fn button(agent: Agent, name: String, action: Action, spec: &ButtonSpec, others: &[Button]) -> Result<Button> {
    let at_m = *spec.at_m.get_ref();
    if !at_m.iter().all(|metres| metres.is_finite()) {
        return Err(wrong(SpecFile::Layout, spec.at_m.span(), "a button at no place", "at_m = [x, y] in metres"));
    }
    let key = match (agent, &spec.key) {
        (Agent::Robot, _) => None,
        (Agent::Human, None) => {
            let found = format!("no key for the human's button \"{name}\"");
            return Err(wrong(SpecFile::Layout, spec.at_m.span(), found, "button = { at_m = [x, y], key = \"k\" }"));
        }
        (Agent::Human, Some(key)) => {
            if key.get_ref().is_whitespace() || others.iter().any(|other| other.key == Some(*key.get_ref())) {
                let found = format!("the key \"{}\" for \"{name}\"", key.get_ref());
                return Err(wrong(SpecFile::Layout, key.span(), found, "a key of its own that is not the space bar"));
            }
            Some(*key.get_ref())
        }
    };
    Ok(Button { name, action, at_m, key })
}

fn aspects(contents: &[Content], locations: &[Location], dishes: &[Dish], tables: &Tables) -> Vec<Aspect> {
    let order_values = || {
        let dishes = (0..dishes.len()).map(|index| OrderContent::Dish(DishId(index as u8)).code());
        [OrderContent::None.code(), OrderContent::Served.code()].into_iter().chain(dishes).collect()
    };
    let label = |kind: LocationKind, code: u8| match (kind, OrderContent::from_code(code)) {
        (LocationKind::Order, OrderContent::None) => "none".to_string(),
        (LocationKind::Order, OrderContent::Served) => "served".to_string(),
        (LocationKind::Order, OrderContent::Dish(dish)) => dishes[dish.index()].name.clone(),
        _ => contents[usize::from(code)].name.clone(),
    };
    let of_location = |(index, location): (usize, &Location)| {
        let accepted = |content: &usize| *content == 0 || tables.accepts[index * tables.width + content];
        let values: Vec<u8> = match location.kind {
            LocationKind::Order => order_values(),
            _ => (0..contents.len()).filter(accepted).map(|content| content as u8).collect(),
        };
        let labels = values.iter().map(|&code| label(location.kind, code)).collect();
        Aspect { name: location.name.clone(), kind: AspectKind::Location(LocationId(index as u8)), values, labels }
    };
    let of_dish = |(index, dish): (usize, &Dish)| Aspect {
        name: format!("recipe of {}", dish.name),
        kind: AspectKind::Recipe(DishId(index as u8)),
        values: dish.variants.iter().map(|variant| variant.0).collect(),
        labels: dish.variants.iter().map(|variant| contents[variant.index()].name.clone()).collect(),
    };
    locations.iter().enumerate().map(of_location).chain(dishes.iter().enumerate().map(of_dish)).collect()
}

/// Areas must lie on the display and be far enough apart for an eye tracker.
fn check_gaps(layout: &LayoutSpec, locations: &[Location], display_m: [f64; 2]) -> Result<()> {
    let spans = layout.order.iter().map(|order| order.display.span());
    let spans = spans.chain(layout.hand.iter().map(|hand| hand.display.span()));
    let spans: Vec<_> = spans.chain(layout.place.iter().map(|place| place.display.span())).collect();
    for (index, location) in locations.iter().enumerate() {
        let area = location.display;
        let inside = area.x >= 0.0 && area.y >= 0.0 && area.x + area.w <= 1.0 && area.y + area.h <= 1.0;
        if !(inside && area.w > 0.0 && area.h > 0.0) {
            let found = format!("\"{}\" reaches beyond the display", location.name);
            return Err(wrong(
                SpecFile::Layout,
                spans[index].clone(),
                found,
                "x, y, w and h as fractions within 0 to 1",
            ));
        }
        for other in &locations[..index] {
            let gap = area.gap_m(other.display, display_m);
            if gap < MIN_GAP_M - 1e-9 {
                let found = format!("\"{}\" only {gap:.3} m from \"{}\"", location.name, other.name);
                let remedy = format!("at least {MIN_GAP_M} m between locations, so that gaze can tell them apart");
                return Err(wrong(SpecFile::Layout, spans[index].clone(), found, remedy));
            }
        }
    }
    Ok(())
}

/// Every signal key is there once.
fn check_signal_keys(layout: &LayoutSpec) -> Result<()> {
    let orders = layout.order.iter().map(|order| &order.signal);
    let hands = layout.hand.iter().map(|hand| &hand.signal);
    let keys = orders.chain(hands).chain(layout.place.iter().map(|place| &place.signal)).flatten();
    let mut seen: Vec<char> = Vec::new();
    for key in keys {
        if key.get_ref().is_whitespace() || seen.contains(key.get_ref()) {
            let found = format!("signal = \"{}\"", key.get_ref());
            return Err(wrong(SpecFile::Layout, key.span(), found, "a key of its own that is not the space bar"));
        }
        seen.push(*key.get_ref());
    }
    Ok(())
}
