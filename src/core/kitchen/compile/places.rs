//! Builds locations and storages from the layout file, and checks that an eye tracker can tell locations apart on the
//! display.

use toml::Spanned;

use super::contents::IngredientItems;
use super::spec_error::{KitchenFileKind, Result, look, wrong, wrong_file};
use crate::kitchen::agent::Agent;
use crate::kitchen::content::ContentId;
use crate::kitchen::layout::{LayoutSpec, PlaceSpec, StorageSpec, is_same_key};
use crate::kitchen::location::{DisplayArea, IngredientStorage, Location, LocationId, LocationKind};
use crate::kitchen::recipe::RecipesSpec;
use crate::kitchen::state::MAX_LOCATIONS;

/// Largest number of simultaneous orders; the cost to go is computed for one and for two orders.
pub const MAX_ORDERS: usize = 2;
/// Least distance between locations on the display, in metres, so that gaze can tell them apart.
pub const MIN_GAP_M: f64 = 0.15;

pub(super) fn locations(layout: &LayoutSpec) -> Result<Vec<Location>> {
    let location =
        |name: &Spanned<String>, kind, display: &Spanned<DisplayArea>, signal: &Option<Spanned<char>>| Location {
            name: name.get_ref().clone(),
            kind,
            display: *display.get_ref(),
            signal_key: signal.as_ref().map(|key| *key.get_ref()),
            look: None,
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
            return Err(wrong(KitchenFileKind::Layout, name.span(), found, "each name once"));
        }
        locations.push(location);
    }
    if locations.len() > MAX_LOCATIONS {
        let found = format!("{} locations", locations.len());
        return Err(wrong_file(KitchenFileKind::Layout, found, format!("at most {MAX_LOCATIONS}")));
    }
    if layout.order.is_empty() || layout.order.len() > MAX_ORDERS {
        let found = format!("{} orders", layout.order.len());
        return Err(wrong_file(KitchenFileKind::Layout, found, format!("1 to {MAX_ORDERS} tables [[order]]")));
    }
    let first_place = layout.order.len() + layout.hand.len();
    for (location, place) in locations.iter_mut().skip(first_place).zip(&layout.place) {
        location.look = place.look.as_ref().map(|text| look(KitchenFileKind::Layout, text)).transpose()?;
    }
    Ok(locations)
}

/// The locations with a special role: both hands, the board where items are stacked, and the plate from which orders
/// are served.
pub(super) fn roles(layout: &LayoutSpec, locations: &[Location]) -> Result<([LocationId; 2], LocationId, LocationId)> {
    let find = |kind| locations.iter().position(|location| location.kind == kind).map(|index| LocationId(index as u8));
    let hand = |agent: Agent| {
        let count = layout.hand.iter().filter(|hand| *hand.agent.get_ref() == agent).count();
        match (find(LocationKind::Hand(agent)), count) {
            (Some(hand), 1) => Ok(hand),
            _ => {
                let found = format!("{count} hands of the {}", agent.name());
                Err(wrong_file(KitchenFileKind::Layout, found, "one [[hand]] for the human and one for the robot"))
            }
        }
    };
    let only = |which: &str, is: fn(&PlaceSpec) -> bool| {
        let first_place = layout.order.len() + layout.hand.len();
        let mut found = layout.place.iter().enumerate().filter(|(_, place)| is(place));
        match (found.next(), found.next()) {
            (Some((index, _)), None) => Ok(LocationId((first_place + index) as u8)),
            (Some(_), Some((_, second))) => {
                let found = format!("a second place with {which} = true, \"{}\"", second.name.get_ref());
                Err(wrong(KitchenFileKind::Layout, second.name.span(), found, "one such place"))
            }
            (None, _) => {
                let found = format!("no place with {which} = true");
                Err(wrong_file(KitchenFileKind::Layout, found, format!("{which} = true at one [[place]]")))
            }
        }
    };
    let hands = [hand(Agent::Human)?, hand(Agent::Robot)?];
    Ok((hands, only("stacks", |place| place.stacks)?, only("serves", |place| place.serves)?))
}

/// Checks that the areas of all locations lie on the display and are far enough apart for an eye tracker.
pub(super) fn check_gaps(layout: &LayoutSpec, locations: &[Location], display_m: [f64; 2]) -> Result<()> {
    let spans = layout.order.iter().map(|order| order.display.span());
    let spans = spans.chain(layout.hand.iter().map(|hand| hand.display.span()));
    let spans: Vec<_> = spans.chain(layout.place.iter().map(|place| place.display.span())).collect();
    for (index, location) in locations.iter().enumerate() {
        let area = location.display;
        let inside = area.x >= 0.0 && area.y >= 0.0 && area.x + area.w <= 1.0 && area.y + area.h <= 1.0;
        if !(inside && area.w > 0.0 && area.h > 0.0) {
            let found = format!("\"{}\" reaches beyond the display", location.name);
            return Err(wrong(
                KitchenFileKind::Layout,
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
                return Err(wrong(KitchenFileKind::Layout, spans[index].clone(), found, remedy));
            }
        }
    }
    Ok(())
}

/// Checks that no key sends the signals about two locations, and that no signal's key is the space bar.
pub(super) fn check_signal_keys(layout: &LayoutSpec) -> Result<()> {
    let mut seen: Vec<(&str, char)> = Vec::new();
    for (name, key) in layout.signal_keys() {
        let twin = seen.iter().find(|(_, other)| is_same_key(*other, *key.get_ref()));
        if key.get_ref().is_whitespace() || twin.is_some() {
            let whose = twin.map_or(String::new(), |(other, _)| format!(", which \"{other}\" has already"));
            let found = format!("signal = \"{}\" for \"{name}\"{whose}", key.get_ref());
            return Err(wrong(
                KitchenFileKind::Layout,
                key.span(),
                found,
                "a key of its own that is not the space bar",
            ));
        }
        seen.push((name, *key.get_ref()));
    }
    Ok(())
}

pub(super) fn storages(
    layout: &LayoutSpec,
    spec: &RecipesSpec,
    items: &IngredientItems,
) -> Result<Vec<IngredientStorage>> {
    let one = |storage: &StorageSpec| {
        let DisplayArea { x, y, w, h } = *storage.display.get_ref();
        if ![x, y, w, h].iter().all(|fraction| fraction.is_finite()) {
            let found = format!("a storage of \"{}\" at no place", storage.ingredient.get_ref());
            return Err(wrong(
                KitchenFileKind::Layout,
                storage.display.span(),
                found,
                "x, y, w and h as fractions within 0 to 1",
            ));
        }
        Ok(IngredientStorage {
            agent: storage.agent,
            item: stored(&storage.ingredient, spec, items)?,
            label: storage.ingredient.get_ref().clone(),
            display: *storage.display.get_ref(),
        })
    };
    layout.storage.iter().map(one).collect()
}

/// The item that a storage of this ingredient supplies.
pub(super) fn stored(name: &Spanned<String>, spec: &RecipesSpec, items: &IngredientItems) -> Result<ContentId> {
    let ingredient = spec.ingredient.iter().position(|ingredient| ingredient.name.get_ref() == name.get_ref());
    let item = ingredient.and_then(|ingredient| items.ingredient.iter().position(|&of| of == ingredient));
    item.map(|item| ContentId(item as u8 + 1)).ok_or_else(|| {
        let names: Vec<&str> = spec.ingredient.iter().map(|ingredient| ingredient.name.get_ref().as_str()).collect();
        let found = format!("ingredient = \"{}\"", name.get_ref());
        wrong(KitchenFileKind::Layout, name.span(), found, format!("one of {}", names.join(", ")))
    })
}
