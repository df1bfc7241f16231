//! Compiles a [`Kitchen`] from a layout file and a recipe file: contents, dishes and their variants, places, buttons,
//! transition tables, state aspects.

mod contents;
mod places;

use std::ops::Range;

use toml::Spanned;

use self::contents::IngredientItems;
use super::compiled::{Kitchen, TransitionTables};
use super::cost_to_go::{MAX_BUTTONS, MAX_STATES};
use super::files;
use super::files::{LayoutSpec, RecipesSpec};
use super::parts::{
    Appearance, AspectKind, Button, Content, ContentId, Dish, DishId, Location, LocationId, LocationKind,
    ProcessingStep, StateAspect,
};
use super::state::OrderContent;

/// Largest number of places where items are processed (stations).
const MAX_STATIONS: usize = 8;

impl Kitchen {
    /// Compiles a kitchen from the texts of a layout file and of the recipe file that belongs to it.
    ///
    /// # Errors
    /// A text is not TOML, or does not describe a valid kitchen.
    pub fn from_toml(layout: &str, recipes: &str) -> Result<Kitchen> {
        let unreadable = |file: KitchenFileKind| {
            move |error: toml::de::Error| KitchenFileError {
                span: error.span(),
                ..wrong_file(file, error.message(), "a file like those in layouts and recipes")
            }
        };
        let spec: LayoutSpec = toml::from_str(layout).map_err(unreadable(KitchenFileKind::Layout))?;
        files::check_layout(layout).map_err(|error| KitchenFileError {
            span: error.place,
            ..wrong_file(KitchenFileKind::Layout, error.found, error.remedy)
        })?;
        let recipes: RecipesSpec = toml::from_str(recipes).map_err(unreadable(KitchenFileKind::Recipes))?;
        Kitchen::compile(&spec, &recipes)
    }

