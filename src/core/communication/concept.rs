//! Communication concepts, the rules by which an assistant sends signals: their interface, their names, and the simple
//! ones (DEV, ToM, none). A concept advises a wizard, gives advice afterwards for a recording, or sends signals by itself.
//!
//! The wizard is not a concept: a person's signals are in the log, and the signals of concepts are compared with them.

use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::planner::Planner;
use super::recommendation::{HumanPressProposal, Recommendation, SignalOption, SignalReason, aspects_told};
use super::settings::AssistantSpec;
use super::signal::{HighlightSet, Signal, unavailable};
use crate::base::time::SessionTime;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, AspectId, ButtonId, Kitchen, State};
use crate::mind::dirichlet::DirichletBelief;
use crate::mind::model::{HumanModel, SignalReadingForecast};
use crate::mind::rounded;

/// The input of a concept at a time at which the concept decides which signal to send, if any.
#[derive(Clone, Copy, Debug)]
pub struct DecisionPoint<'a> {
    /// Sequence number of the event that led to the decision.
    pub seq: u64,
    /// Session time of the event that led to the decision.
    pub time: SessionTime,
    /// Number of presses of both agents so far, which seeds the concept's random stream.
    pub presses: u32,
    /// True state, estimated belief and the robot's intent at the time of the decision.
    pub situation: Situation<'a>,
    /// The signals that may be sent at this time, after the rule against repeated signals.
    pub signals: &'a [Signal],
    /// Sequence number of the human's last press, if that press was an error.
    pub error: Option<u64>,
}

/// A communication concept: the rule by which an assistant sends signals. The concept's answer depends on the decision
/// point and the settings only; caches change computing time, never results.
pub trait Concept: fmt::Debug + Send {
    /// The recommendation at a decision point: the best signal, if any, all options, and the reason.
    fn advise(&mut self, cost: &mut CostToGo, moment: &DecisionPoint) -> Recommendation;

    /// Works ahead after a decision point: fills the caches with what the decision points after the likeliest next
    /// presses will need, as long as `proceed` returns true. Recommendations stay the same, but come sooner.
    fn work_ahead(&mut self, _cost: &mut CostToGo, _moment: &DecisionPoint, _proceed: &(dyn Fn() -> bool + Sync)) {}

    /// Lets the concept compute on this many threads at once, which never changes an answer.
    fn use_threads(&mut self, _threads: usize) {}
}

/// A situation of a trial as the assistant knows it.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// The true state of the kitchen.
    pub state: State,
    /// The estimate of the human's belief at this time.
    pub belief: &'a DirichletBelief,
    /// State aspects of locations that have just changed, and that may attract the human's gaze.
    pub changed: &'a [AspectId],
    /// What the robot is doing now.
    pub robot: RobotIntent,
    /// Duration of a press of the robot, in seconds.
    pub robot_press_s: f64,
    /// Forecast of how a signal that is shown now will be read.
    pub forecast: SignalReadingForecast,
}

impl<'a> Situation<'a> {
    /// A situation in which nothing has just changed, the robot follows its policy, with a press every 2.4 s, and
    /// signals are believed at once.
    pub fn new(state: State, belief: &'a DirichletBelief) -> Situation<'a> {
        let forecast = SignalReadingForecast::default();
        Situation { state, belief, changed: &[], robot: RobotIntent::Free, robot_press_s: 2.4, forecast }
    }
}

/// What the robot is doing now: moving to a button, following its policy, or standing still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RobotIntent {
    /// The robot's arm is moving to a button.
    Busy {
        /// The button to which the arm is moving, as an index into the robot's buttons.
        button: ButtonId,
        /// Time until the arm touches the button, in seconds.
        remaining_s: f64,
        /// Whether the wizard chose the button, so that the robot makes the press even if it is not useful.
        driven: bool,
    },
    /// The robot follows its task policy.
    Free,
    /// The robot is stopped or held by the wizard.
    Still,
}

/// Name of a communication concept (the rule by which an assistant sends signals).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ConceptName {
    /// ToM-Com, theory of mind with communication planning: sends signals that save more presses than they cost.
    #[default]
    TomCom,
    /// ToM, theory of mind without planning: sends signals about aspects with a large expected belief deviation.
    Tom,
    /// DEV, deviation based: proposes the next good presses after an error.
    Dev,
    /// No concept: the assistant sends no signals.
    None,
    /// An external concept: a program of somebody else, which answers over a pipe or a socket.
    External,
}

/// What the benefits and the price of a concept's signals are measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BenefitUnit {
    /// Presses of both agents that a signal saves.
    Presses,
    /// Expected deviation of the belief that a signal corrects, a probability.
    Deviation,
    /// The concept rates no signals.
    None,
}

