//! A session: its settings, its state, and [`apply()`], the only function that changes the state, in a live run, a
//! replay and an analysis alike. `apply` uses no clock, no file and no random numbers.
//!
//! The files from the ground up:
//!
//! - Settings: `setting_checks`, `condition`, `participant_settings`, `console_settings`, `robot_settings`,
//!   `probe_settings`, [`wall_display`], [`stream_settings`], [`tracker`] (with its events and state), and the
//!   specifications in [`plan`]; [`settings`], all of them together. These are used by `session_file`,
//!   `requirements`, [`person_code`], [`header`], [`orders`], and the studies in [`plan`].
//! - Events: `gaze_check`, [`answer_value`], `protocol_event` (with the phases of a plan), `tutorial_event`,
//!   `probe_event`, `preflight_check`, [`wizard_screen`]; [`event`], all of them together.
//! - State: `phase`, `timeline_entry`, `gaze_status`, `robot_status`, `tutorial_state`, `protocol_state`, `probe_state`
//!   with `probe_schedule`; `session_state`, all of them together.
//! - Preconditions and effects of events: `session_effect`, `trial_clock`, [`silence`], `unseen_changes`, `robot_changes`,
//!   [`accuracy_check`], [`gaze_samples`], [`tutorial`], [`protocol`], [`probes`] with [`probe_sampling`],
//!   `interventions`; [`admit`] and [`mod@apply`], all of them together. These are used by the rules of [`offers`],
//!   [`proposals`] and [`advice_moments`]. Further files: [`preflight_checks`], and the [`timers`]
//!   that [`apply()`] sets.
//!
//! What runs and reads sessions: the [`engine`], [`headless`] runs, the [`log`] and other [`files`], [`replay`] and
//! [`verify`]; [`follower`] and [`advisor`] compute judgements, the estimate and advice beside a session, [`watcher`] the
//! advice that other senders would have given; [`history`] has words and series for what happened.

#![warn(missing_docs)]
#![deny(unsafe_code)]

pub mod accuracy_check;
pub mod admit;
pub mod advice_moments;
pub mod advisor;
pub mod answer_value;
pub mod apply;
pub mod code_correction;
mod condition;
mod console_settings;
pub mod engine;
pub mod error_list;
pub mod event;
pub mod features;
pub mod files;
pub mod follower;
mod gaze_check;
pub mod gaze_samples;
mod gaze_status;
pub mod header;
pub mod headless;
pub mod history;
mod interventions;
pub mod log;
mod lsl_settings;
pub mod offers;
pub mod orders;
mod participant_settings;
pub mod person_code;
mod phase;
pub mod plan;
mod preflight_check;
pub mod preflight_checks;
mod probe_event;
pub mod probe_sampling;
mod probe_schedule;
mod probe_settings;
mod probe_state;
pub mod probes;
pub mod proposals;
pub mod protocol;
mod protocol_event;
mod protocol_state;
pub mod ranges;
pub mod replay;
mod requirements;
mod robot_changes;
mod robot_settings;
mod robot_status;
mod session_effect;
mod session_file;
mod session_state;
mod setting_checks;
pub mod settings;
pub mod shard;
pub mod silence;
pub mod stream_settings;
pub mod study_arm;
mod timeline_entry;
pub mod timers;
pub mod tracker;
mod trial_clock;
pub mod tutorial;
mod tutorial_event;
mod tutorial_state;
mod unseen_changes;
pub mod verify;
pub mod wall_display;
pub mod watcher;
pub mod wizard_log;
pub mod wizard_screen;

pub use apply::{AppliedEvent, apply};
pub use event::{Event, TimestampedEvent};
pub use gaze_status::GazeStatus;
pub use header::LogHeader;
pub use phase::TrialPhase;
pub use robot_status::{ArmStatus, RobotStatus};
pub use session_effect::{SessionEffect, Timer};
pub use session_state::{ServedOrder, Session, ShownSignal};
pub use settings::SessionSpec;
pub use timeline_entry::{TimelineEntry, TimelineEvent};
