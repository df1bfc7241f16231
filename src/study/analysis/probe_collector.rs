//! Collects the freeze probes of a recording, event by event, with the true state and the estimate at each freeze.

use std::collections::BTreeMap;

use super::probe_record::{
    AspectAtFreeze, ProbeQuestionKind, ProbeResponse, ProbedQuestion, ProbedTrial, RecordedBeliefAtFreeze,
};
use super::seen_contents::LastSeenContents;
use tomcom_core::base::maths::regularized_incomplete_beta;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{
    Agent, AspectId, AspectKind, ButtonAction, Kitchen, KitchenChange, LocationKind, OrderContent, Press,
};
use tomcom_core::measures::sequences::FALSE_BELOW;
use tomcom_core::mind::RecordedBelief;
use tomcom_session::follower::SessionFollower;
use tomcom_session::probes::{ProbeEvent, ProbeOrigin, ProbeQuestion, ProbeSubject};
use tomcom_session::{Event, Session, TimestampedEvent};

/// Collects the freeze probe questions of a recording, event by event.
#[derive(Debug, Default)]
pub struct ProbeCollector {
    seen: LastSeenContents,
    /// Last recorded belief of a simulated participant, with the time of the record.
    belief: Option<(SessionTime, RecordedBelief)>,
    open: Option<OpenQuestions>,
    questions: Vec<ProbedQuestion>,
    begun: u64,
    dropped: u64,
    skipped: u64,
}

/// The questions of the freeze probe that is open.
#[derive(Debug)]
struct OpenQuestions {
    drawn: Vec<ProbedQuestion>,
    /// Session time at which each question appeared; `None` for questions that were not shown yet.
    asked: Vec<Option<SessionTime>>,
}

impl ProbeCollector {
    /// Notes an event that the follower has just applied.
    pub fn note(&mut self, stamped: &TimestampedEvent, change: &KitchenChange, follower: &SessionFollower) {
        let session = &follower.session;
        self.seen.note(session, &stamped.event, change);
        match &stamped.event {
            Event::ParticipantBelieves(witness) => self.belief = Some((stamped.time, witness.clone())),
            Event::Probe(event) => self.probe(stamped.time, event, follower),
            _ => {}
        }
        if let KitchenChange::Press { press, .. } = change {
            self.next(&session.kitchen, press);
        }
    }

    fn probe(&mut self, now: SessionTime, event: &ProbeEvent, follower: &SessionFollower) {
        match event {
            ProbeEvent::Begun { probe, origin, uses_estimate, questions } => {
                self.begun += 1;
                let drawn: Vec<ProbedQuestion> = (1..)
                    .zip(questions)
                    .map(|(number, question)| ProbedQuestion {
                        probe: *probe,
                        question: number,
                        origin: *origin,
                        uses_estimate: *uses_estimate,
                        ..self.frozen(now, question, follower)
                    })
                    .collect();
                self.open = Some(OpenQuestions { asked: vec![None; drawn.len()], drawn });
            }
            ProbeEvent::Asked { question, .. } => {
                if let Some((asked, _)) = self.question(*question) {
                    *asked = Some(now);
                }
            }
            ProbeEvent::Answered { question, answer, confidence, .. } => {
                if let Some((asked, drawn)) = self.question(*question) {
                    drawn.response = answer.clone().map_or(ProbeResponse::Unsure, ProbeResponse::Value);
                    drawn.confidence = *confidence;
                    drawn.took_s = asked.map(|asked| now.secs_since(asked));
                }
            }
            ProbeEvent::Dropped { .. } => self.dropped += 1,
            ProbeEvent::Skipped { .. } => {
                self.skipped += 1;
                let missing = self.open.iter_mut().flat_map(|open| &mut open.drawn);
                for question in missing.filter(|question| question.response == ProbeResponse::Missing) {
                    question.response = ProbeResponse::Skipped;
                }
            }
            ProbeEvent::Ended { .. } => self.close(),
            ProbeEvent::Requested | ProbeEvent::Delayed { .. } | ProbeEvent::Closed { .. } => {}
        }
    }

    /// The question with this number in the open freeze probe, and the time at which it appeared.
    fn question(&mut self, number: u32) -> Option<(&mut Option<SessionTime>, &mut ProbedQuestion)> {
        let open = self.open.as_mut()?;
        let index = (number as usize).checked_sub(1)?;
        Some((open.asked.get_mut(index)?, open.drawn.get_mut(index)?))
    }

    /// Ends the open freeze probe and keeps the questions that were shown.
    fn close(&mut self) {
        let Some(open) = self.open.take() else { return };
        let shown = open.drawn.into_iter().zip(open.asked).filter(|(_, asked)| asked.is_some());
        self.questions.extend(shown.map(|(question, _)| question));
    }

