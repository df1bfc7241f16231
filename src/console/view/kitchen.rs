//! The kitchen panel, arranged like the wall display (robot left, shared places in the centre, human right): contents,
//! recent changes, keys of signals and buttons, and the gaze.

use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};

use super::paint::Painter;
use super::regions::{PanelAreas, ScreenSize};
use super::theme::TextRole;
use super::{gaze, offers};
use crate::console::beliefs::EstimatedBelief;
use crate::console::chord::KeyChord;
use crate::console::console_model::ConsoleModel;
use crate::console::key_action::KeyLayer;
use crate::console::kitchen_map::{KitchenMap, KitchenMapBox, KitchenMapElement};
use crate::console::text_columns::{fit, squeeze, width, wrap};
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Agent, ButtonAction, ButtonId, Kitchen, LocationId, LocationKind, OrderContent};
use tomcom_session::Session;
use tomcom_session::history::wording;
use tomcom_session::order_needs::OrderNeeds;
use tomcom_session::settings::Condition;

/// Short text in place of the falsely believed value, where there is no room for that value.
const FALSE_BELIEF: &str = "false belief";
/// Time for which a changed content is marked, in seconds.
const FRESH_S: f64 = 5.0;
/// Times after a change, in seconds, for which the content is underlined, and for which it is bold.
const LOUD_S: f64 = 1.2;
const FADING_S: f64 = 3.0;

pub fn draw(
    brush: &mut Painter,
    regions: &PanelAreas,
    session: &Session,
    model: &ConsoleModel,
    believed: &[EstimatedBelief],
) {
    if regions.kitchen.area() == 0 && regions.orders.area() == 0 {
        return;
    }
    if regions.screen_size > ScreenSize::Small {
        frames(brush, regions, session, model);
    }
    let areas = regions.kitchen_inside();
    let plan = KitchenMap::for_session(session, model.coding.is_some(), areas);
    if regions.kitchen.area() > 0 {
        zones(brush, &plan);
    }
    // Whoever plays the participant at this keyboard has to remember the recipes.
    let needs = match model.layer {
        KeyLayer::Wizard => session.order_needs(),
        KeyLayer::Participant => Vec::new(),
    };
    let plate = session.kitchen.plate;
    let on_plate = &session.kitchen.content(session.state.content(plate)).items;
    let is_for = |needs: &OrderNeeds| on_plate.iter().all(|&on| needs.items.iter().any(|needed| needed.item == on));
    let is_known = model.layer == KeyLayer::Wizard;
    let blocked = Some(plate).filter(|_| is_known && !on_plate.is_empty() && !needs.iter().any(is_for));
    let offered = offers::shown(session, model).and_then(|offer| offer.place(session));
    for spot in &plan.spots {
        match spot.thing {
            KitchenMapElement::Location(location) => {
                let place = Place::new(session, model, location);
                let thinks = offers::thinks(session, believed, location);
                let is_blocked = blocked == Some(location);
                let place = Place { thinks, is_offered: offered == Some(location), is_blocked, ..place };
                match session.kitchen.location(location).kind {
                    LocationKind::Order => {
                        place.draw_order(brush, spot, needs.iter().find(|needs| needs.order == location));
                    }
                    _ => place.draw(brush, spot),
                }
            }
            KitchenMapElement::Storage(index) => storage(brush, session, model, index, spot.cells),
        }
    }
    gaze::mark(brush, &plan, areas, session, model);
    gaze::draw_target(brush, &plan, areas.places, session);
}

/// Draws the frames of orders and kitchen, with what their keys do and what their signs mean.
fn frames(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let keys = match model.layer {
        KeyLayer::Wizard if model.coding.is_some() => "[key] codes a false belief",
        KeyLayer::Wizard if model.playback.is_some() => "",
        KeyLayer::Wizard if session.spec.trial.condition == Condition::None => "nobody sends signals",
        KeyLayer::Wizard if session.spec.trial.condition == Condition::Assistant => "the assistant sends the signals",
        KeyLayer::Wizard => "[key] sends a signal",
        KeyLayer::Participant => "[key] presses the button",
    };
    let signs = brush.theme.signs();
    let there = match model.layer {
        KeyLayer::Wizard => format!("{} there  {} in work  {} to do", signs.served, signs.in_work, signs.missing),
        KeyLayer::Participant => String::new(),
    };
    if regions.orders.area() > 0 {
        brush.panel(regions.orders, "Orders", &there);
    }
    if regions.kitchen.area() > 0 {
        let gaze = format!("  {} gaze", signs.gaze);
        let unseen =
            if model.layer == KeyLayer::Wizard { format!("  {} changed unseen", signs.changed) } else { String::new() };
        let remark = [(keys, TextRole::Quiet), (&gaze, TextRole::Gaze), (&unseen, TextRole::Gaze)];
        brush.panel_with(regions.kitchen, &session.kitchen.title, &remark);
    }
}

