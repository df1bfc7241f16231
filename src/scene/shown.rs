//! Content of an entity: shapes, values, text. Lengths in the kitchen are in millimetres on the wall display from its top left
//! corner, lengths of the arm in metres in the frame of the robot's base.

use nalgebra::Isometry3;

use super::colours::Colour;
use crate::arm::link::CollisionSolid;

/// New content of one entity.
#[derive(Clone, Debug, PartialEq)]
pub struct EntityUpdate {
    /// The path of the entity, such as `kitchen/plate`.
    pub entity: String,
    pub shown: EntityData,
}

impl EntityUpdate {
    pub fn new(entity: impl Into<String>, shown: EntityData) -> EntityUpdate {
        EntityUpdate { entity: entity.into(), shown }
    }
}

/// Content of an entity.
#[derive(Clone, Debug, PartialEq)]
pub enum EntityData {
    /// Outlines in the kitchen; an empty list clears the entity.
    Areas(Vec<SceneArea>),
    /// Discs and words in the kitchen.
    Discs(Vec<SceneDisc>),
    /// A point with a circle around it, in the kitchen: `around` is the circle's radius.
    Sight {
        at: [f64; 2],
        around: f64,
        colour: Colour,
    },
    /// Points in space, with words.
    Points(Vec<ScenePoint>),
    /// Shapes in the entity's own frame.
    Solids(Vec<CollisionSolid>, Colour),
    /// Pose of the entity's frame in the frame of the robot's base.
    Place(Isometry3<f64>),
    /// A value of a series.
    Value(f64),
    /// Style of a series: line or marks.
    Line(SceneSeries),
    Marks(SceneSeries),
    /// A line of the log.
    Words {
        level: LogLevel,
        text: String,
        colour: Colour,
    },
    /// A page in Markdown, which replaces the previous one.
    Page(String),
    /// Text of a lane of states; an empty text clears it.
    State(String),
}

/// The outline of a rectangle in the kitchen.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneArea {
    /// Left and upper edge, width and height, in millimetres.
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
    pub colour: Colour,
    /// Half the width of its line, in millimetres.
    pub line: f64,
}

/// A disc in the kitchen with words below its centre, in millimetres; radius 0 for words only.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneDisc {
    pub at: [f64; 2],
    pub radius: f64,
    pub words: String,
    pub colour: Colour,
}

/// A point in space, in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenePoint {
    pub at_m: [f64; 3],
    pub radius_m: f64,
    pub words: String,
    pub colour: Colour,
}

/// Name and colour of a series.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSeries {
    pub name: String,
    pub colour: Colour,
}

/// Level of a line of the text log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogLevel {
    Info,
    /// A press without effect, or a signal that was taken back.
    Warning,
    /// An error of the human.
    Error,
}

/// A name as a part of an entity path.
pub fn slug(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect()
}
