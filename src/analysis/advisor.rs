//! The assistant beside a session: gets a question after every press and every order change, and answers it.

use super::follower::Follower;
use crate::base::time::SessionTime;
use crate::communication::Signal;
use crate::communication::concept::{Concept, ConceptName, DecisionPoint};
use crate::communication::concepts::concept;
use crate::communication::recommendation::Recommendation;
use crate::communication::situation::{RobotIntent, Situation};
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{AspectId, State};
use crate::mind::dirichlet::DirichletBelief;
use crate::session::{Event, Session};

/// What the assistant is asked: the session as it was after an event and all that followed from it at once.
#[derive(Clone, Debug)]
pub struct AdviceRequest {
    /// The number and the time of the event.
    pub seq: u64,
    pub time: SessionTime,
    presses: u32,
    state: State,
    belief: DirichletBelief,
    changed: Vec<AspectId>,
    robot: RobotIntent,
    robot_press_s: f64,
    /// What may be said.
    signals: Vec<Signal>,
    /// The number of the human's last press, if that was an error.
    error: Option<u64>,
}

impl AdviceRequest {
    /// The question after an event of this number and time.
    pub fn from_follower(follower: &Follower, seq: u64, time: SessionTime) -> AdviceRequest {
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
        let belief = follower.filter.belief().clone();
        let signals = follower.repeats.allowed(&session.kitchen, session.spec.signals.own_hand);
        let error = follower.judged.last().filter(|press| press.verdict.error).map(|press| press.seq);
        let changed = session.changed_at(time).map(AspectId::of_location).collect();
        let presses = session.all_presses();
        AdviceRequest { seq, time, presses, state, belief, changed, robot, robot_press_s, signals, error }
    }

    /// What there is to decide about.
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
            ref signals,
            error,
        } = *self;
        let situation = Situation { state, belief, changed, robot, robot_press_s };
        DecisionPoint { seq, time, presses, situation, signals, error }
    }

    /// The same question about another estimate, and with other things that may be said.
    pub fn about(&self, belief: &DirichletBelief, signals: Vec<Signal>) -> AdviceRequest {
        AdviceRequest { belief: belief.clone(), signals, ..self.clone() }
    }
}

/// Answers questions about one session.
#[derive(Debug)]
pub struct Advisor {
    concept: Box<dyn Concept>,
    cost: CostToGo,
}

impl Advisor {
    /// The assistant of a session, by the concept that its settings name.
    pub fn new(session: &Session, cost: CostToGo) -> Advisor {
        Advisor::by(session.spec.assistant.concept, session, cost)
    }

    /// One that advises by this concept.
    pub fn by(name: ConceptName, session: &Session, cost: CostToGo) -> Advisor {
        let Session { kitchen, spec, .. } = session;
        Advisor { concept: concept(name, kitchen.clone(), &spec.human, &spec.assistant, session.seed()), cost }
    }

    /// What the assistant recommends.
    pub fn answer(&mut self, question: &AdviceRequest) -> Recommendation {
        self.concept.advise(&mut self.cost, &question.moment())
    }
}

/// Whether the assistant is asked after such an event: a press of either agent, and what changes the task without one.
pub fn changes_task(event: &Event) -> bool {
    matches!(
        event,
        Event::Press { .. } | Event::OrderShown { .. } | Event::OrderCleared { .. } | Event::KitchenCorrected { .. }
    )
}
