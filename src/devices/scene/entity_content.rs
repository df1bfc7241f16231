//! Content of an entity in Rerun's scene: shapes, values, text. Lengths in the kitchen are such that the wall display
//! is 1500 wide, measured from its top left corner; lengths of the arm are in metres in the frame of the robot's base.

use nalgebra::Isometry3;

use tomcom_arm::kinematics::CollisionSolid;
use tomcom_core::kitchen::{Agent, AspectId};

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
/// Colour of locations with content.
pub const FULL: SceneColour = [0, 136, 126, 255];
/// Colour of the human and the human's presses, as on the participant's page.
pub const HUMAN: SceneColour = [179, 101, 43, 255];
/// Colour of the human's hand and forearm.
pub const SKIN: SceneColour = [222, 170, 136, 255];
/// Colour of the robot and its presses, as on the participant's page.
pub const ROBOT: SceneColour = [77, 124, 176, 255];
/// Colour of signals, as on the participant's page.
pub const SIGNAL: SceneColour = [199, 76, 136, 255];
/// Colour of usable gaze samples.
pub const GAZE: SceneColour = [236, 184, 0, 255];
/// Colour of signals that the wizard sends.
pub const WIZARD: SceneColour = [160, 88, 205, 255];
/// Colour of signals that the assistant recommends or sends.
pub const ASSISTANT: SceneColour = [29, 138, 80, 255];
/// Colour of the human's errors and of stops of the arm.
pub const ERROR: SceneColour = [223, 57, 57, 255];
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

/// Colours of aspects, neighbours far apart.
const ASPECTS: [u32; 24] = [
    0xe72f16, 0x5970e0, 0x448908, 0xc14ba4, 0x088781, 0x937438, 0x8458ff, 0x33893a, 0xed1745, 0x457cb2, 0x698207,
    0xb74bc2, 0x088a58, 0xaf6643, 0x6563ff, 0x488732, 0xe51688, 0x368391, 0x8a7908, 0xa055d8, 0x098c2d, 0xcb5051,
    0x3f6cff, 0x628330,
];

/// The colour of an aspect's name and curves.
pub fn of_aspect(aspect: AspectId) -> SceneColour {
    let [_, red, green, blue] = ASPECTS[aspect.index() % ASPECTS.len()].to_be_bytes();
    [red, green, blue, 255]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_can_be_read_on_black_and_on_white() {
        let named = [FRAME, FULL, HUMAN, ROBOT, SIGNAL, WIZARD, ASSISTANT, ERROR, QUIET];
        for colour in named.into_iter().chain((0..24).map(|nth| of_aspect(AspectId(nth)))) {
            let light = |part: u8| ((f64::from(part) / 255.0 + 0.055) / 1.055).powf(2.4);
            let [red, green, blue, _] = colour.map(light);
            let luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
            let [on_black, on_white] = [(luminance + 0.05) / 0.05, 1.05 / (luminance + 0.05)];
            assert!(on_black > 4.0 && on_white > 4.0, "{colour:?}: {on_black:.1}, {on_white:.1}");
        }
    }
}
