//! Collects the signals of a session event by event: with their reasons and effects, and, of a wizard's, for the measures of
//! [`tomcom_core::measures::wizard_performance`].

use serde::Serialize;

use crate::event::{SignalEndReason, WizardScreenContent};
use crate::follower::SessionFollower;
use crate::settings::ParticipantKind;
use crate::{Event, Session, TimestampedEvent};
use tomcom_core::base::text::count;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::offer::OfferWorth;
use tomcom_core::communication::recommendation::{Recommendation, SignalOption, SignalReason, aspects_told};
use tomcom_core::communication::{Sender, Signal};
use tomcom_core::kitchen::AspectId;
use tomcom_core::measures::sequences::FalseBeliefEpisode;
use tomcom_core::measures::wizard_performance::{
    FalseBeliefPeriod, SignalVerdict, WizardMeasures, WizardSignal, verdicts,
};

/// A signal that was shown, with what is known of its reason and of its effect.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownSignalRecord {
    /// Sequence number of its event.
    pub seq: u64,
    /// Session time.
    pub time: SessionTime,
    pub by: Sender,
    pub signal: Signal,
    /// Why the assistant advised it, in the assistant's terms, or in the words of an external concept. Of a signal that a
    /// wizard chose alone, why the assistant would have sent it.
    pub reason: Option<SignalReason>,
    pub words: Option<String>,
    /// Its value by the last advice before it.
    pub worth: Option<SignalOption>,
    /// Its value when the offer of it opened, which the wizard took.
    pub offered: Option<OfferWorth>,
    /// Session time; `None` while it is shown.
    pub ended: Option<SessionTime>,
    /// When the participant first looked at its place while it was shown.
    pub seen: Option<SessionTime>,
    /// In the form in which a wizard's signals are judged.
    judged: WizardSignal,
}

impl ShownSignalRecord {
    /// The state aspects that it reveals.
    pub fn aspects(&self) -> &[AspectId] {
        &self.judged.aspects
    }

    /// Whether the wizard took it back.
    pub fn is_taken_back(&self) -> bool {
        self.judged.taken_back
    }
}

/// The signals that were shown, and what the wizard's screen showed when the wizard sent them.
#[derive(Clone, Debug, Default)]
pub struct WizardLog {
    pub shown: Vec<ShownSignalRecord>,
    advice: Option<Recommendation>,
    screen: Option<WizardScreenContent>,
    seen: Vec<SignalsPerScreen>,
}

/// Sent while the wizard's screen showed a certain amount of information.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SignalsPerScreen {
    /// Null before the screen was first drawn, and without a console.
    pub screen: Option<WizardScreenContent>,
    pub signals: u64,
}

/// Of one session.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WizardSummary {
    #[serde(flatten)]
    pub measures: WizardMeasures,
    pub screens: Vec<SignalsPerScreen>,
    /// Whether the wizard saw the assistants' recommendations.
    pub unblinded: bool,
}

impl WizardLog {
    /// An event that has just been applied.
    pub fn note(&mut self, stamped: &TimestampedEvent, session: &Session) {
        match &stamped.event {
            Event::Screen(screen) => self.screen = Some(screen.clone()),
            Event::Advised(advice) => self.advice = Some(advice.clone()),
            Event::SignalShown { by, signal, offer } => {
                let judged = WizardSignal {
                    clock: session.trial_clock(stamped.time),
                    press: session.presses[tomcom_core::kitchen::Agent::Human.index()],
                    aspects: aspects_told(&session.kitchen, session.state, signal),
                    to_display_ms: None,
                    taken_back: false,
                };
                self.end(stamped.time);
                self.shown.push(self.record(stamped, session, (*by, signal, *offer), judged));
                if *by == Sender::Assistant {
                    return;
                }
                match self.seen.iter_mut().find(|seen| seen.screen == self.screen) {
                    Some(seen) => seen.signals += 1,
                    None => self.seen.push(SignalsPerScreen { screen: self.screen.clone(), signals: 1 }),
                }
            }
            Event::SignalDrawn { signal } => {
                if let Some(shown) = self.shown.iter_mut().find(|shown| shown.seq == *signal) {
                    shown.judged.to_display_ms = Some(1000.0 * stamped.time.secs_since(shown.time));
                }
            }
            Event::SignalEnded { reason: SignalEndReason::TakenBack } => {
                let by_wizard = self.shown.iter_mut().rev().find(|shown| shown.by == Sender::Wizard);
                if let Some(shown) = by_wizard {
                    shown.judged.taken_back = true;
                }
            }
            Event::Gaze(_) => {
                let place = session.shown.as_ref().and_then(|shown| shown.location);
                let looked = place.and_then(|place| session.gaze.looked_at[place.index()]);
                let open = self.shown.last_mut().filter(|shown| shown.ended.is_none() && shown.seen.is_none());
                if let Some(shown) = open {
                    shown.seen = looked.filter(|looked| *looked >= shown.time);
                }
            }
            _ => {}
        }
        if session.shown.is_none() {
            self.end(stamped.time);
        }
    }

