//! Slips of the hand: which other button is hit instead of the intended one.
//!
//! The neighbour that a slip of the assistant's human model hits ([`Kitchen::nearest_button`]) is another mechanism:
//! inference must not be tested on the human that the assistant models exactly.

use super::weighted_draw::drawn_by_weight;
use tomcom_core::base::rng::Stream;
use tomcom_core::kitchen::{Agent, ButtonId, Kitchen};

/// Distance from the intended button, in metres, at which a button is hit e times less often than next to the intended
/// button: the spacing of the buttons in a row of the sushi kitchen. End points of quick reaches scatter normally
/// around their target (Schmidt et al. 1979), so weights fall with the square of the distance: two spacings away, to
/// 2 %.
const SLIP_REACH_M: f64 = 0.12;
/// How many times as often a button is hit whose cap has the colour of the intended button's cap, at the same distance.
/// What resembles the intended object attracts slips (Norman 1981, description errors), and search is guided by colour
/// (Wolfe 1994). No source has a number for buttons; with 2, of two buttons at the same distance the one of like colour
/// gets two thirds of the slips.
const LIKE_COLOUR: f64 = 2.0;

/// Draws the button of the human that a slip hits instead of the button `meant`: buttons nearby and of like colour are
/// hit more often. If the layout gives the intended button no colour, distance alone decides. `None` if the human has
/// no other button.
pub fn slipped_button(kitchen: &Kitchen, meant: ButtonId, random: &mut Stream) -> Option<ButtonId> {
    let buttons = &kitchen.buttons[Agent::Human.index()];
    let own = &buttons[meant.index()];
    let apart_m = |other: usize| {
        let [x, y] = buttons[other].at_m;
        (x - own.at_m[0]).hypot(y - own.at_m[1])
    };
    let others: Vec<usize> = (0..buttons.len()).filter(|&other| other != meant.index()).collect();
    let nearest_m = others.iter().map(|&other| apart_m(other)).fold(f64::INFINITY, f64::min);
    // Relative to the nearest button, so that the weights of buttons that stand far apart do not all vanish.
    let weight = |other: usize| {
        let is_alike = own.colour.is_some() && buttons[other].colour == own.colour;
        let factor = if is_alike { LIKE_COLOUR } else { 1.0 };
        factor * ((nearest_m.powi(2) - apart_m(other).powi(2)) / SLIP_REACH_M.powi(2)).exp()
    };
    let weights: Vec<f64> = others.iter().map(|&other| weight(other)).collect();
    // What rounding leaves after the last weight belongs to it.
    drawn_by_weight(random, &weights).or(others.len().checked_sub(1)).map(|index| ButtonId(others[index] as u8))
}
