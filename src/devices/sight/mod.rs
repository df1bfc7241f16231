//! What the participant may see. [`scene`] is what stays the same during a recording, [`sight`] is what changes, and
//! [`RobotHand`] is where the robot's hand is now. These modules choose what the page receives; anything else (beliefs,
//! advice, recipes, the robot's intention) has no way to the page.
//!
//! The choice is a whitelist: a new field of the session is invisible until code here adds the field. The page always
//! receives the complete content, so a lost message, a second page and a restart of the page are handled alike.

mod consent;
mod content;
mod displayed_item;
pub mod page_language;
mod probe_page;
mod robot_hand;
mod scene;
mod tutorial_page;

pub use consent::{ConsentHold, consent_sight};
pub use content::{DisplayContent, DisplayStage, ShownContent, TrialClockState, sight, time_left};
pub use probe_page::{ProbeWording, probe_left, probe_wording};
pub use robot_hand::{RobotHand, RobotHandPose};
pub use scene::{DisplayScene, scene};
