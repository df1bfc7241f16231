//! The orders: what each needs, what of it is there already, and what the participant believes otherwise.

use super::kitchen::Place;
use super::paint::Painter;
use super::theme::TextRole;
use crate::console::kitchen_map::KitchenMapBox;
use crate::console::text_columns::width;
use ratatui::layout::Rect;
use tomcom_core::kitchen::OrderContent;
use tomcom_session::order_needs::{ItemProgress, NeededItem, OrderNeeds};

/// Short text in place of a false belief, where there is no room for it.
const FALSE_BELIEF: &str = "false belief";
/// Columns of the age of an order.
const AGE: u16 = 6;

/// A line of an order after its dish: parts in their styles.
type Parts = Vec<(String, TextRole)>;

impl Place<'_> {
    /// Draws an order: its key and name, its dish and age, and the items that it needs, with the sign of what is in work
    /// before the dish that a stack was begun for; in a second line, or else at the end of the first, a false belief about
    /// it.
    pub(super) fn draw_order(&self, brush: &mut Painter, spot: &KitchenMapBox, needs: Option<&OrderNeeds>) {
        let cells = spot.cells;
        if cells.width < 6 || cells.height == 0 {
            return;
        }
        self.rule(brush, Rect { height: cells.height.min(2), ..cells });
        let x = self.title(brush, Rect { height: 1, ..cells }, cells.right()) + 1;
        let sign = brush.theme.signs().served;
        let dish = match self.session.state.order(self.id) {
            OrderContent::Served => format!("{sign} served"),
            OrderContent::None => "no order".to_string(),
            OrderContent::Dish(_) => self.content.clone(),
        };
        let (style, right) = (self.content_style(brush), cells.right());
        let end = brush.text(x, cells.y, right.saturating_sub(x), &dish, style);
        if needs.is_some_and(|needs| needs.is_begun) {
            brush.parts(x - 1, cells.y, 1, &[(brush.theme.signs().in_work, TextRole::Strong)]);
        }
        if !matches!(self.session.state.order(self.id), OrderContent::Dish(_)) {
            return;
        }
        // The items of all orders stand below each other.
        let longest = self.session.kitchen.dishes.iter().map(|dish| width(&dish.name)).max().unwrap_or(0);
        let after = (x + longest).max(end) + 1;
        let is_tall = cells.height > 1;
        let room = right.saturating_sub(after);
        let age = self.session.age(self.session.changed_at[self.id.index()], self.model.now);
        // Only in the wide line do the items of all orders stand below each other.
        let age = |is_long: bool| {
            let columns = if is_long { usize::from(AGE) } else { 0 };
            (format!("{:<columns$}", format!("{age} ")), TextRole::Quiet)
        };
        let thoughts = self.thoughts();
        // Of the ways to write the line, the first one that fits.
        let whole = |with_age: bool, is_long: bool, thought: Option<&String>| -> Parts {
            let age = with_age.then(|| age(is_long));
            let dot = if brush.theme.unicode { '·' } else { '-' };
            let thought = thought.map(|thought| (format!("{dot}{thought}"), TextRole::FalseBelief));
            age.into_iter().chain(self.items(brush, needs, is_long)).chain(thought).collect()
        };
        let mut ways: Vec<Parts> = Vec::new();
        match thoughts.is_empty() || is_tall {
            true => {
                ways.extend([(true, true), (true, false), (false, false)].map(|(age, long)| whole(age, long, None)))
            }
            false => {
                for (with_age, is_long) in [(true, true), (true, false), (false, false)] {
                    ways.extend(thoughts.iter().take(2).map(|thought| whole(with_age, is_long, Some(thought))));
                }
                ways.extend(thoughts.iter().skip(2).map(|thought| whole(false, false, Some(thought))));
            }
        }
        let columns = |parts: &Parts| parts.iter().map(|(text, _)| width(text)).sum::<u16>();
        let fits = ways.iter().position(|parts| columns(parts) <= room).unwrap_or(ways.len() - 1);
        let parts: Vec<(&str, TextRole)> = ways[fits].iter().map(|(text, role)| (text.as_str(), *role)).collect();
        let end = brush.parts(after, cells.y, room, &parts);
        if self.is_unseen() {
            let marks = [self.unseen(), "?"].map(|words| format!("{}{words}", brush.theme.signs().changed));
            if let Some(mark) = marks.iter().find(|mark| end + width(mark) < right) {
                brush.parts(end + 1, cells.y, width(mark), &[(mark, TextRole::Gaze)]);
            }
        }
        let below = right.saturating_sub(after + AGE);
        if let Some(thought) = thoughts.iter().find(|thought| width(thought) <= below).filter(|_| is_tall) {
            brush.parts(after + AGE, cells.y + 1, below, &[(thought, TextRole::FalseBelief)]);
        }
    }

    /// The false belief about the order, in fewer and fewer words.
    fn thoughts(&self) -> Vec<String> {
        let Some((thinks, truth)) = &self.thinks else { return Vec::new() };
        let short = [FALSE_BELIEF, "false"].map(str::to_string);
        [format!("thinks {thinks}, {truth}"), format!("thinks {thinks}")].into_iter().chain(short).collect()
    }

    /// The items of an order, each with a sign: there, in work (where there is room, with what is there now) or missing.
    fn items(&self, brush: &Painter, needs: Option<&OrderNeeds>, is_long: bool) -> Parts {
        let signs = brush.theme.signs();
        let kitchen = &self.session.kitchen;
        let item = |needed: &NeededItem| {
            let name = &kitchen.content(needed.item).wording;
            let shown = if self.is_shown { TextRole::Signal } else { TextRole::Strong };
            let gap = if is_long { "  " } else { " " };
            match needed.progress {
                ItemProgress::Missing => (format!("{} {name}{gap}", signs.missing), shown),
                ItemProgress::InWork(at) if is_long => {
                    let now = kitchen.content_label(self.session.state, at);
                    (format!("{} {name} ({now}){gap}", signs.in_work), TextRole::Text)
                }
                ItemProgress::InWork(_) => (format!("{} {name}{gap}", signs.in_work), TextRole::Text),
                ItemProgress::Stacked | ItemProgress::Ready(_) => {
                    (format!("{} {name}{gap}", signs.served), TextRole::Quiet)
                }
            }
        };
        needs.into_iter().flat_map(|needs| &needs.items).map(item).collect()
    }
}
