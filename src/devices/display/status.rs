//! State and counters of the participant's pages, written by the server and read by the session.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// State of the participant page that takes part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ActivePage {
    /// Width of the participant's page in pixels.
    pub width_px: u32,
    /// Height of the participant's page in pixels.
    pub height_px: u32,
    /// Whether the page shows the layout of upright screens, on which gaze is not mapped.
    pub upright: bool,
    /// Last measured round-trip time between page and server, in milliseconds.
    pub round_trip_ms: Option<f64>,
    /// Time from the last press until its effect was drawn, in milliseconds.
    pub redraw_ms: Option<f64>,
}

/// State and counters of the participant's pages.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DisplayCounts {
    /// State of the page that takes part, if there is one.
    pub page: Option<ActivePage>,
    /// Number of participant pages that only watch.
    pub watching: u64,
    /// Number of malformed messages from pages.
    pub malformed: u64,
    /// Number of refused pages and messages: wrong pairing code, too many, too fast, or from a watching page.
    pub refused: u64,
}

#[derive(Debug, Default)]
pub(super) struct DisplayStatus {
    pub pages: AtomicU64,
    pub malformed: AtomicU64,
    pub refused: AtomicU64,
    page: Mutex<Option<ActivePage>>,
}

impl DisplayStatus {
    /// The present state and counters of the participant's pages.
    pub fn counts(&self) -> DisplayCounts {
        let page = *self.page.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        DisplayCounts {
            page,
            watching: self.pages.load(Ordering::Relaxed).saturating_sub(u64::from(page.is_some())),
            malformed: self.malformed.load(Ordering::Relaxed),
            refused: self.refused.load(Ordering::Relaxed),
        }
    }

    /// Updates the state of the participant page that takes part.
    pub fn page(&self, change: impl FnOnce(&mut Option<ActivePage>)) {
        change(&mut self.page.lock().unwrap_or_else(std::sync::PoisonError::into_inner));
    }
}

/// Adds 1 to a counter of the participant's pages.
pub(super) fn count(counter: &AtomicU64) {
    counter.fetch_add(1, Ordering::Relaxed);
}
