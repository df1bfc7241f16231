//! Kitchen map of the console: the panel of the kitchen, arranged like the areas on the participant's wall display.
//!
//! The wall display is divided along lines that cross no area: the strip of the orders, then columns, then rows. The
//! cells of the console's kitchen panel are divided in the same way, so that the boxes of every kitchen are readable.
//! Every terminal cell maps to a point of the wall display and back, so that the gaze mark can be placed and the mouse
//! pointer can serve as gaze.

use ratatui::layout::Rect;

use super::view::regions::top;
use tomcom_core::kitchen::{Agent, DisplayArea, Kitchen, LocationId, LocationKind};
use tomcom_session::Session;
use tomcom_session::settings::ParticipantKind;

/// An element of the kitchen map with its box on the screen.
#[derive(Clone, Debug)]
pub struct KitchenMapBox {
    pub thing: KitchenMapElement,
    pub cells: Rect,
    area: DisplayArea,
    /// Regions of the wall display and of the screen that belong to the element; the regions of all elements together
    /// cover everything.
    display: Bounds,
    screen: Bounds,
}

/// Columns of the kitchen map that one agent reaches, or that both agents reach.
#[derive(Clone, Debug, PartialEq)]
pub struct AgentZone {
    /// Agent that reaches these columns of the kitchen map; `None` if both agents do.
    pub owner: Option<Agent>,
    pub cells: Rect,
}

/// Kitchen map of the console: the boxes of all locations and storages, and the zones of the agents.
#[derive(Clone, Debug)]
pub struct KitchenMap {
    pub spots: Vec<KitchenMapBox>,
    pub zones: Vec<AgentZone>,
}

/// A rectangle as lower and upper bound along each axis (0 is x, 1 is y).
#[derive(Clone, Copy, Debug)]
struct Bounds([[f64; 2]; 2]);

/// Areas of the screen that together correspond to the wall display: the lines of the orders, and the map of the places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KitchenMapAreas {
    pub orders: Rect,
    pub places: Rect,
}

/// Height of the map of the places: at least, and where there is room for a gap below each place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KitchenMapRows {
    pub least: u16,
    pub most: u16,
}

/// Lines of a place: its name, its content, and news or a false belief.
const PLACE_LINES: u16 = 3;
/// Columns beside the name of the participant's hand: for rule and gap, and for a key with its space where the hand has
/// a key.
const OWN_HAND: u16 = 2;
const KEYED_OWN_HAND: u16 = 4;

impl KitchenMap {
    /// Computes the kitchen map of a kitchen in these areas; `with_keys` reserves room for the keys of the human's
    /// storage.
    pub fn new(kitchen: &Kitchen, areas: KitchenMapAreas, with_keys: bool) -> KitchenMap {
        KitchenMap::with_room(kitchen, areas, with_keys, OWN_HAND)
    }

    /// The kitchen map of a session in these areas; `is_coded` says that a rater codes the errors of the session.
    pub fn for_session(session: &Session, is_coded: bool, areas: KitchenMapAreas) -> KitchenMap {
        match is_coded {
            // For a rater, the participant's hand has a key, too.
            true => KitchenMap::with_room(&session.kitchen, areas, false, KEYED_OWN_HAND),
            false => {
                let with_keys = session.spec.participant.kind == ParticipantKind::Keyboard;
                KitchenMap::new(&session.kitchen, areas, with_keys)
            }
        }
    }

    /// Heights of a kitchen's map of places that leave no void: the line of the zones, then three lines for each place.
    pub fn rows(kitchen: &Kitchen) -> KitchenMapRows {
        let items = items(kitchen, false, OWN_HAND);
        let body: Vec<&Item> = items.iter().filter(|item| !is_order(kitchen, item.thing)).collect();
        let columns = clusters(&body, 0);
        let of = |column: &Vec<&Item>, is_store: bool| {
            column.iter().filter(|item| matches!(item.thing, KitchenMapElement::Storage(_)) == is_store).count() as u16
        };
        let tallest = |is_store| columns.iter().map(|column| of(column, is_store)).max().unwrap_or(0);
        let is_place = |item: &&Item| matches!(item.thing, KitchenMapElement::Location(_));
        let rows = clusters(&body.iter().copied().filter(is_place).collect::<Vec<_>>(), 1).len() as u16;
        let (places, stores) = (tallest(false).max(rows), tallest(true));
        KitchenMapRows {
            least: 1 + (PLACE_LINES * places).max(stores),
            most: 1 + ((PLACE_LINES + 1) * places).max(stores),
        }
    }