    /// A probe question with what was true and what was estimated when the trial froze.
    fn frozen(&self, now: SessionTime, question: &ProbeQuestion, follower: &SessionFollower) -> ProbedQuestion {
        let (session, kitchen) = (&follower.session, &follower.session.kitchen);
        let (kind, aspect) = subject(kitchen, &question.about);
        let truth = aspect.map(|aspect| label(kitchen, aspect, kitchen.true_value(session.state, aspect)));
        ProbedQuestion {
            probe: 0,
            question: 0,
            time_s: session.trial_clock(now).as_secs_f64(),
            origin: ProbeOrigin::Schedule,
            uses_estimate: false,
            kind,
            aspect: aspect.map_or(kind.name().to_string(), |aspect| kitchen.aspects[aspect.index()].name.clone()),
            inclusion: question.inclusion,
            truth,
            response: ProbeResponse::Missing,
            confidence: None,
            took_s: None,
            frozen: aspect.map(|aspect| self.aspect(now, aspect, follower)),
        }
    }

    /// True value, estimated belief and history of a state aspect at the freeze.
    fn aspect(&self, now: SessionTime, aspect: AspectId, follower: &SessionFollower) -> AspectAtFreeze {
        let (session, kitchen) = (&follower.session, &follower.session.kitchen);
        let labels = &kitchen.aspects[aspect.index()].labels;
        // The belief estimate at the freeze includes the effect of the time since the last event.
        let estimate =
            follower.probed.as_ref().map_or(follower.filter.belief(), |probed| &probed.belief).aspect(aspect);
        let truth = kitchen.true_value(session.state, aspect);
        let estimate_p_truth = estimate.mean()[truth];
        let [of_truth, of_others] = [estimate_p_truth, 1.0 - estimate_p_truth].map(|mean| mean * estimate.precision());
        let believed = self.belief.as_ref().filter(|(at, _)| *at == now);
        let believed = believed.and_then(|(_, witness)| witness.aspects.get(aspect.index()));
        let location = match kitchen.aspects[aspect.index()].kind {
            AspectKind::Location(location) => Some(location),
            AspectKind::Recipe(_) => None,
        };
        // Recipes do not change, so for a recipe the usual value and the value last seen are the true one.
        let of_code =
            |code: u8| label(kitchen, aspect, kitchen.aspects[aspect.index()].index_of(code).unwrap_or(truth));
        let of_location = |code: Option<u8>| code.map_or_else(|| label(kitchen, aspect, truth), of_code);
        AspectAtFreeze {
            values: labels.len(),
            estimate: label(kitchen, aspect, estimate.most_likely()),
            estimate_p: labels.iter().cloned().zip(estimate.mean().iter().copied()).collect::<BTreeMap<_, _>>(),
            estimate_p_truth,
            estimate_p_false: regularized_incomplete_beta(FALSE_BELOW, of_truth, of_others),
            believed: believed
                .map(|own| RecordedBeliefAtFreeze { believes: own.believes.clone(), p_truth: own.p_truth }),
            changed_s: location.and_then(|location| self.seen.changed_s(session, location)),
            changed_unseen: location.map(|location| self.seen.is_changed_unseen(location)),
            usual: of_location(location.map(|location| self.seen.usual(session, location))),
            last_seen: of_location(location.map(|location| self.seen.last_seen(location))),
        }
    }

    /// Fills in the right answer to questions about the next press or order, from a press that has just happened.
    fn next(&mut self, kitchen: &Kitchen, press: &Press) {
        let button = kitchen.button(press.agent, press.button);
        let served = match button.action {
            ButtonAction::Serve(order) if press.effective => {
                matches!(press.before.order(order), OrderContent::Dish(_)).then_some(order)
            }
            _ => None,
        };
        for question in self.questions.iter_mut().filter(|question| question.truth.is_none()) {
            question.truth = match question.kind {
                ProbeQuestionKind::NextOrder => served.map(|order| kitchen.location(order).name.clone()),
                ProbeQuestionKind::NextPress if press.agent == Agent::Robot => Some(button.name.clone()),
                _ => None,
            };
        }
    }

    /// The freeze probes of the recording, after the recording's last event has been noted.
    pub fn finish(mut self, session: &Session) -> ProbedTrial {
        self.close();
        let ProbeCollector { begun, dropped, skipped, questions, .. } = self;
        ProbedTrial { planned_arm: session.planned_arm(), begun, dropped, skipped, questions }
    }
}

/// Kind of a probe question, and the state aspect that the question is about.
fn subject(kitchen: &Kitchen, about: &ProbeSubject) -> (ProbeQuestionKind, Option<AspectId>) {
    match about {
        ProbeSubject::Location { location } => {
            let id = kitchen.location_named(location);
            let is_order = id.is_some_and(|id| kitchen.location(id).kind == LocationKind::Order);
            (if is_order { ProbeQuestionKind::Order } else { ProbeQuestionKind::Place }, id.map(AspectId::of_location))
        }
        ProbeSubject::Recipe { dish } => {
            let is_it = |kind: AspectKind| matches!(kind, AspectKind::Recipe(id) if kitchen.dish(id).name == *dish);
            let index = kitchen.aspects.iter().position(|aspect| is_it(aspect.kind));
            (ProbeQuestionKind::Recipe, index.map(|index| AspectId(index as u8)))
        }
        ProbeSubject::NextOrder => (ProbeQuestionKind::NextOrder, None),
        ProbeSubject::NextPress => (ProbeQuestionKind::NextPress, None),
    }
}

/// Name of a state aspect's value, as tables show it.
fn label(kitchen: &Kitchen, aspect: AspectId, value: usize) -> String {
    kitchen.aspects[aspect.index()].labels[value].clone()
}
