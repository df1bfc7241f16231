//! The arrangement of the console's panels for the size of the terminal.

use ratatui::layout::Rect;

use crate::console::beliefs::visibility;
use crate::console::coding;
use crate::console::console_model::{ConsoleModel, SenderComparisonView};
use crate::console::kitchen_map::{KitchenMap, KitchenMapAreas, KitchenMapRows};
use crate::console::panels::Panel;
use tomcom_core::kitchen::Kitchen;
use tomcom_session::Session;
use tomcom_session::settings::WizardVisibility;

/// Smallest terminal that the console supports: columns and rows.
pub const LEAST: (u16, u16) = (72, 22);

/// Least number of columns at which panels are placed side by side.
pub const ROOMY_COLUMNS: u16 = 112;

/// Size class of the terminal: small, medium or large.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum ScreenSize {
    /// Small terminal (80x24): panels shrink to lines.
    #[default]
    Small,
    /// Medium terminal (120x40): panels with frames; the list of events only in place of beliefs that the wizard may not
    /// see.
    Medium,
    /// Large terminal (200x60): panels with frames, and the list of events.
    Large,
}

/// Screen areas of the console's panels; a panel with an empty area is not drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PanelAreas {
    pub screen_size: ScreenSize,
    pub head: Rect,
    /// Area of the offer: one line, or two on narrow terminals.
    pub offer: Rect,
    /// Area of the orders: what each needs, and what of it is there.
    pub orders: Rect,
    pub kitchen: Rect,
    pub belief: Rect,
    /// Area of the last presses with the reasons of errors.
    pub presses: Rect,
    pub recommendation: Rect,
    /// Area of the gaze map, which is shown at full size only: the kitchen panel marks the gaze, too.
    pub gaze_map: Rect,
    pub shown: Rect,
    /// Area of the gaze panel: where the participant looks, and the gaze's quality.
    pub gaze: Rect,
    pub robot: Rect,
    pub events: Rect,
    pub timeline: Rect,
    pub comparison: Rect,
    pub lesson: Rect,
    pub codebook: Rect,
    pub errors: Rect,
    pub scrub: Rect,
    pub message: Rect,
    pub footer: Rect,
}

/// Least number of columns at which the offer and its reason fit into one line.
const OFFER_COLUMNS: u16 = 140;
/// Number of the terminal's rows for each line of a replay's message.
const ROWS_PER_MESSAGE_LINE: u16 = 12;
/// Least width of the kitchen panel, in columns, at which names of usual length need no abbreviation.
const KITCHEN_COLUMNS: u16 = 81;
/// Rows and columns of a panel's frame.
const FRAME: u16 = 2;
/// Height of the timeline without frame, in rows; on small terminals without room for all rows.
const TIMELINE_ROWS: u16 = 6;
const LOW_TIMELINE_ROWS: u16 = 4;
/// Least height of a medium terminal's panels, in rows, for a row of offers in the timeline.
const OFFERS_FROM: u16 = 33;
/// Height of the list of signals on large terminals, in rows.
const RECOMMENDATION_ROWS: u16 = 8;
/// Heights of the panels of display, gaze and robot, in rows.
const SHOWN_ROWS: u16 = 5;
const GAZE_ROWS: u16 = 4;
const ROBOT_ROWS: u16 = 5;
/// Least height of the last presses, in lines.
const PRESS_LINES: u16 = 3;
/// Least height of a wizard training's panel with its frame, in rows.
const LESSON_ROWS: u16 = 8;
/// Rows of its score and its whole task in a column of a medium terminal.
const TASK_ROWS: u16 = 14;

/// Height in rows of a rater's error list without a panel of its own: progress, and three errors.
const ERROR_LINES: u16 = 4;
/// Terminals with fewer rows than the first number give a rater's error list only the second number of rows: for
/// progress, and the present error.
const FEW_ERROR_LINES: (u16, u16) = (24, 2);
/// Least width of the codebook beside the kitchen, in columns.
const CODEBOOK_COLUMNS: u16 = 35;
/// Rows that the codebook's definitions leave for the error list below it, with the list's title.
const ERRORS_ROWS: u16 = 12;