fn zones(brush: &mut Painter, plan: &KitchenMap) {
    for zone in &plan.zones {
        let (name, role) = match zone.owner {
            Some(Agent::Human) => ("HUMAN", TextRole::Human),
            Some(Agent::Robot) => ("ROBOT", TextRole::Robot),
            None => ("SHARED", TextRole::Quiet),
        };
        let line = zone.cells.width.saturating_sub(1);
        let rule = brush.theme.signs().frame[4].repeat(usize::from(line));
        brush.text(zone.cells.x, zone.cells.y, line, &rule, TextRole::Frame);
        let label = format!(" {name} ");
        let x = zone.cells.x + (line.saturating_sub(width(&label))) / 2;
        let style = brush.style(role).add_modifier(Modifier::BOLD).remove_modifier(Modifier::DIM);
        brush.styled(x, zone.cells.y, line, &label, style);
    }
}

fn storage(brush: &mut Painter, session: &Session, model: &ConsoleModel, index: usize, cells: Rect) {
    let storage = &session.kitchen.storages[index];
    let is_it = |action: ButtonAction| action == ButtonAction::Take(storage.item);
    let key = participant_key(session, model, storage.agent, is_it);
    let x = match key {
        Some(key) => badge(brush, cells.x, cells, key, TextRole::Human),
        None => cells.x,
    };
    let end = brush.text(x + 1, cells.y, cells.right().saturating_sub(x + 1), &storage.label, TextRole::Text);
    if let Some(key) = key {
        brush.key_target(cells.x, cells.y, end, key);
    }
}

fn badge(brush: &mut Painter, x: u16, cells: Rect, key: KeyChord, role: TextRole) -> u16 {
    let style = brush.style(role).add_modifier(Modifier::BOLD);
    brush.styled(x, cells.y, cells.right().saturating_sub(x), &format!("[{key}]"), style)
}

/// Key of the first button of an agent that satisfies `is_it`, while the participant's keys are active.
fn participant_key(
    session: &Session,
    model: &ConsoleModel,
    agent: Agent,
    is_it: impl Fn(ButtonAction) -> bool,
) -> Option<KeyChord> {
    if model.layer != KeyLayer::Participant || agent != Agent::Human {
        return None;
    }
    let index = session.kitchen.buttons[Agent::Human.index()].iter().position(|button| is_it(button.action))?;
    model.keys.of_button(ButtonId(index as u8))
}

fn agent_role(agent: Option<Agent>) -> TextRole {
    match agent {
        Some(Agent::Human) => TextRole::Human,
        Some(Agent::Robot) => TextRole::Robot,
        None => TextRole::Strong,
    }
}

/// Box of a kitchen location: a vertical rule that shows the location's state, then key, name and content.
pub(super) struct Place<'a> {
    pub session: &'a Session,
    pub model: &'a ConsoleModel,
    pub id: LocationId,
    kitchen: &'a Kitchen,
    pub content: String,
    is_empty: bool,
    /// Seconds since a recent change of the location's content, and the agent that changed it.
    fresh: Option<(f64, Option<Agent>)>,
    pub is_shown: bool,
    is_offered: bool,
    /// Whether it is the plate, and holds what belongs to no order.
    pub is_blocked: bool,
    /// What the participant falsely believes about the place, and what is true.
    pub thinks: Option<(String, String)>,
}

