//! Stand-ins for the participant's display and the observers' page at the operator's station, in a build without the feature
//! `display`.

use std::net::SocketAddr;

use ratatui::CompletedFrame;

use crate::console::preflight::ObserverStatus;
use crate::console::view::theme::Theme;
use crate::run::error::LiveError;
use tomcom_core::base::time::SessionTime;
use tomcom_devices::sight::ConsentHold;
use tomcom_session::{Event, Session, SessionSpec};

/// Input of a participant's page, which never occurs in this build; so the type has no values.
pub(in crate::run) enum PageInput {}

/// Stand-in for the participant's display, which this build lacks.
#[derive(Default)]
pub(in crate::run) struct StationDisplay {}

impl StationDisplay {
    /// Opens no display; sessions that need a display were refused before.
    pub async fn open(_: &SessionSpec) -> Result<StationDisplay, LiveError> {
        Ok(StationDisplay {})
    }

    /// Says nothing, since this build has no page that could be missing.
    pub fn missing_page(&self) -> Box<dyn Fn() -> Option<String>> {
        Box::new(|| None)
    }

    /// Does nothing, since this build has no page that could ask for consent.
    pub fn welcome(&self, _: &Session, _: Option<&str>) -> bool {
        false
    }

    pub async fn next(&mut self) -> Option<PageInput> {
        std::future::pending().await
    }
}

/// Never called, since this build has no participant's page.
pub(in crate::run) fn lost_since(input: &PageInput) -> Option<std::time::Instant> {
    match *input {}
}

/// Never called, since this build has no participant's page.
pub(in crate::run) fn take_consent_input(
    input: &PageInput,
    _: &mut ConsentHold,
    _: SessionTime,
) -> Option<&'static str> {
    match *input {}
}

/// A remark of an observer, which never occurs in this build; so the type has no values.
pub(in crate::run) enum Remark {}

impl Remark {
    pub fn event(&self) -> Event {
        match *self {}
    }

    pub fn answer(self, _: Result<(), String>) {
        match self {}
    }
}

/// Stand-in for the observers' page, which this build lacks.
#[derive(Default)]
pub(in crate::run) struct StationObservers {}

impl StationObservers {
    /// Opens no page; commands that ask for one were refused before.
    pub async fn open(_: Option<SocketAddr>) -> Result<StationObservers, LiveError> {
        Ok(StationObservers {})
    }

    pub fn show(&self, _: &CompletedFrame<'_>, _: Theme) {}

    pub async fn next(&mut self) -> Option<Remark> {
        std::future::pending().await
    }

    pub fn refuse_waiting(&mut self) {}

    pub fn status(&self) -> Option<Box<dyn Fn() -> ObserverStatus>> {
        None
    }
}