    /// Compiles a kitchen from parsed files, of which [`files::check_layout`] has checked the numbers. Errors name the
    /// file and the position, what was found, and what would be right there.
    pub fn compile(layout: &LayoutSpec, recipes: &RecipesSpec) -> Result<Kitchen> {
        let items = IngredientItems::read(recipes)?;
        let mut contents = contents::contents(recipes, &items)?;
        let words = contents::content_words(recipes, &items)?;
        contents::word(&mut contents, &words);
        let locations = places::locations(layout)?;
        let (hands, board, plate) = places::roles(layout, &locations)?;
        let processes = contents::processes(recipes, &items, &locations)?;
        let dishes = contents::dishes(recipes, &items, &contents)?;
        let tables = tables(layout, recipes, &items, &contents, &locations, &processes)?;
        let orders: Vec<LocationId> = (0..layout.order.len()).map(|index| LocationId(index as u8)).collect();
        let buttons = places::buttons(layout, recipes, &items, &locations, &processes)?;
        let aspects = aspects(&contents, &locations, &dishes, &tables);
        let display_m = [layout.display.width_m, layout.display.height_m];
        places::check_gaps(layout, &locations, display_m)?;
        places::check_signal_keys(layout)?;
        check_size(&locations, &tables, &buttons, &processes)?;
        contents::check_obtainable(recipes, layout, &items, &processes)?;
        Ok(Kitchen {
            name: layout.name.clone(),
            title: layout.title.clone(),
            display_m,
            table_height_m: layout.table.height_m,
            served_shown_s: layout.table.served_shown_s,
            new_order_after_s: layout.table.new_order_after_s,
            storages: places::storages(layout, recipes, &items)?,
            contents,
            words,
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

/// Checks that the kitchen is not too large for the keys and cache lines of the cost to go, which have a fixed size.
fn check_size(
    locations: &[Location],
    tables: &TransitionTables,
    buttons: &[Vec<Button>; 2],
    processes: &[ProcessingStep],
) -> Result<()> {
    let too_large = |found: String, most: String| Err(wrong_file(KitchenFileKind::Layout, found, most));
    let accepted = tables.accepts.chunks(tables.width).zip(locations);
    let physical = accepted.filter(|(_, location)| location.kind != LocationKind::Order);
    let contents = physical.map(|(row, _)| 1 + row.iter().filter(|accepted| **accepted).count() as u128);
    let states = contents.fold(1u128, u128::saturating_mul);
    if states > MAX_STATES {
        return too_large(
            format!("{states} ways to fill the locations"),
            format!("at most {MAX_STATES}: fewer locations, or places that accept less"),
        );
    }
    if let Some(list) = buttons.iter().find(|list| list.len() > MAX_BUTTONS) {
        return too_large(format!("{} buttons of one agent", list.len()), format!("at most {MAX_BUTTONS}"));
    }
    let mut stations: Vec<LocationId> = processes.iter().filter_map(|process| process.place).collect();
    stations.sort_unstable();
    stations.dedup();
    if stations.len() > MAX_STATIONS {
        return too_large(format!("{} places of a process", stations.len()), format!("at most {MAX_STATIONS}"));
    }
    Ok(())
}

fn tables(
    layout: &LayoutSpec,
    spec: &RecipesSpec,
    items: &IngredientItems,
    contents: &[Content],
    locations: &[Location],
    processes: &[ProcessingStep],
) -> Result<TransitionTables> {
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
    Ok(TransitionTables { width, accepts, stacks, becomes })
}

/// Marks in `row` the contents that one word of a place's list `accepts` allows at the place.
fn accept(
    name: &Spanned<String>,
    spec: &RecipesSpec,
    items: &IngredientItems,
    contents: &[Content],
    row: &mut [bool],
) -> Result<()> {
    let dishes = contents::dish_names(spec, items)?;
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
                return Err(in_layout(name.span(), found, remedy));
            }
        };
    }
    Ok(())
}

fn aspects(
    contents: &[Content],
    locations: &[Location],
    dishes: &[Dish],
    tables: &TransitionTables,
) -> Vec<StateAspect> {
    let order_values = || {
        let dishes = (0..dishes.len()).map(|index| OrderContent::Dish(DishId(index as u8)).code());
        [OrderContent::None.code(), OrderContent::Served.code()].into_iter().chain(dishes).collect()
    };
    // The name and the wording of one possible value of a state aspect.
    let said = |kind: LocationKind, code: u8| match (kind, OrderContent::from_code(code)) {
        (LocationKind::Order, OrderContent::None) => ["none", "none"],
        (LocationKind::Order, OrderContent::Served) => ["served", "served"],
        (LocationKind::Order, OrderContent::Dish(dish)) => {
            let dish = &dishes[dish.index()];
            [dish.name.as_str(), contents[dish.stack().index()].wording.as_str()]
        }
        _ => [contents[usize::from(code)].name.as_str(), contents[usize::from(code)].wording.as_str()],
    };
    let of_location = |(index, location): (usize, &Location)| {
        let accepted = |content: &usize| *content == 0 || tables.accepts[index * tables.width + content];
        let values: Vec<u8> = match location.kind {
            LocationKind::Order => order_values(),
            _ => (0..contents.len()).filter(accepted).map(|content| content as u8).collect(),
        };
        let labels = values.iter().map(|&code| said(location.kind, code)[0].to_string()).collect();
        let wordings = values.iter().map(|&code| said(location.kind, code)[1].to_string()).collect();
        let kind = AspectKind::Location(LocationId(index as u8));
        StateAspect { name: location.name.clone(), kind, values, labels, wordings }
    };
    let of_dish = |(index, dish): (usize, &Dish)| StateAspect {
        name: format!("recipe of {}", dish.name),
        kind: AspectKind::Recipe(DishId(index as u8)),
        values: dish.variants.iter().map(|variant| variant.0).collect(),
        labels: dish.variants.iter().map(|variant| contents[variant.index()].name.clone()).collect(),
        wordings: dish.variants.iter().map(|variant| contents[variant.index()].wording.clone()).collect(),
    };
    locations.iter().enumerate().map(of_location).chain(dishes.iter().enumerate().map(of_dish)).collect()
}

/// The file of a kitchen that contains an error: layout or recipes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KitchenFileKind {
    /// The layout file of a kitchen.
    Layout,
    /// The recipe file of a kitchen.
    Recipes,
}

/// Error: a layout or recipe file contains something invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{found}")]
pub struct KitchenFileError {
    /// The file that contains the error.
    pub file: KitchenFileKind,
    /// Position of the error in the file's text, in bytes; `None` for the file as a whole.
    pub span: Option<Range<usize>>,
    /// What the file contains at the position of the error.
    pub found: String,
    /// What the file would have to contain there instead.
    pub remedy: String,
}

pub(super) type Result<T> = std::result::Result<T, KitchenFileError>;

pub(super) fn in_layout(span: Range<usize>, found: impl Into<String>, remedy: impl Into<String>) -> KitchenFileError {
    KitchenFileError { span: Some(span), ..wrong_file(KitchenFileKind::Layout, found, remedy) }
}

pub(super) fn in_recipes(span: Range<usize>, found: impl Into<String>, remedy: impl Into<String>) -> KitchenFileError {
    KitchenFileError { span: Some(span), ..wrong_file(KitchenFileKind::Recipes, found, remedy) }
}

pub(super) fn wrong_file(
    file: KitchenFileKind,
    found: impl Into<String>,
    remedy: impl Into<String>,
) -> KitchenFileError {
    KitchenFileError { file, span: None, found: found.into(), remedy: remedy.into() }
}

/// Reads the appearance of an item, a dish or a place: a shape and its colours.
pub(super) fn look(file: KitchenFileKind, text: &Spanned<String>) -> Result<Appearance> {
    Appearance::read(text.get_ref()).map_err(|remedy| KitchenFileError {
        span: Some(text.span()),
        ..wrong_file(file, format!("look = \"{}\"", text.get_ref()), remedy)
    })
}
