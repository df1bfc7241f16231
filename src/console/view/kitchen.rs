//! The kitchen: robot left, shared places in the centre, human right, as on the wall display, with what is everywhere,
//! what just changed, the key of every signal (or button) at its thing, and where the participant looks.

use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};

use super::paint::{Brush, fit, width, wrap};
use super::regions::{Regions, Room, inside};
use super::theme::Role;
use crate::base::time::SessionTime;
use crate::console::arrange::{Plan, Thing};
use crate::console::keys::Layer;
use crate::console::model::Model;
use crate::console::words;
use crate::kitchen::{Action, Agent, ButtonId, Kitchen, LocationId, LocationKind, OrderContent};
use crate::session::Session;
use crate::session::settings::{Condition, ParticipantKind};

/// How long a change is told, in seconds.
const FRESH_S: f64 = 5.0;
/// How long it is told loudly.
const LOUD_S: f64 = 1.2;
/// How long the last gaze is drawn.
const GAZE_S: f64 = 3.0;

/// Draws the kitchen panel.
pub fn draw(brush: &mut Brush, regions: &Regions, session: &Session, model: &Model) {
    let area = regions.kitchen;
    if regions.room > Room::Small {
        let remark = match model.layer {
            Layer::Wizard if model.playback.is_some() => "",
            Layer::Wizard if session.spec.trial.condition == Condition::None => "unassisted: no signals",
            Layer::Wizard => "[key] tells the participant",
            Layer::Participant => "[key] is the participant's button",
        };
        brush.panel(area, &session.kitchen.title, remark);
    }
    let with_keys = session.spec.participant.kind == ParticipantKind::Keyboard;
    let plan = Plan::new(&session.kitchen, regions.kitchen_inside(), with_keys);
    zones(brush, &plan);
    for spot in &plan.spots {
        match spot.thing {
            Thing::Location(location) => Place::new(session, model, location).draw(brush, spot.cells),
            Thing::Storage(index) => storage(brush, session, model, index, spot.cells),
        }
    }
    gaze_mark(brush, &plan, area, session, model);
}

fn zones(brush: &mut Brush, plan: &Plan) {
    for zone in &plan.zones {
        let (name, role) = match zone.owner {
            Some(Agent::Human) => ("HUMAN", Role::Human),
            Some(Agent::Robot) => ("ROBOT", Role::Robot),
            None => ("SHARED", Role::Quiet),
        };
        let line = zone.cells.width.saturating_sub(1);
        let quiet = brush.style(Role::Quiet);
        let rule = brush.theme.signs().frame[4].repeat(usize::from(line));
        brush.text(zone.cells.x, zone.cells.y, line, &rule, quiet);
        let label = format!(" {name} ");
        let x = zone.cells.x + (line.saturating_sub(width(&label))) / 2;
        let style = brush.style(role).add_modifier(Modifier::BOLD).remove_modifier(Modifier::DIM);
        brush.text(x, zone.cells.y, line, &label, style);
    }
}

fn storage(brush: &mut Brush, session: &Session, model: &Model, index: usize, cells: Rect) {
    let storage = &session.kitchen.storages[index];
    let is_it = |action: Action| action == Action::Take(storage.item);
    let key = participant_key(session, model, storage.agent, is_it);
    let text = brush.style(Role::Text);
    let x = match key {
        Some(key) => badge(brush, cells.x, cells, &key, Role::Human),
        None => cells.x,
    };
    brush.text(x + 1, cells.y, cells.right().saturating_sub(x + 1), &storage.label, text);
}

fn badge(brush: &mut Brush, x: u16, cells: Rect, key: &str, role: Role) -> u16 {
    let style = brush.style(role).add_modifier(Modifier::BOLD);
    let label = format!("[{key}]");
    brush.text(x, cells.y, cells.right().saturating_sub(x), &label, style)
}

/// The participant's key of the first of its buttons that `is_it`, while the keys are the participant's.
fn participant_key(session: &Session, model: &Model, agent: Agent, is_it: impl Fn(Action) -> bool) -> Option<String> {
    if model.layer != Layer::Participant || agent != Agent::Human {
        return None;
    }
    let index = session.kitchen.buttons[Agent::Human.index()].iter().position(|button| is_it(button.action))?;
    model.keys.of_button(ButtonId(index as u8)).map(|chord| chord.to_string())
}

fn agent_role(agent: Option<Agent>) -> Role {
    match agent {
        Some(Agent::Human) => Role::Human,
        Some(Agent::Robot) => Role::Robot,
        None => Role::Strong,
    }
}

/// A location's box.
struct Place<'a> {
    session: &'a Session,
    model: &'a Model,
    id: LocationId,
    kitchen: &'a Kitchen,
    /// What lies there, and whether it is nothing.
    content: String,
    is_empty: bool,
    /// Seconds since it changed, if that is not long ago, and who did it.
    fresh: Option<(f64, Option<Agent>)>,
    /// The participant is shown this place.
    is_shown: bool,
}

