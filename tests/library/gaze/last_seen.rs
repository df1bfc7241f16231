//! What a participant has last seen at each location: looks that are interrupted do not add up.

use std::path::Path;
use std::sync::Arc;

use tomcom::edge::files::read_session;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::{Agent, KitchenChange, LocationId};
use tomcom_session::probes::{ProbeEvent, ProbeOrigin};
use tomcom_session::{Event, Session, TimestampedEvent, apply};
use tomcom_study::analysis::seen_contents::LastSeenContents;
use tomcom_study::rater_episodes::{BeliefEvidence, BeliefEvidenceEvent};

/// A session with what was last seen in it, event by event.
struct Look {
    session: Session,
    seen: LastSeenContents,
    trace: BeliefEvidence,
    seq: u64,
    hand: LocationId,
}

impl Look {
    /// A trial in which the robot has taken tuna at 4 s.
    fn changed() -> Look {
        let files = read_session(Path::new("sessions/default.toml")).expect("the default session");
        let session = Session::new(Arc::new(files.kitchen.kitchen), files.spec, 0);
        let hand = session.kitchen.hands[Agent::Robot.index()];
        let (seen, trace) = (LastSeenContents::default(), BeliefEvidence::default());
        let mut look = Look { session, seen, trace, seq: 0, hand };
        look.at(3.0, Event::TrialStarted);
        look.at(4.0, Event::Press { agent: Agent::Robot, button: "take tuna".to_string(), at_ns: None });
        look
    }

    /// The same trial after the participant has looked at the tuna for 0.06 s.
    fn begun() -> Look {
        let mut look = Look::changed();
        look.gaze(4.5, 4);
        assert!(look.is_unseen(), "a look of 0.06 s is too short");
        look
    }

    fn at(&mut self, seconds: f64, event: Event) {
        let time = SessionTime::from_secs_f64(seconds);
        let stamped = TimestampedEvent { seq: self.seq, time, event };
        let applied = apply(&mut self.session, &stamped).expect("the event fits");
        self.seen.note(&self.session, &stamped.event, &applied.change);
        self.trace.note(&stamped, &applied.change, &self.session);
        self.seq += 1;
    }

    /// A gaze sample at the robot's hand that was taken and arrived at these times.
    fn late(&mut self, taken_s: f64, arrived_s: f64) {
        let [x, y] = self.session.kitchen.location(self.hand).display.centre();
        let taken_ns = Some(SessionTime::from_secs_f64(taken_s));
        self.at(arrived_s, Event::Gaze(GazeSample { taken_ns, ..GazeSample::new(x, y, 1.0) }));
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

/// Five samples of 0.12 s at the robot's hand, taken from `taken_s` on, all of which arrive at 4.15 s: after the change at 4 s.
fn arriving_after_the_change(taken_s: f64) -> Look {
    let mut look = Look::changed();
    for step in 0..5 {
        look.late(taken_s + 0.03 * f64::from(step), 4.15);
    }
    look
}

#[test]
fn a_look_counts_by_the_time_at_which_it_was_taken() {
    let looks =
        |look: &Look| look.trace.events.iter().any(|(_, event)| matches!(event, BeliefEvidenceEvent::Looked { .. }));
    let before = arriving_after_the_change(3.7);
    assert!(before.session.is_unseen(before.hand), "the mark on the wizard's screen, and the stratum of probes");
    assert!(before.is_unseen() && !looks(&before), "the old content was looked at");
    assert_eq!(before.session.gaze.looked_at[before.hand.index()], Some(SessionTime::from_secs_f64(3.82)));
    let after = arriving_after_the_change(4.01);
    assert!(!after.session.is_unseen(after.hand));
    assert!(!after.is_unseen() && looks(&after));
    // The duration of a look is that between samples, however they arrive: 0.06 s of the new content are too short.
    let across = arriving_after_the_change(3.94);
    assert!(!across.session.is_unseen(across.hand), "the gaze was there after the change");
    assert!(across.is_unseen() && !looks(&across));
}

/// A sample that arrives again, or late, says nothing about where the gaze is now.
#[test]
fn a_faulty_sample_ends_no_look() {
    let mut look = Look::changed();
    look.late(4.5, 4.5);
    look.late(4.56, 4.56);
    look.late(3.9, 4.57);
    look.late(4.61, 4.62);
    assert!(!look.is_unseen(), "0.11 s");
}

#[test]
fn the_scripted_wizard_sees_at_which_content_the_participant_looked() {
    let mut look = Look::changed();
    look.late(3.9, 4.1);
    assert_eq!((look.session.looked_at(), look.session.sees_present_content(look.hand)), (Some(look.hand), false));
    look.late(4.05, 4.15);
    assert_eq!((look.session.looked_at(), look.session.sees_present_content(look.hand)), (Some(look.hand), true));
}

/// A probe ends at 20 s: a sample that was taken before is no look at the kitchen, although it arrives after.
#[test]
fn a_sample_that_was_taken_during_a_probe_is_no_look_at_the_kitchen() {
    let look = |taken_s: f64| {
        let mut look = Look::changed();
        look.session.probes.ended_at = Some(SessionTime::from_secs_f64(20.0));
        look.late(taken_s, 20.05);
        (look.session.looked_at().is_some(), look.session.is_unseen(look.hand))
    };
    assert_eq!((look(19.9), look(20.01)), ((false, true), (true, false)));
}
