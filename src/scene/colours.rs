//! Colours that can be told apart and read on dark and on light ground. The same agent has the same colour everywhere; ingredients that look alike have like ones.

use crate::kitchen::{Agent, AspectId, ContentId, Kitchen};

/// Red, green, blue, opacity.
pub type Colour = [u8; 4];

/// The outline of the display.
pub const FRAME: Colour = [104, 110, 122, 255];
/// Locations without content.
pub const EMPTY: Colour = [124, 130, 142, 255];
/// Locations with content.
pub const FULL: Colour = [0, 172, 160, 255];
/// The human and its presses.
pub const HUMAN: Colour = [52, 152, 235, 255];
/// Of the human's hand and forearm.
pub const SKIN: Colour = [222, 170, 136, 255];
/// The robot and its presses.
pub const ROBOT: Colour = [236, 136, 32, 255];
/// Signals, and gaze that is usable.
pub const SIGNAL: Colour = [236, 184, 0, 255];
/// What the wizard sends.
pub const WIZARD: Colour = [180, 100, 230, 255];
/// What the assistant advises or sends.
pub const ASSISTANT: Colour = [40, 176, 104, 255];
/// Errors and stops.
pub const ERROR: Colour = [232, 60, 60, 255];
/// What matters less.
pub const QUIET: Colour = [134, 140, 152, 255];
/// A gaze sample that tells nothing.
pub const LOST: Colour = [120, 120, 120, 255];
/// The table.
pub const TABLE: Colour = [92, 84, 76, 255];
/// Buttons on the table.
pub const BUTTON: Colour = [176, 58, 58, 255];
/// Links of the arm.
pub const STEEL: Colour = [176, 186, 200, 255];
/// Joints of the arm.
pub const JOINT: Colour = [82, 132, 190, 255];

/// Of ingredients that do not look alike: yellow, green, orange, blue, pink, violet, cyan, lime.
const HUES: [f64; 8] = [0.13, 0.38, 0.06, 0.58, 0.93, 0.75, 0.48, 0.22];

/// The colour of an agent.
pub fn agent_colour(agent: Agent) -> Colour {
    match agent {
        Agent::Human => HUMAN,
        Agent::Robot => ROBOT,
    }
}

/// The colour of an ingredient item: a hue for all that look alike, paler the further it is processed.
pub fn of_item(kitchen: &Kitchen, item: ContentId) -> Colour {
    let content = kitchen.content(item);
    let own = content.ingredient.unwrap_or_default();
    let alike = content.look_alikes.iter().filter_map(|&other| kitchen.content(other).ingredient);
    let family = alike.fold(own, usize::min);
    let states = || (0..item.index()).filter(|&other| kitchen.contents[other].ingredient == Some(own));
    let paler = states().count() as f64;
    let hue = (HUES[family % HUES.len()] + if own == family { 0.0 } else { 0.94 }).fract();
    of_hue(hue, (0.85 - 0.22 * paler).max(0.25), 0.98)
}

/// The colour of an aspect: of its curves, and of the place's name in the kitchen.
pub fn of_aspect(aspect: AspectId) -> Colour {
    let nth = aspect.index();
    of_hue((0.02 + nth as f64 * 0.618).fract(), if nth.is_multiple_of(2) { 0.75 } else { 0.45 }, 0.95)
}

/// The colour of this hue, saturation and value, each from 0 to 1.
fn of_hue(hue: f64, saturation: f64, value: f64) -> Colour {
    let channel = |shift: f64| {
        let k = (shift + hue * 6.0) % 6.0;
        let part = value - value * saturation * k.min(4.0 - k).clamp(0.0, 1.0);
        (part * 255.0).round() as u8
    };
    [channel(5.0), channel(3.0), channel(1.0), 255]
}
