//! What a participant has last seen at each location: looks that are interrupted do not add up.

use std::path::Path;
use std::sync::Arc;

use tomcom::analysis::seen_contents::LastSeenContents;
use tomcom::base::time::SessionTime;
use tomcom::edge::files::read_session;
use tomcom::gaze::GazeSample;
use tomcom::kitchen::{Agent, KitchenChange, LocationId};
use tomcom::session::probes::{ProbeEvent, ProbeOrigin};
use tomcom::session::{Event, Session, TimestampedEvent, apply};

/// A session with what was last seen in it, event by event.
struct Look {
    session: Session,
    seen: LastSeenContents,
    seq: u64,
    hand: LocationId,
}

impl Look {
    /// A trial in which the robot has taken tuna, which the participant has looked at for 0.06 s.
    fn begun() -> Look {
        let files = read_session(Path::new("sessions/default.toml")).expect("the default session");
        let session = Session::new(Arc::new(files.kitchen.kitchen), files.spec, 0);
        let hand = session.kitchen.hands[Agent::Robot.index()];
        let mut look = Look { session, seen: LastSeenContents::default(), seq: 0, hand };
        look.at(3.0, Event::TrialStarted);
        look.at(4.0, Event::Press { agent: Agent::Robot, button: "take tuna".to_string(), at_ns: None });
        look.gaze(4.5, 4);
        assert!(look.is_unseen(), "a look of 0.06 s is too short");
        look
    }

    fn at(&mut self, seconds: f64, event: Event) {
        let time = SessionTime::from_secs_f64(seconds);
        let stamped = TimestampedEvent { seq: self.seq, time, event };
        let applied = apply(&mut self.session, &stamped).expect("the event fits");
        self.seen.note(&self.session, &stamped.event, &applied.change);
        self.seq += 1;
    }

    /// This number of gaze samples at the robot's hand, 0.02 s apart.
    fn gaze(&mut self, from_s: f64, samples: u32) {
        let [x, y] = self.session.kitchen.location(self.hand).display.centre();
        for step in 0..samples {
            self.at(from_s + 0.02 * f64::from(step), Event::Gaze(GazeSample::new(x, y, 1.0)));
        }
    }

    fn is_unseen(&self) -> bool {
        self.seen.is_changed_unseen(self.hand)
    }
}

#[test]
fn a_look_goes_on_until_the_location_counts_as_seen() {
    let mut look = Look::begun();
    look.gaze(4.58, 3);
    assert!(!look.is_unseen(), "0.12 s");
}

#[test]
fn a_pause_and_a_freeze_probe_interrupt_looks() {
    let mut paused = Look::begun();
    paused.at(4.57, Event::TrialPaused);
    paused.at(14.0, Event::TrialResumed);
    paused.gaze(14.02, 4);
    assert!(paused.is_unseen(), "two looks of 0.06 s");
    paused.gaze(14.1, 3);
    assert!(!paused.is_unseen(), "the second one went on");
    let mut probed = Look::begun();
    let begun =
        ProbeEvent::Begun { probe: 1, origin: ProbeOrigin::Wizard, uses_estimate: false, questions: Vec::new() };
    probed.seen.note(&probed.session, &Event::Probe(begun), &KitchenChange::None);
    probed.gaze(4.58, 4);
    assert!(probed.is_unseen(), "two looks of 0.06 s");
}
