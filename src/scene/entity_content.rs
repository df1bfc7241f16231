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
    /// What it shows from now on.
    pub shown: EntityData,
}

impl EntityUpdate {
    /// This entity shows this from now on.
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
    /// A point with a circle around it, in the kitchen.
    Sight {
        /// The point, in millimetres from the display's upper left corner.
        at: [f64; 2],
        /// The circle's radius, in millimetres.
        around: f64,
        /// The colour of both.
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
    /// The values of a series are drawn as a line.
    Line(SceneSeries),
    /// The values of a series are drawn as a thin line, for series of which many are drawn at once.
    QuietLine(SceneSeries),
    /// The values of a series are drawn as marks.
    Marks(SceneSeries, MarkShape),
    /// A line of the log.
    Words {
        /// How much it matters.
        level: LogLevel,
        /// The text.
        text: String,
        /// Its colour.
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
    /// Left edge, in millimetres.
    pub left: f64,
    /// Upper edge, in millimetres.
    pub top: f64,
    /// Width, in millimetres.
    pub width: f64,
    /// Height, in millimetres.
    pub height: f64,
    /// The colour of the outline.
    pub colour: Colour,
    /// Half the width of its line, in millimetres.
    pub line: f64,
}

/// A disc in the kitchen with words below its centre, in millimetres; radius 0 for words only.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneDisc {
    /// Its centre, in millimetres from the display's upper left corner.
    pub at: [f64; 2],
    /// Its radius in millimetres; 0: words alone.
    pub radius: f64,
    /// The words; empty: none.
    pub words: String,
    /// The colour of the disc.
    pub colour: Colour,
}

/// A point in space, in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenePoint {
    /// The point in the frame of the robot's base, in metres.
    pub at_m: [f64; 3],
    /// The radius with which it is drawn, in metres.
    pub radius_m: f64,
    /// The words beside it; empty: none.
    pub words: String,
    /// Its colour.
    pub colour: Colour,
}

/// Name and colour of a series.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSeries {
    /// The name in the legend.
    pub name: String,
    /// The colour of line or marks.
    pub colour: Colour,
}

/// Shape of the marks of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkShape {
    /// A cross.
    Cross,
    /// A filled circle.
    Circle,
    /// A diamond.
    Diamond,
}

/// Level of a line of the text log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogLevel {
    /// Something happened as it should.
    Info,
    /// An ineffective press, or a signal that was taken back.
    Warning,
    /// An error of the human.
    Error,
}

/// A name as a part of an entity path.
pub fn slug(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect()
}
