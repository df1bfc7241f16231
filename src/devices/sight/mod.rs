//! What the participant may see. [`scene`] is what stays the same during a recording, [`sight`] is what changes, and
//! [`RobotHand`] is where the robot's hand is now. These modules choose what the page receives; anything else (beliefs,
//! advice, recipes, the robot's intention) has no way to the page.
//!
//! The choice is a whitelist: a new field of the session is invisible until code here adds the field. The page always
//! receives the complete content, so a lost message, a second page and a restart of the page are handled alike.

#[cfg(feature = "physics")]
mod arm_tip;
mod consent;
mod content;
mod display_place;
mod displayed_item;
pub mod page_language;
mod probe_page;
mod robot_hand;
mod robot_pose;
mod scene;
mod shown_clock;

mod tutorial_page;

pub use consent::{ConsentHold, consent_sight};
pub use content::{DisplayContent, DisplayStage, ShownContent, sight};
pub use probe_page::{ProbeWording, choice_made_of, probe_left, probe_wording};
pub use robot_hand::RobotHand;
pub use robot_pose::RobotHandPose;
pub use scene::{DisplayScene, scene};
pub use shown_clock::{TrialClockState, time_left};