    fn with_room(kitchen: &Kitchen, areas: KitchenMapAreas, with_keys: bool, own_hand: u16) -> KitchenMap {
        let items = items(kitchen, with_keys, own_hand);
        let (strip, body): (Vec<&Item>, Vec<&Item>) = items.iter().partition(|item| is_order(kitchen, item.thing));
        let lowest = |items: &[&Item]| items.iter().map(|item| item.area.y + item.area.h).fold(0.0, f64::max);
        let highest = |items: &[&Item]| items.iter().map(|item| item.area.y).fold(1.0, f64::min);
        let cut = (lowest(&strip) + highest(&body)) / 2.0;
        // Where the wall display has the orders between or below the places, the regions overlap.
        let (strip_y, body_y) = match lowest(&strip) <= highest(&body) {
            true => ([0.0, cut], [cut, 1.0]),
            false => ([0.0, 1.0], [0.0, 1.0]),
        };
        let mut plan = KitchenMap::columns(&body, areas.places, body_y);
        plan.spots.extend(lines_of_orders(&strip, areas.orders, strip_y));
        plan.spots = cover(plan.spots);
        plan
    }

    /// Arranges kitchen elements in columns with common rows, below the line that names the agents' zones.
    fn columns(items: &[&Item], cells: Rect, display_y: [f64; 2]) -> KitchenMap {
        let (line, cells) = top(cells, 1);
        let columns = clusters(items, 0);
        let is_store = |column: &[&Item]| column.iter().all(|item| matches!(item.thing, KitchenMapElement::Storage(_)));
        let in_rows: Vec<&Item> = columns.iter().filter(|c| !is_store(c)).flatten().copied().collect();
        let rows = clusters(&in_rows, 1);
        let widths = widths(&columns, cells.width);
        let mut spots = Vec::new();
        let mut zones: Vec<AgentZone> = Vec::new();
        let mut x = cells.x;
        for (index, column) in columns.iter().enumerate() {
            let width = widths[index];
            let slot = Rect { x, width, ..cells };
            x += width;
            let display_x = ends(&columns, index, 0, [0.0, 1.0]);
            let shares_rows = column.iter().all(|item| matches!(item.thing, KitchenMapElement::Location(_)))
                && rows
                    .iter()
                    .all(|row| row.iter().filter(|item| column.iter().any(|c| c.thing == item.thing)).count() <= 1);
            let own = one_by_one(column, |area| area.y + area.h / 2.0);
            let lines = if shares_rows { &rows } else { &own };
            for (line, members) in lines.iter().enumerate() {
                let Some(item) = members.iter().find(|item| column.iter().any(|c| c.thing == item.thing)) else {
                    continue;
                };
                let region = share(slot, lines.len(), line);
                let display_y = ends(lines, line, 1, display_y);
                spots.push(spot(item, region, Bounds([display_x, display_y])));
            }
            let owner = owner(column);
            match zones.last_mut() {
                Some(zone) if zone.owner == owner => zone.cells.width += width,
                _ => zones.push(AgentZone { owner, cells: Rect { x: slot.x, width, ..line } }),
            }
        }
        KitchenMap { spots, zones }
    }

    /// The point of the wall display under the centre of a terminal cell, as fractions of width and height;
    /// extrapolated for cells outside the kitchen panel.
    pub fn display_point(&self, column: u16, row: u16) -> [f64; 2] {
        let cell = [f64::from(column) + 0.5, f64::from(row) + 0.5];
        match self.nearest(cell, |spot| spot.screen) {
            Some(spot) => [0, 1].map(|axis| along(cell[axis], &spot.knots(axis), |knot| (knot.1, knot.0))),
            None => [0.5, 0.5],
        }
    }

    /// The terminal cell at which a point of the wall display is drawn.
    pub fn cell(&self, point: [f64; 2]) -> Option<(u16, u16)> {
        let spot = self.nearest(point, |spot| spot.display)?;
        let [x, y] = [0, 1].map(|axis| along(point[axis], &spot.knots(axis), |knot| knot));
        (x >= 0.0 && y >= 0.0).then_some((x as u16, y as u16))
    }

    /// The kitchen element whose bounds contain the point, or else the nearest element.
    fn nearest(&self, point: [f64; 2], bounds: impl Fn(&KitchenMapBox) -> Bounds) -> Option<&KitchenMapBox> {
        let distance = |spot: &KitchenMapBox| {
            let outside = |axis: usize| {
                let [low, high] = bounds(spot).0[axis];
                (low - point[axis]).max(point[axis] - high).max(0.0)
            };
            outside(0) + outside(1)
        };
        self.spots.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }
}

