//! Which panel is where, for the size of the terminal.

use ratatui::layout::Rect;

use crate::session::settings::Visibility;

/// Below this nothing can be drawn that helps.
pub const LEAST: (u16, u16) = (72, 22);

/// How much room there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Room {
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
    pub room: Room,
    pub head: Rect,
    pub kitchen: Rect,
    pub belief: Rect,
    pub recommendation: Rect,
    /// The gaze map, in the room of the two above where the wizard may not see them.
    pub gaze_map: Rect,
    pub shown: Rect,
    pub robot: Rect,
    pub gaze: Rect,
    pub events: Rect,
    pub timeline: Rect,
    pub footer: Rect,
}

impl Regions {
    /// Deals out a terminal of `size` columns and rows.
    pub fn new(size: (u16, u16), visibility: Visibility) -> Regions {
        let room = match size {
            (columns, rows) if columns >= 168 && rows >= 46 => Room::Large,
            (columns, rows) if columns >= 108 && rows >= 34 => Room::Medium,
            _ => Room::Small,
        };
        let all = Rect::new(0, 0, size.0, size.1);
        let (head, rest) = top(all, 1);
        let (rest, footer) = bottom(rest, 1);
        let blank = Rect::default();
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
            footer,
        };
        match room {
            Room::Small => bare.small(visibility),
            Room::Medium | Room::Large => bare.wide(visibility),
        }
    }

    fn small(self, visibility: Visibility) -> Regions {
        let (rest, timeline) = bottom(self.kitchen, 4);
        let (rest, recommendation) = bottom(rest, u16::from(visibility == Visibility::Recommendation));
        let (rest, belief) = bottom(rest, u16::from(visibility >= Visibility::Belief));
        let (rest, gaze) = bottom(rest, 1);
        let (rest, shown) = bottom(rest, 1);
        let (kitchen, robot) = bottom(rest, 1);
        Regions { kitchen, robot, shown, gaze, belief, recommendation, timeline, ..self }
    }

    fn wide(self, visibility: Visibility) -> Regions {
        let is_large = self.room == Room::Large;
        let (rest, timeline) = bottom(self.kitchen, 8);
        let (rest, events) = right(rest, if is_large { rest.width / 4 } else { 0 });
        let (kitchen, side) = right(rest, if is_large { rest.width * 38 / 100 } else { rest.width / 3 });
        let (side, gaze) = bottom(side, if is_large { 7 } else { 6 });
        let (side, robot) = bottom(side, 4);
        let (side, shown) = bottom(side, 5);
        let regions = Regions { kitchen, shown, robot, gaze, events, timeline, ..self };
        match visibility {
            Visibility::State => Regions { gaze_map: side, ..regions },
            Visibility::Belief => Regions { belief: side, ..regions },
            Visibility::Recommendation => {
                let (belief, recommendation) = bottom(side, side.height * 2 / 5);
                Regions { belief, recommendation, ..regions }
            }
        }
    }

    /// The cells of the kitchen panel without its frame, where the display points are.
    pub fn kitchen_inside(&self) -> Rect {
        match self.room {
            Room::Small => self.kitchen,
            _ => inside(self.kitchen),
        }
    }
}

/// What is left inside of a frame.
pub fn inside(area: Rect) -> Rect {
    Rect { x: area.x + 1, y: area.y + 1, width: area.width.saturating_sub(2), height: area.height.saturating_sub(2) }
}

fn top(area: Rect, rows: u16) -> (Rect, Rect) {
    let rows = rows.min(area.height);
    (Rect { height: rows, ..area }, Rect { y: area.y + rows, height: area.height - rows, ..area })
}

fn bottom(area: Rect, rows: u16) -> (Rect, Rect) {
    let (rest, bottom) = top(area, area.height.saturating_sub(rows));
    (rest, bottom)
}

fn right(area: Rect, columns: u16) -> (Rect, Rect) {
    let columns = columns.min(area.width);
    let rest = area.width - columns;
    (Rect { width: rest, ..area }, Rect { x: area.x + rest, width: columns, ..area })
}
