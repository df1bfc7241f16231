//! The belief panel: estimated beliefs, false ones first, with the truth and their duration.

use ratatui::layout::Rect;

use super::paint::{Painter, fit, width};
use super::regions::Regions;
use super::theme::TextRole;
use crate::base::time::SessionTime;
use crate::communication::recommendation::phrase;
use crate::console::console_model::ConsoleModel;
use crate::history::belief_track::{self, AspectSnapshot, BeliefSnapshot};
use crate::kitchen::{AspectId, AspectKind, Kitchen};
use crate::session::{Phase, Session};

/// Period of the belief chart, in seconds; the small curves cover half of it.
const COURSE_S: f64 = belief_track::SHOWN_S;
/// Number of columns from which an aspect fits into one line.
const ONE_LINE: u16 = 66;
const WITH_COURSE: u16 = 72;
const COURSE: u16 = 10;
/// Least and largest height of the chart with its title.
const CHART_ROWS: [u16; 2] = [3, 10];
/// Number of rows below which the panel has no frame.
const FRAMED: u16 = 5;

/// Drawing context of the belief panel.
struct Panel<'a> {
    session: &'a Session,
    now: SessionTime,
    moments: &'a [BeliefSnapshot],
    held: &'a [AspectSnapshot],
    focus: Option<AspectId>,
}

/// Draws the belief panel.
pub fn draw(brush: &mut Painter, regions: &Regions, session: &Session, model: &ConsoleModel) {
    let area = regions.belief;
    if area.area() == 0 {
        return;
    }
    let now = if session.is_running() { model.now } else { model.now.min(session.time) };
    let moments = model.belief.until(model.now);
    let last = moments.last().filter(|_| session.phase != Phase::Ready);
    let Some(last) = last else {
        let waits = "estimated from the trial's start on";
        match area.height < FRAMED {
            true => {
                brush.parts(area.x, area.y, area.width, &[(" belief   ", TextRole::Quiet), (waits, TextRole::Quiet)]);
            }
            false => {
                let inside = brush.panel(area, "Belief", "estimated");
                let quiet = brush.style(TextRole::Quiet);
                brush.text(inside.x + 1, inside.y, inside.width.saturating_sub(1), waits, quiet);
            }
        }
        return;
    };
    let panel = Panel { session, now, moments, held: &last.held, focus: model.belief_focus };
    match area.height < FRAMED {
        true => panel.lines(brush, area.x, area.y, area.width, area.height),
        false => panel.panel(brush, area),
    }
}