impl<'a> Place<'a> {
    fn new(session: &'a Session, model: &'a ConsoleModel, id: LocationId) -> Place<'a> {
        let kitchen = &session.kitchen;
        let content = kitchen.content_label(session.state, id).to_string();
        let is_order = kitchen.location(id).kind == LocationKind::Order;
        let is_empty = match is_order {
            true => session.state.order(id) == OrderContent::None,
            false => session.state.content(id).is_empty(),
        };
        let at = session.changed_at[id.index()];
        let age_s = session.age(at, model.now).as_secs_f64();
        let fresh = (at > SessionTime::ZERO && age_s < FRESH_S).then(|| (age_s, session.changed_by(at)));
        let is_shown = session.shown.as_ref().is_some_and(|shown| shown.location == Some(id));
        let (is_offered, is_blocked, thinks) = (false, false, None);
        Place { session, model, id, kitchen, content, is_empty, fresh, is_shown, is_offered, is_blocked, thinks }
    }

    fn draw(&self, brush: &mut Painter, spot: &KitchenMapBox) {
        let cells = spot.cells;
        if cells.width < 6 || cells.height == 0 {
            return;
        }
        self.rule(brush, cells);
        self.title(brush, cells, spot.right());
        let below = Rect { x: cells.x + 2, y: cells.y + 1, width: cells.width - 2, height: cells.height - 1 };
        if below.height == 0 {
            return;
        }
        let buttons = further_buttons(self.session, self.model, self.id);
        let free = below.height - (buttons.len() as u16).min(below.height - 1);
        let room = Rect { height: free, ..below };
        let mut lines = self.contents(brush, room);
        if self.is_blocked && lines < room.height {
            brush.text(room.x, room.y + lines, room.width, "fits no order", TextRole::Strong);
            lines += 1;
        }
        match buttons.is_empty() {
            true => self.news_and_belief(brush, room, lines),
            false => {
                self.belief(brush, room, lines);
                draw_buttons(brush, below, &buttons);
            }
        }
    }

    /// Draws the vertical rule of the location: heavy while a signal highlights the location, in the agent's colour
    /// after a change.
    pub(super) fn rule(&self, brush: &mut Painter, cells: Rect) {
        let signs = brush.theme.signs();
        let (sign, role) = match (self.is_shown, self.fresh) {
            (true, _) => (signs.rules[2], TextRole::Signal),
            _ if self.is_offered => (signs.rules[1], TextRole::Signal),
            (_, Some((_, by))) => (signs.rules[1], agent_role(by)),
            _ => (signs.rules[0], if self.is_empty { TextRole::Frame } else { TextRole::Quiet }),
        };
        for y in cells.y..cells.bottom() {
            brush.text(cells.x, y, 1, sign, role);
        }
    }

    /// Draws key and name of the location; a long name may fill the gap to the next box, which begins at `right`. Returns
    /// the next column.
    pub(super) fn title(&self, brush: &mut Painter, cells: Rect, right: u16) -> u16 {
        let label = self.kitchen.location(self.id).label();
        let mut x = cells.x + 1;
        if let Some((key, role)) = self.key() {
            x = badge(brush, x, cells, key, role);
        }
        let style = match self.is_shown {
            true => brush.style(TextRole::Signal).add_modifier(Modifier::UNDERLINED),
            false if self.is_offered => brush.style(TextRole::Signal),
            false => brush.style(if self.is_empty { TextRole::Quiet } else { TextRole::Text }),
        };
        let label = if width(&label) < cells.right().saturating_sub(x) { format!(" {label}") } else { label };
        let end = brush.styled(x, cells.y, right.saturating_sub(x), &label, style);
        if let Some((key, _)) = self.key() {
            brush.key_target(cells.x, cells.y, end, key);
        }
        end
    }

    /// Whether the location's box marks that the participant has not seen the last change; the mark is for the wizard,
    /// not for a participant at this keyboard.
    pub(super) fn is_unseen(&self) -> bool {
        self.model.layer == KeyLayer::Wizard && self.session.is_unseen(self.id)
    }

    /// What is told of an unseen change, in words and as a sign: while no usable gaze comes, nobody knows whether the
    /// participant saw it.
    pub(super) fn unseen(&self, brush: &Painter) -> (&'static str, &'static str) {
        let signs = brush.theme.signs();
        match gaze::is_known(self.session, self.model.now) {
            true => ("unseen", signs.changed),
            false => ("gaze unknown", signs.unknown),
        }
    }

    /// The key of this location in the active layer (wizard's or participant's keys).
    fn key(&self) -> Option<(KeyChord, TextRole)> {
        match self.model.layer {
            KeyLayer::Wizard => {
                let sends = self.session.spec.trial.condition == Condition::Wizard || self.model.playback.is_some();
                let key = self.model.keys.of_signal(self.id).filter(|_| sends);
                let key = key.or_else(|| self.model.keys.of_belief(self.id));
                key.map(|key| (key, TextRole::Signal))
            }
            KeyLayer::Participant => {
                let main = |action| matches!(action, ButtonAction::Use(at) | ButtonAction::Serve(at) if at == self.id);
                participant_key(self.session, self.model, Agent::Human, main).map(|key| (key, TextRole::Human))
            }
        }
    }

    pub(super) fn content_style(&self, brush: &Painter) -> Style {
        match self.fresh {
            Some((age_s, by)) if age_s < LOUD_S => {
                brush.style(agent_role(by)).add_modifier(Modifier::BOLD | Modifier::UNDERLINED)
            }
            Some((age_s, by)) if age_s < FADING_S => brush.style(agent_role(by)).add_modifier(Modifier::BOLD),
            Some((_, by)) => brush.style(agent_role(by)),
            None if self.is_empty => brush.style(TextRole::Quiet),
            None => brush.style(TextRole::Strong),
        }
    }

    /// Draws the content of the location; returns the number of lines.
    fn contents(&self, brush: &mut Painter, room: Rect) -> u16 {
        let (style, ellipsis) = (self.content_style(brush), brush.theme.signs().ellipsis);
        let mut lines = wrap(&self.content, room.width);
        if lines.len() > usize::from(room.height) {
            let rest = lines.split_off(usize::from(room.height) - 1).join(" ");
            lines.push(squeeze(&rest, room.width, ellipsis));
        }
        for (row, line) in lines.iter().take(usize::from(room.height)).enumerate() {
            brush.styled(room.x, room.y + row as u16, room.width, line, style);
        }
        lines.len() as u16
    }

    /// Draws the recent change and the false belief below the content, which takes this number of lines. The change
    /// stands first, so that its age is read as the content's, not as the belief's.
    fn news_and_belief(&self, brush: &mut Painter, room: Rect, lines: u16) {
        if lines >= room.height {
            // Change and false belief share the end of the last line; the belief has priority.
            self.belief(brush, room, lines);
            self.news(brush, room, lines);
            return;
        }
        // A belief that takes several lines is shortened rather than that nobody knows when the place changed.
        let own_line = u16::from(lines + u16::from(self.thinks.is_some()) < room.height);
        let has_news = self.news(brush, Rect { height: lines + own_line, ..room }, lines);
        self.belief(brush, room, lines + if has_news { own_line } else { 0 });
    }

    /// Draws the false belief about the location below the first lines, or at the end of the last line if none is free.
    fn belief(&self, brush: &mut Painter, room: Rect, lines: u16) {
        let Some((thinks, _)) = &self.thinks else { return };
        let words = thinks_of(thinks);
        if lines < room.height {
            let rows = wrap(&words, room.width);
            // Half a value would be read as another one.
            let fits = rows.len() <= usize::from(room.height - lines);
            let rows = if fits { rows } else { vec![FALSE_BELIEF.to_string()] };
            for (row, text) in rows.iter().enumerate() {
                brush.text(room.x, room.y + lines + row as u16, room.width, text, TextRole::FalseBelief);
            }
            return;
        }
        let y = room.bottom() - 1;
        let written = (0..room.width).filter(|x| brush.is_written(room.x + x, y)).max().map_or(0, |x| x + 2);
        let left = room.width.saturating_sub(written);
        // If the believed value does not fit, a short text says that there is a false belief; the belief panel has the
        // details.
        let words = [words.as_str(), FALSE_BELIEF].into_iter().find(|words| width(words) <= left).unwrap_or("");
        brush.text(room.x + written, y, left, words, TextRole::FalseBelief);
    }

    /// Draws the robot's next press here and a recent change, below the content or at the end of its last line; returns
    /// whether there is either.
    fn news(&self, brush: &mut Painter, room: Rect, lines: u16) -> bool {
        let signs = brush.theme.signs();
        let mut news: Vec<(String, TextRole)> = Vec::new();
        if let Some((button, _, _)) = self.session.robot.intention
            && wording::place(self.kitchen, Agent::Robot, button) == self.id
            && !self.session.robot.stopped
        {
            news.push((format!("{}robot comes", signs.to), TextRole::Robot));
        }
        // One sign says that the participant has not looked since the change.
        let (words, sign) = self.unseen(brush);
        let unseen = if self.is_unseen() { sign } else { "" };
        match self.fresh {
            // An age beside the robot would be read as its time of arrival.
            _ if !news.is_empty() => news.extend((!unseen.is_empty()).then(|| (unseen.to_string(), TextRole::Gaze))),
            Some((age_s, by)) => {
                let words = by.map(|by| format!("{unseen}{} {age_s:.0} s ago", by.name()));
                let words = words.filter(|words| width(words) <= room.width && lines < room.height);
                news.push((words.unwrap_or(format!("{unseen}{age_s:.0}s")), agent_role(by)));
            }
            None if !unseen.is_empty() => {
                let age = self.session.age(self.session.changed_at[self.id.index()], self.model.now);
                news.push((format!("{}{words} {age}", signs.changed), TextRole::Gaze));
            }
            None => {}
        }
        let has_news = !news.is_empty();
        let y = room.y + lines.min(room.height - 1);
        let needed = news.iter().map(|(text, _)| width(text) + 1).sum::<u16>();
        // Without a free line, the free end of the last line is used.
        let ends = match lines < room.height {
            true => 0,
            false => (0..room.width).filter(|x| brush.is_written(room.x + x, y)).max().map_or(0, |x| x + 2),
        };
        if ends + needed > room.width {
            news.retain(|(_, role)| *role != TextRole::Robot || ends + needed <= room.width);
        }
        let mut x = if lines < room.height { room.x } else { room.right().saturating_sub(needed) };
        for (text, role) in news {
            if x >= room.x + ends && x + width(&text) <= room.right() {
                x = brush.text(x, y, width(&text), &text, role) + 1;
            }
        }
        has_news
    }
}

