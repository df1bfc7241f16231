//! Content of an entity in Rerun's scene: shapes, values, text. Lengths in the kitchen are in millimetres on the wall
//! display, measured from its top left corner; lengths of the arm are in metres in the frame of the robot's base.

use nalgebra::Isometry3;

use super::colours::SceneColour;
use tomcom_arm::kinematics::CollisionSolid;

/// New content of one entity in Rerun's scene.
#[derive(Clone, Debug, PartialEq)]
pub struct EntityUpdate {
    /// Path of the entity in Rerun, such as `kitchen/plate`.
    pub entity: String,
    /// Content that the entity shows from now on.
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
    /// Discs with labels in the kitchen.
    Discs(Vec<SceneDisc>),
    /// The gaze point with a circle around the point, in the kitchen.
    Sight {
        /// Position of the point, in millimetres from the display's upper left corner.
        at: [f64; 2],
        /// Radius of the circle, in millimetres.
        around: f64,
        /// Colour of the gaze point and its circle.
        colour: SceneColour,
    },
    /// Points in space, each with a label.
    Points(Vec<ScenePoint>),
    /// Solids in the entity's own coordinate frame.
    Solids(Vec<CollisionSolid>, SceneColour),
    /// Pose of the entity's coordinate frame in the frame of the robot's base.
    Place(Isometry3<f64>),
    /// A value of a time series.
    Value(f64),
    /// Style of a time series: a line.
    Line(SeriesStyle),
    /// Style of a time series: a thin line, for plots with many series.
    QuietLine(SeriesStyle),
    /// Style of a time series: marks.
    Marks(SeriesStyle, MarkShape),
    /// A line of the text log.
    Words {
        /// Severity of the line in the text log.
        level: SceneLogLevel,
        /// Text of the line in the text log.
        text: String,
        /// Colour of the line in the text log.
        colour: SceneColour,
    },
    /// A page of text in Markdown, which replaces the previous page.
    Page(String),
    /// Text of a lane that shows a state over time; an empty text clears the lane.
    State(String),
}

/// The outline of a rectangle in the kitchen.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneArea {
    /// Left edge of the rectangle, in millimetres.
    pub left: f64,
    /// Upper edge of the rectangle, in millimetres.
    pub top: f64,
    /// Width of the rectangle, in millimetres.
    pub width: f64,
    /// Height of the rectangle, in millimetres.
    pub height: f64,
    /// Colour of the rectangle's outline.
    pub colour: SceneColour,
    /// Half the width of the rectangle's outline, in millimetres.
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
    /// Colour in which the disc is drawn.
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
    /// Colour in which the point is drawn.
    pub colour: SceneColour,
}

/// Name and colour of a time series.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesStyle {
    /// Name of the series in the legend.
    pub name: String,
    /// Colour of the series' line or marks.
    pub colour: SceneColour,
}

/// Shape of the marks of a time series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkShape {
    /// The marks are crosses.
    Cross,
    /// The marks are filled circles.
    Circle,
    /// The marks are diamonds.
    Diamond,
}

/// Severity of a line in the text log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneLogLevel {
    /// The line reports something that happened as intended.
    Info,
    /// The line reports that a press had no effect, or that a signal was taken back.
    Warning,
    /// The line reports an error of the human.
    Error,
}

/// A name in the form in which it can be part of an entity's path.
pub fn slug(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect()
}
