//! The questions of a recording's freeze probes as the analysis needs them: what was true, estimated and (in
//! simulations) believed when the trial froze; and the answer.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::analysis::seen_contents::LastSeenContents;
use tomcom_core::base::maths::regularized_incomplete_beta;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{
    Agent, AspectId, AspectKind, ButtonAction, Kitchen, KitchenChange, LocationId, LocationKind, OrderContent, Press,
};
use tomcom_core::measures::sequences::FALSE_BELOW;
use tomcom_core::mind::RecordedBelief;
use tomcom_session::follower::SessionFollower;
use tomcom_session::probes::{ProbeEvent, ProbeOrigin, ProbeQuestion, ProbeSubject};
use tomcom_session::study_arm::StudyArm;
use tomcom_session::{Event, Session, TimestampedEvent, probe_sampling};

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, strum::IntoStaticStr)]
#[strum(serialize_all = "snake_case")]
pub enum ProbeQuestionKind {
    Order,
    Recipe,
    Place,
    /// The question asks which order will be ready next (level 2 of situation awareness).
    NextOrder,
    /// The question asks what the robot will press next (level 2 of situation awareness).
    NextPress,
}

impl ProbeQuestionKind {
    pub fn name(self) -> &'static str {
        self.into()
    }

    pub fn words(self) -> &'static str {
        match self {
            ProbeQuestionKind::Order => "orders",
            ProbeQuestionKind::Recipe => "recipes",
            ProbeQuestionKind::Place => "other places",
            ProbeQuestionKind::NextOrder => "which order is ready next",
            ProbeQuestionKind::NextPress => "what the robot does next",
        }
    }

    /// Whether it asks what comes next (level 2 of situation awareness), not what is the case now.
    pub fn is_level_2(self) -> bool {
        matches!(self, ProbeQuestionKind::NextOrder | ProbeQuestionKind::NextPress)
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ProbeResponse {
    Value(String),
    Unsure,
    /// The participant gave no answer, because the wizard skipped the rest of the probe.
    Skipped,
    Missing,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AspectAtFreeze {
    pub values: usize,
    pub estimate: String,
    pub estimate_p: BTreeMap<String, f64>,
    pub estimate_p_truth: f64,
    /// Estimated probability that the participant's belief is false, as in [`tomcom_core::measures::detection`].
    pub estimate_p_false: f64,
    /// Recorded belief of a simulated participant; `None` for people.
    pub believed: Option<RecordedBeliefAtFreeze>,
    /// Since the last change of the place, without pauses; `None` for recipes, and without a change in the trial.
    pub changed_s: Option<f64>,
    /// By somebody else, since the participant last looked at it or changed it; `None` for recipes.
    pub changed_unseen: Option<bool>,
    /// Name of the value that the asked location had for the longest time so far; for a recipe, the true value.
    pub usual: String,
    /// Name of the value that the participant last saw at the location, or made there; for a recipe, the true value.
    pub last_seen: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedBeliefAtFreeze {
    pub believes: String,
    pub p_truth: f64,
}

impl RecordedBeliefAtFreeze {
    /// Whether the participant's belief is false: P(truth) is below [`FALSE_BELOW`].
    pub fn is_wrong(&self) -> bool {
        self.p_truth < FALSE_BELOW
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProbedQuestion {
    /// Number of the freeze probe in the trial, from 1.
    pub probe: u32,
    /// Number of the question in the probe, from 1.
    pub question: u32,
    pub time_s: f64,
    pub origin: ProbeOrigin,
    pub uses_estimate: bool,
    pub kind: ProbeQuestionKind,
    /// Name of the state aspect that the question is about; for questions of level 2, name of the kind of question.
    pub aspect: String,
    /// The question as it was drawn. Truth, answer and predictions are among its choices.
    pub asked: ProbeQuestion,
    /// Name of the right answer, one of the question's choices; `None` for questions of level 2 if the trial ended before the right answer was known.
    pub truth: Option<String>,
    pub response: ProbeResponse,
    /// Confidence of the participant in the answer, from 1 to 3, if it was asked for.
    pub confidence: Option<u8>,
    pub took_s: Option<f64>,
    /// The asked state aspect at the freeze; `None` for questions of level 2.
    pub frozen: Option<AspectAtFreeze>,
}

impl ProbedQuestion {
    /// The inverse of the inclusion probability (Horvitz and Thompson 1952).
    pub fn weight(&self) -> f64 {
        1.0 / self.asked.inclusion
    }

    /// "I don't know" is wrong. `None` without an answer in time, or if the truth is unknown.
    pub fn is_wrong(&self) -> Option<bool> {
        let truth = self.truth.as_ref()?;
        match &self.response {
            ProbeResponse::Value(answer) => Some(answer != truth),
            ProbeResponse::Unsure => Some(true),
            ProbeResponse::Skipped | ProbeResponse::Missing => None,
        }
    }

    /// In the main results: drawn by the schedule, about the present state, answered in time.
    pub(crate) fn is_counted(&self) -> bool {
        self.origin == ProbeOrigin::Schedule && !self.kind.is_level_2() && self.is_wrong().is_some()
    }

    /// Name of the value that the participant answered; `None` for "I don't know" and without an answer.
    pub fn answer(&self) -> Option<&str> {
        match &self.response {
            ProbeResponse::Value(answer) => Some(answer),
            ProbeResponse::Unsure | ProbeResponse::Skipped | ProbeResponse::Missing => None,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProbedTrial {
    pub planned_arm: StudyArm,
    pub begun: u64,
    pub dropped: u64,
    pub skipped: u64,
    pub questions: Vec<ProbedQuestion>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProbedTrialStatistics {
    pub counted: u64,
    /// Weighted share of wrong answers among the probe questions of the main results; `None` without such questions.
    pub share_wrong: Option<f64>,
}

impl ProbedTrial {
    pub fn statistics(&self) -> ProbedTrialStatistics {
        let answers = self.counted().filter_map(|one| Some((one.weight(), one.is_wrong()?)));
        ProbedTrialStatistics { counted: self.counted().count() as u64, share_wrong: weighted_share(answers) }
    }

    pub fn is_any(&self) -> bool {
        self.begun + self.dropped > 0
    }

    pub fn counted(&self) -> impl Iterator<Item = &ProbedQuestion> {
        self.questions.iter().filter(|question| question.is_counted())
    }
}

/// Weighted share of elements that are true; an element is a weight, and whether it is true. `None` without elements.
pub(crate) fn weighted_share(of: impl IntoIterator<Item = (f64, bool)>) -> Option<f64> {
    let (mut all, mut part) = (0.0, 0.0);
    for (weight, is_it) in of {
        all += weight;
        part += if is_it { weight } else { 0.0 };
    }
    (all > 0.0).then(|| part / all)
}

#[derive(Debug, Default)]
pub struct ProbeCollector {
    seen: LastSeenContents,
    belief: Option<(SessionTime, RecordedBelief)>,
    open: Option<OpenQuestions>,
    questions: Vec<ProbedQuestion>,
    begun: u64,
    dropped: u64,
    skipped: u64,
}

#[derive(Debug)]
struct OpenQuestions {
    drawn: Vec<ProbedQuestion>,
    /// Session time at which each question appeared; `None` for questions that were not shown yet.
    asked: Vec<Option<SessionTime>>,
}

impl ProbeCollector {
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

    fn question(&mut self, number: u32) -> Option<(&mut Option<SessionTime>, &mut ProbedQuestion)> {
        let open = self.open.as_mut()?;
        let index = (number as usize).checked_sub(1)?;
        Some((open.asked.get_mut(index)?, open.drawn.get_mut(index)?))
    }

    fn close(&mut self) {
        let Some(open) = self.open.take() else { return };
        let shown = open.drawn.into_iter().zip(open.asked).filter(|(_, asked)| asked.is_some());
        self.questions.extend(shown.map(|(question, _)| question));
    }

    fn frozen(&self, now: SessionTime, question: &ProbeQuestion, follower: &SessionFollower) -> ProbedQuestion {
        let (session, kitchen) = (&follower.session, &follower.session.kitchen);
        let (kind, aspect) = (kind_of(kitchen, &question.about), probe_sampling::aspect(kitchen, &question.about));
        let truth = aspect.map(|aspect| {
            let truth = kitchen.true_value(session.state, aspect);
            question.choice_for(&kitchen.aspects[aspect.index()].labels[truth]).to_string()
        });
        ProbedQuestion {
            probe: 0,
            question: 0,
            time_s: session.trial_clock(now).as_secs_f64(),
            origin: ProbeOrigin::Schedule,
            uses_estimate: false,
            kind,
            aspect: aspect.map_or(kind.name().to_string(), |aspect| kitchen.aspects[aspect.index()].name.clone()),
            asked: question.clone(),
            truth,
            response: ProbeResponse::Missing,
            confidence: None,
            took_s: None,
            frozen: aspect.map(|aspect| self.aspect(now, aspect, question, follower)),
        }
    }

    /// In terms of the question's choices.
    fn aspect(
        &self,
        now: SessionTime,
        aspect: AspectId,
        question: &ProbeQuestion,
        follower: &SessionFollower,
    ) -> AspectAtFreeze {
        let (session, kitchen) = (&follower.session, &follower.session.kitchen);
        let labels = &kitchen.aspects[aspect.index()].labels;
        // The belief estimate at the freeze includes the effect of the time since the last event.
        let estimate =
            follower.probed.as_ref().map_or(follower.filter.belief(), |probed| &probed.belief).aspect(aspect);
        let truth = kitchen.true_value(session.state, aspect);
        let chosen = |label: &String| question.choice_for(label).to_string();
        let mut estimate_p: BTreeMap<String, f64> = BTreeMap::new();
        for (label, p) in labels.iter().zip(estimate.mean()) {
            *estimate_p.entry(chosen(label)).or_default() += p;
        }
        let right = chosen(&labels[truth]);
        let is_right = |value: &str| question.choice_for(value) == right;
        // Values that share a choice have a Dirichlet distribution together, too.
        let estimate_p_truth = estimate_p[&right];
        let [of_truth, of_others] = [estimate_p_truth, 1.0 - estimate_p_truth].map(|mean| mean * estimate.precision());
        let believed = self.belief.as_ref().filter(|(at, _)| *at == now);
        let believed = believed.and_then(|(_, witness)| witness.aspects.get(aspect.index()));
        let location = match kitchen.aspects[aspect.index()].kind {
            AspectKind::Location(location) => Some(location),
            AspectKind::Recipe(_) => None,
        };
        // Recipes do not change, so for a recipe the usual value and the value last seen are the true one.
        let of_code = |code: u8| chosen(&labels[kitchen.aspects[aspect.index()].index_of(code).unwrap_or(truth)]);
        let of_location = |code: Option<u8>| code.map_or_else(|| chosen(&labels[truth]), of_code);
        AspectAtFreeze {
            values: estimate_p.len(),
            estimate: chosen(&labels[estimate.most_likely()]),
            estimate_p,
            estimate_p_truth,
            estimate_p_false: regularized_incomplete_beta(FALSE_BELOW, of_truth, of_others),
            believed: believed.map(|own| RecordedBeliefAtFreeze {
                believes: chosen(&own.believes),
                p_truth: own.p_truth.max(own.values.iter().filter(|(value, _)| is_right(value)).map(|(_, p)| p).sum()),
            }),
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
            let truth = match question.kind {
                ProbeQuestionKind::NextOrder => served.map(|order| kitchen.location(order).name.as_str()),
                ProbeQuestionKind::NextPress if press.agent == Agent::Robot => Some(button.name.as_str()),
                _ => None,
            };
            question.truth = truth.map(|truth| question.asked.choice_for(truth).to_string());
        }
    }

    pub fn finish(mut self, session: &Session) -> ProbedTrial {
        self.close();
        let ProbeCollector { begun, dropped, skipped, questions, .. } = self;
        ProbedTrial { planned_arm: session.planned_arm(), begun, dropped, skipped, questions }
    }
}

fn kind_of(kitchen: &Kitchen, about: &ProbeSubject) -> ProbeQuestionKind {
    let is_order = |id: LocationId| kitchen.location(id).kind == LocationKind::Order;
    match about {
        ProbeSubject::Location { location } if kitchen.location_named(location).is_some_and(is_order) => {
            ProbeQuestionKind::Order
        }
        ProbeSubject::Location { .. } => ProbeQuestionKind::Place,
        ProbeSubject::Recipe { .. } => ProbeQuestionKind::Recipe,
        ProbeSubject::NextOrder => ProbeQuestionKind::NextOrder,
        ProbeSubject::NextPress => ProbeQuestionKind::NextPress,
    }
}