/// Numbers of rows that the kitchen needs, and those that only some uses of the console need: coding, comparison, replay.
#[derive(Clone, Copy, Debug)]
struct LineRows {
    orders: u16,
    kitchen: KitchenMapRows,
    /// If a rater codes errors: rows of the codebook across the screen; and of its panel beside the kitchen, at least and
    /// with all definitions.
    codebook: Option<[u16; 3]>,
    comparison: Option<u16>,
    scrubs: bool,
    /// Largest number of lines of a message: a replay says more of errors and signals than a session, a training or a rater
    /// is told.
    messages: u16,
    /// Of an offer on a narrow terminal: its reason stands in a line of its own.
    offer: u16,
}

impl PanelAreas {
    /// Computes the arrangement of panels on a terminal with `size` columns and rows, for this session and console.
    pub fn showing(size: (u16, u16), session: &Session, model: &ConsoleModel) -> PanelAreas {
        let assistants =
            |compared: &SenderComparisonView| compared.seen.as_ref().map_or(1, |seen| seen.pairs.len()) as u16;
        let compared = model.comparison.as_ref().map(assistants);
        let codebook = model.coding.as_ref().map(|_| {
            let (keys, kitchen) = (&model.keys, &session.kitchen);
            let compact = coding::compact(keys, kitchen, size.0.saturating_sub(2)).len() as u16;
            let beside = [coding::compact, coding::full];
            let [least, most] = beside.map(|lines| lines(keys, kitchen, CODEBOOK_COLUMNS).len() as u16 + FRAME);
            [compact, least, most]
        });
        let scrubs = model.playback.is_some();
        let messages = if scrubs && codebook.is_none() && model.lesson.is_none() { 3 } else { 1 };
        let kitchen = LineRows::for_kitchen(&session.kitchen);
        let offer = if session.spec.asks_assistant() { 2 } else { 1 };
        let lines = LineRows { codebook, comparison: compared, scrubs, messages, offer, ..kitchen };
        let regions = PanelAreas::with(size, visibility(session, model), model.alone, lines);
        if model.lesson.is_some() { regions.teaching() } else { regions }
    }

    /// Adds the wizard training's panel: below the list of events, or else in place of the last presses.
    fn teaching(self) -> PanelAreas {
        match self.events.area() {
            0 if self.kitchen.area() == 0 => self,
            _ if self.screen_size == ScreenSize::Small => {
                PanelAreas { lesson: self.presses, presses: Rect::default(), ..self }
            }
            0 => {
                let rows = self.presses.height.max(LESSON_ROWS);
                let (kitchen, lesson) = bottom(self.kitchen.union(self.presses), rows);
                PanelAreas { kitchen, lesson, presses: Rect::default(), ..self }
            }
            _ => {
                // The task has priority over what happened before.
                let rows = TASK_ROWS.max(self.events.height / 2);
                let rows = if self.events.height < rows + FRAME + 2 { self.events.height } else { rows };
                let (events, lesson) = bottom(self.events, rows);
                PanelAreas { events, lesson, ..self }
            }
        }
    }

    /// Computes the arrangement of all panels without the comparison, or of one panel at full size.
    pub fn new(size: (u16, u16), kitchen: &Kitchen, visibility: WizardVisibility, alone: Option<Panel>) -> PanelAreas {
        PanelAreas::with(size, visibility, alone, LineRows::for_kitchen(kitchen))
    }