impl<'a> Place<'a> {
    fn new(session: &'a Session, model: &'a Model, id: LocationId) -> Place<'a> {
        let kitchen = &session.kitchen;
        let content = kitchen.content_label(session.state, id).to_string();
        let is_order = kitchen.location(id).kind == LocationKind::Order;
        let is_empty = match is_order {
            true => session.state.order(id) == OrderContent::None,
            false => session.state.content(id).is_empty(),
        };
        let at = session.changed_at[id.index()];
        let age_s = session.age(at, model.now).as_secs_f64();
        let fresh = (at > SessionTime::ZERO && age_s < FRESH_S).then(|| (age_s, words::changed_by(session, at)));
        let is_shown = session.shown.as_ref().is_some_and(|shown| shown.signal.target() == kitchen.location(id).name);
        Place { session, model, id, kitchen, content, is_empty, fresh, is_shown }
    }

    fn draw(&self, brush: &mut Brush, cells: Rect) {
        if cells.width < 6 || cells.height < 3 {
            return;
        }
        let signs = brush.theme.signs();
        let (frame, style) = match (self.is_shown, self.fresh) {
            (true, _) => (&signs.heavy, brush.style(Role::Signal)),
            (_, Some((_, by))) => (&signs.frame, brush.style(agent_role(by))),
            _ => (&signs.frame, brush.style(if self.is_empty { Role::Quiet } else { Role::Text })),
        };
        brush.frame(cells, frame, style);
        let label_inside = self.title(brush, cells);
        let inner = inside(cells);
        let inner = Rect { x: inner.x + 1, width: inner.width.saturating_sub(1), ..inner };
        let mut y = inner.y;
        if label_inside && inner.height >= 3 {
            let quiet = brush.style(Role::Quiet);
            let label = self.kitchen.location(self.id).label();
            // A name that is too long by a letter takes the margin.
            let margin = u16::from(width(&label) > inner.width);
            let room = inner.width + margin;
            brush.text(inner.x - margin, y, room, &squeeze(&label, room), quiet);
            y += 1;
        }
        let room = Rect { y, height: inner.bottom() - y, ..inner };
        match self.kitchen.location(self.id).kind {
            LocationKind::Order => self.order(brush, room),
            _ => self.contents(brush, room),
        }
        self.bottom(brush, cells);
    }

    /// Key and name in the upper edge; whether the name did not fit there.
    fn title(&self, brush: &mut Brush, cells: Rect) -> bool {
        let end = cells.right() - 1;
        let mut x = cells.x + 1;
        if let Some((key, role)) = self.key() {
            x = badge(brush, x, Rect { width: cells.width - 1, ..cells }, &key, role);
        }
        let label = self.kitchen.location(self.id).label();
        let room = end.saturating_sub(x);
        let style = brush.style(if self.is_shown { Role::Signal } else { Role::Quiet });
        let fits = width(&label) + 2 <= room;
        if fits {
            brush.text(x, cells.y, room, &format!(" {label} "), style);
        } else if cells.height < 5 {
            brush.text(x, cells.y, room, &label, style);
        }
        !fits && cells.height >= 5
    }

    /// The key that acts here, in the active layer.
    fn key(&self) -> Option<(String, Role)> {
        match self.model.layer {
            Layer::Wizard => self.model.keys.of_signal(self.id).map(|chord| (chord.to_string(), Role::Signal)),
            Layer::Participant => {
                let main = |action| matches!(action, Action::Use(at) | Action::Serve(at) if at == self.id);
                participant_key(self.session, self.model, Agent::Human, main).map(|key| (key, Role::Human))
            }
        }
    }

    fn content_style(&self, brush: &Brush) -> Style {
        match self.fresh {
            Some((age_s, by)) if age_s < LOUD_S && !self.is_empty => brush.theme.badge(agent_role(by)),
            Some((_, by)) => brush.style(agent_role(by)).add_modifier(Modifier::BOLD),
            None if self.is_empty => brush.style(Role::Quiet),
            None => brush.style(Role::Strong),
        }
    }

    fn contents(&self, brush: &mut Brush, room: Rect) {
        let style = self.content_style(brush);
        let lines = match room.height {
            1 => vec![squeeze(&self.content, room.width)],
            _ => wrap(&self.content, room.width),
        };
        let shown = usize::from(room.height);
        for (row, line) in lines.iter().take(shown).enumerate() {
            brush.text(room.x, room.y + row as u16, room.width, line, style);
        }
    }

    fn order(&self, brush: &mut Brush, room: Rect) {
        let style = self.content_style(brush);
        let is_wanted = matches!(self.session.state.order(self.id), OrderContent::Dish(_));
        let age = self.session.age(self.session.changed_at[self.id.index()], self.model.now);
        let sign = brush.theme.signs().served;
        let text = match self.session.state.order(self.id) {
            OrderContent::Served => format!("{sign} served"),
            OrderContent::None => "no order".to_string(),
            OrderContent::Dish(_) => self.content.clone(),
        };
        brush.text(room.x, room.y, room.width, &text, style);
        if is_wanted {
            let quiet = brush.style(Role::Text);
            brush.text_right(room.right().saturating_sub(1), room.y, 6, &age.to_string(), quiet);
        }
        if let (true, true, Some(recipe)) = (self.is_shown, room.height > 1, words::recipe(self.session, self.id)) {
            let style = brush.style(Role::Signal);
            brush.text(room.x, room.y + 1, room.width, &squeeze(&recipe, room.width), style);
        }
    }

    /// The lower edge: what the robot is about to do here, what just changed, and the participant's other buttons.
    fn bottom(&self, brush: &mut Brush, cells: Rect) {
        let y = cells.bottom() - 1;
        let buttons = self.other_buttons();
        if !buttons.is_empty() {
            self.draw_buttons(brush, cells, &buttons);
            return;
        }
        let room = cells.width.saturating_sub(2);
        let mut x = cells.x + 1;
        let signs = brush.theme.signs();
        if let Some((button, _, _)) = self.session.robot.intention
            && words::place(self.kitchen, Agent::Robot, button) == self.id
            && !self.session.robot.stopped
        {
            let style = brush.style(Role::Robot);
            x = brush.text(x, y, room, &format!("{}robot ", signs.to), style);
        }
        if let Some((age_s, by)) = self.fresh {
            let style = brush.style(agent_role(by));
            let label = format!("{}{age_s:.0}s", signs.changed);
            if x + width(&label) < cells.right() {
                brush.text_right(cells.right() - 1, y, room, &label, style);
            }
        }
    }

    /// One button a line, from the lower edge upwards; where the box is too low for that, all in the edge.
    fn draw_buttons(&self, brush: &mut Brush, cells: Rect, buttons: &[(String, String)]) {
        let style = brush.style(Role::Human).add_modifier(Modifier::BOLD);
        let count = buttons.len() as u16;
        let room = cells.width.saturating_sub(2);
        for (index, (key, name)) in buttons.iter().enumerate() {
            let index = index as u16;
            let (x, y, room) = match cells.height > 3 {
                true => (cells.x + 1, cells.bottom() - count + index, room),
                false => (cells.x + 1 + index * room / count, cells.bottom() - 1, room / count),
            };
            let name = fit(name, room.saturating_sub(3), "");
            brush.text(x, y, room, &format!("[{key}]{name}"), style);
        }
    }

    /// The participant's buttons that act here beside the main one, processes and the hand's bin: key and name.
    fn other_buttons(&self) -> Vec<(String, String)> {
        if self.model.layer != Layer::Participant {
            return Vec::new();
        }
        let hand = self.kitchen.hands[Agent::Human.index()];
        let is_here = |action: Action| match action {
            Action::Process(process) => self.kitchen.processes[usize::from(process)].place.unwrap_or(hand) == self.id,
            Action::Trash => self.id == hand,
            _ => false,
        };
        let buttons = self.kitchen.buttons[Agent::Human.index()].iter().enumerate();
        let with_key = buttons.filter(|(_, button)| is_here(button.action)).filter_map(|(index, button)| {
            let key = self.model.keys.of_button(ButtonId(index as u8))?;
            Some((key.to_string(), button.name.replace('_', " ")))
        });
        with_key.collect()
    }
}

