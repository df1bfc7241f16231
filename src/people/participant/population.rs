//! Population of simulated participants: distributions of traits, and individual participants drawn from them.

use serde::{Deserialize, Serialize};
use tomcom_core::base::rng::Stream;

use super::normal;

/// Distribution of one trait over the simulated population, given by median and relative spread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "{ median = 0.1, sigma = 0.4 }")]
pub struct TraitSpread {
    /// Median of the trait, in the trait's unit.
    pub median: f64,
    /// Standard deviation over people of the trait's logarithm (of its logit, if the trait is a probability).
    pub sigma: f64,
}

/// A probability of 0 for everybody, the default of traits that the calibrated population does not have.
const NEVER: TraitSpread = TraitSpread::from_median(0.0, 0.4);

/// Default probability of a wrong answer to a question of a freeze probe: small, since otherwise wrong answers would
/// hide the few false beliefs.
const ANSWERS_WRONG: TraitSpread = TraitSpread::from_median(0.01, 0.4);
/// Least P(truth) with which a belief does not count as false, see `measures::sequences::FALSE_BELOW`.
const ANSWERS_FROM: f64 = 0.5;
const ANSWER_S: TraitSpread = TraitSpread::from_median(3.0, 0.3);
/// Default probability of following a noticed proposal; it is an assumption, since proposals were never shown to
/// people.
const FOLLOWS_PROPOSAL: TraitSpread = TraitSpread::from_median(0.9, 0.4);

impl TraitSpread {
    const fn from_median(median: f64, sigma: f64) -> TraitSpread {
        TraitSpread { median, sigma }
    }

    /// Draws a positive trait of a person: log-normal, truncated at three sigma.
    fn draw(self, random: &mut Stream) -> f64 {
        self.median * (self.sigma * normal(random).clamp(-3.0, 3.0)).exp()
    }

    /// Draws a person's trait that is a probability: logit-normal, truncated at three sigma.
    fn draw_chance(self, random: &mut Stream) -> f64 {
        let odds = self.median / (1.0 - self.median) * (self.sigma * normal(random).clamp(-3.0, 3.0)).exp();
        odds / (1.0 + odds)
    }
}