    /// Computes the arrangement of panels with these additional rows.
    fn with(size: (u16, u16), visibility: WizardVisibility, alone: Option<Panel>, lines: LineRows) -> PanelAreas {
        let screen_size = match size {
            (columns, rows) if columns >= 168 && rows >= 46 => ScreenSize::Large,
            (columns, rows) if columns >= ROOMY_COLUMNS && rows >= 34 => ScreenSize::Medium,
            _ => ScreenSize::Small,
        };
        let all = Rect::new(0, 0, size.0, size.1);
        let (head, rest) = top(all, 1);
        let offer_rows = if size.0 < OFFER_COLUMNS { lines.offer } else { 1 };
        let (offer, rest) = top(rest, if visibility == WizardVisibility::Recommendation { offer_rows } else { 0 });
        let (rest, footer) = bottom(rest, 1);
        let (rest, message) = bottom(rest, lines.messages.min(size.1 / ROWS_PER_MESSAGE_LINE).max(1));
        let (rest, scrub) = bottom(rest, u16::from(lines.scrubs));
        let (rest, codebook, errors) = match lines.codebook {
            Some([rows, ..]) if alone.is_some() || screen_size == ScreenSize::Small => {
                let few = size.1 < FEW_ERROR_LINES.0;
                let (rest, errors) = bottom(rest, if few { FEW_ERROR_LINES.1 } else { ERROR_LINES });
                let (rest, codebook) = bottom(rest, rows);
                (rest, codebook, errors)
            }
            _ => (rest, Rect::default(), Rect::default()),
        };
        let rows =
            lines.comparison.filter(|_| alone.is_none()).map_or(0, |number| comparison_rows(screen_size, number));
        let (rest, comparison) = bottom(rest, rows);
        let bare = PanelAreas { screen_size, head, offer, kitchen: rest, comparison, ..PanelAreas::default() };
        let bare = PanelAreas { codebook, errors, scrub, message, footer, ..bare };
        let regions = match screen_size {
            _ if let Some(panel) = alone => return bare.alone(panel, lines),
            ScreenSize::Small => bare.small(visibility, lines),
            ScreenSize::Medium => bare.medium(visibility, lines),
            ScreenSize::Large => bare.large(visibility, lines),
        };
        lines.codebook.map_or(regions, |[_, least, most]| regions.coding([least, most]))
    }

    /// Gives the codebook and the error list the areas of panels that a rater must not see: signals and estimates.
    fn coding(self, codebook_rows: [u16; 2]) -> PanelAreas {
        let blank = Rect::default();
        match self.screen_size {
            // On small terminals the robot's state and the gaze share a line.
            ScreenSize::Small => {
                let presses = Rect { y: self.gaze.y, height: self.presses.height + 1, ..self.presses };
                PanelAreas { gaze: self.shown, presses, shown: blank, ..self }
            }
            ScreenSize::Medium => {
                let (codebook, errors) = codes_and_errors(self.events.union(self.shown), codebook_rows);
                PanelAreas { codebook, errors, events: blank, shown: blank, ..self }
            }
            ScreenSize::Large => {
                let (column, events) = bottom(self.events, self.events.height / 3);
                let (codebook, errors) = codes_and_errors(column, codebook_rows);
                PanelAreas { codebook, errors, events, gaze: self.shown.union(self.gaze), shown: blank, ..self }
            }
        }
    }

    fn alone(self, panel: Panel, lines: LineRows) -> PanelAreas {
        let body = self.kitchen;
        let mut regions =
            PanelAreas { kitchen: Rect::default(), screen_size: self.screen_size.max(ScreenSize::Medium), ..self };
        match panel {
            // The kitchen map has the orders above it, as the wall display has.
            Panel::Kitchen => (regions.orders, regions.kitchen) = top(body, 2 * lines.orders + FRAME),
            panel => *regions.area_of(panel) = body,
        }
        regions
    }

    pub fn panel_area(mut self, panel: Panel) -> Rect {
        *self.area_of(panel)
    }

    fn area_of(&mut self, panel: Panel) -> &mut Rect {
        match panel {
            Panel::Kitchen => &mut self.kitchen,
            Panel::Orders => &mut self.orders,
            Panel::Belief => &mut self.belief,
            Panel::Presses => &mut self.presses,
            Panel::Recommendation => &mut self.recommendation,
            Panel::GazeMap => &mut self.gaze_map,
            Panel::Events => &mut self.events,
            Panel::Timeline => &mut self.timeline,
            Panel::Comparison => &mut self.comparison,
        }
    }

    /// Height of the timeline; 0 where the comparison replaces it.
    fn timeline_rows(&self, rows: u16) -> u16 {
        if self.comparison.area() > 0 { 0 } else { rows }
    }

