//! What communication concepts would have done in an unassisted trial, for every value of their parameters at once: the
//! dear part, the planning, is done once a moment, and all costs are swept over the same benefits.

use crate::analysis::advisor::AdviceRequest;
use crate::analysis::advisor::changes_task;
use crate::analysis::follower::Follower;
use crate::analysis::watcher::follows_at_once;
use crate::base::time::SessionTime;
use crate::communication::concept::{Concept, ConceptName};
use crate::communication::planner::Planner;
use crate::communication::recommendation::{SignalOption, aspects_told};
use crate::communication::repeats::Repeats;
use crate::communication::settings::AssistantSpec;
use crate::communication::tom::TomConcept;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, Change};
use crate::measures::attribution::Cause;
use crate::measures::sequences::{Episode, Sequence, sequence_errors};
use crate::session::apply::ApplyError;
use crate::session::{Applied, Event, Session, Stamped};
use crate::study::prevention::{ConceptSignal, FalseBeliefTruth, PressTruth, SequenceTruth, TrialTruth};
use crate::study::roc::{CONCEPTS, LEAST_COST, SweptTrial, parameters};

/// A concept with one value of its parameter.
#[derive(Debug)]
struct Voice {
    concept: ConceptName,
    parameter: f64,
    /// What it has said.
    repeats: Repeats,
    sent: Vec<ConceptSignal>,
}

/// Follows a session, and asks after every press and order change, as the engine does.
#[derive(Debug)]
pub struct ConceptSweep {
    pub follower: Follower,
    planner: Planner,
    tom: TomConcept,
    cost: CostToGo,
    voices: Vec<Voice>,
    /// The newest event after which is asked, when all that follows at once has happened.
    to_ask: Option<(u64, SessionTime)>,
}

impl ConceptSweep {
    /// A sweeper of a session from before its first event on.
    pub fn new(session: Session, cost: CostToGo) -> ConceptSweep {
        let (kitchen, spec) = (session.kitchen.clone(), &session.spec);
        // Planned as carefully as the least cost asks for.
        let assistant = AssistantSpec { cost_of_communication: LEAST_COST, ..spec.assistant.clone() };
        let voice = |concept: ConceptName, parameter: f64| Voice {
            concept,
            parameter,
            repeats: Repeats::default(),
            sent: Vec::new(),
        };
        let of_concept = |concept: ConceptName| parameters(concept).into_iter().map(move |one| voice(concept, one));
        let speaking = CONCEPTS.into_iter().filter(|concept| *concept != ConceptName::Dev);
        ConceptSweep {
            planner: Planner::new(kitchen.clone(), &spec.human, assistant, session.seed()),
            tom: TomConcept::new(kitchen, 0.0),
            follower: Follower::new(session, cost.clone()),
            cost,
            voices: speaking.flat_map(of_concept).collect(),
            to_ask: None,
        }
    }

    /// Moves on by one event.
    ///
    /// # Errors
    /// Those of [`Follower::apply`].
    pub fn apply(&mut self, stamped: &Stamped) -> Result<Change, ApplyError> {
        if self.to_ask.is_some_and(|(_, time)| !follows_at_once(stamped, time)) {
            self.ask();
        }
        let Applied { change, .. } = self.follower.apply(stamped)?;
        if stamped.event.is_sample() {
            return Ok(change);
        }
        let session = &self.follower.session;
        for voice in &mut self.voices {
            if matches!(stamped.event, Event::TrialStarted) {
                voice.repeats = Repeats::default();
            }
            voice.repeats.update(&session.kitchen, session.state, self.follower.filter.belief());
        }
        if session.is_running() && changes_task(&stamped.event) {
            self.to_ask = Some((stamped.seq, stamped.time));
        }
        Ok(change)
    }

    /// What every concept would say now.
    fn ask(&mut self) {
        let Some((seq, time)) = self.to_ask.take().filter(|_| self.follower.session.is_running()) else { return };
        let session = &self.follower.session;
        let (kitchen, state) = (&session.kitchen, session.state);
        let own_hand = session.spec.signals.own_hand;
        let question = AdviceRequest::from_follower(&self.follower, seq, time);
        let moment = question.moment();
        let benefits = self.planner.advise(&mut self.cost, &moment).options;
        let deviations = self.tom.advise(&mut self.cost, &moment).options;
        let press = session.presses[Agent::Human.index()] as usize;
        for voice in &mut self.voices {
            let options: &[SignalOption] = match voice.concept {
                ConceptName::TomCom => &benefits,
                _ => &deviations,
            };
            let allowed = voice.repeats.allowed(kitchen, own_hand);
            let best = options.iter().find(|option| allowed.contains(&option.signal));
            if let Some(option) = best.filter(|option| option.benefit > voice.parameter) {
                voice.repeats.shown(kitchen, state, &option.signal);
                voice.sent.push(ConceptSignal { time, press, aspects: aspects_told(kitchen, state, &option.signal) });
            }
        }
    }

    /// What they would have done; call it after the last event.
    pub fn swept(&self) -> Vec<SweptTrial> {
        let truth = truth(&self.follower);
        let spoken = self.voices.iter().map(|voice| SweptTrial {
            concept: voice.concept,
            parameter: voice.parameter,
            count: truth.count_signals(&voice.sent),
        });
        let proposed = parameters(ConceptName::Dev).into_iter().map(|parameter| SweptTrial {
            concept: ConceptName::Dev,
            parameter,
            count: truth.count_proposals(parameter as usize),
        });
        spoken.chain(proposed).collect()
    }
}

/// What was true in a session that was followed to its end, where it is known what the human believed.
fn truth(follower: &Follower) -> TrialTruth {
    let kitchen = &follower.session.kitchen;
    let press = |press: &crate::measures::JudgedPress| PressTruth {
        time: press.time,
        error: press.verdict.error,
        related: matches!(press.cause, Some(Cause::Belief { .. })),
    };
    let spell = |episode: &Episode| FalseBeliefTruth {
        aspect: episode.aspect,
        began: episode.began,
        ended: episode.corrected,
        harmful: episode.errors > 0,
    };
    let sequence = |(sequence, errors): (Sequence, Vec<usize>)| SequenceTruth {
        aspects: sequence.target.aspects(kitchen).collect(),
        errors: errors.into_iter().map(|index| follower.judged[index].time).collect(),
    };
    TrialTruth {
        presses: follower.judged.iter().map(press).collect(),
        spells: follower.episodes.all().map(spell).collect(),
        sequences: sequence_errors(&follower.judged).into_iter().map(sequence).collect(),
    }
}
