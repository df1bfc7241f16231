//! The assistant of a session: when it is asked for advice, with what, and its answer.

use crate::external::happenings::{Happening, Happenings};
use crate::follower::SessionFollower;
use crate::{Event, Session};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::communication::concept::{Concept, ConceptName, DecisionPoint, RobotIntent, Situation, concept};
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{AspectId, State};
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_core::mind::model::SignalReadingForecast;

/// A request for advice: the session after an event and all its immediate consequences.
#[derive(Clone, Debug)]
pub struct AdviceRequest {
    pub seq: u64,
    pub time: SessionTime,
    presses: u32,
    state: State,
    belief: DirichletBelief,
    changed: Vec<AspectId>,
    robot: RobotIntent,
    robot_press_s: f64,
    forecast: SignalReadingForecast,
    signals: Vec<Signal>,
    /// Sequence number of the human's last press, if that press was an error.
    error: Option<u64>,
    /// The trial's clock, in seconds.
    pub(crate) clock_s: f64,
    /// What happened since the last request, for an external concept; empty without one.
    pub(crate) since: Vec<Happening>,
}

impl AdviceRequest {
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
        AdviceRequest {
            seq,
            time,
            presses: session.all_presses(),
            state: session.state,
            belief,
            changed: session.changed_at(time).map(AspectId::of_location).collect(),
            robot,
            robot_press_s: session.spec.robot.press_s,
            forecast: follower.filter.forecast(),
            signals: follower.repeats.allowed(&session.kitchen, session.highlights()),
            error: follower.judged.last().filter(|press| press.verdict.error).map(|press| press.seq),
            clock_s: session.trial_clock(time).as_secs_f64(),
            since: follower.happenings.as_mut().map(Happenings::take).unwrap_or_default(),
        }
    }

    pub fn moment(&self) -> DecisionPoint<'_> {
        let AdviceRequest { seq, time, presses, state, robot, robot_press_s, forecast, error, .. } = *self;
        let (belief, changed, signals) = (&self.belief, &self.changed, &self.signals);
        let situation = Situation { state, belief, changed, robot, robot_press_s, forecast };
        DecisionPoint { seq, time, presses, situation, signals, error }
    }

    pub fn about(&self, belief: &DirichletBelief, signals: Vec<Signal>) -> AdviceRequest {
        AdviceRequest { belief: belief.clone(), signals, ..self.clone() }
    }
}

#[derive(Debug)]
pub struct Advisor {
    concept: Box<dyn Concept>,
    cost: CostToGo,
    /// Whether it computes ahead between requests in a live session.
    pub works_ahead: bool,
}

impl Advisor {
    pub fn new(session: &Session, cost: CostToGo) -> Advisor {
        Advisor::by(session.spec.assistant.concept.name(), session, cost)
    }

    pub fn by(name: ConceptName, session: &Session, cost: CostToGo) -> Advisor {
        let Session { kitchen, spec, .. } = session;
        let concept = concept(name, kitchen.clone(), &spec.human, &spec.assistant, session.seed());
        Advisor { concept, cost, works_ahead: spec.assistant.works_ahead }
    }

    pub fn answer(&mut self, question: &AdviceRequest) -> Recommendation {
        self.concept.advise(&mut self.cost, &question.moment())
    }

    /// Lets it compute on this many threads at once, which never changes an answer.
    pub fn use_threads(&mut self, threads: usize) {
        self.concept.use_threads(threads);
    }

    /// Number of decisions whose cost to go was in no cache.
    pub fn computed_decisions(&self) -> u64 {
        self.cost.decisions_missed()
    }

    /// Prepares for likely next requests as long as `proceed` returns true; see [`Concept::work_ahead`].
    pub fn work_ahead(&mut self, question: &AdviceRequest, proceed: &(dyn Fn() -> bool + Sync)) {
        self.concept.work_ahead(&mut self.cost, &question.moment(), proceed);
    }
}

/// Whether the assistant is asked for advice after an event that has just been applied: a press of either agent, a
/// change of the task without a press, an unusually long silence of the human.
pub fn leads_to_advice(session: &Session, event: &Event) -> bool {
    let leads = matches!(
        event,
        Event::Press { .. }
            | Event::OrderShown { .. }
            | Event::OrderCleared { .. }
            | Event::KitchenCorrected { .. }
            | Event::HumanWaits { .. }
    );
    leads && session.is_running()
}
