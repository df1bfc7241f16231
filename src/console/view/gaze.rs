//! The gaze: its panel, its map, its mark in the kitchen, and its accuracy check.

use crossterm::event::KeyCode;
use ratatui::layout::Rect;
use ratatui::style::Modifier;

use super::dialog::open;
use super::paint::Painter;
use super::regions::{PanelAreas, ScreenSize};
use super::theme::TextRole;
use crate::console::chord::KeyChord;
use crate::console::console_model::{ConsoleModel, TRAIL_S};
use crate::console::gaze_check::{AS_IT_IS, AccuracyCheckAction, CORRECTED, REPEAT, chosen};
use crate::console::key_action::KeyLayer;
use crate::console::kitchen_map::{KitchenMap, KitchenMapAreas};
use crate::console::text_columns::{fit, width};
use tomcom_core::base::text::count;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::calibration::{GOOD_DEG, GazeAccuracy, USABLE_DEG};
use tomcom_core::gaze::{MIN_CONFIDENCE, nearest_location};
use tomcom_core::kitchen::LocationId;
use tomcom_session::gaze_samples::{LOST_S, faults};
use tomcom_session::settings::GazeSource;
use tomcom_session::tracker::DeviceConnection;
use tomcom_session::{Session, TrialPhase};

/// Time for which the last gaze sample is drawn, in seconds.
const GAZE_S: f64 = 3.0;
/// Longest time since the last gaze sample for which the participant counts as looking there now, in seconds.
const NOW_S: f64 = 0.2;

/// Draws the gaze panel: place and age of the gaze, and what is wrong with its samples.
pub fn draw(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let area = regions.gaze;
    if area.area() == 0 {
        return;
    }
    if regions.screen_size == ScreenSize::Small {
        brush.text(area.x, area.y, area.width, " gaze     ", TextRole::Quiet);
        line(brush, area.x + 10, area.y, area.width.saturating_sub(11), session, model, true);
        return;
    }
    let source = session.spec.participant.gaze.entry().name;
    // The gaze panel shows only the most frequent fault; the preflight checks and the summaries show all.
    let worst = faults(session).into_iter().max_by_key(|(samples, _)| *samples);
    let rejected = Some(model.rejected_senders).filter(|senders| *senders > 0);
    let rejected = rejected.map(|senders| format!(", {} rejected", count(senders, "sender", "senders")));
    let told = worst.map(|(samples, kind)| format!(", {samples} {kind}")).into_iter().chain(rejected);
    let remark = format!("{source}{}", told.collect::<String>());
    let inside = brush.panel(area, "Gaze", &remark);
    let (x, columns) = (inside.x + 1, inside.width.saturating_sub(2));
    let is_low = inside.height < 2;
    line(brush, x, inside.y, columns, session, model, is_low);
    if is_low {
        return;
    }
    if let Some(loss) = GazeLoss::now(session, model.now) {
        let why = loss.why(session, model);
        let share = 100.0 * session.gaze.unusable as f64 / session.gaze.samples.max(1) as f64;
        let whole = format!("{why}; {share:.0} % of all samples");
        let fits = loss.cause == GazeLossCause::Unusable && width(&whole) <= columns;
        let told = if fits { whole } else { why };
        brush.text(x, inside.y + 1, columns, &told, TextRole::Text);
    } else if let Some(code) = pairing(session, model) {
        brush.text(x, inside.y + 1, columns, &code, TextRole::Text);
    }
}

/// The code that gaze senders at other computers need, while no gaze arrives.
fn pairing(session: &Session, model: &ConsoleModel) -> Option<String> {
    model.gaze_pairing.as_ref().and_then(|pairing| pairing.line(session, model.now))
}

