//! What an entity shows: shapes, values, words. Lengths of the kitchen are in millimetres of the wall display from its top
//! left, those of the arm in metres in the frame of the robot's base.

use nalgebra::Isometry3;

use super::colours::Colour;
use crate::arm::link::CollisionSolid;

/// Something that an entity shows from a moment on.
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

/// What is shown.
#[derive(Clone, Debug, PartialEq)]
pub enum EntityData {
    /// Outlines in the kitchen; none: nothing is there.
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
    /// Where the entity's frame is, in that of the robot's base.
    Place(Isometry3<f64>),
    /// A value of a series.
    Value(f64),
    /// How the values of a series are drawn: as a line, or as marks.
    Line(SceneSeries),
    Marks(SceneSeries),
    /// A line of the log.
    Words {
        level: LogLevel,
        text: String,
        colour: Colour,
    },
    /// A page in Markdown, instead of the one before.
    Page(String),
    /// What a lane of states says from now on; an empty text: nothing.
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

/// A disc in the kitchen with words below its centre, in millimetres; of radius 0: words alone.
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

/// How a series is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSeries {
    pub name: String,
    pub colour: Colour,
}

/// How much a line of the log matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogLevel {
    Info,
    /// It had no effect, or was taken back.
    Warning,
    /// An error of the human.
    Error,
}

/// A name as part of a path.
pub fn slug(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect()
}
