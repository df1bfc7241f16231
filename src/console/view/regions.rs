//! Which panel is where, for the size of the terminal.

use ratatui::layout::Rect;

use crate::console::compared::ComparisonView;
use crate::console::model::ConsoleModel;
use crate::console::panel::Panel;
use crate::session::Session;
use crate::session::settings::Visibility;

/// Below this nothing can be drawn that helps.
pub const LEAST: (u16, u16) = (72, 22);

/// From so many columns on there is room for panels beside each other.
pub const ROOMY_COLUMNS: u16 = 112;

/// How much room there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ScreenSize {
    /// Panels shrink to lines; down to 80x24.
    Small,
    /// Everything at once: 120x40.
    Medium,
    /// With the events in words beside: 200x60.
    Large,
}

/// The places of the panels; an empty one is not drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Regions {
    pub room: ScreenSize,
    pub head: Rect,
    pub kitchen: Rect,
    pub belief: Rect,
    pub recommendation: Rect,
    /// The gaze map, in the room of the two above where the wizard may not see them.
    pub gaze_map: Rect,
    /// The participant's side: what the display shows, and where the gaze is; two lines where there is little room.
    pub shown: Rect,
    pub gaze: Rect,
    pub robot: Rect,
    pub events: Rect,
    pub timeline: Rect,
    /// Wizard and assistants side by side, in the place of the timeline.
    pub comparison: Rect,
    /// What a training says, in the room of what the wizard may not see.
    pub lesson: Rect,
    pub footer: Rect,
}

/// The least columns of the kitchen panel in which names of the usual length are written out.
const KITCHEN_COLUMNS: u16 = 81;
/// Rows of the timeline with its title.
const TIMELINE_ROWS: u16 = 7;

impl Regions {
    /// Deals out a terminal of `size` columns and rows to what this console shows.
    pub fn showing(size: (u16, u16), session: &Session, model: &ConsoleModel) -> Regions {
        let assistants = |compared: &ComparisonView| compared.seen.as_ref().map_or(1, |seen| seen.pairs.len()) as u16;
        let compared = model.comparison.as_ref().map(assistants);
        let regions = Regions::with(size, session.spec.console.visibility, model.alone, compared);
        if model.lesson.is_some() { regions.teaching() } else { regions }
    }

    /// Makes room for what a training says: below the gaze map, or else above the timeline.
    fn teaching(self) -> Regions {
        match self.gaze_map.area() {
            0 if self.kitchen.area() == 0 => self,
            0 => {
                let (kitchen, lesson) = bottom(self.kitchen, if self.room == ScreenSize::Small { 3 } else { 7 });
                Regions { kitchen, lesson, ..self }
            }
            _ => {
                let (gaze_map, lesson) = bottom(self.gaze_map, self.gaze_map.height / 2);
                Regions { gaze_map, lesson, ..self }
            }
        }
    }

    /// Deals it out to all panels but the comparison, or to one alone.
    pub fn new(size: (u16, u16), visibility: Visibility, alone: Option<Panel>) -> Regions {
        Regions::with(size, visibility, alone, None)
    }

    /// With a comparison of a wizard with so many assistants, if there is one.
    fn with(size: (u16, u16), visibility: Visibility, alone: Option<Panel>, assistants: Option<u16>) -> Regions {
        let room = match size {
            (columns, rows) if columns >= 168 && rows >= 46 => ScreenSize::Large,
            (columns, rows) if columns >= ROOMY_COLUMNS && rows >= 34 => ScreenSize::Medium,
            _ => ScreenSize::Small,
        };
        let all = Rect::new(0, 0, size.0, size.1);
        let (head, rest) = top(all, 1);
        let (rest, footer) = bottom(rest, 1);
        let blank = Rect::default();
        let rows = assistants.filter(|_| alone.is_none()).map_or(0, |number| comparison_rows(room, number));
        let (rest, comparison) = bottom(rest, rows);
        let bare = Regions {
            room,
            head,
            kitchen: rest,
            belief: blank,
            recommendation: blank,
            gaze_map: blank,
            shown: blank,
            robot: blank,
            gaze: blank,
            events: blank,
            timeline: blank,
            comparison,
            lesson: blank,
            footer,
        };
        match room {
            _ if let Some(panel) = alone => bare.alone(panel),
            ScreenSize::Small => bare.small(visibility),
            ScreenSize::Medium => bare.medium(visibility),
            ScreenSize::Large => bare.large(visibility),
        }
    }

    fn alone(self, panel: Panel) -> Regions {
        let blank = Rect::default();
        let body = self.kitchen;
        let mut regions = Regions { kitchen: blank, room: self.room.max(ScreenSize::Medium), ..self };
        match panel {
            Panel::Kitchen => regions.kitchen = body,
            Panel::Belief => regions.belief = body,
            Panel::Recommendation => regions.recommendation = body,
            Panel::GazeMap => regions.gaze_map = body,
            Panel::Events => regions.events = body,
            Panel::Timeline => regions.timeline = body,
            Panel::Comparison => regions.comparison = body,
        }
        regions
    }

    /// Where a panel is.
    pub fn panel_area(&self, panel: Panel) -> Rect {
        match panel {
            Panel::Kitchen => self.kitchen,
            Panel::Belief => self.belief,
            Panel::Recommendation => self.recommendation,
            Panel::GazeMap => self.gaze_map,
            Panel::Events => self.events,
            Panel::Timeline => self.timeline,
            Panel::Comparison => self.comparison,
        }
    }

