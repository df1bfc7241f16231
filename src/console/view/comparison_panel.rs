//! The comparison of wizard and assistants: one lane of communications each on a common time axis, lines between
//! matches, similarity statistics, and differences.

use ratatui::layout::Rect;
use ratatui::style::Modifier;

use super::paint::Painter;
use super::regions::{PanelAreas, ROOMY_COLUMNS, ScreenSize};
use super::theme::TextRole;
use super::timeline::{axis, columns_ago, signal_sign};
use crate::console::console_model::ConsoleModel;
use crate::console::key_action::{KeyAction, ViewAction};
use crate::console::text_columns::width;
use tomcom_core::base::text::decimal;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::SignalKind;
use tomcom_session::Session;
use tomcom_session::history::comparison::{Communication, SenderComparison, UnmatchedCommunication};

/// Time that one terminal column of the comparison stands for, in seconds.
const COLUMN_S: f64 = 1.0;
const LABELS: u16 = 10;

const TITLE: &str = "Signals of wizard and assistant compared";

pub fn draw(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let area = regions.comparison;
    let Some(compared) = model.comparison.as_ref().filter(|_| area.area() > 0) else { return };
    let is_small = regions.screen_size == ScreenSize::Small;
    let window = compared.seen.as_ref().map(|seen| format!("signals match within {} presses", seen.window));
    let inside = match is_small {
        true => area,
        false => brush.panel(area, TITLE, &window.unwrap_or_default()),
    };
    let Some(seen) = &compared.seen else {
        let words = "signals are compared from the first order or press on";
        brush.text(inside.x + 1, inside.y, inside.width, words, TextRole::Quiet);
        return;
    };
    let plot = Rect { x: inside.x + LABELS, width: inside.width.saturating_sub(LABELS + 1), ..inside };
    axis(brush, plot, session, model, COLUMN_S);
    let chosen = compared.chosen().map(|(at, seen)| (at, seen.differences[at]));
    let assistants = seen.pairs.len() as u16;
    // Lines between matching communications are drawn only if there are rows for them.
    let joined = inside.height >= 4 + 2 * assistants;
    let view = View { session, model, plot, seen, chosen: chosen.map(|(_, chosen)| chosen) };
    let mut y = inside.y + 1;
    view.lane(brush, 0, y);
    for lane in 1..seen.lanes.len() {
        if joined {
            y += 1;
            view.matches(brush, lane, y);
        }
        y += 1;
        view.lane(brush, lane, y);
    }
    y += 1;
    let figures = usize::from(inside.bottom().saturating_sub(y + 1)).min(seen.pairs.len());
    for lane in 1..=figures {
        figures_line(brush, inside, y, seen, lane);
        y += 1;
    }
    let rest = Rect { y, height: inside.bottom().saturating_sub(y), ..inside };
    differences(brush, rest, seen, chosen, model);
}

struct View<'a> {
    session: &'a Session,
    model: &'a ConsoleModel,
    plot: Rect,
    seen: &'a SenderComparison,
    chosen: Option<UnmatchedCommunication>,
}

impl View<'_> {
    /// Terminal column of a session time, if that time is visible.
    fn column(&self, time: SessionTime) -> Option<u16> {
        let age = columns_ago(self.session, self.model, time, COLUMN_S);
        (0..i64::from(self.plot.width)).contains(&age).then(|| self.plot.right() - 1 - age as u16)
    }

    fn lane(&self, brush: &mut Painter, lane: usize, y: u16) {
        if y >= self.plot.bottom() {
            return;
        }
        let role = if lane == 0 { TextRole::Signal } else { TextRole::Strong };
        brush.text(self.plot.x - LABELS + 1, y, LABELS - 1, &self.seen.lanes[lane].name, role);
        for (index, spoken) in self.seen.lanes[lane].spoken.iter().enumerate() {
            let Some(x) = self.column(spoken.time) else { continue };
            let is_chosen = self.chosen.is_some_and(|chosen| (chosen.lane, chosen.index) == (lane, index));
            let style =
                if is_chosen { brush.style(role).add_modifier(Modifier::UNDERLINED) } else { brush.style(role) };
            let sign = self.sign(brush, spoken);
            brush.styled(x, y, 1, &sign, style);
        }
    }

    /// Sign of a communication in its lane: the key of a signal, or a common sign for a proposal of presses.
    fn sign(&self, brush: &Painter, spoken: &Communication) -> String {
        if spoken.what.kind() == SignalKind::Proposal {
            return brush.theme.signs().by_hand.to_string();
        }
        signal_sign(self.session, self.model, &spoken.what)
    }

    /// Draws lines from the communications of the first lane to their matches in this lane.
    fn matches(&self, brush: &mut Painter, lane: usize, y: u16) {
        if y >= self.plot.bottom() {
            return;
        }
        let [top_left, top_right, bottom_left, bottom_right, across, down] = brush.theme.signs().frame;
        for &(of, with) in &self.seen.pairs[lane - 1].matched {
            let times = [self.seen.lanes[0].spoken[of].time, self.seen.lanes[lane].spoken[with].time];
            let [Some(from), Some(to)] = times.map(|time| self.column(time)) else { continue };
            for x in from.min(to)..from.max(to) {
                brush.text(x, y, 1, across, TextRole::Quiet);
            }
            let (start, end) = match from.cmp(&to) {
                std::cmp::Ordering::Equal => (down, down),
                std::cmp::Ordering::Less => (bottom_left, top_right),
                std::cmp::Ordering::Greater => (bottom_right, top_left),
            };
            brush.text(from, y, 1, start, TextRole::Quiet);
            brush.text(to, y, 1, end, TextRole::Quiet);
        }
    }
}

