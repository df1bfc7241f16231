//! How the pages are: counted by the server, looked at by the session.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// The page that acts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ActivePage {
    pub width_px: u32,
    pub height_px: u32,
    /// There and back, in milliseconds, as it measured it last.
    pub round_trip_ms: Option<f64>,
    /// From the last press to its effect on the screen, in milliseconds.
    pub redraw_ms: Option<f64>,
}

/// What was counted so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DisplayCounts {
    pub page: Option<ActivePage>,
    /// Pages that only watch.
    pub watching: u64,
    /// Messages that were none.
    pub malformed: u64,
    /// Pages and messages that were not let in: a wrong code, too many, too fast, or of a page that only watches.
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
    pub fn counts(&self) -> DisplayCounts {
        let page = *self.page.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        DisplayCounts {
            page,
            watching: self.pages.load(Ordering::Relaxed).saturating_sub(u64::from(page.is_some())),
            malformed: self.malformed.load(Ordering::Relaxed),
            refused: self.refused.load(Ordering::Relaxed),
        }
    }

    /// Changes what is known of the page that acts.
    pub fn page(&self, change: impl FnOnce(&mut Option<ActivePage>)) {
        change(&mut self.page.lock().unwrap_or_else(std::sync::PoisonError::into_inner));
    }
}

/// Counts one more.
pub(super) fn count(counter: &AtomicU64) {
    counter.fetch_add(1, Ordering::Relaxed);
}