impl Panel<'_> {
    fn kitchen(&self) -> &Kitchen {
        &self.session.kitchen
    }

    fn panel(&self, brush: &mut Painter, area: Rect) {
        let wrong = self.held.iter().filter(|held| held.is_false()).count();
        let remark = if wrong == 0 { "estimated".to_string() } else { format!("estimated, {wrong} wrong") };
        let inside = brush.panel(area, "Belief", &remark);
        let (x, columns) = (inside.x + 1, inside.width.saturating_sub(2));
        let ranked = belief_track::ranked(self.moments);
        let rows_of = |aspect: usize| match columns < ONE_LINE && self.held[aspect].is_false() {
            true => 1 + self.told(aspect, columns).len() as u16,
            false => 1,
        };
        let mut bottom = inside.bottom();
        if let Some(focus) = self.focus
            && inside.height > CHART_ROWS[0] + 2
        {
            let list: u16 = ranked.iter().map(|&aspect| rows_of(aspect)).sum();
            let rows = inside.height.saturating_sub(list).clamp(CHART_ROWS[0], CHART_ROWS[1]);
            bottom -= rows;
            self.chart(brush, focus, x, bottom, columns, rows);
        }
        let mut y = inside.y;
        let list: u16 = ranked.iter().map(|&aspect| rows_of(aspect)).sum();
        if columns >= ONE_LINE && inside.y + list < bottom {
            self.headings(brush, x, y, columns);
            y += 1;
        }
        for (index, &aspect) in ranked.iter().enumerate() {
            let rows = rows_of(aspect);
            let left = ranked.len() - index;
            // The last line shows the number of aspects without room.
            if y + rows > bottom || (y + rows == bottom && left > 1) {
                let wrong = ranked[index..].iter().filter(|&&aspect| self.held[aspect].is_false()).count();
                let more = match wrong {
                    0 => format!("{} {left} more are as they should be", brush.theme.signs().ellipsis),
                    _ => format!("{} {left} more, {wrong} of them wrong", brush.theme.signs().ellipsis),
                };
                let style = brush.style(if wrong > 0 { TextRole::FalseBelief } else { TextRole::Quiet });
                if y < bottom {
                    brush.text(x, y, columns, &more, style);
                }
                return;
            }
            match columns {
                columns if columns >= ONE_LINE => self.row(brush, aspect, x, y, columns),
                _ => self.narrow(brush, aspect, x, y, columns),
            }
            y += rows;
        }
    }

    /// Draws the column headings of [`Panel::row`].
    fn headings(&self, brush: &mut Painter, x: u16, y: u16, columns: u16) {
        let Widths { name, word, bar } = self.widths(columns);
        let quiet = brush.style(TextRole::Quiet);
        let believed = x + name + 1;
        let truth = believed + word + bar + 6;
        brush.text(believed, y, word, "believed", quiet);
        brush.text(truth, y, word, "in truth", quiet);
        brush.text_right(truth + word + 7, y, 6, "wrong", quiet);
        if columns >= WITH_COURSE {
            brush.text_right(x + columns, y, COURSE, "30 s", quiet);
        }
    }

    /// Draws an aspect in one line: name, believed value, probability, true value, duration of the false belief, curve.
    fn row(&self, brush: &mut Painter, aspect: usize, x: u16, y: u16, columns: u16) {
        let with_course = columns >= WITH_COURSE;
        let Widths { name, word, bar } = self.widths(columns);
        let held = self.held[aspect];
        let (role, quiet) = (self.role(aspect), brush.style(TextRole::Quiet));
        let style = brush.style(role);
        brush.text(x, y, name, &self.name(aspect), if held.is_false() { style } else { quiet });
        let mut at = x + name + 1;
        brush.text(at, y, word, self.label(aspect, usize::from(held.believes)), style);
        at += word + 1;
        brush.bar(at, y, bar, f64::from(held.p), role);
        at += bar + 1;
        brush.text(at, y, 4, &share(held.p), style);
        at += 4;
        let truth_style = if held.is_false() { brush.style(TextRole::Text) } else { quiet };
        brush.text(at, y, word, self.truth(aspect), truth_style);
        at += word + 1;
        self.since(brush, aspect, at, y);
        if with_course {
            self.curve(brush, aspect, Rect::new(x + columns - COURSE, y, COURSE, 1), COURSE_S / 2.0);
        }
    }

    /// Lines about a false belief below the name: believed and true value, on separate lines if they do not fit into one.
    fn told(&self, aspect: usize, columns: u16) -> Vec<String> {
        let whole = self.against_truth(aspect);
        let room = columns.saturating_sub(2);
        match whole.split_once("; ") {
            Some((believed, truth)) if width(&whole) > room => vec![believed.to_string(), truth.to_string()],
            _ => vec![whole],
        }
    }

    /// Draws an aspect in a narrow panel: a false belief in lines below its name, a right belief in one line.
    fn narrow(&self, brush: &mut Painter, aspect: usize, x: u16, y: u16, columns: u16) {
        let held = self.held[aspect];
        let role = self.role(aspect);
        let style = brush.style(role);
        let quiet = brush.style(TextRole::Quiet);
        let right = x + columns;
        let bar = right.saturating_sub(15);
        brush.text(bar + 5, y, 4, &share(held.p), style);
        self.since(brush, aspect, bar + 9, y);
        let (name, believed) = (self.name(aspect), self.label(aspect, usize::from(held.believes)));
        let mut room = columns.saturating_sub(16);
        // Names have priority over the bar, since the number shows the same.
        if held.is_false() || width(&name) + 1 + width(believed) <= room {
            brush.bar(bar, y, 4, f64::from(held.p), role);
        } else {
            room += 5;
        }
        if !held.is_false() {
            // The name has priority over the value of a right belief.
            let name = fit(&name, room.saturating_sub(6), brush.theme.signs().ellipsis);
            let end = brush.text(x, y, room, &name, quiet) + 1;
            brush.text(end, y, (x + room).saturating_sub(end), believed, style);
            return;
        }
        brush.text(x, y, room, &name, style);
        let text = brush.style(TextRole::Text);
        for (row, line) in self.told(aspect, columns).iter().enumerate() {
            brush.text(x + 2, y + 1 + row as u16, columns.saturating_sub(2), line, text);
        }
    }

    /// Duration of the false belief, or a mark that the gaze has just been there.
    fn since(&self, brush: &mut Painter, aspect: usize, x: u16, y: u16) {
        if belief_track::read_at(self.moments, aspect, self.now).is_some() {
            let style = brush.style(TextRole::Gaze);
            let sign = brush.theme.signs().gaze;
            brush.text(x, y, 1, sign, style);
        }
        if let Some(since) = belief_track::wrong_since(self.moments, aspect) {
            let style = brush.style(TextRole::FalseBelief);
            let age = self.session.age(since, self.now).to_string();
            brush.text_right(x + 6, y, 5, &age, style);
        }
    }

    /// The few lines of a small screen: the worst beliefs, or one over time.
    fn lines(&self, brush: &mut Painter, x: u16, y: u16, columns: u16, rows: u16) {
        let quiet = brush.style(TextRole::Quiet);
        brush.text(x, y, columns, " belief   ", quiet);
        let (x, columns) = (x + 10, columns.saturating_sub(11));
        if let Some(focus) = self.focus {
            return self.chart(brush, focus, x, y, columns, rows);
        }
        let wrong: Vec<usize> =
            belief_track::ranked(self.moments).into_iter().filter(|&aspect| self.held[aspect].is_false()).collect();
        if wrong.is_empty() {
            brush.text(x, y, columns, "nothing is estimated to be believed wrong", quiet);
        }
        for (row, &aspect) in wrong.iter().take(usize::from(rows)).enumerate() {
            let (held, y) = (self.held[aspect], y + row as u16);
            let more = wrong.len() - row - 1;
            let is_last = row as u16 + 1 == rows && more > 0;
            let note = if is_last { format!("+{more}  ") } else { String::new() };
            let age = belief_track::wrong_since(self.moments, aspect).map(|since| self.session.age(since, self.now));
            let end = format!("{note}{} {:>5}", share(held.p), age.unwrap_or_default().to_string());
            let style = brush.style(TextRole::FalseBelief);
            brush.text_right(x + columns, y, columns, &end, style);
            let room = columns.saturating_sub(end.len() as u16 + 1);
            let head = format!("{}: ", self.name(aspect));
            let told = self.against_truth(aspect);
            // The truth is what may be told: what is believed gives way to it.
            let told = match told.rsplit_once("; ") {
                Some((believed, truth)) if width(&head) + width(&told) > room => {
                    let left = room.saturating_sub(width(&head) + width(truth) + 2);
                    format!("{}; {truth}", fit(believed, left, brush.theme.signs().ellipsis))
                }
                _ => told,
            };
            brush.text(x, y, room, &format!("{head}{told}"), style);
        }
    }

    /// P(truth) of one aspect over time.
    fn chart(&self, brush: &mut Painter, aspect: AspectId, x: u16, y: u16, columns: u16, rows: u16) {
        let held = self.held[aspect.index()];
        let quiet = brush.style(TextRole::Quiet);
        let p = share(held.p_truth);
        let title = format!("{} is {}", self.name(aspect.index()), self.truth(aspect.index()));
        let end = format!("P(truth) {p}, {COURSE_S:.0} s");
        brush.text_right(x + columns, y, columns, &end, quiet);
        let style = brush.style(self.role(aspect.index()));
        brush.text(x, y, columns.saturating_sub(end.len() as u16 + 1), &title, style);
        if rows > 1 {
            self.curve(brush, aspect.index(), Rect::new(x, y + 1, columns, rows - 1), COURSE_S);
        }
    }

    /// A curve of P(truth) over the last `seconds`, its false stretches in the colour of false beliefs.
    fn curve(&self, brush: &mut Painter, aspect: usize, area: Rect, seconds: f64) {
        let Rect { x, y, width: columns, height: rows } = area;
        let levels = brush.theme.signs().levels;
        let course = belief_track::course(self.moments, aspect, self.now, seconds, usize::from(columns));
        for (column, p) in course.iter().enumerate() {
            let Some(p) = p else { continue };
            let is_false = *p < crate::measures::sequences::FALSE_BELOW;
            let style = brush.style(if is_false { TextRole::FalseBelief } else { TextRole::Quiet });
            // The lowest level is drawn, too: something is known there.
            let height = (p * f64::from(rows) * levels.len() as f64).ceil().max(1.0) as usize;
            for row in 0..rows {
                let below = usize::from(rows - 1 - row) * levels.len();
                if height > below {
                    let level = levels[(height - below).min(levels.len()) - 1];
                    brush.text(x + column as u16, y + row, 1, level, style);
                }
            }
        }
    }

    fn role(&self, aspect: usize) -> TextRole {
        match self.held[aspect] {
            held if held.is_false() => TextRole::FalseBelief,
            held if f64::from(held.p_truth) < DOUBTFUL => TextRole::Text,
            _ => TextRole::Quiet,
        }
    }

    /// "cooking pot"; a recipe by the order that wants it, or else by its dish.
    fn name(&self, aspect: usize) -> String {
        let kitchen = self.kitchen();
        match kitchen.aspects[aspect].kind {
            AspectKind::Location(location) => kitchen.location(location).label(),
            AspectKind::Recipe(dish) => {
                let mut orders = kitchen.wanted(self.session.state).filter(|(_, wanted)| *wanted == dish);
                match orders.next() {
                    Some((order, _)) => format!("recipe of {}", kitchen.location(order).label()),
                    None => format!("recipe {}", kitchen.dish(dish).name),
                }
            }
        }
    }

    fn widths(&self, columns: u16) -> Widths {
        let names = (0..self.held.len()).map(|aspect| width(&self.name(aspect)));
        Widths::fitting(columns, names.max().unwrap_or(0))
    }

    fn label(&self, aspect: usize, value: usize) -> &str {
        &self.kitchen().aspects[aspect].wordings[value]
    }

    /// What is believed against what is. The truth may be what is believed most, and yet not surely enough.
    fn against_truth(&self, aspect: usize) -> String {
        match (self.label(aspect, usize::from(self.held[aspect].believes)), self.truth(aspect)) {
            (believed, truth) if believed == truth => format!("unsure of {truth}"),
            (believed, truth) => format!("{}; is {truth}", phrase(believed)),
        }
    }

    fn truth(&self, aspect: usize) -> &str {
        self.label(aspect, self.kitchen().true_value(self.session.state, AspectId(aspect as u8)))
    }
}

/// The widths of the columns of an aspect in one line.
struct Widths {
    name: u16,
    /// What is believed, and what is true.
    word: u16,
    bar: u16,
}

impl Widths {
    /// Of so many columns in all, with names of at most `longest` columns.
    fn fitting(columns: u16, longest: u16) -> Widths {
        let (course, bar) = if columns >= WITH_COURSE { (COURSE + 1, 6) } else { (0, 4) };
        let text = columns - course - bar - 14;
        let name = longest.min(text * 9 / 20);
        Widths { name, word: (text - name) / 2, bar }
    }
}

/// Below this expected probability of the truth a belief is no longer quiet.
const DOUBTFUL: f64 = 0.8;

/// A share in three columns: ".83", "1.0".
fn share(p: f32) -> String {
    match (p * 100.0).round() as u32 {
        100.. => "1.0".to_string(),
        hundredths => format!(".{hundredths:02}"),
    }
}