    /// The comparison has the timeline's place.
    fn timeline_rows(&self, rows: u16) -> u16 {
        if self.comparison.area() > 0 { 0 } else { rows }
    }

    /// The panels as lines below the kitchen, the three worst beliefs among them.
    fn small(self, visibility: Visibility) -> Regions {
        let (rest, timeline) = bottom(self.kitchen, self.timeline_rows(4));
        let (rest, recommendation) = bottom(rest, u16::from(visibility == Visibility::Recommendation));
        let beliefs = if rest.height >= 17 { 3 } else { 1 };
        let (rest, belief) = bottom(rest, if visibility >= Visibility::Belief { beliefs } else { 0 });
        let (rest, gaze) = bottom(rest, 1);
        let (rest, shown) = bottom(rest, 1);
        let (kitchen, robot) = bottom(rest, 1);
        Regions { kitchen, robot, shown, gaze, belief, recommendation, timeline, ..self }
    }

    /// The kitchen at the left; at the right from what is believed over what could be said to who does what.
    fn medium(self, visibility: Visibility) -> Regions {
        let (rest, timeline) = bottom(self.kitchen, self.timeline_rows(TIMELINE_ROWS));
        let (kitchen, side) = left(rest, (rest.width * 13 / 20).max(KITCHEN_COLUMNS));
        let (side, robot) = bottom(side, 4);
        let (side, gaze) = bottom(side, 4);
        let (side, shown) = bottom(side, 5);
        Regions { kitchen, shown, robot, gaze, timeline, ..self }.judge(side, visibility)
    }

    /// Three columns: what is, what is believed and could be said, what happened.
    fn large(self, visibility: Visibility) -> Regions {
        let (rest, timeline) = bottom(self.kitchen, self.timeline_rows(TIMELINE_ROWS));
        let (rest, events) = right(rest, 36);
        let (kitchen, side) = left(rest, (rest.width / 2).max(KITCHEN_COLUMNS));
        let (kitchen, below) = bottom(kitchen, kitchen.height * 3 / 10);
        let (participant, map) = left(below, below.width / 2);
        let (shown, gaze) = top(participant, 5);
        let (side, robot) = bottom(side, 6);
        let regions = Regions { kitchen, shown, gaze, robot, events, timeline, ..self };
        match visibility {
            Visibility::State => Regions { gaze_map: side, ..regions },
            _ => Regions { gaze_map: map, ..regions.judge(side, visibility) },
        }
    }

    /// Gives this area to what the wizard may see beside the state.
    fn judge(self, side: Rect, visibility: Visibility) -> Regions {
        match visibility {
            Visibility::State => Regions { gaze_map: side, ..self },
            Visibility::Belief => Regions { belief: side, ..self },
            Visibility::Recommendation => {
                let (belief, recommendation) = bottom(side, side.height * 2 / 5);
                Regions { belief, recommendation, ..self }
            }
        }
    }

    /// The names of the panels that have room.
    pub fn panels(&self) -> Vec<&'static str> {
        let panels = [
            ("kitchen", self.kitchen),
            ("belief", self.belief),
            ("recommendation", self.recommendation),
            ("gaze_map", self.gaze_map),
            ("display", self.shown),
            ("robot", self.robot),
            ("gaze", self.gaze),
            ("events", self.events),
            ("timeline", self.timeline),
            ("comparison", self.comparison),
        ];
        panels.into_iter().filter(|(_, area)| area.area() > 0).map(|(name, _)| name).collect()
    }

    /// The cells of the kitchen panel without its title, where the display points are.
    pub fn kitchen_inside(&self) -> Rect {
        match self.room {
            ScreenSize::Small => self.kitchen,
            _ => below_title(self.kitchen),
        }
    }
}

/// Rows of the comparison: axis and first lane, for each assistant its lane, its matches and its figures, and the
/// differences; with a title where there is room.
fn comparison_rows(room: ScreenSize, assistants: u16) -> u16 {
    match room {
        // Figures of the first assistant alone.
        ScreenSize::Small => 4 + if assistants == 1 { 2 } else { assistants },
        ScreenSize::Medium => 4 + 3 * assistants,
        ScreenSize::Large => 7 + 3 * assistants,
    }
}

/// What is left inside of a frame.
pub fn inside(area: Rect) -> Rect {
    Rect { x: area.x + 1, y: area.y + 1, width: area.width.saturating_sub(2), height: area.height.saturating_sub(2) }
}

/// What is left below the title of a panel, with a margin at both sides.
pub fn below_title(area: Rect) -> Rect {
    Rect { x: area.x + 1, y: area.y + 1, width: area.width.saturating_sub(2), height: area.height.saturating_sub(1) }
}

fn top(area: Rect, rows: u16) -> (Rect, Rect) {
    let rows = rows.min(area.height);
    (Rect { height: rows, ..area }, Rect { y: area.y + rows, height: area.height - rows, ..area })
}

fn bottom(area: Rect, rows: u16) -> (Rect, Rect) {
    let (rest, bottom) = top(area, area.height.saturating_sub(rows));
    (rest, bottom)
}

fn left(area: Rect, columns: u16) -> (Rect, Rect) {
    let (left, right) = right(area, area.width.saturating_sub(columns));
    (left, right)
}

fn right(area: Rect, columns: u16) -> (Rect, Rect) {
    let columns = columns.min(area.width);
    let rest = area.width - columns;
    (Rect { width: rest, ..area }, Rect { x: area.x + rest, width: columns, ..area })
}
