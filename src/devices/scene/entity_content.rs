//! Content of an entity in Rerun's scene: shapes, values, text. Lengths in the kitchen are such that the wall display
//! is 1500 wide, measured from its top left corner; lengths of the arm are in metres in the frame of the robot's base.

use nalgebra::Isometry3;

use tomcom_arm::kinematics::CollisionSolid;
use tomcom_core::kitchen::Agent;

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
    Labels(Vec<SceneLabel>),
    /// A picture in the kitchen; another one takes its place.
    Picture(ScenePicture),
    /// The gaze point, with a circle around it.
    Sight {
        at: [f64; 2],
        colour: SceneColour,
    },
    /// Radius of the circle around gaze points.
    SightRadius(f64),
    Points(Vec<ScenePoint>),
    Solids(Vec<CollisionSolid>, SceneColour),
    Place(Isometry3<f64>),
    Value(f64),
    /// The curve has no value until the next one.
    NoValue,
    Line(SeriesStyle),
    Marks(SeriesStyle, MarkShape),
    Words {
        level: SceneLogLevel,
        text: String,
        colour: SceneColour,
    },
    Page(String),
    /// A page that holds for the whole recording, in place of the one before.
    WholePage(String),
    /// Text of a lane that shows a state over time, and the colour of its bar; an empty text clears the lane.
    State(String, SceneColour),
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

/// A label in the kitchen; Rerun draws the text below this point.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneLabel {
    pub at: [f64; 2],
    pub words: String,
    pub colour: SceneColour,
}

/// A picture that fills a rectangle in the kitchen.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenePicture {
    /// The content of a PNG file.
    pub png: &'static [u8],
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
    /// Pictures with a larger number lie on those with a smaller one.
    pub layer: u8,
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

#[derive(Clone, Debug, PartialEq)]
pub struct SeriesStyle {
    pub name: String,
    pub colour: SceneColour,
}

impl SeriesStyle {
    pub fn new(name: impl Into<String>, colour: SceneColour) -> SeriesStyle {
        SeriesStyle { name: name.into(), colour }
    }
}

/// Shape of the marks of a time series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkShape {
    Cross,
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

// The viewer's ground is black or white. Colours of texts have a luminance whose contrast is above 4 with both.

/// Colour of the display's outline, and of locations without content.
pub const FRAME: SceneColour = [115, 121, 132, 255];
/// Colour of the names of what lies in a place.
pub const CONTENT: SceneColour = [179, 101, 43, 255];
/// Colour of the human and the human's presses. Those of the human, the robot, signals, gaze, errors and false beliefs are
/// as on the console.
pub const HUMAN: SceneColour = [0, 136, 126, 255];
/// Colour of the human's hand and forearm.
pub const SKIN: SceneColour = [222, 170, 136, 255];
/// Colour of the robot and its presses.
pub const ROBOT: SceneColour = [77, 124, 176, 255];
/// Colour of signals, of advice, and of what the wizard does.
pub const SIGNAL: SceneColour = [160, 88, 205, 255];
/// Colour of usable gaze samples and of looks.
pub const GAZE: SceneColour = [52, 138, 62, 255];
/// Colour of the human's errors and of stops of the arm.
pub const ERROR: SceneColour = [223, 57, 57, 255];
/// Colour of false beliefs.
pub const FALSE: SceneColour = [152, 110, 0, 255];
/// Colour of less important curves and texts, and of gaze samples that the belief filter cannot use.
pub const QUIET: SceneColour = [116, 121, 131, 255];
/// Colour of the table.
pub const TABLE: SceneColour = [92, 84, 76, 255];
/// Colour of buttons on the table.
pub const BUTTON: SceneColour = [176, 58, 58, 255];
/// Colour of the arm's links.
pub const STEEL: SceneColour = [176, 186, 200, 255];
/// Colour of the arm's joints.
pub const JOINT: SceneColour = [82, 132, 190, 255];

pub fn agent_colour(agent: Agent) -> SceneColour {
    match agent {
        Agent::Human => HUMAN,
        Agent::Robot => ROBOT,
    }
}

/// Colours of the curves of one plot: as many as the sushi kitchen has places and recipes.
pub const CURVES: [SceneColour; 16] = [
    [63, 108, 255, 255],
    [179, 101, 43, 255],
    [68, 137, 8, 255],
    [229, 22, 136, 255],
    [8, 135, 129, 255],
    [160, 85, 216, 255],
    [30, 150, 210, 255],
    [150, 150, 60, 255],
    [255, 15, 255, 255],
    [150, 60, 105, 255],
    [120, 15, 240, 255],
    [45, 90, 165, 255],
    [105, 90, 30, 255],
    [165, 135, 165, 255],
    [120, 105, 135, 255],
    [180, 15, 165, 255],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_and_curves_can_be_seen_on_black_and_on_white() {
        let named = [FRAME, CONTENT, HUMAN, ROBOT, SIGNAL, GAZE, ERROR, FALSE, QUIET];
        let texts = named.into_iter().map(|colour| (colour, 4.0));
        for (colour, least) in texts.chain(CURVES.map(|colour| (colour, 3.0))) {
            let light = |part: u8| ((f64::from(part) / 255.0 + 0.055) / 1.055).powf(2.4);
            let [red, green, blue, _] = colour.map(light);
            let luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
            let [on_black, on_white] = [(luminance + 0.05) / 0.05, 1.05 / (luminance + 0.05)];
            assert!(on_black > least && on_white > least, "{colour:?}: {on_black:.1}, {on_white:.1}");
        }
    }
}
