//! One rollout: a human who decides by a sample of the belief, and the robot in between.
//!
//! All rollouts of the same number share their random numbers, whatever was said, so that their differences are precise.
//! A rollout that comes to be in the same situation as the one without a signal goes on like that one, and is not
//! continued.

use rand::RngExt;

use super::human::{Cases, Decider, HumanChoice};
use super::robot::{self, OngoingRobotPress, RobotChoices, RobotPolicy};
use crate::base::rng::Stream;
use crate::communication::settings::RolloutModel;
use crate::communication::situation::{RobotIntent, Situation};
use crate::kitchen::cost_to_go::{CostToGo, Fidelity};
use crate::kitchen::state::MAX_LOCATIONS;
use crate::kitchen::{Agent, AspectId, ButtonId, Kitchen, Recipes, State};

/// So many presses of the robot between two decisions have random numbers of their own.
const ROBOT_DRAWS: usize = 4;

/// The random numbers of one decision of the human, and of the robot until then; `looks` by location.
#[derive(Clone, Copy, Debug, Default)]
pub struct RolloutDraws {
    decision: f64,
    slip: f64,
    looks: [f64; MAX_LOCATIONS],
    choices: [f64; ROBOT_DRAWS],
    predictions: [f64; ROBOT_DRAWS],
    captures: [f64; ROBOT_DRAWS],
}

impl RolloutDraws {
    pub fn draw(random: &mut Stream) -> RolloutDraws {
        let mut draws = RolloutDraws { decision: random.random(), slip: random.random(), ..RolloutDraws::default() };
        draws.looks.iter_mut().for_each(|draw| *draw = random.random());
        draws.choices.iter_mut().for_each(|draw| *draw = random.random());
        draws.predictions.iter_mut().for_each(|draw| *draw = random.random());
        draws.captures.iter_mut().for_each(|draw| *draw = random.random());
        draws
    }

    /// Takes these numbers for the decision, for the robot's first choice before it, and for whether the eye is drawn to
    /// its first press.
    pub fn begin_with(&mut self, first: &[f64]) {
        if let &[decision, choice, capture] = first {
            (self.decision, self.choices[0], self.captures[0]) = (decision, choice, capture);
        }
    }
}

/// What a rollout stands on.
pub struct RolloutContext<'a> {
    pub kitchen: &'a Kitchen,
    pub recipes: Recipes,
    pub decider: &'a Decider,
    /// By button of the human, the aspects of the places that decide what it does.
    pub involved: &'a [Vec<AspectId>],
    /// What is looked at before each of them is pressed.
    pub watched: &'a [Vec<AspectId>],
    pub model: &'a RolloutModel,
    pub robot_press_s: f64,
    /// The chance that a place which is needed is looked at before a press.
    pub looks: f64,
    /// The chance that any other place is looked at before a decision.
    pub other_looks: f64,
    /// The chance that the human thinks a press of the robot through.
    pub foresight: f64,
}

/// Where a rollout is, right before a decision of the human.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RolloutState {
    pub state: State,
    pub cases: Cases,
    errand: Option<OngoingRobotPress>,
    is_still: bool,
    presses: i32,
    now_s: f64,
}

/// The moments and deeds of the rollout in which nothing was said.
#[derive(Clone, Debug, Default)]
pub struct BaselineRollout {
    moments: Vec<RolloutState>,
    deeds: Vec<HumanChoice>,
    pub value: i32,
}

/// How a rollout with a signal went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RolloutOutcome {
    /// Presses of both and the cost to go at the end.
    pub value: i32,
    /// The first decision that was another one than without the signal: what was done without it, and with it.
    pub parted: Option<(HumanChoice, HumanChoice)>,
}

impl RolloutState {
    /// The rollout's beginning, when the human holds these cases for possible; `sees`: what has just changed draws its eye.
    pub fn begin(&mut self, kitchen: &Kitchen, situation: &Situation, cases: &Cases, sees: bool) {
        self.state = situation.state;
        self.cases.copy_from(cases);
        for &aspect in situation.changed.iter().filter(|_| sees) {
            self.cases.learn(kitchen, aspect, self.state);
        }
        self.is_still = situation.robot == RobotIntent::Still;
        self.errand = match situation.robot {
            RobotIntent::Busy { button, remaining_s, driven } => {
                Some(OngoingRobotPress { button, due_s: remaining_s, driven })
            }
            RobotIntent::Free | RobotIntent::Still => None,
        };
        (self.presses, self.now_s) = (0, 0.0);
    }

    /// The eye is drawn to what was otherwise before.
    fn see_changes(&mut self, kitchen: &Kitchen, before: State) {
        for location in kitchen.changed(before, self.state) {
            self.cases.learn(kitchen, AspectId::of_location(location), self.state);
        }
    }

    fn copy_from(&mut self, other: &RolloutState) {
        self.cases.copy_from(&other.cases);
        self.state = other.state;
        self.errand = other.errand;
        self.is_still = other.is_still;
        (self.presses, self.now_s) = (other.presses, other.now_s);
    }

    /// Whether all that follows is the same as from another moment of the same time.
    fn goes_on_like(&self, other: &RolloutState) -> bool {
        self.state == other.state && self.errand == other.errand && self.cases == other.cases
    }
}

