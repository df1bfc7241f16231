//! The belief panel: the participant's estimated beliefs with certainty, truth and age, false ones first, ordered by
//! the presses that they cost; or one belief over time.

use ratatui::layout::Rect;

use super::gaze::GazeLoss;
use super::paint::Painter;
use super::regions::PanelAreas;
use super::theme::TextRole;
use super::timeline::ticks;
use crate::console::beliefs::{BeliefCorrectness, EstimatedBelief, are_by_cost, name, percent, visibility};
use crate::console::console_model::{ConsoleModel, Playback};
use crate::console::mouse::ClickAction;
use crate::console::panels::Panel as PanelName;
use crate::console::text_columns::{fit, width, wrap};
use tomcom_core::base::text::count;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::AspectId;
use tomcom_core::measures::sequences::FALSE_BELOW;
use tomcom_session::Session;
use tomcom_session::history::belief_track::{self, BeliefSnapshot, SHOWN_S};
use tomcom_session::history::wording;
use tomcom_session::replay::ReplayLandmark;
use tomcom_session::settings::WizardVisibility;

/// Least width, in columns, of a panel that shows each belief in one line.
const ONE_LINE: u16 = 66;
/// Least height of a belief panel with a frame, in rows.
const FRAMED: u16 = 5;
/// Height of a chart of a belief over time, with its title.
const CHART_ROWS: u16 = 5;
/// Probability of the truth from which a chart of it would stand at 100 %.
const CERTAIN: f64 = 0.9;
/// Columns of the bar for a belief's probability and of the gap before it.
const BAR: u16 = 7;
/// Columns of the probability scale at the left of a chart.
const SCALE: u16 = 6;

/// Text of the belief panel while no belief is false.
pub(super) const QUIET: &str = "No belief is probably false";

/// Text of the belief panel before the trial's first estimate.
const BEFORE: &str = "no estimate before the trial starts";

/// Drawing context of the belief panel: session, present time, and estimates.
struct Panel<'a> {
    session: &'a Session,
    now: SessionTime,
    moments: &'a [BeliefSnapshot],
    beliefs: &'a [EstimatedBelief],
    /// Number of false and unsure beliefs that are scrolled away.
    from: usize,
    /// Whether a replay stands at an error: its text has the beliefs before the press.
    is_after_error: bool,
}

pub fn draw(
    brush: &mut Painter,
    regions: &PanelAreas,
    session: &Session,
    model: &ConsoleModel,
    believed: &[EstimatedBelief],
) {
    let area = regions.belief;
    if area.area() == 0 || visibility(session, model) < WizardVisibility::Belief {
        return;
    }
    let moments = model.belief.until(model.now);
    let told = believed.iter().filter(|belief| belief.standing != BeliefCorrectness::Right).count();
    let from = model.beliefs_from.min(told.saturating_sub(1));
    let stands_at = model.playback.as_ref().and_then(Playback::stands_at);
    let is_after_error = stands_at.is_some_and(|(what, _)| what == Some(ReplayLandmark::Error));
    let panel = Panel { session, now: model.now, moments, beliefs: believed, from, is_after_error };
    if area.height < FRAMED {
        return panel.lines(brush, area);
    }
    let inside = brush.panel(area, "Beliefs", &panel.remark());
    let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
    let focus = model.belief_focus.filter(|_| model.alone == Some(PanelName::Belief));
    let focus = focus.and_then(|focus| panel.beliefs.iter().find(|belief| belief.aspect == focus));
    match focus {
        Some(belief) => panel.chart(brush, belief, inside),
        None if panel.beliefs.is_empty() => {
            brush.text(inside.x, inside.y, inside.width, BEFORE, TextRole::Quiet);
        }
        None => panel.list(brush, inside),
    }
}