/// A name in a single line: first the spaces go, then the ends of the longest words.
pub fn squeeze(name: &str, columns: u16) -> String {
    let mut words: Vec<String> = name.replace(" + ", " +").split(' ').map(str::to_string).collect();
    if width(name) <= columns {
        return name.to_string();
    }
    while width(&words.join(" ")) > columns {
        let Some(longest) = words.iter_mut().max_by_key(|word| word.chars().count()) else { break };
        if longest.chars().count() <= 2 {
            break;
        }
        longest.pop();
    }
    fit(&words.join(" "), columns, "")
}

fn gaze_mark(brush: &mut Brush, plan: &Plan, panel: Rect, session: &Session, model: &Model) {
    let Some((at, sample)) = session.gaze.last else { return };
    let age_s = model.now.secs_since(at);
    let Some((x, y)) = plan.cell([sample.x, sample.y]) else { return };
    if age_s > GAZE_S || x < panel.x || x >= panel.right() || y < panel.y || y >= panel.bottom() {
        return;
    }
    let style = brush.style(Role::Gaze);
    let style = if age_s > 1.0 { style.remove_modifier(Modifier::BOLD).add_modifier(Modifier::DIM) } else { style };
    let sign = brush.theme.signs().gaze;
    let is_text = |symbol: &str| symbol.chars().any(|letter| letter.is_alphanumeric());
    let covers_text = brush.buffer.cell((x, y)).is_some_and(|cell| is_text(cell.symbol()));
    if !covers_text {
        brush.text(x, y, 1, sign, style);
        return;
    }
    // A word under the gaze stays readable: its letter is marked, and the sign goes to the box's corner.
    brush.buffer.set_style(Rect::new(x, y, 1, 1), style.add_modifier(Modifier::REVERSED));
    if let Some(spot) = plan.spots.iter().find(|spot| spot.cells.contains((x, y).into())) {
        brush.text(spot.cells.right().saturating_sub(2), spot.cells.y, 1, sign, style);
    }
}