/// Draws in one line where the participant looks, or how long no gaze is of use, and on request why.
fn line(brush: &mut Painter, x: u16, y: u16, columns: u16, session: &Session, model: &ConsoleModel, says_why: bool) {
    let last = session.gaze.last.map(|(at, sample)| (at, place(session, [sample.x, sample.y])));
    if let Some(loss) = GazeLoss::now(session, model.now) {
        let lost = loss.words(model.now);
        let why = if says_why { format!(": {}", loss.why(session, model)) } else { String::new() };
        let last = last.map_or(String::new(), |(_, place)| format!("; last: {place}"));
        brush.parts(x, y, columns, &[(&lost, TextRole::Alarm), (&why, TextRole::Text), (&last, TextRole::Quiet)]);
        return;
    }
    let Some((at, place)) = last else {
        let words = if session.gaze.samples > 0 { "no usable gaze so far" } else { "no gaze sample so far" };
        let code = pairing(session, model).filter(|_| says_why).map_or(String::new(), |code| format!("   {code}"));
        brush.parts(x, y, columns, &[(words, TextRole::Quiet), (&code, TextRole::Text)]);
        return;
    };
    let age_s = model.now.secs_since(at);
    if age_s > LOST_S {
        brush.parts(x, y, columns, &[("last: ", TextRole::Quiet), (&place, TextRole::Quiet)]);
        return;
    }
    let age = if age_s < NOW_S { ", now".to_string() } else { format!(", {age_s:.1} s ago") };
    let room = columns.saturating_sub(width(&age));
    let sign = format!("{} ", brush.theme.signs().gaze);
    let end = brush.parts(x, y, room, &[(&sign, TextRole::Gaze), (&place, TextRole::Gaze)]);
    brush.text(end, y, width(&age), &age, TextRole::Quiet);
}

/// The place of a point of the display, in words.
fn place(session: &Session, at_m: [f64; 2]) -> String {
    let kitchen = &session.kitchen;
    let storage = kitchen.storages.iter().find(|storage| storage.display.distance_m(at_m, kitchen.display_m) == 0.0);
    match (nearest_location(kitchen, at_m), storage) {
        (Some((location, 0.0)), _) => kitchen.location(location).label(),
        (_, Some(storage)) => format!("storage of {}", storage.label),
        (Some((location, distance_m)), None) => {
            format!("{:.0} cm from {}", (distance_m * 100.0).max(1.0), kitchen.location(location).label())
        }
        (None, None) => "on the display".to_string(),
    }
}

/// Whether it is known where the participant looked lately.
pub(super) fn is_known(session: &Session, now: SessionTime) -> bool {
    session.gaze.last.is_some_and(|(at, _)| session.age(at, now).as_secs_f64() <= GAZE_S)
}

/// That no gaze is of use now, although it should be: the same for head line, gaze panel and beliefs.
pub(super) struct GazeLoss {
    cause: GazeLossCause,
    /// Of the last usable sample, or when the tracker was lost.
    pub(super) since: Option<SessionTime>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum GazeLossCause {
    NoTracker,
    NoDisplayTags,
    Unusable,
    Silence,
}

impl GazeLoss {
    /// `None` while usable samples arrive, and while none have to: before and after the trial, and in a pause of gaze that
    /// comes from no tracker.
    pub(super) fn now(session: &Session, now: SessionTime) -> Option<GazeLoss> {
        let source = session.spec.participant.gaze;
        if source == GazeSource::None {
            return None;
        }
        let last = session.gaze.last.map(|(at, _)| at);
        let loss = |cause, since: Option<SessionTime>| Some(GazeLoss { cause, since });
        match (&session.tracker.link, session.tracker.sees_display) {
            (DeviceConnection::Lost { since, .. }, _) => return loss(GazeLossCause::NoTracker, last.or(Some(*since))),
            (DeviceConnection::Unknown, _) if matches!(source, GazeSource::Pupil | GazeSource::Lsl) => {
                return loss(GazeLossCause::NoTracker, last);
            }
            (DeviceConnection::Connected { .. }, Some(false)) => return loss(GazeLossCause::NoDisplayTags, last),
            _ => {}
        }
        let goes_on =
            session.phase == TrialPhase::Paused && !matches!(source, GazeSource::Simulated | GazeSource::Mouse);
        match session.gaze_hz(now) {
            _ if last.is_some_and(|at| now.secs_since(at) <= LOST_S) => None,
            Some(_) => loss(GazeLossCause::Unusable, last),
            None => loss(GazeLossCause::Silence, last).filter(|_| session.is_running() || goes_on),
        }
    }

    fn lost(&self) -> &'static str {
        match self.cause {
            GazeLossCause::NoTracker => "no tracker",
            GazeLossCause::NoDisplayTags => "no display tags",
            GazeLossCause::Unusable => "gaze unusable",
            GazeLossCause::Silence => "no gaze",
        }
    }

    /// "no gaze for 26 s".
    pub(super) fn words(&self, now: SessionTime) -> String {
        let lost = self.lost();
        self.since.map_or(lost.to_string(), |since| format!("{lost} for {:.0} s", now.secs_since(since)))
    }

    /// "NO GAZE 26 s".
    pub(super) fn capitals(&self, now: SessionTime) -> String {
        let lost = self.lost().to_uppercase();
        self.since.map_or(lost.clone(), |since| format!("{lost} {:.0} s", now.secs_since(since)))
    }