impl Panel<'_> {
    fn of_standing(&self, standing: BeliefCorrectness) -> impl Iterator<Item = &EstimatedBelief> {
        self.beliefs.iter().filter(move |belief| belief.standing == standing)
    }

    fn remark(&self) -> String {
        let loss = GazeLoss::now(self.session, self.now).filter(|_| !self.beliefs.is_empty());
        match self.of_standing(BeliefCorrectness::False).count() {
            _ if self.from > 0 => format!("{} above", self.from),
            0 if self.is_after_error => "after the press".to_string(),
            number if self.is_after_error => format!("{number} false, after the press"),
            _ if let Some(loss) = &loss => loss.words(self.now),
            0 => "estimated, not known".to_string(),
            number if are_by_cost(self.session) => format!("{number} false, costliest first"),
            number => format!("{number} false, oldest first"),
        }
    }

    /// Draws the list of beliefs, and below it, as far as there is room, charts of the first beliefs over time.
    fn list(&self, brush: &mut Painter, area: Rect) {
        let mut y = area.y;
        let is_false = |belief: &EstimatedBelief| belief.standing == BeliefCorrectness::False;
        let is_wide = area.width >= ONE_LINE;
        if !self.beliefs.iter().any(is_false) {
            brush.text(area.x, y, area.width, QUIET, TextRole::Quiet);
            y += 1;
        }
        let told: Vec<&EstimatedBelief> =
            self.beliefs.iter().filter(|belief| belief.standing != BeliefCorrectness::Right).collect();
        let right = self.beliefs.len() - told.len();
        for (index, belief) in told.iter().enumerate().skip(self.from) {
            // A wide panel gives a belief a line of its own, and further ones if its words need them.
            let is_row = is_wide && self.fits_row(belief, area.width);
            let lines = if is_row { Vec::new() } else { self.told(belief, area.width - 2) };
            let rows = 1 + lines.len() as u16;
            // The panel's last line counts the beliefs that have no room.
            if y + rows >= area.bottom() {
                let left = told.len() - index;
                let is_any_false = told[index..].iter().any(|belief| is_false(belief));
                let role = if is_any_false { TextRole::FalseBelief } else { TextRole::Quiet };
                let words = format!("{} {left} more false or unsure beliefs", brush.theme.signs().ellipsis);
                brush.text(area.x, y, area.width, &words, role);
                return;
            }
            match is_row {
                true => self.row(brush, belief, area, y),
                false => self.head(brush, belief, area, y, &lines),
            }
            brush.target(Rect { y, height: rows, ..area }, ClickAction::Belief(belief.aspect));
            y += rows;
        }
        if right > 0 && y < area.bottom() {
            let words = match told.is_empty() {
                true => count(right as u64, "belief is probably right", "beliefs are probably right"),
                false => count(right as u64, "other is probably right", "others are probably right"),
            };
            brush.text(area.x, y, area.width, &words, TextRole::Quiet);
            y += 2;
        }
        // A belief that was right all the time needs no chart.
        let is_charted = |belief: &&EstimatedBelief| match belief.standing {
            BeliefCorrectness::Right => is_wide && self.was_doubtful(belief, area.width.saturating_sub(SCALE)),
            _ => true,
        };
        for belief in self.beliefs.iter().filter(is_charted) {
            if y + CHART_ROWS > area.bottom() {
                return;
            }
            let cells = Rect { y, height: CHART_ROWS, ..area };
            self.chart(brush, belief, cells);
            brush.target(cells, ClickAction::Belief(belief.aspect));
            y += CHART_ROWS + 1;
        }
    }

    /// Whether a chart with this number of columns shows a time at which the truth was not almost certain.
    fn was_doubtful(&self, belief: &EstimatedBelief, columns: u16) -> bool {
        self.course(belief.aspect, columns).into_iter().flatten().any(|p| p < CERTAIN)
    }

    /// Estimated probability of the truth for each column of a chart; `None` where there is no estimate.
    fn course(&self, aspect: AspectId, columns: u16) -> Vec<Option<f64>> {
        let (aspect, columns) = (aspect.index(), usize::from(columns));
        belief_track::course(self.moments, aspect, self.session, self.now, SHOWN_S, columns)
    }

    /// What the participant believes and what is true, in as few lines as the columns allow.
    fn told(&self, belief: &EstimatedBelief, columns: u16) -> Vec<String> {
        let (thinks, truth) = self.values(belief);
        if belief.standing == BeliefCorrectness::Unsure {
            return vec![format!("unsure, may think {thinks}")];
        }
        let whole = format!("thinks {thinks}, {truth}");
        match width(&whole) <= columns {
            true => vec![whole],
            false => [format!("thinks {thinks},"), truth].iter().flat_map(|line| wrap(line, columns)).collect(),
        }
    }

    /// What the participant thinks, and what is true: "cut salmon", "needs cut tuna".
    fn values(&self, belief: &EstimatedBelief) -> (String, String) {
        wording::contrast(&self.session.kitchen, belief.aspect, belief.thinks, belief.truth)
    }

    /// Probability of what the participant thinks or may think, as the line says, and the time for which the truth has
    /// been improbable: "83 % 0:22".
    fn certainty(&self, belief: &EstimatedBelief) -> String {
        let age = belief.since.map(|since| self.session.age(since, self.now).to_string()).unwrap_or_default();
        format!("{:>5} {age:>5}", percent(f64::from(belief.p)))
    }

    /// Name of a belief's state aspect; for an unsure belief with its most probable wrong value.
    fn title(&self, belief: &EstimatedBelief) -> String {
        let name = name(self.session, belief.aspect);
        match belief.standing {
            BeliefCorrectness::Unsure => format!("{name}: unsure, may think {}", self.values(belief).0),
            _ => name,
        }
    }

    /// What stands at the right end of a belief's first line: its certainty, and in a wide panel the presses that it
    /// costs: "83 % 0:22   4 presses".
    fn end(&self, belief: &EstimatedBelief, columns: u16) -> String {
        let certainty = self.certainty(belief);
        if columns < ONE_LINE || !are_by_cost(self.session) {
            return certainty;
        }
        let cost = match belief.cost.round() {
            cost if cost < 1.0 => String::new(),
            1.0 => " 1 press".to_string(),
            cost => format!("{cost:>2} presses"),
        };
        format!("{certainty}  {cost:<10}")
    }

    /// What stands at the left of a belief that has one line: aspect and believed value, and what is true.
    fn sides(&self, belief: &EstimatedBelief) -> (String, String) {
        let (thinks, truth) = self.values(belief);
        match belief.standing {
            BeliefCorrectness::Unsure => (self.title(belief), String::new()),
            _ => (format!("{}: thinks {thinks}, ", self.title(belief)), truth),
        }
    }

    /// Whether a belief's words fit into one line beside its certainty.
    fn fits_row(&self, belief: &EstimatedBelief, columns: u16) -> bool {
        let (head, is) = self.sides(belief);
        width(&head) + width(&is) + width(&self.end(belief, columns)) < columns
    }

    /// Draws a belief in several lines: its name and certainty, and below them what the participant believes and, if
    /// that is false, what is true.
    fn head(&self, brush: &mut Painter, belief: &EstimatedBelief, area: Rect, y: u16, lines: &[String]) {
        let end = self.end(belief, area.width);
        let (title, room) = (name(self.session, belief.aspect), area.width.saturating_sub(width(&end) + 1));
        brush.text(area.x, y, room, &title, role(belief));
        brush.text_right(area.right(), y, area.width, &end, role(belief));
        for (row, line) in lines.iter().enumerate() {
            brush.text(area.x + 2, y + 1 + row as u16, area.width - 2, line, TextRole::Text);
        }
    }

    fn row(&self, brush: &mut Painter, belief: &EstimatedBelief, area: Rect, y: u16) {
        let end = self.end(belief, area.width);
        brush.text_right(area.right(), y, area.width, &end, role(belief));
        let (head, is) = self.sides(belief);
        // Words have priority over the probability bar, since the number shows the same.
        let mut room = area.width.saturating_sub(width(&end) + 1);
        if width(&head) + width(&is) + BAR < room {
            room -= BAR;
            brush.bar(area.x + room + 1, y, BAR - 1, f64::from(belief.p), role(belief));
        }
        let x = brush.text(area.x, y, room, &head, role(belief));
        brush.text(x, y, (area.x + room).saturating_sub(x), &is, TextRole::Text);
    }

    fn lines(&self, brush: &mut Painter, area: Rect) {
        let x = brush.text(area.x, area.y, area.width, " beliefs  ", TextRole::Quiet);
        let room = area.width.saturating_sub(11);
        let told: Vec<&EstimatedBelief> =
            self.beliefs.iter().filter(|belief| belief.standing != BeliefCorrectness::Right).collect();
        if told.is_empty() {
            let words = if self.beliefs.is_empty() { BEFORE } else { QUIET };
            brush.text(x, area.y, room, words, TextRole::Quiet);
        }
        for (row, belief) in told.iter().skip(self.from).take(usize::from(area.height)).enumerate() {
            let y = area.y + row as u16;
            let more = told.len() - self.from - row - 1;
            let more =
                if row as u16 + 1 == area.height && more > 0 { format!("  +{more} more") } else { String::new() };
            let end = format!("{}{more}", self.certainty(belief));
            brush.text_right(x + room, y, room, &end, role(belief));
            let columns = room.saturating_sub(width(&end) + 1);
            let (thinks, truth) = self.values(belief);
            let line = match belief.standing {
                BeliefCorrectness::Unsure => self.title(belief),
                _ => format!("{}: thinks {thinks}, {truth}", self.title(belief)),
            };
            // What an order needs is its recipe.
            let line = if width(&line) > columns { line.trim_start_matches("recipe of ").to_string() } else { line };
            brush.text(x, y, columns, &fit(&line, columns, brush.theme.signs().ellipsis), role(belief));
            brush.target(Rect { y, height: 1, ..area }, ClickAction::Belief(belief.aspect));
        }
    }

    /// Draws the estimated probability of the truth over the last minute of the trial's clock, with axes.
    fn chart(&self, brush: &mut Painter, belief: &EstimatedBelief, area: Rect) {
        let (thinks, truth) = self.values(belief);
        let name = name(self.session, belief.aspect);
        let right = wording::value(&self.session.kitchen, belief.aspect, belief.truth);
        let thought = match belief.standing {
            BeliefCorrectness::Right => format!("{name}: {right}"),
            BeliefCorrectness::Unsure => format!("{name}: may think {thinks} {}, {truth}", percent(belief.p.into())),
            BeliefCorrectness::False => format!("{name}: thinks {thinks} {}, {truth}", percent(belief.p.into())),
        };
        // The curve is the probability of the truth; if there is no room for both, the title says this instead of what
        // is believed.
        let curve = "probability of the truth";
        match width(&thought) + width(curve) + 2 <= area.width {
            true => {
                brush.text_right(area.right(), area.y, area.width, curve, TextRole::Quiet);
                brush.text(area.x, area.y, area.width, &thought, role(belief));
            }
            false => {
                let whole = format!("{name}: probability of {right}");
                let titles = [whole, format!("{name}: {curve}"), format!("{name}: P(truth)")];
                let fits = titles.iter().find(|title| width(title) <= area.width);
                brush.text(area.x, area.y, area.width, fits.unwrap_or(&titles[2]), role(belief));
            }
        }
        let plot = Rect {
            x: area.x + SCALE,
            y: area.y + 1,
            width: area.width.saturating_sub(SCALE),
            height: area.height.saturating_sub(2),
        };
        if plot.height == 0 {
            return;
        }
        brush.text_right(plot.x - 1, plot.y, SCALE, "100 %", TextRole::Quiet);
        brush.text_right(plot.x - 1, plot.bottom() - 1, SCALE, "0 %", TextRole::Quiet);
        if plot.height >= 5 {
            brush.text_right(plot.x - 1, plot.y + plot.height / 2, SCALE, "50 %", TextRole::Quiet);
        }
        self.curve(brush, belief.aspect, plot);
        let axis = Rect { y: plot.bottom(), height: 1, ..plot };
        let end = self.session.trial_clock(self.now);
        ticks(brush, axis, end, SHOWN_S / f64::from(plot.width.max(1)));
    }

    /// Draws the curve of the truth's probability, in the colour of false beliefs where that probability is low.
    fn curve(&self, brush: &mut Painter, aspect: AspectId, area: Rect) {
        let Rect { x, y, width: columns, height: rows } = area;
        let levels = brush.theme.signs().levels;
        for (column, p) in self.course(aspect, columns).iter().enumerate() {
            let Some(p) = p else { continue };
            let role = if *p < FALSE_BELOW { TextRole::FalseBelief } else { TextRole::Quiet };
            // Even a probability near zero is drawn, to be told from times without an estimate.
            let height = (p * f64::from(rows) * levels.len() as f64).ceil().max(1.0) as usize;
            for row in 0..rows {
                let below = usize::from(rows - 1 - row) * levels.len();
                if height > below {
                    let level = levels[(height - below).min(levels.len()) - 1];
                    brush.text(x + column as u16, y + row, 1, level, role);
                }
            }
        }
    }
}

/// Style of a belief: yellow is reserved for false beliefs.
fn role(belief: &EstimatedBelief) -> TextRole {
    match belief.standing {
        BeliefCorrectness::False => TextRole::FalseBelief,
        BeliefCorrectness::Unsure => TextRole::Text,
        BeliefCorrectness::Right => TextRole::Quiet,
    }
}
