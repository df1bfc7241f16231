//! Replay of a recording, with hypothetical signals where the analysis of a study needs them.

use super::sweep::ConceptSweep;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::kitchen::KitchenChange;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::measures::matching::WINDOW;
use tomcom_session::apply::ApplyError;
use tomcom_session::follower::SessionFollower;
use tomcom_session::settings::Condition;
use tomcom_session::watcher::{SenderComparisonFollower, SenderComparisonSettings};
use tomcom_session::{Session, TimestampedEvent};

/// Replay of a recording together with the hypothetical signals that its condition needs.
#[derive(Debug)]
pub enum ReplayPass {
    /// Replay without hypothetical signals.
    Plain(Box<SessionFollower>),
    /// Replay of a wizard trial with the assistant's hypothetical signals.
    Beside(Box<SenderComparisonFollower>),
    /// Replay of an unassisted trial with hypothetical signals of all compared concepts.
    Swept(Box<ConceptSweep>),
}

impl ReplayPass {
    /// The replay for this session. `concepts`: whether hypothetical signals are wanted. `is_known`: whether the
    /// participant's beliefs are recorded, or may follow from raters' codes.
    pub fn new(session: Session, concepts: bool, is_known: bool, cost: CostToGo) -> ReplayPass {
        let (spec, mut session) = (&session.spec.clone(), session);
        match spec.trial.condition {
            Condition::Wizard if concepts => {
                let request = SenderComparisonSettings { with: Vec::new(), window: WINDOW };
                session.spec.assistant.concept = ConceptName::TomCom;
                ReplayPass::Beside(Box::new(SenderComparisonFollower::new(session, cost, &request)))
            }
            // Prevented errors can be counted only where false beliefs are known.
            Condition::None if concepts && is_known => ReplayPass::Swept(Box::new(ConceptSweep::new(session, cost))),
            _ => ReplayPass::Plain(Box::new(SessionFollower::new(session, cost))),
        }
    }

    /// Applies the next event of the recording.
    ///
    /// # Errors
    /// The event does not fit the session.
    pub fn apply(&mut self, stamped: &TimestampedEvent) -> Result<KitchenChange, ApplyError> {
        match self {
            ReplayPass::Plain(follower) => follower.apply(stamped).map(|applied| applied.change),
            ReplayPass::Beside(watcher) => watcher.apply(stamped),
            ReplayPass::Swept(sweeper) => sweeper.apply(stamped),
        }
    }

    /// The cost to go with the caches that the replay filled, for the next recording.
    pub fn into_cost(self) -> CostToGo {
        match self {
            ReplayPass::Plain(follower) => follower.cost,
            ReplayPass::Beside(watcher) => watcher.follower.cost,
            ReplayPass::Swept(sweeper) => sweeper.cost,
        }
    }

    /// The replayed session with its judged presses and estimates.
    pub fn follower(&self) -> &SessionFollower {
        match self {
            ReplayPass::Plain(follower) => follower,
            ReplayPass::Beside(watcher) => &watcher.follower,
            ReplayPass::Swept(sweeper) => &sweeper.follower,
        }
    }
}
