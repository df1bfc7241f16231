//! Durations of events in the BIDS export: an event such as a pause begins a span of time that a later event ends.

use std::collections::BTreeMap;

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::Agent;
use tomcom_session::gaze_check::GazeCheckEvent;
use tomcom_session::event::Event;
use tomcom_session::probes::ProbeEvent;
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::tracker::TrackerEvent;
use tomcom_session::wall_display::DisplayEvent;

/// Something that lasts from one event to another in a recording, such as a pause or a signal.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Span {
    Trial,
    Pause,
    Phase,
    Order(String),
    RobotPress,
    RobotIdle,
    RobotStop,
    RobotHold,
    Safety,
    Signal,
    Offer,
    Probe,
    Target,
    TrackerLoss,
    DisplayUnseen,
    DisplayLoss,
    Unfocused,
    EyesClosed,
}

/// Spans that have begun and not ended, each with the table row and the time of the event that began the span.
#[derive(Debug, Default)]
pub(super) struct OpenSpans(BTreeMap<Span, (usize, SessionTime)>);

impl OpenSpans {
    /// Notes an event that stands in row `row` of the table: returns the event's duration so far (`None` for a span
    /// that goes on), and the spans that the event ends, each as the row of the event that began the span and its
    /// duration.
    pub(super) fn note(
        &mut self,
        row: usize,
        time: SessionTime,
        event: &Event,
    ) -> (Option<SessionTime>, Vec<(usize, SessionTime)>) {
        let (begins, ends) = (begun(event), ended(event));
        let is_over = |span: &Span| match event {
            Event::SessionEnded => true,
            Event::TrialEnded { .. } | Event::TrialAborted { .. } => is_of_trial(span),
            _ => ends.contains(span) || begins.as_ref() == Some(span),
        };
        let over: Vec<(usize, SessionTime)> =
            self.0.iter().filter(|(span, _)| is_over(span)).map(|(_, (row, since))| (*row, time - *since)).collect();
        self.0.retain(|span, _| !is_over(span));
        match begins {
            Some(span) => {
                self.0.insert(span, (row, time));
                (None, over)
            }
            None => (Some(SessionTime::ZERO), over),
        }
    }
}

/// Whether a span of this kind ends at the latest with the trial.
fn is_of_trial(span: &Span) -> bool {
    matches!(
        span,
        Span::Trial
            | Span::Pause
            | Span::Order(_)
            | Span::RobotPress
            | Span::RobotIdle
            | Span::RobotStop
            | Span::RobotHold
            | Span::Signal
            | Span::Offer
            | Span::Probe
    )
}

/// The span of time that an event begins; `None` for an event without duration.
fn begun(event: &Event) -> Option<Span> {
    Some(match event {
        Event::TrialStarted => Span::Trial,
        Event::TrialPaused => Span::Pause,
        Event::Protocol(ProtocolEvent::PhaseStarted { .. }) => Span::Phase,
        Event::OrderShown { order, .. } => Span::Order(order.clone()),
        Event::RobotIntends { .. } => Span::RobotPress,
        Event::RobotIdles { .. } => Span::RobotIdle,
        Event::RobotStopped => Span::RobotStop,
        Event::RobotHeld { .. } => Span::RobotHold,
        Event::RobotSafety { .. } => Span::Safety,
        Event::SignalShown { .. } => Span::Signal,
        Event::OfferOpened(_) => Span::Offer,
        Event::Probe(ProbeEvent::Begun { .. }) => Span::Probe,
        Event::Calibration(GazeCheckEvent::TargetShown { .. }) => Span::Target,
        Event::Tracker(TrackerEvent::Lost { .. }) => Span::TrackerLoss,
        Event::Tracker(TrackerEvent::DisplayLost | TrackerEvent::OtherSurfaces { .. }) => Span::DisplayUnseen,
        Event::Tracker(TrackerEvent::Blink { closed: true, .. }) => Span::EyesClosed,
        Event::Display(DisplayEvent::Lost) => Span::DisplayLoss,
        Event::FocusLost => Span::Unfocused,
        _ => return None,
    })
}

/// The spans of time that an event ends. (An event that begins a span also ends an earlier span of the same kind; such
/// an earlier span is not listed here.)
fn ended(event: &Event) -> Vec<Span> {
    match event {
        Event::TrialResumed => vec![Span::Pause],
        Event::OrderCleared { order } => vec![Span::Order(order.clone())],
        Event::Press { agent: Agent::Robot, .. } | Event::RobotAborts { .. } => vec![Span::RobotPress],
        Event::RobotIntends { .. } => vec![Span::RobotIdle],
        Event::RobotIdles { .. } => vec![Span::RobotPress],
        Event::RobotResumed => vec![Span::RobotStop],
        Event::RobotReleased { .. } => vec![Span::RobotHold],
        Event::SignalEnded { .. } => vec![Span::Signal],
        Event::OfferClosed { .. } => vec![Span::Offer],
        Event::Probe(ProbeEvent::Ended { .. }) => vec![Span::Probe],
        Event::Calibration(
            GazeCheckEvent::TargetsHidden | GazeCheckEvent::Dismissed | GazeCheckEvent::Begun { .. },
        ) => vec![Span::Target],
        Event::Tracker(TrackerEvent::Connected { .. }) => vec![Span::TrackerLoss],
        Event::Tracker(TrackerEvent::DisplayFound) => vec![Span::DisplayUnseen],
        Event::Tracker(TrackerEvent::Blink { closed: false, .. }) => vec![Span::EyesClosed],
        Event::Display(DisplayEvent::Connected { .. }) => vec![Span::DisplayLoss],
        Event::FocusRegained => vec![Span::Unfocused],
        _ => Vec::new(),
    }
}
