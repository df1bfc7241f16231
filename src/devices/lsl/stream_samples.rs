//! Samples of a session's LSL streams, one kind for each stream.

use serde_json::json;

use super::marker_text::{code, event_text};
use super::stream_description::session_signals;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::kitchen::Agent;
use tomcom_core::measures::JudgedPress;
use tomcom_session::event::Event;
use tomcom_session::history::belief_track::BeliefSnapshot;
use tomcom_session::settings::LslOutlet;
use tomcom_session::{Session, TimelineEvent, TimestampedEvent};

/// Least time between two samples of the beliefs stream if only gaze has changed the beliefs, in seconds.
const BELIEF_STEP_S: f64 = 0.1;

/// A sample of an LSL stream.
#[derive(Clone, Debug, PartialEq)]
pub struct StreamSample {
    /// The LSL stream to which the sample belongs.
    pub outlet: LslOutlet,
    /// Session time of the event or state that the sample reports.
    pub time: SessionTime,
    /// Values of the sample, one for each channel of the stream.
    pub values: LslSampleValues,
}

/// The values of an LSL sample, one for each channel.
#[derive(Clone, Debug, PartialEq)]
pub enum LslSampleValues {
    /// Values of a sample in a stream of numbers; NaN stands for a missing value.
    Numbers(Vec<f64>),
    /// Values of a sample in a stream of texts.
    Texts(Vec<String>),
}

/// Converts the events of a session into samples of its LSL streams.
#[derive(Clone, Debug)]
pub struct LslSampleConverter {
    outlets: Vec<LslOutlet>,
    /// Name of the recording to which the samples belong.
    recording: String,
    /// The signals with a channel for their net benefit, in the order of the channels.
    signals: Vec<Signal>,
    /// The last sample of the beliefs stream, with its session time.
    believed: Option<(SessionTime, Vec<f32>)>,
}

impl LslSampleConverter {
    /// A converter for the LSL streams that the session sends; `recording` is the name of the recording.
    pub fn new(session: &Session, recording: &str) -> LslSampleConverter {
        let outlets = session.spec.lsl.as_ref().map_or(Vec::new(), |lsl| lsl.outlets.clone());
        LslSampleConverter {
            outlets,
            recording: recording.to_string(),
            signals: session_signals(&session.spec, &session.kitchen),
            believed: None,
        }
    }

    /// Samples that name the recording to which the following samples belong; they stand for no event. The samples are
    /// sent at the beginning of a recording and again at the beginning of its trial, since a recorder may have been
    /// started in between.
    pub fn opening(&self, session: &Session, time: SessionTime) -> Vec<StreamSample> {
        let (spec, recording) = (&session.spec, &self.recording);
        let told = json!({
            "kind": "recording",
            "recording": recording,
            "participant": spec.participant.code,
            "condition": spec.trial.condition.name(),
        });
        let text = |outlet, text: String| StreamSample { outlet, time, values: LslSampleValues::Texts(vec![text]) };
        let all =
            [text(LslOutlet::Markers, format!("recording/{recording}")), text(LslOutlet::Events, told.to_string())];
        all.into_iter().filter(|sample| self.outlets.contains(&sample.outlet)).collect()
    }

    /// Samples for events that were just applied to this session. `judged`: every press of the human so far; `belief`:
    /// the belief estimate after the last event.
    pub fn samples(
        &mut self,
        events: &[TimestampedEvent],
        session: &Session,
        judged: &[JudgedPress],
        belief: &BeliefSnapshot,
    ) -> Vec<StreamSample> {
        let mut samples: Vec<StreamSample> = Vec::new();
        for stamped in events {
            if stamped.event == Event::TrialStarted {
                samples.extend(self.opening(session, stamped.time));
            }
            samples.extend(self.event_samples(stamped, session, judged));
        }
        let by_gaze = events.iter().all(|stamped| stamped.event.is_sample());
        samples.extend(self.belief_sample(belief, by_gaze));
        samples.retain(|sample| self.outlets.contains(&sample.outlet));
        samples
    }