    fn why(&self, session: &Session, model: &ConsoleModel) -> String {
        match (self.cause, session.gaze.latest_unusable, &session.tracker.link) {
            (GazeLossCause::NoTracker, _, DeviceConnection::Lost { reason, .. }) => reason.clone(),
            (GazeLossCause::NoTracker, ..) => "it has not answered yet".to_string(),
            (GazeLossCause::NoDisplayTags, ..) => "the tracker does not detect them".to_string(),
            (GazeLossCause::Unusable, Some(sample), _) if sample.confidence < MIN_CONFIDENCE => {
                format!("confidence {:.2} < {MIN_CONFIDENCE}", sample.confidence)
            }
            (GazeLossCause::Unusable, Some(sample), _) => format!("beside display ({:.1}, {:.1})", sample.x, sample.y),
            (GazeLossCause::Unusable, None, _) => "faulty samples".to_string(),
            (GazeLossCause::Silence, ..) => {
                let is_closed = model.gaze_closed.is_some_and(|at| session.gaze.arrived.is_none_or(|last| last <= at));
                let silent = if is_closed { "its sender closed the connection" } else { "no samples arrive" };
                pairing(session, model).unwrap_or(silent.to_string())
            }
        }
    }
}

/// Draws the gaze map: the wall display to scale with the trail of recent gaze, and the time since the last look at
/// each place.
pub fn draw_map(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    if regions.gaze_map.area() == 0 {
        return;
    }
    let inside = brush.panel(regions.gaze_map, "Gaze map", "seconds since the last look");
    let cell = |point: [f64; 2]| {
        let along = |value: f64, low: u16, length: u16| low + (value.clamp(0.0, 0.999) * f64::from(length)) as u16;
        (along(point[0], inside.x, inside.width), along(point[1], inside.y, inside.height))
    };
    let signs = brush.theme.signs();
    for (at, sample) in &model.trail {
        if model.now.secs_since(*at) < TRAIL_S {
            let (x, y) = cell([sample.x, sample.y]);
            brush.text(x, y, 1, signs.trail, TextRole::Gaze);
        }
    }
    let mut labels: Vec<Rect> = Vec::new();
    let latest = session.gaze.last.filter(|(at, _)| model.now.secs_since(*at) < NOW_S);
    let latest = latest.map(|(at, sample)| sample.taken(at));
    for (index, location) in session.kitchen.locations.iter().enumerate() {
        let (x, y) = cell(location.display.centre());
        let seen = session.gaze.looked_at[index].map(|at| session.age(at, model.now).as_secs_f64());
        let y = y.min(inside.bottom().saturating_sub(2));
        let key = model.keys.of_signal(LocationId(index as u8)).filter(|_| model.layer == KeyLayer::Wizard);
        let label = match key {
            Some(key) => format!("[{key}]"),
            None => fit(&location.label(), 6, brush.theme.signs().ellipsis),
        };
        let (age, role) = match seen {
            // Only the place of the latest gaze sample is looked at now.
            Some(_) if latest.is_some() && session.gaze.looked_at[index] == latest => {
                ("now".to_string(), TextRole::Gaze)
            }
            Some(age_s) if age_s < 1.0 => (format!("{age_s:.1}s"), TextRole::Text),
            Some(age_s) => (format!("{age_s:.0}s"), TextRole::Text),
            None => ("never".to_string(), TextRole::Quiet),
        };
        // On a small map some places have no room.
        let Some(place) = free(inside, &labels, (x, y), width(&label).max(width(&age))) else { continue };
        labels.push(place);
        for (row, text, role) in [(0, &label, TextRole::Quiet), (1, &age, role)] {
            let margin = (place.width.saturating_sub(width(text))) / 2;
            brush.text(place.x + margin, place.y + row, place.width, text, role);
        }
    }
    if let Some((_, sample)) = session.gaze.last {
        let (x, y) = cell([sample.x, sample.y]);
        // Text under the gaze stays readable: the sign stands in the nearest free cell of the row.
        let is_free = |at: &u16| !labels.iter().any(|label| label.contains((*at, y).into()));
        let near =
            (0..inside.width).flat_map(|by| [x.saturating_sub(by).max(inside.x), (x + by).min(inside.right() - 1)]);
        let x = near.into_iter().find(is_free).unwrap_or(x);
        brush.text(x, y, 1, signs.gaze, TextRole::Gaze);
    }
}

