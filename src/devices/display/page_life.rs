//! Detection of participant pages that are gone. A browser answers the server's pings by itself, even if its page
//! hangs. The page's own messages come from timers, which browsers throttle to one per minute while the page is hidden.

use std::time::{Duration, Instant};

/// Interval of the server's pings to a page.
const PING: Duration = Duration::from_secs(2);
/// Silence of a browser (no answer to pings) after which it counts as gone.
const SILENCE: Duration = Duration::from_secs(8);
/// Time without a message after which a visible page counts as hanging; a visible page sends one message per second.
const VISIBLE: Duration = Duration::from_secs(8);
/// Time without a message after which a hidden page counts as hanging.
const HIDDEN: Duration = Duration::from_secs(90);

/// Times of a participant page's last signs of life.
#[derive(Clone, Copy, Debug)]
pub(super) struct PageLife {
    /// Arrival of the last WebSocket frame of any kind, answers to pings included.
    heard: Instant,
    /// Arrival of the last message that the page itself sent (not the browser).
    spoke: Instant,
    pinged: Instant,
    is_hidden: bool,
}

impl PageLife {
    /// Signs of life of a page that has just sent something.
    pub fn new(now: Instant) -> PageLife {
        PageLife { heard: now, spoke: now, pinged: now, is_hidden: false }
    }

    /// Records the arrival of a WebSocket frame; `is_message` says that the page itself sent it.
    pub fn heard(&mut self, now: Instant, is_message: bool) {
        self.heard = now;
        if is_message {
            self.spoke = now;
        }
    }

    /// Records whether the participant's page is hidden.
    pub fn hide(&mut self, is_hidden: bool) {
        self.is_hidden = is_hidden;
    }

    /// Records that a ping was sent to the page.
    pub fn pinged(&mut self, now: Instant) {
        self.pinged = now;
    }

    /// Time of the server's next ping to the page, or of giving up the page.
    pub fn next(&self) -> Instant {
        (self.pinged + PING).min(self.gone_at())
    }

    /// Whether nothing was heard from the page for too long.
    pub fn is_gone(&self, now: Instant) -> bool {
        now >= self.gone_at()
    }

    fn gone_at(&self) -> Instant {
        let patience = if self.is_hidden { HIDDEN } else { VISIBLE };
        (self.heard + SILENCE).min(self.spoke + patience)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Test: number of seconds, out of six hours, for which a page stays connected.
    fn stays_s(answers: bool, is_hidden: bool, message_s: u64) -> u64 {
        let start = Instant::now();
        let mut life = PageLife::new(start);
        life.hide(is_hidden);
        let hours_s = 6 * 3600;
        let gone = (1..=hours_s).find(|second| {
            let now = start + Duration::from_secs(*second);
            if now >= life.next() && !life.is_gone(now) {
                life.pinged(now);
                if answers {
                    life.heard(now, false);
                }
            }
            if second % message_s == 0 {
                life.heard(now, true);
            }
            life.is_gone(now)
        });
        gone.unwrap_or(hours_s)
    }

    #[test]
    fn a_page_stays_for_hours_as_long_as_its_browser_answers_and_it_says_something() {
        let hours_s = 6 * 3600;
        assert_eq!(stays_s(true, false, 1), hours_s, "a visible page");
        assert_eq!(stays_s(true, true, 60), hours_s, "a hidden page, whose timers are slowed down");
        assert_eq!(stays_s(false, false, hours_s), 8, "a browser that is gone");
        assert_eq!(stays_s(true, false, hours_s), 8, "a visible page that hangs");
        assert_eq!(stays_s(true, true, hours_s), 90, "a hidden page that hangs");
        assert_eq!(stays_s(false, true, 60), 8, "a hidden page whose browser is gone");
    }
}
