//! Colours of the scene in Rerun, which can be told apart and read on a dark and on a light background. An agent has
//! the same colour everywhere in the scene; ingredients that look alike have similar colours.

use tomcom_core::kitchen::{Agent, AspectId, ContentId, Kitchen};

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

/// The colour of an agent.
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

/// The colour of a state aspect, for its curves and for the location's name in the kitchen.
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