/// A free position for a two-row label of the gaze map: centred at its place, or as few columns beside it as possible, or
/// a row above or below.
fn free(inside: Rect, labels: &[Rect], (x, y): (u16, u16), columns: u16) -> Option<Rect> {
    let last = inside.right().saturating_sub(columns).max(inside.x);
    let lowest = inside.bottom().saturating_sub(2).max(inside.y);
    let at = |shift: i32, down: i32| {
        let x = (i32::from(x) - i32::from(columns / 2) + shift).clamp(inside.x.into(), last.into()) as u16;
        let y = (i32::from(y) + down).clamp(inside.y.into(), lowest.into()) as u16;
        Rect { x, y, width: columns, height: 2.min(inside.bottom().saturating_sub(y)) }
    };
    // Two labels of the gaze map are at least a column apart.
    let is_free = |place: &Rect| {
        labels.iter().all(|label| {
            !Rect { width: label.width + 1, ..*label }.intersects(*place)
                && !Rect { width: place.width + 1, ..*place }.intersects(*label)
        })
    };
    let reach = i32::from(inside.width);
    [0, -1, 1]
        .iter()
        .flat_map(|&down| (0..reach).flat_map(move |by| [(by, down), (-by, down)]))
        .map(|(by, down)| at(by, down))
        .find(is_free)
}

/// Draws the gaze sign where the participant looks. Text under the gaze stays as it is: the sign then stands after the
/// name of the place or, where there is no room, before it.
pub(super) fn mark(
    brush: &mut Painter,
    plan: &KitchenMap,
    areas: KitchenMapAreas,
    session: &Session,
    model: &ConsoleModel,
) {
    let Some((at, sample)) = session.gaze.last else { return };
    let age_s = model.now.secs_since(at);
    let Some((x, y)) = plan.cell([sample.x, sample.y]) else { return };
    if age_s > GAZE_S || ![areas.orders, areas.places].iter().any(|area| area.contains((x, y).into())) {
        return;
    }
    let style = brush.style(TextRole::Gaze);
    let style = if age_s > 1.0 { style.remove_modifier(Modifier::BOLD).add_modifier(Modifier::DIM) } else { style };
    let signs = brush.theme.signs();
    let sign = signs.gaze;
    let is_text = |symbol: &str| symbol != " " && !signs.rules.contains(&symbol) && !signs.frame.contains(&symbol);
    let has_text = |x: u16| brush.buffer.cell((x, y)).is_some_and(|cell| is_text(cell.symbol()));
    // A space between two words counts as text that the gaze sign must not cover.
    let covers_text = has_text(x) || (has_text(x.saturating_sub(1)) && has_text(x + 1));
    let spot = plan.spots.iter().find(|spot| spot.cells.contains((x, y).into())).filter(|_| covers_text);
    let Some(spot) = spot else {
        brush.styled(x, y, 1, sign, style);
        return;
    };
    let cells = spot.cells;
    let is_free = |x: &u16| !brush.is_written(*x, cells.y) && !brush.is_written(x.saturating_sub(1), cells.y);
    let gap = Some(cells.right()).filter(|x| !brush.is_written(*x, cells.y));
    let free = (cells.x + 1..cells.right()).find(is_free).or(gap);
    brush.styled(free.unwrap_or(cells.x), cells.y, 1, sign, style);
}

const COLUMNS: u16 = 76;
/// Column, inside the frame, at which the measured values of the gaze accuracy check begin.
const VALUE: u16 = 15;

/// Draws the present target of the gaze accuracy check in the kitchen panel.
pub fn draw_target(brush: &mut Painter, plan: &KitchenMap, panel: Rect, session: &Session) {
    let Some(check) = &session.calibration else { return };
    let Some(((index, _), point)) = check.shown.zip(check.target()) else { return };
    let Some((x, y)) = plan.cell(point) else { return };
    let text = format!(" + look here: target {} of {} ", index + 1, check.targets.len());
    let columns = width(&text).min(panel.width);
    // The cross is on the target; the instruction stands to its right, or to its left if there is no room.
    let before = if x + columns < panel.right() { 1 } else { columns.saturating_sub(2) };
    let text =
        if before == 1 { text } else { format!(" look here: target {} of {} + ", index + 1, check.targets.len()) };
    let badge = brush.theme.badge(TextRole::Gaze);
    let (x, y) = (x.saturating_sub(before).max(panel.x), y.clamp(panel.y, panel.bottom().saturating_sub(1)));
    brush.styled(x, y, columns, &text, badge);
}

