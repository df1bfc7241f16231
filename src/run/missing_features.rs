//! What stands for the parts that a build lacks: without `display` the participant's page and the observers' page, without
//! `rerun` the streams to viewers, without `ur` a real arm. Sessions and commands that need such a part are refused before
//! (`tomcom_session::features`), so what comes from the part, or goes to it, is a type without values.

/// A type without values, whose functions are therefore never called.
macro_rules! uncallable {
    ($type:ident { $($function:ident($($argument:ty),*) $(-> $result:ty)?,)* }) => {
        pub(in crate::run) enum $type {}

        impl $type {
            $(pub fn $function(&self, $(_: $argument),*) $(-> $result)? {
                match *self {}
            })*
        }
    };
}

#[cfg(not(feature = "ur"))]
pub(super) mod arm {
    use std::future::pending;

    use crate::run::error::LiveError;
    use tomcom_core::kitchen::Kitchen;
    use tomcom_session::{Event, SessionSpec};

    uncallable! { ArmNews {} }
    uncallable! { ArmOrders { begin(), order(impl Sized), tell(&Event), } }

    #[derive(Default)]
    pub(in crate::run) struct StationArm {}

    impl StationArm {
        pub fn open(_: &SessionSpec, _: &Kitchen) -> Result<StationArm, LiveError> {
            Ok(StationArm {})
        }

        pub fn orders(&self) -> Option<ArmOrders> {
            None
        }

        pub async fn next(&mut self) -> Option<ArmNews> {
            pending().await
        }
    }
}

#[cfg(not(feature = "display"))]
pub(super) mod display {
    use std::future::pending;
    use std::net::SocketAddr;
    use std::time::Instant;

    use ratatui::CompletedFrame;

    use crate::console::console_model::NoticeLevel;
    use crate::console::preflight::{ObserverStatus, ParticipantDisplayHealth};
    use crate::console::view::theme::Theme;
    use crate::run::error::LiveError;
    use crate::run::operator_station::OperatorStation;
    use tomcom_core::base::time::SessionTime;
    use tomcom_devices::sight::ConsentHold;
    use tomcom_session::{Event, Session, SessionSpec};

    uncallable! { PageInput {} }
    uncallable! { Remark { event() -> Event, answer(Result<(), String>), } }
    uncallable! {
        ParticipantDisplay {
            build(&Session),
            move_robot(&Session, SessionTime),
            show(&Session, SessionTime),
            examine(&mut ParticipantDisplayHealth),
        }
    }

    impl ParticipantDisplay {
        pub fn at(_: &OperatorStation) -> (Option<ParticipantDisplay>, Option<ParticipantDisplayHealth>) {
            (None, None)
        }
    }

    pub(in crate::run) struct PageEvent {
        pub event: Option<Event>,
        pub notice: Option<(NoticeLevel, String)>,
    }

    impl PageEvent {
        pub fn from_input(input: PageInput, _: &Session, _: SessionTime) -> PageEvent {
            match input {}
        }
    }

    pub(in crate::run) fn lost_since(input: &PageInput) -> Option<Instant> {
        match *input {}
    }

    pub(in crate::run) fn take_consent_input(
        input: &PageInput,
        _: &mut ConsentHold,
        _: SessionTime,
    ) -> Option<&'static str> {
        match *input {}
    }

    #[derive(Default)]
    pub(in crate::run) struct StationDisplay {}

    impl StationDisplay {
        pub async fn open(_: &SessionSpec) -> Result<StationDisplay, LiveError> {
            Ok(StationDisplay {})
        }

        /// Says nothing, since there is no page that could be missing.
        pub fn missing_page(&self) -> Box<dyn Fn() -> Option<String>> {
            Box::new(|| None)
        }

        /// Returns that no page asks for consent.
        pub fn welcome(&self, _: &Session, _: Option<&str>) -> bool {
            false
        }

        pub async fn next(&mut self) -> Option<PageInput> {
            pending().await
        }
    }

    #[derive(Default)]
    pub(in crate::run) struct StationObservers {}

    impl StationObservers {
        pub async fn open(_: Option<SocketAddr>) -> Result<StationObservers, LiveError> {
            Ok(StationObservers {})
        }

        pub fn show(&self, _: &CompletedFrame<'_>, _: Theme) {}

        pub async fn next(&mut self) -> Option<Remark> {
            pending().await
        }

        pub fn refuse_waiting(&mut self) {}

        pub fn status(&self) -> Option<Box<dyn Fn() -> ObserverStatus>> {
            None
        }
    }
}

#[cfg(not(feature = "rerun"))]
pub(super) mod rerun {
    use crate::console::console_model::RerunStreamStatus;
    use tomcom_session::engine::SessionEngine;
    use tomcom_session::features::{Feature, MissingFeature};
    use tomcom_session::log::LogWriter;
    use tomcom_session::{LogHeader, Session, TimestampedEvent};

    uncallable! {
        StreamedSession {
            view(&[TimestampedEvent], &SessionEngine),
            give_up_file() -> bool,
            status() -> RerunStreamStatus,
            close(&LogWriter),
        }
    }

    impl StreamedSession {
        /// Opens no stream.
        ///
        /// # Errors
        /// The session's settings ask for a stream, without which it goes on: the wizard is told so.
        pub fn open(
            session: &Session,
            _: &LogHeader,
            _: &mut LogWriter,
            _: u64,
            _: bool,
        ) -> Result<Option<StreamedSession>, String> {
            if session.spec.rerun.is_on() { Err(MissingFeature(Feature::Rerun).to_string()) } else { Ok(None) }
        }
    }
}