/// What the program knows of a concept beside its rule.
#[derive(Clone, Copy, Debug)]
pub struct ConceptEntry {
    /// Name in files, on the command line and in style sheets.
    pub name: &'static str,
    /// Name in texts.
    pub title: &'static str,
    /// What it sends, for lists of choices.
    pub sends: &'static str,
    /// Unit of its benefits.
    pub unit: BenefitUnit,
}

impl ConceptName {
    /// All communication concepts.
    pub const ALL: [ConceptName; 5] =
        [ConceptName::TomCom, ConceptName::Tom, ConceptName::Dev, ConceptName::None, ConceptName::External];
    /// The concepts that are part of the program, so that their names alone choose them.
    pub const OWN: [ConceptName; 4] = [ConceptName::TomCom, ConceptName::Tom, ConceptName::Dev, ConceptName::None];

    /// The concept's names, what it sends, and the unit of its benefits.
    pub const fn entry(self) -> ConceptEntry {
        match self {
            ConceptName::TomCom => ConceptEntry {
                name: "tom-com",
                title: "ToM-Com",
                sends: "Signals that save more presses than they cost (ToM-Com)",
                unit: BenefitUnit::Presses,
            },
            ConceptName::Tom => ConceptEntry {
                name: "tom",
                title: "ToM",
                sends: "Signals about sufficiently certain false beliefs (ToM)",
                unit: BenefitUnit::Deviation,
            },
            ConceptName::Dev => ConceptEntry {
                name: "dev",
                title: "DEV",
                sends: "Proposals of the next good presses after an error (DEV); on the display where the assistant acts by \
                        itself, at the console where a wizard decides",
                unit: BenefitUnit::None,
            },
            ConceptName::None => {
                ConceptEntry { name: "none", title: "no concept", sends: "No signals", unit: BenefitUnit::None }
            }
            ConceptName::External => ConceptEntry {
                name: "external",
                title: "external concept",
                sends: "What a program of yours answers",
                unit: BenefitUnit::Presses,
            },
        }
    }

    /// Name of the communication concept in files.
    pub const fn name(self) -> &'static str {
        self.entry().name
    }

    /// Name of the communication concept in texts.
    pub const fn title(self) -> &'static str {
        self.entry().title
    }

    /// The concept with this name in files.
    pub fn named(name: &str) -> Option<ConceptName> {
        ConceptName::ALL.into_iter().find(|concept| concept.name() == name)
    }

    /// Unit of the concept's benefits.
    pub const fn unit(self) -> BenefitUnit {
        self.entry().unit
    }
}

/// Creates the communication concept with this name and the settings of a session. `seed` and the number of presses
/// seed the concept's random stream. An external concept is asked over its connection, and is silent here.
pub fn concept(
    name: ConceptName,
    kitchen: Arc<Kitchen>,
    human: &HumanModel,
    spec: &AssistantSpec,
    seed: u64,
) -> Box<dyn Concept> {
    match name {
        ConceptName::TomCom => Box::new(Planner::new(kitchen, human, spec.clone(), seed)),
        ConceptName::Tom => Box::new(TomConcept::new(kitchen, spec.belief_threshold)),
        ConceptName::Dev => Box::new(DevConcept::new(kitchen, spec.proposed_presses)),
        ConceptName::None | ConceptName::External => Box::new(SilentConcept),
    }
}

/// The concept that never sends a signal, used in the unassisted condition.
#[derive(Clone, Copy, Debug)]
pub struct SilentConcept;

impl Concept for SilentConcept {
    fn advise(&mut self, _: &mut CostToGo, moment: &DecisionPoint) -> Recommendation {
        Recommendation::silent(moment.seq, moment.time)
    }
}

/// Largest number of presses of both agents that a proposal of DEV plans ahead.
const MOST_AHEAD: usize = 40;

/// DEV, the deviation based concept: when the human's press was an error, it proposes the next good presses (paper, "Concept
/// comparisons": 1 to 5 presses).
///
/// A proposal has a kind of signal of its own ([`Signal::Propose`]): "next: …". Most good presses involve the human's own
/// hand or a storage, about which there is no other signal, and highlighting the location of a press would reveal its
/// content, as the theory of mind concepts do. In trials of DEV the assistant sends proposals; beside a wizard, proposals
/// are shown at the console only. The offline comparison of concepts assumes that participants follow proposals, as in the
/// paper.
#[derive(Clone, Debug)]
pub struct DevConcept {
    kitchen: Arc<Kitchen>,
    presses: usize,
}

impl DevConcept {
    /// A DEV concept that proposes `presses` presses at a time.
    pub fn new(kitchen: Arc<Kitchen>, presses: usize) -> DevConcept {
        DevConcept { kitchen, presses }
    }