    /// Arrangement for small terminals: panels as lines without frames, with only the worst beliefs; the timeline only
    /// where it leaves room for the last presses.
    fn small(self, visibility: WizardVisibility, lines: LineRows) -> PanelAreas {
        let (orders, rest) = top(self.kitchen, lines.orders);
        let beliefs = if rest.height >= 15 { 2 } else { 1 };
        let beliefs = if visibility >= WizardVisibility::Belief { beliefs } else { 0 };
        let free = rest.height.saturating_sub(2 + beliefs + lines.kitchen.least);
        let has_timeline = free >= LOW_TIMELINE_ROWS + PRESS_LINES && self.comparison.area() == 0;
        let (rest, timeline) = bottom(rest, if has_timeline { LOW_TIMELINE_ROWS } else { 0 });
        // Last presses have priority over gaps in the map.
        let presses = if has_timeline { free - LOW_TIMELINE_ROWS } else { free };
        let (rest, presses) = bottom(rest, presses.max(1));
        let (rest, belief) = bottom(rest, beliefs);
        let (rest, gaze) = bottom(rest, 1);
        let (kitchen, agents) = bottom(rest, 1);
        // The words of a signal are longer than those of a press.
        let (robot, shown) = left(agents, agents.width / 2 - 2);
        PanelAreas { orders, kitchen, robot, shown, gaze, belief, presses, timeline, ..self }
    }

    /// Arrangement for medium terminals: orders, kitchen and last presses at the left; beliefs, display, gaze and robot
    /// at the right.
    fn medium(self, visibility: WizardVisibility, lines: LineRows) -> PanelAreas {
        // A row of offers comes after all lines of the kitchen.
        let has_offers = visibility == WizardVisibility::Recommendation && self.kitchen.height >= OFFERS_FROM;
        // A rater's timeline has no signals, and the gaze no second line.
        let codes = u16::from(lines.codebook.is_some());
        let rows = self.timeline_rows(TIMELINE_ROWS + FRAME + u16::from(has_offers) - codes);
        let (rest, timeline) = bottom(self.kitchen, rows);
        let (column, side) = left(rest, (rest.width * 13 / 20).max(KITCHEN_COLUMNS));
        let (side, robot) = bottom(side, ROBOT_ROWS);
        let (side, gaze) = bottom(side, GAZE_ROWS - codes);
        let (side, shown) = bottom(side, SHOWN_ROWS);
        let (orders, kitchen, presses) = lines.column(column);
        let regions = PanelAreas { orders, kitchen, presses, shown, robot, gaze, timeline, ..self };
        match visibility {
            WizardVisibility::State => PanelAreas { events: side, ..regions },
            WizardVisibility::Belief | WizardVisibility::Recommendation => PanelAreas { belief: side, ..regions },
        }
    }

    /// Arrangement for large terminals in two columns: at the left orders and kitchen, and below them last presses,
    /// display, gaze and robot; at the right beliefs, events and recommendations, as far as the wizard may see them.
    fn large(self, visibility: WizardVisibility, lines: LineRows) -> PanelAreas {
        // The timeline has one more row where offers are shown.
        let rows = TIMELINE_ROWS + FRAME + u16::from(visibility == WizardVisibility::Recommendation);
        let rows = rows - u16::from(lines.codebook.is_some());
        let (rest, timeline) = bottom(self.kitchen, self.timeline_rows(rows));
        let (column, side) = left(rest, (rest.width * 11 / 20).max(KITCHEN_COLUMNS));
        let (orders, kitchen, below) = lines.column(column);
        let (presses, devices) = left(below, below.width * 3 / 5);
        let (devices, robot) = bottom(devices, (devices.height / 3).max(ROBOT_ROWS));
        let (shown, gaze) = bottom(devices, devices.height / 2);
        let regions = PanelAreas { orders, kitchen, presses, shown, gaze, robot, timeline, ..self };
        let (belief, events) = bottom(side, side.height / 3);
        match visibility {
            WizardVisibility::State => PanelAreas { events: side, ..regions },
            WizardVisibility::Belief => PanelAreas { belief, events, ..regions },
            WizardVisibility::Recommendation => {
                let (belief, recommendation) = bottom(belief, RECOMMENDATION_ROWS);
                PanelAreas { belief, recommendation, events, ..regions }
            }
        }
    }