impl KitchenMapBox {
    /// The column after the box and the gap that follows it, where the next box begins.
    pub fn right(&self) -> u16 {
        (self.screen.0[0][1] as u16).max(self.cells.right())
    }

    /// Pairs of wall display coordinate and terminal coordinate along one axis, between which coordinates are
    /// interpolated.
    fn knots(&self, axis: usize) -> [(f64, f64); 4] {
        let (area, cells) = (extent(self.area, axis), bounds(self.cells).0[axis]);
        let (display, screen) = (self.display.0[axis], self.screen.0[axis]);
        [(display[0], screen[0]), (area[0], cells[0]), (area[1], cells[1]), (display[1], screen[1])]
    }
}

/// Piecewise linear interpolation through four knots, extrapolated at both ends with the slope of the middle piece.
fn along(value: f64, knots: &[(f64, f64); 4], order: impl Fn((f64, f64)) -> (f64, f64)) -> f64 {
    let knots = knots.map(order);
    let piece = |a: (f64, f64), b: (f64, f64)| match b.0 - a.0 {
        length if length.abs() < 1e-9 => a.1,
        length => a.1 + (value - a.0) / length * (b.1 - a.1),
    };
    let middle = (knots[2].1 - knots[1].1) / (knots[2].0 - knots[1].0).max(1e-9);
    if value < knots[0].0 {
        knots[0].1 + (value - knots[0].0) * middle
    } else if value > knots[3].0 {
        knots[3].1 + (value - knots[3].0) * middle
    } else if value < knots[1].0 {
        piece(knots[0], knots[1])
    } else if value <= knots[2].0 {
        piece(knots[1], knots[2])
    } else {
        piece(knots[2], knots[3])
    }
}

/// Row number `index` of an area that is divided into `count` rows of equal height.
fn share(cells: Rect, count: usize, index: usize) -> Rect {
    let edge = |index: usize| cells.y + (usize::from(cells.height) * index / count.max(1)) as u16;
    Rect { y: edge(index), height: edge(index + 1) - edge(index), ..cells }
}

fn spot(item: &Item, region: Rect, display: Bounds) -> KitchenMapBox {
    let cells = match item.thing {
        KitchenMapElement::Location(_) => {
            // In a tall region, boxes grow and leave an empty row between them.
            let height = match region.height {
                rows @ 0..=4 => rows,
                rows => (rows - 1).min(6),
            };
            let width = region.width.saturating_sub(u16::from(region.width > MIN_CARD));
            Rect { width, height, ..region }
        }
        KitchenMapElement::Storage(_) => Rect { height: region.height.min(1), ..region },
    };
    KitchenMapBox { thing: item.thing, cells, area: item.area, display, screen: bounds(region) }
}

fn bounds(cells: Rect) -> Bounds {
    Bounds([[cells.x, cells.right()].map(f64::from), [cells.y, cells.bottom()].map(f64::from)])
}

/// The orders as lines one below another, each as wide as the area.
fn lines_of_orders(items: &[&Item], cells: Rect, display_y: [f64; 2]) -> Vec<KitchenMapBox> {
    let groups = one_by_one(items, |area| area.x);
    let place = |(index, group): (usize, &Vec<&Item>)| {
        let region = share(cells, groups.len(), index);
        let display = Bounds([ends(&groups, index, 0, [0.0, 1.0]), display_y]);
        KitchenMapBox { thing: group[0].thing, cells: region, area: group[0].area, display, screen: bounds(region) }
    };
    groups.iter().enumerate().map(place).collect()
}

/// Extends the display region of every box so that it contains the box's own area.
fn cover(mut spots: Vec<KitchenMapBox>) -> Vec<KitchenMapBox> {
    for spot in &mut spots {
        for axis in 0..2 {
            let [low, high] = spot.display.0[axis];
            let [from, to] = extent(spot.area, axis);
            spot.display.0[axis] = [low.min(from), high.max(to)];
        }
    }
    spots
}

/// An element of the kitchen map: a location or an ingredient storage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KitchenMapElement {
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

/// Puts every kitchen element into a group of its own, in the order of their places.
fn one_by_one<'a>(items: &[&'a Item], place: fn(DisplayArea) -> f64) -> Vec<Vec<&'a Item>> {
    let mut sorted = items.to_vec();
    sorted.sort_by(|a, b| place(a.area).total_cmp(&place(b.area)));
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