/// A rollout's machinery.
pub struct Rollout<'a> {
    pub stage: &'a RolloutContext<'a>,
    pub cost: &'a mut CostToGo,
    pub policy: &'a mut RobotPolicy,
    pub draws: &'a [RolloutDraws],
    /// When the human decides first, in seconds.
    pub first_s: f64,
}

impl Rollout<'_> {
    /// The rollout in which nothing is said; remembers its moments.
    pub fn silent(&mut self, moment: &mut RolloutState, trace: &mut BaselineRollout) {
        trace.deeds.clear();
        for step in 0..self.draws.len() {
            self.until_decision(moment, step);
            if trace.moments.len() == step {
                trace.moments.push(RolloutState::default());
            }
            trace.moments[step].copy_from(moment);
            let deed = self.decide(moment, step);
            trace.deeds.push(deed);
        }
        trace.value = self.value(moment);
    }

    /// A rollout in which something was said, beside the silent one.
    pub fn told(&mut self, moment: &mut RolloutState, trace: &BaselineRollout) -> RolloutOutcome {
        let mut parted = None;
        for step in 0..self.draws.len() {
            self.until_decision(moment, step);
            let silent = &trace.moments[step];
            if moment.goes_on_like(silent) {
                return RolloutOutcome { value: trace.value + moment.presses - silent.presses, parted };
            }
            let deed = self.decide(moment, step);
            let silent = trace.deeds[step];
            if parted.is_none() && silent != deed {
                parted = Some((silent, deed));
            }
        }
        RolloutOutcome { value: self.value(moment), parted }
    }

    fn value(&mut self, moment: &RolloutState) -> i32 {
        moment.presses + self.cost.all_orders(moment.state, &self.stage.recipes) as i32
    }

    /// The robot goes on until the human decides.
    fn until_decision(&mut self, moment: &mut RolloutState, step: usize) {
        let until_s = self.first_s + step as f64 * self.stage.model.human_press_s;
        let mut presses = 0;
        if moment.is_still {
            moment.now_s = until_s;
            return;
        }
        loop {
            self.set_out(moment, step, presses);
            let Some(errand) = moment.errand.filter(|errand| errand.due_s <= until_s) else { break };
            moment.now_s = errand.due_s;
            moment.errand = None;
            let choices = self.choices(moment.state);
            if errand.holds(choices) {
                let before = moment.state;
                moment.state = robot::press(self.stage.kitchen, before, &self.stage.recipes, errand.button);
                moment.presses += 1;
                let draw = self.draws[step].predictions[presses % ROBOT_DRAWS];
                if draw < self.stage.foresight {
                    let draw = draw / self.stage.foresight;
                    moment.cases.robot_pressed(self.stage.kitchen, self.cost, self.policy, draw);
                }
                if self.draws[step].captures[presses % ROBOT_DRAWS] < self.stage.model.capture {
                    moment.see_changes(self.stage.kitchen, before);
                }
                presses += 1;
            }
        }
        moment.now_s = until_s;
    }

    /// What the robot's policy says to the state as it truly is.
    fn choices(&mut self, state: State) -> RobotChoices {
        self.policy.choices(self.stage.kitchen, self.cost, Fidelity::Exact, state, &self.stage.recipes)
    }

    /// A free arm sets out for what the policy says.
    fn set_out(&mut self, moment: &mut RolloutState, step: usize, presses: usize) {
        if moment.errand.is_some() {
            return;
        }
        let choices = self.choices(moment.state);
        if choices.count() > 0 {
            let draw = self.draws[step].choices[presses % ROBOT_DRAWS];
            let button: ButtonId = choices.nth((draw * f64::from(choices.count())) as u32);
            moment.errand =
                Some(OngoingRobotPress { button, due_s: moment.now_s + self.stage.robot_press_s, driven: false });
        }
    }

    /// The human looks around and at what its next press needs, decides, and presses.
    fn decide(&mut self, moment: &mut RolloutState, step: usize) -> HumanChoice {
        let (stage, draws) = (self.stage, &self.draws[step]);
        for (index, &draw) in draws.looks[..stage.kitchen.locations.len()].iter().enumerate() {
            if draw < stage.other_looks {
                moment.cases.learn(stage.kitchen, AspectId(index as u8), moment.state);
            }
        }
        let inclination = stage.decider.inclination(self.cost, &moment.cases);
        let mut meant = stage.decider.meant(&inclination, draws.decision);
        if let HumanChoice::Press(button) = meant {
            let mut is_news = false;
            for &aspect in &stage.watched[button.index()] {
                if draws.looks[aspect.index()] < stage.looks {
                    is_news |= moment.cases.learn(stage.kitchen, aspect, moment.state);
                }
            }
            if is_news {
                let inclination = stage.decider.inclination(self.cost, &moment.cases);
                meant = stage.decider.meant(&inclination, draws.decision);
            }
        }
        let deed = stage.decider.done(meant, draws.slip);
        if let HumanChoice::Press(button) = deed {
            let before = moment.state;
            let after = stage.kitchen.press(before, &stage.recipes, Agent::Human, button);
            moment.state = after.unwrap_or(before);
            moment.presses += 1;
            moment.cases.pressed(stage.kitchen, button, &stage.involved[button.index()], before, after);
        }
        deed
    }
}
