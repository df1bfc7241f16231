//! The position in a recording that is shown: moved by keys and clicks, and by time while the recording plays.

use std::time::{Duration, Instant};

use super::Review;
use crate::console::console_model::{NoticeLevel, Playback, ReplayAction, SPEEDS, TRAIL_S};
use tomcom_core::base::text::count;
use tomcom_core::base::time::SessionTime;
use tomcom_session::Event;
use tomcom_session::replay::ReplayLandmark;

/// Longest time per frame that is spent on applying events at full speed.
const WORK: Duration = Duration::from_millis(20);
/// Length of one step of seeking in a recording, 10 s.
const SEEK: SessionTime = SessionTime(10_000_000_000);

impl Review {
    /// Moves the replay, or changes whether and how fast it plays.
    pub(super) fn go(&mut self, to: ReplayAction) {
        let speeds = SPEEDS.len() - 1;
        match to {
            ReplayAction::PlayPause => {
                let at_end = self.film.position == self.film.length().1 && !self.grows;
                if at_end {
                    let start = self.film.trial_start();
                    self.stand_at(start);
                }
                self.playback(|playback| playback.playing = !playback.playing);
            }
            ReplayAction::Faster => self.playback(|playback| playback.speed = (playback.speed + 1).min(speeds)),
            ReplayAction::Slower => self.playback(|playback| playback.speed = playback.speed.saturating_sub(1)),
            ReplayAction::StepForward => self.step_to(self.film.next_step()),
            ReplayAction::StepBack => self.step_to(self.film.last_step()),
            ReplayAction::On(what) => self.look_for(what, true),
            ReplayAction::BackTo(what) => self.look_for(what, false),
            ReplayAction::ToStart => self.stand_at(0),
            ReplayAction::ToEvent(number) => {
                self.stand_at(number as usize + 1);
                self.name_landmark(ReplayLandmark::Error);
            }
            ReplayAction::ToTime(time) => self.seek(time),
            ReplayAction::ToClock(clock) => match self.film.at_clock(clock) {
                Some(time) => self.seek(time),
                None => {
                    let end = self.film.trial_length();
                    let words = format!("there is no {clock}: the trial's clock ends at {end}");
                    self.model.say(NoticeLevel::Refused, words);
                }
            },
            ReplayAction::ToNth(what, number) => self.go_to_nth(what, number),
            ReplayAction::SeekForward => self.seek(self.now + SEEK),
            ReplayAction::SeekBack => self.seek(self.now - SEEK),
            ReplayAction::ToEnd => {
                let (length, events) = self.film.length();
                self.wind(events);
                self.now = length;
                let grows = self.grows;
                self.playback(|playback| playback.playing = grows);
            }
        }
        let follows = self.grows && to == ReplayAction::ToEnd;
        if !matches!(to, ReplayAction::Faster | ReplayAction::Slower) {
            self.playback(|playback| playback.follows = follows);
        }
        self.at = Instant::now();
    }

    /// Shows the recording as it was after its first `position` events, and pauses there.
    pub(super) fn stand_at(&mut self, position: usize) {
        self.wind(position);
        self.now = self.film.time();
        self.playback(|playback| playback.playing = false);
    }

    /// Moves the replay to the next or previous landmark of this kind, if there is one.
    fn look_for(&mut self, what: ReplayLandmark, forward: bool) {
        // Where it stands at a landmark of another kind, one of this kind can have the same time.
        let stands_at = self.model.playback.as_ref().and_then(Playback::stands_at);
        let is_told = stands_at.is_some_and(|(at, _)| at == Some(what));
        match self.film.landmark(what, forward, !is_told) {
            Some(position) => {
                self.stand_at(position);
                self.name_landmark(what);
            }
            None => {
                let which = if forward { "later" } else { "earlier" };
                self.model.say(NoticeLevel::Refused, format!("the recording has no {which} {}", what.name()));
            }
        }
    }

    /// Moves the replay to the landmark of this kind with this number, if there is one.
    fn go_to_nth(&mut self, what: ReplayLandmark, number: usize) {
        let times = self.film.landmarks(what);
        match number.checked_sub(1).and_then(|index| times.get(index)) {
            Some(&time) => {
                let position = self.film.until(time);
                self.stand_at(position);
                self.name_landmark(what);
            }
            None => {
                let name = what.name();
                let all = count(times.len() as u64, name, &format!("{name}s"));
                self.model.say(NoticeLevel::Refused, format!("there is no {name} {number}: the recording has {all}"));
            }
        }
    }

    /// Shows which landmark of this kind the replay stands at, if it stands at one, and what it is.
    fn name_landmark(&mut self, what: ReplayLandmark) {
        let (position, said) = (self.film.position, self.film.named(what));
        self.playback(|playback| playback.landmark = said.map(|said| (position, Some(what), said)));
    }

    /// Moves the replay to the next or previous event, and shows which event that is.
    fn step_to(&mut self, position: usize) {
        self.stand_at(position);
        let (position, said) = (self.film.position, self.film.named_event());
        self.playback(|playback| playback.landmark = said.map(|said| (position, None, said)));
    }

    /// Goes to a session time, and plays on if it played.
    fn seek(&mut self, time: SessionTime) {
        self.now = time.min(self.film.length().0);
        let position = self.film.until(self.now);
        self.wind(position);
    }

    fn wind(&mut self, position: usize) {
        self.film.wind(position);
        // The gaze map shows what it shows after playing up to here.
        self.model.trail.clear();
        let from = self.film.until(self.film.time() - SessionTime::from_secs_f64(TRAIL_S));
        self.film.each(from..self.film.position, |stamped| {
            if let Event::Gaze(sample) = stamped.event {
                self.model.see(stamped.time, sample);
            }
        });
    }

    /// Advances the replay by the time that has passed since the last frame.
    pub(super) fn play(&mut self) {
        let passed = self.at.elapsed();
        self.at = Instant::now();
        let (length, events) = self.film.length();
        if self.is(|playback| playback.follows) {
            // For a session that is still running, the shown clock goes on between events.
            let ahead = if self.grows { self.read_at.elapsed().as_nanos() as u64 } else { 0 };
            self.now = self.now.max(length + SessionTime(ahead));
        } else if self.is(|playback| playback.playing) {
            let speed = self.model.playback.as_ref().map_or(1.0, |playback| SPEEDS[playback.speed]);
            self.now = match speed.is_finite() {
                true => (self.now + SessionTime::from_secs_f64(passed.as_secs_f64() * speed)).min(length),
                false => length,
            };
        } else {
            return;
        }
        if !self.film.is_read() {
            self.now = self.now.min(self.film.read_to());
        }
        let until = self.film.until(self.now);
        let began = Instant::now();
        while self.film.position < until && began.elapsed() < WORK {
            let Some(stamped) = self.film.forward() else { break };
            if let Event::Gaze(sample) = stamped.event {
                self.model.see(stamped.time, sample);
            }
        }
        if self.film.position < until {
            self.now = self.film.time();
        } else if self.film.position == events && !self.grows {
            self.playback(|playback| playback.playing = false);
        }
        self.dirty = true;
    }
}
