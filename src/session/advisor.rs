//! The assistant of a session: answers a request for advice after every press and every order change, and at the other
//! times that the session's settings name.

use super::follower::SessionFollower;
use crate::Session;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::communication::concept::{Concept, ConceptName, DecisionPoint};
use tomcom_core::communication::concept::concept;
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::communication::concept::{RobotIntent, Situation};
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{AspectId, State};
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_core::mind::model::SignalReadingForecast;

/// A request for advice: the session after an event and all its immediate consequences.
#[derive(Clone, Debug)]
pub struct AdviceRequest {
    /// Sequence number of the event after which advice is requested.
    pub seq: u64,
    /// Session time of the event after which advice is requested.
    pub time: SessionTime,
    presses: u32,
    state: State,
    belief: DirichletBelief,
    changed: Vec<AspectId>,
    robot: RobotIntent,
    robot_press_s: f64,
    forecast: SignalReadingForecast,
    /// The signals that can be sent at the time of the request.
    signals: Vec<Signal>,
    /// Sequence number of the human's last press, if that press was an error.
    error: Option<u64>,
}

impl AdviceRequest {
    /// A request for advice after the event with this sequence number and time.
    pub fn from_follower(follower: &mut SessionFollower, seq: u64, time: SessionTime) -> AdviceRequest {
        let belief = follower.belief_for_advice(time);
        let session = &follower.session;
        let robot = match session.robot.intention {
            _ if session.robot.stopped || session.robot.held && session.robot.driven_to.is_none() => RobotIntent::Still,
            Some((button, _, until)) => {
                let remaining_s = until.secs_since(time).max(0.0);
                RobotIntent::Busy { button, remaining_s, driven: session.robot.driven_to.is_some() }
            }
            None => RobotIntent::Free,
        };
        let (state, robot_press_s) = (session.state, session.spec.robot.press_s);
        let signals = follower.repeats.allowed(&session.kitchen, session.highlights());
        let error = follower.judged.last().filter(|press| press.verdict.error).map(|press| press.seq);
        let changed = session.changed_at(time).map(AspectId::of_location).collect();
        let presses = session.all_presses();
        let forecast = follower.filter.forecast();
        AdviceRequest { seq, time, presses, state, belief, changed, robot, robot_press_s, forecast, signals, error }
    }

    /// The request for advice in the form in which a communication concept receives it.
    pub fn moment(&self) -> DecisionPoint<'_> {
        let AdviceRequest {
            seq,
            time,
            presses,
            state,
            ref belief,
            ref changed,
            robot,
            robot_press_s,
            forecast,
            ref signals,
            error,
        } = *self;
        let situation = Situation { state, belief, changed, robot, robot_press_s, forecast };
        DecisionPoint { seq, time, presses, situation, signals, error }
    }

    /// This request for advice with another estimate and other available signals.
    pub fn about(&self, belief: &DirichletBelief, signals: Vec<Signal>) -> AdviceRequest {
        AdviceRequest { belief: belief.clone(), signals, ..self.clone() }
    }
}

/// The session's assistant, which answers requests for advice by its communication concept.
#[derive(Debug)]
pub struct Advisor {
    concept: Box<dyn Concept>,
    cost: CostToGo,
    /// Whether the assistant works ahead between requests for advice in a live session.
    pub works_ahead: bool,
}

impl Advisor {
    /// The session's assistant, with the communication concept that the session's settings name.
    pub fn new(session: &Session, cost: CostToGo) -> Advisor {
        Advisor::by(session.spec.assistant.concept, session, cost)
    }

    /// An assistant for the session with the given communication concept.
    pub fn by(name: ConceptName, session: &Session, cost: CostToGo) -> Advisor {
        let Session { kitchen, spec, .. } = session;
        let concept = concept(name, kitchen.clone(), &spec.human, &spec.assistant, session.seed());
        Advisor { concept, cost, works_ahead: spec.assistant.works_ahead }
    }

    /// The assistant's recommendation for a request for advice.
    pub fn answer(&mut self, question: &AdviceRequest) -> Recommendation {
        self.concept.advise(&mut self.cost, &question.moment())
    }

    /// Number of decisions whose cost to go had to be computed so far, because no cache held the decisions.
    pub fn computed_decisions(&self) -> u64 {
        self.cost.counts().decisions_missed
    }

    /// Prepares for the requests for advice that are likely after this one, as long as `proceed` returns true; see
    /// [`Concept::work_ahead`].
    pub fn work_ahead(&mut self, question: &AdviceRequest, proceed: &mut dyn FnMut() -> bool) {
        self.concept.work_ahead(&mut self.cost, &question.moment(), proceed);
    }
}