fn thinks_of(thought: &str) -> String {
    format!("thinks: {thought}")
}

/// Key and name of each further button at a place; none while the wizard's keys are active.
pub(super) fn further_buttons(session: &Session, model: &ConsoleModel, place: LocationId) -> Vec<(KeyChord, String)> {
    if model.layer != KeyLayer::Participant {
        return Vec::new();
    }
    let kitchen = &session.kitchen;
    let hand = kitchen.hands[Agent::Human.index()];
    let is_here = |action: ButtonAction| match action {
        ButtonAction::Process(process) => kitchen.processes[usize::from(process)].place.unwrap_or(hand) == place,
        ButtonAction::Trash => place == hand,
        _ => false,
    };
    let buttons = kitchen.buttons[Agent::Human.index()].iter().enumerate();
    let with_key = buttons.filter(|(_, button)| is_here(button.action)).filter_map(|(index, button)| {
        let key = model.keys.of_button(ButtonId(index as u8))?;
        Some((key, button.name.replace('_', " ")))
    });
    with_key.collect()
}

/// Draws the buttons one per line from the lower edge of the place's box upwards, or all in the last line if the box is
/// too low.
pub(super) fn draw_buttons(brush: &mut Painter, room: Rect, buttons: &[(KeyChord, String)]) {
    let style = brush.style(TextRole::Human).add_modifier(Modifier::BOLD);
    let count = buttons.len() as u16;
    for (index, (key, name)) in buttons.iter().enumerate() {
        let index = index as u16;
        let (x, y, columns) = match room.height > count {
            true => (room.x, room.bottom() - count + index, room.width),
            false => (room.x + index * room.width / count, room.bottom() - 1, room.width / count),
        };
        let name = fit(name, columns.saturating_sub(3), brush.theme.signs().ellipsis);
        let end = brush.styled(x, y, columns, &format!("[{key}]{name}"), style);
        brush.key_target(x, y, end, *key);
    }
}
