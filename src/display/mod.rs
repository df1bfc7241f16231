//! What the participant may see: made from the session by two functions and the robot's hand, and from nothing else. [`scene`] is what stays
//! the same during a recording, [`sight`] what changes, [`RobotHand`] where the robot is now. They pick what is shown; whatever they do not pick (beliefs, advice,
//! recipes, the robot's intention) has no way to the page.
//!
//! `sight` computes what the participant may see now, `scene` what stays the same: a whitelist, so that a new field of the session is
//! invisible until it is added here. The page always gets the whole sight, so a lost message, a second page and a restart are the same case.

#[cfg(feature = "physics")]
mod arm_tip;
mod consent;
mod display_place;
mod displayed_item;
pub mod page_language;
mod probe_page;
mod robot_hand;
mod robot_pose;
mod scene;
mod shown_clock;
mod sight;
mod tutorial_page;

pub use consent::consent_sight;
pub use probe_page::{ProbeWording, choice_made_of, probe_left, probe_wording};
pub use robot_hand::RobotHand;
pub use robot_pose::RobotPose;
pub use scene::{DisplayScene, scene};
pub use shown_clock::{DisplayedClock, time_left};
pub use sight::{DisplayStage, DisplayUpdate, sight};