    /// The next good presses of the human: presses that lower the cost to go of all orders. Where no press of the human
    /// lowers the cost, a press of the robot that does is assumed in between.
    fn good(&self, cost: &mut CostToGo, state: State) -> Vec<ButtonId> {
        let mut state = state;
        let mut presses = Vec::new();
        for _ in 0..MOST_AHEAD {
            let step = self.step(cost, state, Agent::Human).map(|step| (Some(step.0), step.1));
            let step = step.or_else(|| Some((None, self.step(cost, state, Agent::Robot)?.1)));
            let Some((button, after)) = step.filter(|_| presses.len() < self.presses) else { break };
            presses.extend(button);
            state = after;
        }
        presses
    }

    /// The agent's best press if the press lowers the cost to go; ties go to the layout's order.
    fn step(&self, cost: &mut CostToGo, state: State, agent: Agent) -> Option<(ButtonId, State)> {
        let recipes = self.kitchen.true_recipes();
        let decision = cost.decision(state, &recipes, agent);
        let buttons = self.kitchen.buttons[agent.index()].len();
        let best = (0..buttons).min_by_key(|&button| decision.after[button])?;
        let button = ButtonId(best as u8);
        let after = self.kitchen.press(state, &recipes, agent, button)?;
        (decision.after[best] < decision.here).then_some((button, after))
    }
}

impl Concept for DevConcept {
    /// The advice of DEV: a proposal of presses is valid, and is updated, until the human's next press.
    fn advise(&mut self, cost: &mut CostToGo, moment: &DecisionPoint) -> Recommendation {
        let name = |button: ButtonId| self.kitchen.button(Agent::Human, button).name.clone();
        let proposal = moment.error.map(|error| {
            let presses = self.good(cost, moment.situation.state).into_iter().map(name).collect();
            HumanPressProposal { error, presses }
        });
        let proposal = proposal.filter(|proposal| !proposal.presses.is_empty());
        Recommendation { proposal, ..Recommendation::silent(moment.seq, moment.time) }
    }
}

/// ToM, the concept with theory of mind, but without planning: signals about false or uncertain beliefs, whether the beliefs
/// matter now or not (paper, "Concept comparisons"; Buehler and Weisswange 2018).
///
/// It has the paper's signals: the recipe of an order, and highlights of the places where both agents get into each other's
/// way, the robot's hand and the assembly board. Among those that can be sent, the one whose aspect has the largest expected
/// belief deviation, 1 - E[P(truth)], is recommended if that deviation exceeds a threshold (0.4 to 0.99 in the paper).
#[derive(Clone, Debug)]
pub struct TomConcept {
    kitchen: Arc<Kitchen>,
    threshold: f64,
}

impl TomConcept {
    /// A ToM concept with this threshold of the expected belief deviation, a probability.
    pub fn new(kitchen: Arc<Kitchen>, threshold: f64) -> TomConcept {
        TomConcept { kitchen, threshold }
    }

    fn is_of_paper(&self, signal: &Signal) -> bool {
        match signal {
            Signal::ShowRecipe(_) => true,
            Signal::Highlight(_) => {
                let highlights = HighlightSet::of_paper(&self.kitchen);
                signal.location(&self.kitchen).is_some_and(|location| highlights.holds(location))
            }
            Signal::Propose(_) => false,
        }
    }

    /// Largest expected belief deviation among the state aspects that a signal shows.
    fn deviation(&self, moment: &DecisionPoint, signal: &Signal) -> f64 {
        let (kitchen, state, belief) = (&self.kitchen, moment.situation.state, moment.situation.belief);
        let aspects = aspects_told(kitchen, state, signal).into_iter();
        aspects.map(|aspect| 1.0 - belief.p_truth(kitchen, state, aspect)).fold(0.0, f64::max)
    }
}

impl Concept for TomConcept {
    /// The advice of ToM: a signal's benefit is the expected belief deviation; the net benefit is the deviation minus
    /// the threshold.
    fn advise(&mut self, _: &mut CostToGo, moment: &DecisionPoint) -> Recommendation {
        let (kitchen, state) = (&self.kitchen, moment.situation.state);
        let of_paper = moment.signals.iter().filter(|signal| self.is_of_paper(signal));
        let possible = of_paper.filter(|signal| unavailable(kitchen, state, signal).is_none());
        let mut ranked: Vec<(f64, &Signal)> = possible.map(|signal| (self.deviation(moment, signal), signal)).collect();
        // The sort is stable, so that signals with equal deviations keep the layout's order.
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        let best = ranked.first().filter(|(deviation, _)| *deviation > self.threshold);
        let option = |&(deviation, signal): &(f64, &Signal)| SignalOption {
            signal: signal.clone(),
            benefit: rounded(deviation),
            standard_error: 0.0,
            net: rounded(deviation - self.threshold),
            rollouts: 0,
        };
        Recommendation {
            options: ranked.iter().map(option).collect(),
            best: best.map(|(_, signal)| (*signal).clone()),
            reason: best
                .and_then(|(_, signal)| SignalReason::for_signal(kitchen, state, moment.situation.belief, signal)),
            ..Recommendation::silent(moment.seq, moment.time)
        }
    }
}
