//! Collects a wizard's signals event by event, for the measures of [`tomcom_core::measures::wizard_performance`].

use serde::Serialize;

use crate::event::{SignalEndReason, WizardScreenContent};
use crate::follower::SessionFollower;
use crate::settings::ParticipantKind;
use crate::{Event, Session, TimestampedEvent};
use tomcom_core::base::text::count;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Sender;
use tomcom_core::communication::recommendation::aspects_told;
use tomcom_core::measures::sequences::FalseBeliefEpisode;
use tomcom_core::measures::wizard_performance::{FalseBeliefPeriod, WizardMeasures, WizardSignal};

/// The wizard's signals, each with what the wizard's screen showed when it was sent.
#[derive(Clone, Debug, Default)]
pub struct WizardLog {
    sent: Vec<(u64, SessionTime, WizardSignal)>,
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
            Event::SignalShown { by: Sender::Wizard, signal, .. } => {
                let sent = WizardSignal {
                    clock: session.trial_clock(stamped.time),
                    press: session.presses[tomcom_core::kitchen::Agent::Human.index()],
                    aspects: aspects_told(&session.kitchen, session.state, signal),
                    to_display_ms: None,
                    taken_back: false,
                };
                self.sent.push((stamped.seq, stamped.time, sent));
                match self.seen.iter_mut().find(|seen| seen.screen == self.screen) {
                    Some(seen) => seen.signals += 1,
                    None => self.seen.push(SignalsPerScreen { screen: self.screen.clone(), signals: 1 }),
                }
            }
            Event::SignalDrawn { signal } => {
                if let Some((_, time, sent)) = self.sent.iter_mut().find(|(seq, ..)| seq == signal) {
                    sent.to_display_ms = Some(1000.0 * stamped.time.secs_since(*time));
                }
            }
            Event::SignalEnded { reason: SignalEndReason::TakenBack } => {
                if let Some((.., sent)) = self.sent.last_mut() {
                    sent.taken_back = true;
                }
            }
            _ => {}
        }
    }

    fn sent(&self) -> Vec<WizardSignal> {
        self.sent.iter().map(|(.., sent)| sent.clone()).collect()
    }
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
            began: clock_at(session, episode.began),
            corrected: episode.corrected.map(|time| (clock_at(session, time), presses(time))),
            errors: episode.errors,
        }
    };
    episodes.map(period).collect()
}

/// An earlier session time on the trial's clock.
pub fn clock_at(session: &Session, time: SessionTime) -> SessionTime {
    let paused = session.pauses.iter().map(|&(from, until)| until.min(time) - from);
    paused.fold(time - session.trial_start, |clock, pause| clock - pause)
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