/// Draws the statistics of how similar the communications of an assistant's lane are to those of the first lane.
fn figures_line(brush: &mut Painter, inside: Rect, y: u16, seen: &SenderComparison, lane: usize) {
    let name = format!("{:<9}", seen.lanes[lane].name);
    if seen.lanes[0].spoken.is_empty() {
        let text = "no signal was sent so far: nothing to compare with";
        brush.parts(inside.x + 1, y, inside.width - 1, &[(&name, TextRole::Strong), (text, TextRole::Quiet)]);
        return;
    }
    let found = &seen.pairs[lane - 1].similarity;
    let number = |value: Option<f64>| decimal(value, 2);
    let lead = found.lead();
    let [recall, precision, f1] = [found.signal.recall, found.signal.precision, found.signal.f1].map(number);
    let (kappa, chance) = (number(found.kappa), number(found.signal.chance_recall));
    let text = match inside.width >= ROOMY_COLUMNS - 8 {
        true => format!(
            "recall {recall} (chance {chance}), precision {precision}, F1 {f1}, kappa {kappa}, lead {lead}; {}/{} \
             signals matched, {} sent",
            found.matched, found.of_n, found.with_n
        ),
        false => format!("recall {recall}, precision {precision}, F1 {f1}, kappa {kappa}, lead {lead}"),
    };
    brush.parts(inside.x + 1, y, inside.width - 1, &[(&name, TextRole::Strong), (&text, TextRole::Text)]);
}

/// Draws the list of differences between wizard and assistant around the selected one.
fn differences(
    brush: &mut Painter,
    area: Rect,
    seen: &SenderComparison,
    chosen: Option<(usize, UnmatchedCommunication)>,
    model: &ConsoleModel,
) {
    let Some((at, _)) = chosen.filter(|_| area.height > 0) else {
        if area.height > 0 {
            let words = "signals of wizard and assistant do not differ so far";
            brush.text(area.x + 1, area.y, area.width - 1, words, TextRole::Quiet);
        }
        return;
    };
    let rows = usize::from(area.height);
    // The selected difference is in the middle of the list, except near the list's ends.
    let from = at.saturating_sub(rows / 2).min(seen.differences.len().saturating_sub(rows));
    for (row, (index, difference)) in seen.differences.iter().enumerate().skip(from).take(rows).enumerate() {
        let y = area.y + row as u16;
        let is_chosen = index == at;
        let number = format!("{:>3}/{}  ", index + 1, seen.differences.len());
        let role = if is_chosen { TextRole::Strong } else { TextRole::Quiet };
        let open = model.keys.chord_for(&KeyAction::Look(ViewAction::Open)).filter(|_| is_chosen);
        let open = open.map_or(String::new(), |key| format!("  {key} details"));
        let headline = seen.headline(difference);
        let room = area.width.saturating_sub(width(&open) + 1);
        let x = brush.parts(area.x + 1, y, room, &[(&number, TextRole::Quiet), (&headline, role)]);
        brush.text(x, y, area.right().saturating_sub(x), &open, TextRole::Signal);
    }
}
