//! Content of an entity in Rerun's scene: shapes, values, text. Lengths in the kitchen are in millimetres on the wall
//! display, measured from its top left corner; lengths of the arm are in metres in the frame of the robot's base.

use nalgebra::Isometry3;

use tomcom_arm::kinematics::CollisionSolid;
use tomcom_core::kitchen::{Agent, AspectId, ContentId, Kitchen};

/// New content of one entity in Rerun's scene.
#[derive(Clone, Debug, PartialEq)]
pub struct EntityUpdate {
    pub entity: String,
    pub shown: EntityData,
}

impl EntityUpdate {
    /// Creates an update after which the entity shows this content.
    pub fn new(entity: impl Into<String>, shown: EntityData) -> EntityUpdate {
        EntityUpdate { entity: entity.into(), shown }
    }
}

/// Content of an entity in Rerun's scene.
#[derive(Clone, Debug, PartialEq)]
pub enum EntityData {
    /// Outlines of rectangles in the kitchen; an empty list clears the entity.
    Areas(Vec<SceneArea>),
    Discs(Vec<SceneDisc>),
    /// The gaze point with a circle around the point, in the kitchen.
    Sight {
        /// Position of the point, in millimetres from the display's upper left corner.
        at: [f64; 2],
        /// Radius of the circle, in millimetres.
        around: f64,
        colour: SceneColour,
    },
    Points(Vec<ScenePoint>),
    Solids(Vec<CollisionSolid>, SceneColour),
    Place(Isometry3<f64>),
    Value(f64),
    Line(SeriesStyle),
    QuietLine(SeriesStyle),
    Marks(SeriesStyle, MarkShape),
    Words {
        level: SceneLogLevel,
        text: String,
        colour: SceneColour,
    },
    Page(String),
    /// Text of a lane that shows a state over time; an empty text clears the lane.
    State(String),
}

/// The outline of a rectangle in the kitchen.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneArea {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
    pub colour: SceneColour,
    pub line: f64,
}

/// A disc in the kitchen with a label below its centre.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneDisc {
    /// Centre of the disc, in millimetres from the display's upper left corner.
    pub at: [f64; 2],
    /// Radius of the disc in millimetres; 0 shows the label only.
    pub radius: f64,
    /// Label below the disc's centre; empty for no label.
    pub words: String,
    pub colour: SceneColour,
}

/// A labelled point in space, in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenePoint {
    /// Position of the point in the frame of the robot's base, in metres.
    pub at_m: [f64; 3],
    /// Radius with which the point is drawn, in metres.
    pub radius_m: f64,
    /// Label beside the point; empty for no label.
    pub words: String,
    pub colour: SceneColour,
}

/// Name and colour of a time series.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesStyle {
    pub name: String,
    pub colour: SceneColour,
}

/// Shape of the marks of a time series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkShape {
    Cross,
    Circle,
    Diamond,
}

/// Severity of a line in the text log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneLogLevel {
    Info,
    /// The line reports that a press had no effect, or that a signal was taken back.
    Warning,
    Error,
}

/// A name in the form in which it can be part of an entity's path.
pub fn slug(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect()
}

/// A colour: red, green, blue and opacity, each from 0 to 255.
pub type SceneColour = [u8; 4];

/// Colour of the display's outline.
pub const FRAME: SceneColour = [104, 110, 122, 255];
/// Colour of locations without content.
pub const EMPTY: SceneColour = [124, 130, 142, 255];
/// Colour of locations with content.
pub const FULL: SceneColour = [0, 172, 160, 255];
/// Colour of the human and the human's presses.
pub const HUMAN: SceneColour = [52, 152, 235, 255];
/// Colour of the human's hand and forearm.
pub const SKIN: SceneColour = [222, 170, 136, 255];
/// Colour of the robot and its presses.
pub const ROBOT: SceneColour = [236, 136, 32, 255];
/// Colour of signals, and of usable gaze samples.
pub const SIGNAL: SceneColour = [236, 184, 0, 255];
/// Colour of signals that the wizard sends.
pub const WIZARD: SceneColour = [180, 100, 230, 255];
/// Colour of signals that the assistant recommends or sends.
pub const ASSISTANT: SceneColour = [40, 176, 104, 255];
/// Colour of the human's errors and of stops of the arm.
pub const ERROR: SceneColour = [232, 60, 60, 255];
/// Colour of less important curves and texts.
pub const QUIET: SceneColour = [134, 140, 152, 255];
/// Colour of gaze samples that the belief filter cannot use.
pub const LOST: SceneColour = [120, 120, 120, 255];
/// Colour of the table.
pub const TABLE: SceneColour = [92, 84, 76, 255];
/// Colour of buttons on the table.
pub const BUTTON: SceneColour = [176, 58, 58, 255];
/// Colour of the arm's links.
pub const STEEL: SceneColour = [176, 186, 200, 255];
/// Colour of the arm's joints.
pub const JOINT: SceneColour = [82, 132, 190, 255];

/// Hues of ingredients that do not look alike: yellow, green, orange, blue, pink, violet, cyan, lime.
const HUES: [f64; 8] = [0.13, 0.38, 0.06, 0.58, 0.93, 0.75, 0.48, 0.22];

pub fn agent_colour(agent: Agent) -> SceneColour {
    match agent {
        Agent::Human => HUMAN,
        Agent::Robot => ROBOT,
    }
}

/// The colour of an item: ingredients that look alike share a hue, and the further an ingredient is processed, the
/// paler it is.
pub fn of_item(kitchen: &Kitchen, item: ContentId) -> SceneColour {
    let content = kitchen.content(item);
    let own = content.ingredient.unwrap_or_default();
    let alike = content.look_alikes.iter().filter_map(|&other| kitchen.content(other).ingredient);
    let family = alike.fold(own, usize::min);
    let states = || (0..item.index()).filter(|&other| kitchen.contents[other].ingredient == Some(own));
    let paler = states().count() as f64;
    let hue = (HUES[family % HUES.len()] + if own == family { 0.0 } else { 0.94 }).fract();
    of_hue(hue, (0.85 - 0.22 * paler).max(0.25), 0.98)
}

pub fn of_aspect(aspect: AspectId) -> SceneColour {
    let nth = aspect.index();
    of_hue((0.02 + nth as f64 * 0.618).fract(), if nth.is_multiple_of(2) { 0.75 } else { 0.45 }, 0.95)
}

/// Computes the colour with this hue, saturation and value, each from 0 to 1.
fn of_hue(hue: f64, saturation: f64, value: f64) -> SceneColour {
    let channel = |shift: f64| {
        let k = (shift + hue * 6.0) % 6.0;
        let part = value - value * saturation * k.min(4.0 - k).clamp(0.0, 1.0);
        (part * 255.0).round() as u8
    };
    [channel(5.0), channel(3.0), channel(1.0), 255]
}