    /// Area in which the wizard reads what the assistant recommends: the list of signals, or else the offer.
    fn recommendations(&self) -> Rect {
        if self.recommendation.area() > 0 { self.recommendation } else { self.offer }
    }

    /// Names of the console's visible panels, as recorded in the log.
    pub fn panels(&self) -> Vec<&'static str> {
        let panels = [
            ("orders", self.orders),
            ("kitchen", self.kitchen),
            ("belief", self.belief),
            ("presses", self.presses),
            ("recommendation", self.recommendations()),
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

    /// Area that lists and cards may cover: the head line, messages and key hints stay visible.
    pub fn middle(&self) -> Rect {
        let (top, bottom) = (self.head.bottom(), self.message.y);
        Rect { x: self.head.x, y: top, width: self.head.width, height: bottom.saturating_sub(top) }
    }

    /// Areas of orders and kitchen without their frames, which together correspond to the wall display.
    pub fn kitchen_inside(&self) -> KitchenMapAreas {
        let within = |area: Rect| match self.screen_size {
            ScreenSize::Small => area,
            _ => inside(area),
        };
        KitchenMapAreas { orders: within(self.orders), places: within(self.kitchen) }
    }
}

impl LineRows {
    fn for_kitchen(kitchen: &Kitchen) -> LineRows {
        let orders = kitchen.orders.len() as u16;
        LineRows {
            orders,
            kitchen: KitchenMap::rows(kitchen),
            codebook: None,
            comparison: None,
            scrubs: false,
            messages: 1,
            offer: 2,
        }
    }

    /// Divides a column among orders, kitchen map and last presses. The last presses get what the others do not need:
    /// two lines for an order, and a gap between the places of the map, come after the least number of presses.
    fn column(&self, column: Rect) -> (Rect, Rect, Rect) {
        let KitchenMapRows { least, most } = self.kitchen;
        let spare = column.height.saturating_sub(self.orders + least + PRESS_LINES + 3 * FRAME);
        let more_orders = self.orders.min(spare);
        let more_kitchen = (most - least).min(spare - more_orders);
        let (orders, rest) = top(column, self.orders + more_orders + FRAME);
        let (kitchen, presses) = top(rest, least + more_kitchen + FRAME);
        (orders, kitchen, presses)
    }
}

/// Divides a column of the screen between the codebook and the list of errors, which come before the definitions.
fn codes_and_errors(column: Rect, [least, most]: [u16; 2]) -> (Rect, Rect) {
    top(column, if most + ERRORS_ROWS <= column.height { most } else { least })
}

/// Height of the comparison: axis, first lane, three rows for each assistant (lane, lines between matches, statistics),
/// differences, and a frame if there is room.
fn comparison_rows(screen_size: ScreenSize, assistants: u16) -> u16 {
    match screen_size {
        // On small terminals, only the first of the compared assistants has a row of statistics.
        ScreenSize::Small => 4 + if assistants == 1 { 2 } else { assistants },
        ScreenSize::Medium => 5 + 3 * assistants,
        ScreenSize::Large => 8 + 3 * assistants,
    }
}

pub fn inside(area: Rect) -> Rect {
    Rect { x: area.x + 1, y: area.y + 1, width: area.width.saturating_sub(2), height: area.height.saturating_sub(2) }
}

/// Splits off the top rows of an area, at most all of them: the rows, and the rest.
pub(in crate::console) fn top(area: Rect, rows: u16) -> (Rect, Rect) {
    let rows = rows.min(area.height);
    (Rect { height: rows, ..area }, Rect { y: area.y + rows, height: area.height - rows, ..area })
}

fn bottom(area: Rect, rows: u16) -> (Rect, Rect) {
    top(area, area.height.saturating_sub(rows))
}

fn left(area: Rect, columns: u16) -> (Rect, Rect) {
    let columns = columns.min(area.width);
    (Rect { width: columns, ..area }, Rect { x: area.x + columns, width: area.width - columns, ..area })
}
