//! Signals that are judged when they are sent.

use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::{Sender, Signal};
use tomcom_core::kitchen::Agent;
use tomcom_session::event::{Event, SignalEndReason, TimestampedEvent};
use tomcom_session::history::signal_judge::{SignalJudge, SignalJudgementCounts};
use tomcom_session::{Session, SessionSpec, apply};

use crate::kitchen;

/// A trial whose signals are judged.
struct Trial {
    session: Session,
    judge: SignalJudge,
    seq: u64,
}

impl Trial {
    fn start() -> Trial {
        let spec: SessionSpec = toml::from_str("layout = \"\"").expect("the settings have defaults");
        let mut trial =
            Trial { session: Session::new(kitchen("sushi"), spec, 0), judge: SignalJudge::default(), seq: 0 };
        trial.event(Event::TrialStarted);
        trial
    }

    fn event(&mut self, event: Event) {
        self.seq += 1;
        let stamped =
            TimestampedEvent { seq: self.seq, time: SessionTime::from_secs_f64(10.0 * self.seq as f64), event };
        apply(&mut self.session, &stamped).expect("the event fits");
        self.judge.judge(&stamped, &self.session);
    }

    fn highlight(&mut self, place: &str, by: Sender) {
        let signal = Signal::Highlight(place.to_string());
        self.event(Event::SignalShown { by, signal, offer: None });
    }

    /// From now on only these places are believed wrong.
    fn believes_wrong(&mut self, places: &[&str]) {
        let named = |place: &&str| self.session.kitchen.aspect_named(place).expect("an aspect");
        let wrong: Vec<_> = places.iter().map(named).collect();
        self.judge.note(&self.session, |aspect| wrong.contains(&aspect));
    }

    fn press(&mut self) {
        self.event(Event::Press { agent: Agent::Human, button: "take rice".to_string(), at_ns: None });
    }
}

#[test]
fn a_signal_is_judged_by_what_was_believed_before_it() {
    let mut trial = Trial::start();
    trial.believes_wrong(&["cooking_pot"]);
    trial.highlight("cooking_pot", Sender::Wizard);
    trial.highlight("cutting_board", Sender::Wizard);
    trial.event(Event::SignalEnded { reason: SignalEndReason::TakenBack });
    let tally = SignalJudgementCounts { hits: 1, late: 0, needless: 1, taken_back: 1 };
    assert_eq!((trial.judge.tally(Sender::Wizard), tally.sent()), (tally, 2));
    assert_eq!(trial.judge.tally(Sender::Assistant), SignalJudgementCounts::default());
}

#[test]
fn it_is_late_up_to_three_presses_after_the_belief_became_right() {
    let mut trial = Trial::start();
    trial.believes_wrong(&["cooking_pot"]);
    trial.believes_wrong(&[]);
    for _ in 0..3 {
        trial.press();
    }
    trial.highlight("cooking_pot", Sender::Wizard);
    assert_eq!(
        trial.judge.tally(Sender::Wizard),
        SignalJudgementCounts { late: 1, ..SignalJudgementCounts::default() }
    );
    trial.press();
    trial.highlight("cooking_pot", Sender::Wizard);
    assert_eq!(
        trial.judge.tally(Sender::Wizard),
        SignalJudgementCounts { late: 1, needless: 1, ..SignalJudgementCounts::default() }
    );
}
