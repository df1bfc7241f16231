//! The orders: what each needs, what of it is there already, and what the participant believes otherwise.

use super::kitchen::Place;
use super::paint::Painter;
use super::theme::TextRole;
use crate::console::kitchen_map::KitchenMapBox;
use crate::console::text_columns::width;
use ratatui::layout::Rect;
use tomcom_core::kitchen::{LocationId, OrderContent};
use tomcom_session::order_needs::{ItemProgress, LastStep, NeededItem, OrderNeeds};

/// Short text in place of a false belief, where there is no room for it.
const FALSE_BELIEF: &str = "false belief";
/// Columns of the age of an order.
const AGE: u16 = 6;

/// A line of an order after its dish: parts in their styles.
type Parts = Vec<(String, TextRole)>;

impl Place<'_> {
    /// Draws an order: its key and name, its dish and age, and the items that it needs, with the sign of what is in work
    /// before the dish that a stack was begun for; in a second line, or else at the end of the first, what the items in work
    /// are now or the step that is left, and a false belief about it.
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
        let end = brush.styled(x, cells.y, right.saturating_sub(x), &dish, style);
        if needs.is_some_and(|needs| needs.is_begun) {
            brush.text(x - 1, cells.y, 1, brush.theme.signs().in_work, TextRole::Strong);
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
        let step = needs.and_then(|needs| self.last_step(brush, needs));
        // Of the ways to write the line, the first one that fits.
        let whole = |with_age: bool, is_long: bool, thought: Option<&String>| -> Parts {
            let age = with_age.then(|| age(is_long));
            let dot = if brush.theme.unicode { '·' } else { '-' };
            let thought = thought.map(|thought| (format!("{dot}{thought}"), TextRole::FalseBelief));
            let step = step.as_ref().filter(|_| !is_tall).map(|(step, _)| (format!("{step} "), self.open_role()));
            age.into_iter().chain(self.items(brush, needs, is_long, !is_tall)).chain(step).chain(thought).collect()
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
            let (words, sign) = self.unseen(brush);
            let marks = [format!("{}{words}", brush.theme.signs().changed), sign.to_string()];
            if let Some(mark) = marks.iter().find(|mark| end + width(mark) < right) {
                brush.text(end + 1, cells.y, width(mark), mark, TextRole::Gaze);
            }
        }
        if is_tall {
            let (y, mut x) = (cells.y + 1, after + AGE);
            let now = needs.and_then(|needs| self.in_work(brush, needs)).map(|now| (now, TextRole::Text));
            // No step is left to be told while something is in work.
            if let Some((words, role)) = now.or(step.map(|(_, step)| (step, self.open_role()))) {
                x = brush.text(x, y, right.saturating_sub(x), &words, role) + 2;
            }
            let left = right.saturating_sub(x);
            if let Some(thought) = thoughts.iter().find(|thought| width(thought) <= left) {
                brush.text(x, y, left, thought, TextRole::FalseBelief);
            }
        }
    }

    /// Style of what is still to be done for the order.
    fn open_role(&self) -> TextRole {
        if self.is_shown { TextRole::Signal } else { TextRole::Strong }
    }

    /// The step that is left once all items are there, in one word and whole: "stack", "stack cut tuna from cutting
    /// board".
    fn last_step(&self, brush: &Painter, needs: &OrderNeeds) -> Option<(String, String)> {
        let kitchen = &self.session.kitchen;
        let ready = || {
            needs.items.iter().filter_map(|needed| match needed.progress {
                ItemProgress::Ready(at) => Some((kitchen.content(needed.item).wording.as_str(), at)),
                _ => None,
            })
        };
        let from = |at: LocationId| format!(" from {}", kitchen.location(at).label());
        let (word, rest) = match needs.last_step? {
            LastStep::Stack => {
                let names = ready().map(|(name, _)| name).collect::<Vec<_>>().join(" + ");
                let place = ready().next().filter(|_| ready().count() == 1).map_or(String::new(), |(_, at)| from(at));
                ("stack", format!(" {names}{place}"))
            }
            LastStep::Plate(at) => ("plate", from(at)),
            LastStep::Serve => ("serve", String::new()),
        };
        let word = format!("{} {word}", brush.theme.signs().missing);
        Some((word.clone(), word + &rest))
    }

    /// What the items in work are now: "now raw rice, raw tuna".
    fn in_work(&self, brush: &Painter, needs: &OrderNeeds) -> Option<String> {
        let now = needs.items.iter().filter_map(|needed| match needed.progress {
            ItemProgress::InWork(at) => Some(self.session.kitchen.content_label(self.session.state, at)),
            _ => None,
        });
        let now = now.collect::<Vec<_>>().join(", ");
        (!now.is_empty()).then(|| format!("{} now {now}", brush.theme.signs().in_work))
    }

    /// The false belief about the order, in fewer and fewer words.
    fn thoughts(&self) -> Vec<String> {
        let Some((thinks, truth)) = &self.thinks else { return Vec::new() };
        let short = [FALSE_BELIEF, "false"].map(str::to_string);
        [format!("thinks {thinks}, {truth}"), format!("thinks {thinks}")].into_iter().chain(short).collect()
    }

    /// The items of an order, each with a sign: there, in work (in a long line `with_content`, with what is there now) or
    /// missing.
    fn items(&self, brush: &Painter, needs: Option<&OrderNeeds>, is_long: bool, with_content: bool) -> Parts {
        let signs = brush.theme.signs();
        let kitchen = &self.session.kitchen;
        let item = |needed: &NeededItem| {
            let name = &kitchen.content(needed.item).wording;
            let gap = if is_long { "  " } else { " " };
            match needed.progress {
                ItemProgress::Missing => (format!("{} {name}{gap}", signs.missing), self.open_role()),
                ItemProgress::InWork(at) if is_long && with_content => {
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