/// Parameters of the simulated population. The defaults of planning and slips are calibrated to the paper's participants
/// (study, "Simulated participants", steps A and B). Step C, their beliefs over two trials, is in `sessions/paper.toml`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Population {
    /// Time from one press to the next, in seconds, of a participant with some practice.
    pub press_s: TraitSpread,
    /// Standard deviation of the logarithm of one participant's times from press to press.
    pub press_jitter: f64,
    /// Relative increase of the time between presses for a beginner (0.3: 30 % slower).
    pub novice_slowdown: f64,
    /// Number of presses after which half of a beginner's slowdown is gone.
    pub practice_presses: f64,
    /// Probability of a slip that hits another button, rather one nearby and of like colour (see [`super::hand::slipped_button`]).
    pub slip: TraitSpread,
    /// Probability of a slip that takes the look-alike ingredient from the storage.
    pub look_alike_slip: TraitSpread,
    /// Probability that a press is thoughtless: any of the presses that would be effective as the participant believes,
    /// which may be the intended one.
    pub thoughtless: TraitSpread,
    /// Probability that the participant notices an own slip.
    pub notices_slip: f64,
    /// Probability of repeating an unexpectedly ineffective press before searching for its cause (perseveration).
    pub insists: f64,
    /// Probability that the participant looks at a location right before using it.
    pub checks: TraitSpread,
    /// Probability of another look before a press if the last look at the press's location is some time ago.
    pub makes_sure: TraitSpread,
    /// Probability that a change anywhere on the display captures the participant's attention.
    pub capture: TraitSpread,
    /// Probability that a new order captures the participant's attention.
    pub order_capture: TraitSpread,
    /// Probability that a fixation is outside of the task's locations.
    pub wanders: TraitSpread,
    /// Weight of the robot's hand in the choice of fixation targets (1: as a location of the next press).
    pub watches_robot: TraitSpread,
    /// Duration of a fixation of the eyes, in seconds.
    pub fixation_s: TraitSpread,
    /// Probability of mistaking the content of a location for one that looks like it.
    pub misreads: TraitSpread,
    /// Share of the belief in the unseen content of the robot's hand that is lost when the robot presses.
    pub doubts_robot_hand: TraitSpread,
    /// Share of the belief in the unseen content of a shared location that is lost when the robot presses.
    pub doubts_places: TraitSpread,
    /// Probability that the participant gives to the true recipe after the instruction, on a menu of six dishes.
    pub learned: TraitSpread,
    /// Probability of the true recipe to which an unused memory fades, on a menu of six dishes.
    pub half_forgotten: TraitSpread,
    /// Half-life of the fading of recipe memories, in seconds.
    pub half_life_s: TraitSpread,
    /// Rate per minute at which the participant forgets the recipe during the work on its order, and then recalls the
    /// recipe again.
    pub loses_thread_per_min: TraitSpread,
    /// Weight of a look-alike topping among the false memories of a recipe (another topping has weight 1).
    pub confuses_look_alikes: f64,
    /// Probability that the participant doubts a recipe when the robot's behaviour contradicts it.
    pub takes_hints: TraitSpread,
    /// Time without a useful press after which the participant looks around and doubts recipes, in seconds.
    pub patience_s: TraitSpread,
    /// Time for which the participant stays with one order, in seconds.
    pub commitment_s: TraitSpread,
    /// Number of own presses that the participant thinks through; rounded, from 2 to 5.
    pub depth: TraitSpread,
    /// Probability that the participant does not check the preconditions of the presses after the next one.
    pub skips_check: TraitSpread,
    /// Probability that the participant takes a part of the last dish instead of one of the present dish, by habit.
    pub follows_habit: TraitSpread,
    /// Probability that the participant forgets parts at parking places.
    pub forgets_parked: TraitSpread,
    /// Probability that the participant first does what is within reach for another order.
    pub takes_along: TraitSpread,
    /// Probability that the participant notices a signal; at most 0.85.
    pub notices_signal: TraitSpread,
    /// Shortest and longest time from the appearance of a signal to its reading, in seconds.
    pub signal_after_s: [f64; 2],
    /// Shortest and longest time that reading a signal takes, in seconds. The participant sees nothing else meanwhile.
    pub reads_signal_s: [f64; 2],
    /// Probability that the participant, by reading a signal, forgets which press was intended next.
    pub loses_intention: TraitSpread,
    /// Time from reading a signal to the next press if the intended press was forgotten, in seconds.
    pub resumes_after_s: f64,
    /// Share by which the attention to signals moves towards the usefulness of each signal that is read.
    pub tires_of_signals: TraitSpread,
    /// Probability of misreading a recipe that a signal shows.
    pub misreads_signal: f64,
    /// Probability that the participant keeps the own version of a recipe when a signal shows another version.
    pub keeps_own_recipe: TraitSpread,
    /// Probability, for each recipe, that the participant is sure of a wrong version after the instruction.
    pub misremembers: TraitSpread,
    /// Probability that the participant guesses rightly what the robot did by a press that the participant did not see.
    pub guesses_robot: TraitSpread,
    /// Probability that the participant, after an own press, does not know how to go on: the participant waits until
    /// something changes in what the participant believes, or a signal is read.
    pub gets_stuck: TraitSpread,
    /// Factor, per earlier trial, on the odds of knowing a recipe (1: no learning between trials).
    pub recipes_gained: f64,
    /// Share of the presses in earlier trials that count as practice (0: earlier trials give no practice).
    pub practice_kept: f64,
    /// Size of the eye tracker's systematic offset, in metres on the display (1 deg at 2 m is 0.035 m).
    pub tracker_offset_m: f64,
    /// Whether all participants know the state and all recipes, and so make only planning errors and slips.
    pub all_knowing: bool,
    /// Probability of a wrong answer to a question of a freeze probe, whatever the participant believes.
    pub answers_wrong: TraitSpread,
    /// Least probability of a belief's most probable value from which the value is given as the answer to a probe;
    /// below it, the answer is "I don't know".
    pub answers_from: f64,
    /// Time that a participant takes to answer a question of a freeze probe, in seconds.
    pub answer_s: TraitSpread,
    /// Probability that the participant, having read a proposal, makes the proposed presses at the next decision,
    /// whatever the participant believes.
    pub follows_proposal: TraitSpread,
}