    fn event_samples(
        &self,
        stamped: &TimestampedEvent,
        session: &Session,
        judged: &[JudgedPress],
    ) -> Vec<StreamSample> {
        let sample = |outlet, time, values| StreamSample { outlet, time, values };
        let (now, texts) = (stamped.time, |texts: Vec<String>| LslSampleValues::Texts(texts));
        let mut samples = match &stamped.event {
            Event::Gaze(gaze) => {
                let read = session.corrected(*gaze);
                let values = LslSampleValues::Numbers(vec![read.x, read.y, read.confidence]);
                return vec![sample(LslOutlet::Gaze, gaze.taken_ns.unwrap_or(now), values)];
            }
            Event::RobotMoves(arm) => {
                return vec![sample(LslOutlet::Arm, now, LslSampleValues::Numbers(arm.joints.to_vec()))];
            }
            Event::Press { agent, button, at_ns } => {
                let values = texts(press_texts(*agent, button, stamped, session, judged));
                vec![sample(LslOutlet::Presses, at_ns.unwrap_or(now), values)]
            }
            Event::Advised(advice) => {
                vec![sample(LslOutlet::NetBenefit, advice.for_ns, LslSampleValues::Numbers(self.net_benefits(advice)))]
            }
            _ => Vec::new(),
        };
        samples.push(sample(LslOutlet::Markers, now, texts(vec![code(stamped)])));
        samples.push(sample(LslOutlet::Events, now, texts(vec![event_text(stamped)])));
        samples
    }

    /// Net benefit of each signal, in the order of the stream's channels; NaN for signals that cannot be sent now.
    fn net_benefits(&self, advice: &Recommendation) -> Vec<f64> {
        let option = |signal: &Signal| advice.options.iter().find(|option| option.signal == *signal);
        self.signals.iter().map(|signal| option(signal).map_or(f64::NAN, |option| option.net)).collect()
    }

    /// A sample of the beliefs, if the beliefs have changed; while only gaze changes them, at most one sample per
    /// [`BELIEF_STEP_S`].
    fn belief_sample(&mut self, belief: &BeliefSnapshot, by_gaze: bool) -> Option<StreamSample> {
        let is_due = |(at, _): &(SessionTime, Vec<f32>)| !by_gaze || belief.time.secs_since(*at) >= BELIEF_STEP_S;
        let held: Vec<f32> = belief.held.iter().map(|held| held.p_truth).collect();
        if !self.believed.as_ref().is_none_or(|last| is_due(last) && last.1 != held) {
            return None;
        }
        let values = LslSampleValues::Numbers(held.iter().map(|p_truth| f64::from(*p_truth)).collect());
        self.believed = Some((belief.time, held));
        Some(StreamSample { outlet: LslOutlet::Beliefs, time: belief.time, values })
    }
}

/// Texts of a sample about a press: agent, button, whether the press had an effect, and whether it was an error ("yes",
/// "no", or empty for a press that is not judged).
fn press_texts(
    agent: Agent,
    button: &str,
    stamped: &TimestampedEvent,
    session: &Session,
    judged: &[JudgedPress],
) -> Vec<String> {
    let yes = |is_so: bool| if is_so { "yes" } else { "no" }.to_string();
    let mut entries = session.timeline.iter().rev().take_while(|entry| entry.time >= stamped.time);
    let is_effective = entries.any(|entry| match &entry.what {
        TimelineEvent::Press { agent: other, button: id, no_effect, .. } => {
            let is_it = *other == agent && session.kitchen.button(agent, *id).name == button;
            is_it && entry.time == stamped.time && no_effect.is_none()
        }
        _ => false,
    });
    let verdict =
        judged.iter().rev().take_while(|press| press.seq >= stamped.seq).find(|press| press.seq == stamped.seq);
    let error = verdict.map_or(String::new(), |press| yes(press.verdict.error));
    vec![agent.name().to_string(), button.to_string(), yes(is_effective), error]
}
