//! Elements of the kitchen map (locations and storages), and how they share its columns and rows.

use tomcom_core::kitchen::{Agent, DisplayArea, Kitchen, LocationId, LocationKind};

/// An element of the kitchen map: a location or an ingredient storage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KitchenMapElement {
    /// Location of the kitchen, such as a hand, a board or an order.
    Location(LocationId),
    /// Ingredient storage, as an index into [`Kitchen::storages`].
    Storage(usize),
}

/// An element of the kitchen with what its place on the map follows from.
pub(super) struct Item {
    pub thing: KitchenMapElement,
    pub area: DisplayArea,
    pub owner: Option<Agent>,
    pub min_columns: u16,
}

/// Least width of a location's box, in columns.
pub(super) const MIN_CARD: u16 = 12;

/// The elements of a kitchen for its map; `with_keys` reserves room for the keys of the human's storage, `own_hand` are
/// the columns beside the name of the participant's hand.
pub(super) fn items(kitchen: &Kitchen, with_keys: bool, own_hand: u16) -> Vec<Item> {
    let location = |(index, location): (usize, &tomcom_core::kitchen::Location)| {
        let owner = if let LocationKind::Hand(agent) = location.kind { Some(agent) } else { None };
        let thing = KitchenMapElement::Location(LocationId(index as u8));
        // Columns beside a location's name for rule, key and gap (the participant's hand seldom has a key); orders
        // stand in a strip of their own.
        let beside = match location.kind {
            LocationKind::Hand(Agent::Human) => own_hand + u16::from(with_keys),
            // Without the gap, there is room for the keys of the storage.
            _ if with_keys => 4,
            _ => 5,
        };
        let min_columns = (location.label().chars().count() as u16 + beside).max(MIN_CARD);
        Item { thing, area: location.display, owner, min_columns }
    };
    let storage = |(index, storage): (usize, &tomcom_core::kitchen::IngredientStorage)| Item {
        thing: KitchenMapElement::Storage(index),
        area: storage.display,
        owner: Some(storage.agent),
        // Columns for a space before the storage's name and for its key; the robot's storage keeps a gap to its right
        // neighbour where there is room.
        min_columns: storage.label.chars().count() as u16
            + match storage.agent {
                Agent::Human if with_keys => 4,
                Agent::Human => 1,
                Agent::Robot if with_keys => 1,
                Agent::Robot => 2,
            },
    };
    let locations = kitchen.locations.iter().enumerate().map(location);
    locations.chain(kitchen.storages.iter().enumerate().map(storage)).collect()
}

/// Whether an element of the map is an order.
pub(super) fn is_order(kitchen: &Kitchen, thing: KitchenMapElement) -> bool {
    matches!(thing, KitchenMapElement::Location(id) if kitchen.location(id).kind == LocationKind::Order)
}

/// Lower and upper bound of an area of the wall display along an axis (0 is x, 1 is y).
pub(super) fn extent(area: DisplayArea, axis: usize) -> [f64; 2] {
    if axis == 0 { [area.x, area.x + area.w] } else { [area.y, area.y + area.h] }
}

/// Groups of kitchen elements whose extents along an axis overlap, in the order of the axis.
pub(super) fn clusters<'a>(items: &[&'a Item], axis: usize) -> Vec<Vec<&'a Item>> {
    let mut sorted = items.to_vec();
    sorted.sort_by(|a, b| extent(a.area, axis)[0].total_cmp(&extent(b.area, axis)[0]));
    let mut groups: Vec<Vec<&Item>> = Vec::new();
    let mut end = f64::NEG_INFINITY;
    for item in sorted {
        let [low, high] = extent(item.area, axis);
        match groups.last_mut() {
            Some(group) if low < end => group.push(item),
            _ => groups.push(vec![item]),
        }
        end = end.max(high);
    }
    groups
}

/// Puts every kitchen element into a row of its own, from top to bottom.
pub(super) fn clusters_forced<'a>(items: &[&'a Item]) -> Vec<Vec<&'a Item>> {
    let mut sorted = items.to_vec();
    sorted.sort_by(|a, b| (a.area.y + a.area.h / 2.0).total_cmp(&(b.area.y + b.area.h / 2.0)));
    sorted.into_iter().map(|item| vec![item]).collect()
}

/// Bounds of a group of kitchen elements along an axis: the middles of the gaps to the neighbouring groups.
pub(super) fn ends(groups: &[Vec<&Item>], index: usize, axis: usize, whole: [f64; 2]) -> [f64; 2] {
    let low = |group: &[&Item]| group.iter().map(|item| extent(item.area, axis)[0]).fold(f64::INFINITY, f64::min);
    let high = |group: &[&Item]| group.iter().map(|item| extent(item.area, axis)[1]).fold(f64::NEG_INFINITY, f64::max);
    let from = if index == 0 { whole[0] } else { (high(&groups[index - 1]) + low(&groups[index])) / 2.0 };
    let to = match groups.get(index + 1) {
        Some(next) => (high(&groups[index]) + low(next)) / 2.0,
        None => whole[1],
    };
    [from, to.max(from)]
}

/// Widths of the kitchen map's columns: first what their names need, then equal shares of the rest for columns with
/// locations.
pub(super) fn widths(columns: &[Vec<&Item>], total: u16) -> Vec<u16> {
    let need: Vec<u16> = columns.iter().map(|c| c.iter().map(|item| item.min_columns).max().unwrap_or(0)).collect();
    let grows = |column: &[&Item]| column.iter().any(|item| matches!(item.thing, KitchenMapElement::Location(_)));
    let growing = columns.iter().filter(|c| grows(c)).count().max(1) as u16;
    let sum: u16 = need.iter().sum();
    let spare = total.saturating_sub(sum);
    let mut widths: Vec<u16> = Vec::new();
    let mut grown = 0;
    for (column, need) in columns.iter().zip(&need) {
        let mut width = *need;
        if grows(column) {
            width += spare / growing + u16::from(grown < spare % growing);
            grown += 1;
        }
        widths.push(width);
    }
    // Missing columns of the terminal are taken from the widest columns of the kitchen map.
    for _ in total..sum {
        if let Some(widest) = widths.iter_mut().max() {
            *widest -= 1;
        }
    }
    widths
}

/// The agent that alone reaches all elements of a column; `None` if both agents reach some.
pub(super) fn owner(column: &[&Item]) -> Option<Agent> {
    let first = column.first()?.owner;
    if column.iter().all(|item| item.owner == first) { first } else { None }
}