/// A participant's experience (practice) from earlier trials.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Experience {
    pub trials: u32,
    pub presses: f64,
}

impl Default for Population {
    fn default() -> Self {
        Population {
            press_s: TraitSpread::from_median(1.5, 0.12),
            press_jitter: 0.3,
            novice_slowdown: 0.3,
            practice_presses: 25.0,
            slip: TraitSpread::from_median(0.007, 0.4),
            look_alike_slip: TraitSpread::from_median(0.009, 0.4),
            thoughtless: TraitSpread::from_median(0.005, 0.4),
            notices_slip: 0.85,
            insists: 0.0,
            checks: TraitSpread::from_median(0.9, 0.3),
            makes_sure: TraitSpread::from_median(0.4, 0.5),
            capture: TraitSpread::from_median(0.6, 0.3),
            order_capture: TraitSpread::from_median(0.75, 0.3),
            wanders: TraitSpread::from_median(0.15, 0.3),
            watches_robot: TraitSpread::from_median(1.2, 0.3),
            fixation_s: TraitSpread::from_median(0.3, 0.12),
            misreads: TraitSpread::from_median(0.02, 0.3),
            doubts_robot_hand: TraitSpread::from_median(0.12, 0.2),
            doubts_places: TraitSpread::from_median(0.02, 0.2),
            learned: TraitSpread::from_median(0.89, 0.4),
            half_forgotten: TraitSpread::from_median(0.7, 0.3),
            half_life_s: TraitSpread::from_median(240.0, 0.3),
            loses_thread_per_min: TraitSpread::from_median(0.15, 0.4),
            confuses_look_alikes: 3.0,
            takes_hints: TraitSpread::from_median(0.15, 0.4),
            patience_s: TraitSpread::from_median(4.0, 0.25),
            commitment_s: TraitSpread::from_median(12.0, 0.3),
            depth: TraitSpread::from_median(3.4, 0.25),
            skips_check: TraitSpread::from_median(0.2, 0.4),
            follows_habit: TraitSpread::from_median(0.15, 0.4),
            forgets_parked: TraitSpread::from_median(0.2, 0.4),
            takes_along: TraitSpread::from_median(0.4, 0.4),
            notices_signal: TraitSpread::from_median(0.82, 0.15),
            signal_after_s: [0.5, 1.5],
            reads_signal_s: [0.5, 1.5],
            loses_intention: TraitSpread::from_median(0.05, 0.4),
            resumes_after_s: 1.0,
            tires_of_signals: TraitSpread::from_median(0.1, 0.4),
            misreads_signal: 0.03,
            keeps_own_recipe: NEVER,
            misremembers: NEVER,
            guesses_robot: NEVER,
            gets_stuck: NEVER,
            recipes_gained: 1.0,
            practice_kept: 0.0,
            tracker_offset_m: 0.02,
            all_knowing: false,
            answers_wrong: ANSWERS_WRONG,
            answers_from: ANSWERS_FROM,
            answer_s: ANSWER_S,
            follows_proposal: FOLLOWS_PROPOSAL,
        }
    }
}

/// Traits of one simulated participant, drawn from the population, with meanings and units as in [`Population`].
#[derive(Clone, Debug, PartialEq)]
pub struct ParticipantTraits {
    pub press_s: f64,
    pub slip: f64,
    pub look_alike_slip: f64,
    pub thoughtless: f64,
    pub checks: f64,
    pub makes_sure: f64,
    pub capture: f64,
    pub order_capture: f64,
    pub wanders: f64,
    pub watches_robot: f64,
    pub fixation_s: f64,
    pub misreads: f64,
    pub doubts_robot_hand: f64,
    pub doubts_places: f64,
    pub learned: f64,
    pub half_forgotten: f64,
    pub half_life_s: f64,
    pub(crate) loses_thread_per_s: f64,
    pub takes_hints: f64,
    pub patience_s: f64,
    pub commitment_s: f64,
    pub notices_signal: f64,
    pub depth: usize,
    pub skips_check: f64,
    pub follows_habit: f64,
    pub forgets_parked: f64,
    pub takes_along: f64,
    pub loses_intention: f64,
    pub tires_of_signals: f64,
    pub keeps_own_recipe: f64,
    pub misremembers: f64,
    pub guesses_robot: f64,
    pub answers_wrong: f64,
    pub answer_s: f64,
    pub follows_proposal: f64,
    pub gets_stuck: f64,
}