    fn end(&mut self, now: SessionTime) {
        if let Some(open) = self.shown.last_mut().filter(|shown| shown.ended.is_none()) {
            open.ended = Some(now);
        }
    }

    fn record(
        &self,
        stamped: &TimestampedEvent,
        session: &Session,
        (by, signal, offer): (Sender, &Signal, Option<u64>),
        judged: WizardSignal,
    ) -> ShownSignalRecord {
        let offer = offer.and_then(|seq| session.offers.find(seq)).map(|offer| &offer.advice);
        let advice = self.advice.as_ref();
        let option = |advice: &Recommendation| advice.options.iter().find(|option| option.signal == *signal).cloned();
        // The reason of an advice is that of its first signal.
        let of_it = advice.filter(|advice| match (&advice.best, advice.top()) {
            (Some(best), _) => best == signal,
            (None, top) => top.is_some_and(|top| top.signal == *signal),
        });
        let reason = offer.and_then(|offer| offer.reason.clone()).or(of_it.and_then(|advice| advice.reason.clone()));
        let words = offer.and_then(|offer| offer.words.clone()).or(of_it.and_then(|advice| advice.words.clone()));
        ShownSignalRecord {
            seq: stamped.seq,
            time: stamped.time,
            by,
            signal: signal.clone(),
            reason,
            words,
            worth: advice.and_then(option),
            offered: offer.and_then(|offer| offer.worth),
            ended: None,
            seen: None,
            judged,
        }
    }

    /// The wizard's.
    fn sent(&self) -> Vec<WizardSignal> {
        self.shown.iter().filter(|shown| shown.by == Sender::Wizard).map(|shown| shown.judged.clone()).collect()
    }
}

/// The judgement of each signal that was shown, of wizard and assistant alike; `None` where the participant's beliefs are not
/// known, and before the trial is over.
pub fn signal_verdicts(follower: &SessionFollower) -> Option<Vec<SignalVerdict>> {
    let periods = false_belief_periods(follower).filter(|_| follower.session.is_trial_over())?;
    let shown: Vec<WizardSignal> = follower.signals.shown.iter().map(|shown| shown.judged.clone()).collect();
    Some(verdicts(&shown, &periods))
}

impl WizardSummary {
    /// Of a session as far as it was followed.
    pub fn from_follower(follower: &SessionFollower) -> WizardSummary {
        let periods = false_belief_periods(follower);
        WizardSummary {
            measures: WizardMeasures::from_signals(&follower.signals.sent(), periods.as_deref()),
            screens: follower.signals.seen.clone(),
            unblinded: follower.session.unblinded,
        }
    }

    /// By false belief episodes from raters' codes. Raters code errors only, so it is unknown whether other beliefs
    /// were false: signals about harmless false beliefs, wrong signals and needless ones are not told apart.
    pub fn measures_by_raters(follower: &SessionFollower, episodes: &[FalseBeliefEpisode]) -> WizardMeasures {
        let periods = periods(follower, episodes.iter());
        let measures = WizardMeasures::from_signals(&follower.signals.sent(), Some(&periods));
        WizardMeasures { wrong_targets: None, needless: None, harmless: None, ..measures }
    }
}

/// On the trial's clock; `None` where the participant's beliefs are not known.
pub fn false_belief_periods(follower: &SessionFollower) -> Option<Vec<FalseBeliefPeriod>> {
    let known = follower.session.spec.participant.kind == ParticipantKind::Simulated
        && follower.judged.iter().all(|press| press.belief_known);
    known.then(|| periods(follower, follower.episodes.all()))
}

fn periods<'a>(
    follower: &SessionFollower,
    episodes: impl Iterator<Item = &'a FalseBeliefEpisode>,
) -> Vec<FalseBeliefPeriod> {
    let session = &follower.session;
    let period = |episode: &FalseBeliefEpisode| {
        let presses = |time: SessionTime| follower.judged.partition_point(|press| press.time < time) as u32;
        FalseBeliefPeriod {
            aspect: episode.aspect,
            began: session.trial_clock_at(episode.began),
            corrected: episode.corrected.map(|time| (session.trial_clock_at(time), presses(time))),
            errors: episode.errors,
        }
    };
    episodes.map(period).collect()
}

pub fn describe(figures: &WizardSummary) -> String {
    let measures = &figures.measures;
    let drawn = measures.key_to_display_ms.map_or("not recorded".to_string(), |times| {
        format!("{:.1} ms in the median, {:.1} ms at most", times.median, times.max)
    });
    let blind = if figures.unblinded { "; saw what assistants would say" } else { "" };
    let mut text = format!(
        "wizard: {}, {} taken back, from key to display {drawn}{blind}\n",
        count(measures.signals, "signal", "signals"),
        measures.taken_back
    );
    match measures.words() {
        None => text += "        what was believed is not known, so neither are hits and misses\n",
        Some([beliefs, signals]) => {
            let after =
                measures.latency_s.map_or(String::new(), |s| format!(", hit after {:.1} s in the median", s.median));
            text += &format!("        {beliefs}{after}\n        signals without a hit: {signals}\n");
        }
    }
    text
}