pub fn draw_accuracy_check(brush: &mut Painter, screen: Rect, session: &Session, model: &ConsoleModel) {
    let Some(outcome) = session.calibration.as_ref().and_then(|check| check.result.as_ref()) else { return };
    let inside = open(brush, screen, (COLUMNS, 13), "Gaze accuracy check", "space stops the robot");
    let columns = inside.width.saturating_sub(2);
    let mut y = inside.y + 1;
    let mut line = |brush: &mut Painter, name: &str, text: &str, role: TextRole| {
        brush.text(inside.x + 1, y, VALUE, name, TextRole::Quiet);
        brush.text(inside.x + 1 + VALUE, y, columns.saturating_sub(VALUE), text, role);
        y += 1;
    };
    let esc = KeyChord::plain(KeyCode::Esc);
    let again = format!("enter or {REPEAT}");
    let Some(found) = &outcome.found else {
        line(brush, "accuracy", "not measured: too few usable gaze samples at the targets", TextRole::Alarm);
        line(brush, "fix", "let the participant look at every target; check the tracker", TextRole::Text);
        let hints = [
            (again.as_str(), "repeat the gaze accuracy check", Some(KeyChord::char(REPEAT))),
            ("esc", "cancel the check", Some(esc)),
        ];
        brush.hints(inside.x + 1, inside.bottom().saturating_sub(1), columns, &hints);
        return;
    };
    let (words, role) = verdict(found.accuracy_deg);
    let cm = |deg: f64| deg.to_radians().tan() * session.spec.tracker.distance_m * 100.0;
    line(
        brush,
        "accuracy",
        &format!("{:.2} deg, {:.1} cm on the display: {words}", found.accuracy_deg, cm(found.accuracy_deg)),
        role,
    );
    let (words, role) = verdict(found.corrected_deg);
    line(
        brush,
        "corrected",
        &format!("{:.2} deg, {:.1} cm without the offset: {words}", found.corrected_deg, cm(found.corrected_deg)),
        role,
    );
    line(brush, "precision", &format!("{:.2} deg (RMS between samples)", found.precision_deg), TextRole::Text);
    line(brush, "targets", &accuracy_at_targets(found), TextRole::Text);
    let mistaken = session.calibration.as_ref().and_then(|check| check.mistaken_coordinates(&session.viewing()));
    if let Some(words) = mistaken {
        line(brush, "fix", &format!("{words}, it seems: change what the sender sends"), TextRole::Alarm);
    }
    let taken = chosen(model, Some(found));
    let rows = [
        (CORRECTED, "accept the gaze with its offset subtracted", AccuracyCheckAction::Corrected),
        (AS_IT_IS, "accept the gaze without correction", AccuracyCheckAction::AsItIs),
        (REPEAT, "repeat the gaze accuracy check", AccuracyCheckAction::Repeat),
    ];
    y += 1;
    for (key, does, is) in rows {
        let is_taken = is == taken;
        let (enter, role) = if is_taken { ("enter    ", TextRole::Strong) } else { ("         ", TextRole::Quiet) };
        let words = format!("{key}  ");
        let parts = [(enter, TextRole::Strong), (words.as_str(), TextRole::Strong), (does, role)];
        let end = brush.parts(inside.x + 1, y, columns, &parts);
        // The first click on an action selects it, the next click carries it out.
        let chord = if is_taken { KeyChord::plain(KeyCode::Enter) } else { KeyChord::char(key) };
        brush.key_target(inside.x + 1, y, end, chord);
        y += 1;
    }
    let parts = [("         esc  ", TextRole::Strong), ("cancel: the gaze stays as before", TextRole::Quiet)];
    let end = brush.parts(inside.x + 1, y, columns, &parts);
    brush.key_target(inside.x + 1, y, end, esc);
}

fn verdict(accuracy_deg: f64) -> (&'static str, TextRole) {
    match accuracy_deg {
        deg if deg <= GOOD_DEG => ("good", TextRole::Text),
        deg if deg <= USABLE_DEG => ("usable", TextRole::Strong),
        _ => ("too far off", TextRole::Alarm),
    }
}

/// Measured gaze accuracy at every target, in degrees.
fn accuracy_at_targets(found: &GazeAccuracy) -> String {
    let one = |target: &tomcom_core::gaze::calibration::TargetAccuracy| match target.accuracy_deg {
        Some(deg) => format!("{deg:.1}"),
        None => "no gaze".to_string(),
    };
    let each: Vec<String> = found.targets.iter().map(one).collect();
    format!("{} deg, centre target first", each.join(", "))
}
