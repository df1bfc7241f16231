//! A session: its settings, its state, and [`apply()`], the only function that changes the state, in a live run, a
//! replay and an analysis alike. `apply` uses no clock, no file and no random numbers.
//!
//! - Settings: [`settings`], [`wall_display`], [`stream_settings`], [`tracker`], [`ranges`]; the files of a study are
//!   [`plan`], [`questionnaire`] and [`tutorial`].
//! - Events and state: [`event`], `session_state`, [`header`].
//! - Preconditions and effects of events: [`admit`] and [`mod@apply`]; of one feature each: [`gaze_check`],
//!   [`gaze_samples`], [`protocol`], [`tutorial`], [`probes`] with [`probe_settings`] and [`probe_sampling`], [`offers`], [`proposals`].
//! - What a device of the participant tells: [`button_box`].
//! - Concepts and participants of other people, which answer over a connection: [`external`].
//! - What runs and reads sessions: [`engine`], [`headless`], [`log`], [`files`], [`replay`], [`verify`].
//! - What is computed beside a session: [`follower`] (judgements, the belief estimate), [`advisor`] (advice), [`watcher`]
//!   (advice that other senders would have given), [`history`] (words and series), [`wizard_log`].

#![deny(unsafe_code)]

/// The name of a variant in files, as strum makes it.
macro_rules! named {
    ($($enumeration:ty),+) => {
        $(impl $enumeration {
            pub fn name(self) -> &'static str {
                self.into()
            }
        })+
    };
}

pub mod admit;
pub mod advisor;
pub mod apply;
pub mod button_box;
pub mod engine;
pub mod error_list;
pub mod event;
pub mod external;
pub mod features;
pub mod files;
pub mod film;
pub mod follower;
pub mod gaze_check;
pub mod gaze_samples;
pub mod header;
pub mod headless;
pub mod history;
pub mod log;
pub mod offers;
pub mod order_needs;
pub mod orders;
pub mod person_code;
pub mod plan;
pub mod preflight_checks;
pub mod probe_sampling;
pub mod probe_settings;
pub mod probes;
pub mod proposals;
pub mod protocol;
pub mod questionnaire;
pub mod ranges;
pub mod replay;
mod session_state;
pub mod settings;
pub mod stream_settings;
pub mod study_arm;
pub mod tracker;
pub mod tutorial;
pub mod verify;
pub mod wall_display;
pub mod watcher;
pub mod wizard_log;

pub use apply::{AppliedEvent, SessionEffect, Timer, apply};
pub use event::{Event, TimestampedEvent};
pub use gaze_samples::GazeStatus;
pub use header::LogHeader;
pub use session_state::{
    ArmStatus, RobotStatus, ServedOrder, Session, ShownSignal, TimelineEntry, TimelineEvent, TrialPhase,
};
pub use settings::SessionSpec;