/// Least and largest number of own presses that a participant thinks through (study, "Simulated participants").
const DEPTHS: [usize; 2] = [2, 5];
/// Upper bound of the probability of noticing a signal (study, "Simulated participants").
const MOST_SIGNALS_NOTICED: f64 = 0.85;

impl Population {
    /// The first parameters that contradict each other: the path of one of these in a session file, the value found,
    /// and a valid value. The ranges of single parameters are in `session::ranges`.
    pub fn fault(&self) -> Option<(&'static str, String, &'static str)> {
        let intervals = [
            ("participant.population.signal_after_s", "signal_after_s", self.signal_after_s),
            ("participant.population.reads_signal_s", "reads_signal_s", self.reads_signal_s),
        ];
        let (path, name, [least, most]) = intervals.into_iter().find(|(_, _, [least, most])| most < least)?;
        Some((path, format!("{name} = [{least}, {most}]"), "[least, most], in seconds"))
    }

    pub fn draw(&self, random: &mut Stream) -> ParticipantTraits {
        ParticipantTraits {
            press_s: self.press_s.draw(random),
            slip: self.slip.draw_chance(random),
            look_alike_slip: self.look_alike_slip.draw_chance(random),
            thoughtless: self.thoughtless.draw_chance(random),
            checks: self.checks.draw_chance(random),
            makes_sure: self.makes_sure.draw_chance(random),
            capture: self.capture.draw_chance(random),
            order_capture: self.order_capture.draw_chance(random),
            wanders: self.wanders.draw_chance(random),
            watches_robot: self.watches_robot.draw(random),
            fixation_s: self.fixation_s.draw(random),
            misreads: self.misreads.draw_chance(random),
            doubts_robot_hand: self.doubts_robot_hand.draw_chance(random),
            doubts_places: self.doubts_places.draw_chance(random),
            learned: self.learned.draw_chance(random),
            half_forgotten: self.half_forgotten.draw_chance(random),
            half_life_s: self.half_life_s.draw(random),
            loses_thread_per_s: self.loses_thread_per_min.draw(random) / 60.0,
            takes_hints: self.takes_hints.draw_chance(random),
            patience_s: self.patience_s.draw(random),
            commitment_s: self.commitment_s.draw(random),
            notices_signal: self.notices_signal.draw_chance(random).min(MOST_SIGNALS_NOTICED),
            depth: (self.depth.draw(random).round() as usize).clamp(DEPTHS[0], DEPTHS[1]),
            skips_check: self.skips_check.draw_chance(random),
            follows_habit: self.follows_habit.draw_chance(random),
            forgets_parked: self.forgets_parked.draw_chance(random),
            takes_along: self.takes_along.draw_chance(random),
            loses_intention: self.loses_intention.draw_chance(random),
            tires_of_signals: self.tires_of_signals.draw_chance(random),
            keeps_own_recipe: self.keeps_own_recipe.draw_chance(random),
            misremembers: self.misremembers.draw_chance(random),
            guesses_robot: self.guesses_robot.draw_chance(random),
            answers_wrong: self.answers_wrong.draw_chance(random),
            answer_s: self.answer_s.draw(random),
            follows_proposal: self.follows_proposal.draw_chance(random),
            gets_stuck: self.gets_stuck.draw_chance(random),
        }
    }
}

impl ParticipantTraits {
    /// The same individual's traits after some trials, when the individual knows the recipes better.
    pub fn after(self, experience: Experience, population: &Population) -> ParticipantTraits {
        let gain = population.recipes_gained.powi(experience.trials as i32);
        let better = |p: f64| gain * p / (1.0 - p + gain * p);
        match experience.trials {
            0 => self,
            _ => {
                ParticipantTraits { learned: better(self.learned), half_forgotten: better(self.half_forgotten), ..self }
            }
        }
    }
}
