//! Population of simulated participants: distributions of traits, and individual participants drawn from them.

use serde::{Deserialize, Serialize};
use tomcom_core::base::rng::Stream;
use tomcom_core::base::settings_table;

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

settings_table! {
    /// Parameters of the simulated population. The defaults of planning and slips are calibrated to the paper's participants
    /// (study, "Simulated participants", steps A and B). Step C, their beliefs over two trials, is in `sessions/paper.toml`.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields, default)]
    Population {
        /// Time from one press to the next, in seconds, of a participant with some practice.
        press_s: TraitSpread = TraitSpread::from_median(1.5, 0.12),
        /// Standard deviation of the logarithm of one participant's times from press to press.
        press_jitter: f64 = 0.3,
        /// Relative increase of the time between presses for a beginner (0.3: 30 % slower).
        novice_slowdown: f64 = 0.3,
        /// Number of presses after which half of a beginner's slowdown is gone.
        practice_presses: f64 = 25.0,
        /// Probability of a slip that hits another button, rather one nearby and of like colour (see [`super::hand::slipped_button`]).
        slip: TraitSpread = TraitSpread::from_median(0.007, 0.4),
        /// Probability of a slip that takes the look-alike ingredient from the storage.
        look_alike_slip: TraitSpread = TraitSpread::from_median(0.009, 0.4),
        /// Probability that a press is thoughtless: any of the presses that would be effective as the participant believes,
        /// which may be the intended one.
        thoughtless: TraitSpread = TraitSpread::from_median(0.005, 0.4),
        /// Probability that the participant notices an own slip.
        notices_slip: f64 = 0.85,
        /// Probability of repeating an unexpectedly ineffective press before searching for its cause (perseveration).
        insists: f64 = 0.0,
        /// Probability that the participant looks at a location right before using it.
        checks: TraitSpread = TraitSpread::from_median(0.9, 0.3),
        /// Probability of another look before a press if the last look at the press's location is some time ago.
        makes_sure: TraitSpread = TraitSpread::from_median(0.4, 0.5),
        /// Probability that a change anywhere on the display captures the participant's attention.
        capture: TraitSpread = TraitSpread::from_median(0.6, 0.3),
        /// Probability that a new order captures the participant's attention.
        order_capture: TraitSpread = TraitSpread::from_median(0.75, 0.3),
        /// Probability that a fixation is outside of the task's locations.
        wanders: TraitSpread = TraitSpread::from_median(0.15, 0.3),
        /// Weight of the robot's hand in the choice of fixation targets (1: as a location of the next press).
        watches_robot: TraitSpread = TraitSpread::from_median(1.2, 0.3),
        /// Duration of a fixation of the eyes, in seconds.
        fixation_s: TraitSpread = TraitSpread::from_median(0.3, 0.12),
        /// Probability of mistaking the content of a location for one that looks like it.
        misreads: TraitSpread = TraitSpread::from_median(0.02, 0.3),
        /// Share of the belief in the unseen content of the robot's hand that is lost when the robot presses.
        doubts_robot_hand: TraitSpread = TraitSpread::from_median(0.12, 0.2),
        /// Share of the belief in the unseen content of a shared location that is lost when the robot presses.
        doubts_places: TraitSpread = TraitSpread::from_median(0.02, 0.2),
        /// Probability that the participant gives to the true recipe after the instruction, on a menu of six dishes.
        learned: TraitSpread = TraitSpread::from_median(0.89, 0.4),
        /// Probability of the true recipe to which an unused memory fades, on a menu of six dishes.
        half_forgotten: TraitSpread = TraitSpread::from_median(0.7, 0.3),
        /// Half-life of the fading of recipe memories, in seconds.
        half_life_s: TraitSpread = TraitSpread::from_median(240.0, 0.3),
        /// Rate per minute at which the participant forgets the recipe during the work on its order, and then recalls the
        /// recipe again.
        loses_thread_per_min: TraitSpread = TraitSpread::from_median(0.15, 0.4),
        /// Weight of a look-alike topping among the false memories of a recipe (another topping has weight 1).
        confuses_look_alikes: f64 = 3.0,
        /// Probability that the participant doubts a recipe when the robot's behaviour contradicts it.
        takes_hints: TraitSpread = TraitSpread::from_median(0.15, 0.4),
        /// Time without a useful press after which the participant looks around and doubts recipes, in seconds.
        patience_s: TraitSpread = TraitSpread::from_median(4.0, 0.25),
        /// Time for which the participant stays with one order, in seconds.
        commitment_s: TraitSpread = TraitSpread::from_median(12.0, 0.3),
        /// Number of own presses that the participant thinks through; rounded, from 2 to 5.
        depth: TraitSpread = TraitSpread::from_median(3.4, 0.25),
        /// Probability that the participant does not check the preconditions of the presses after the next one.
        skips_check: TraitSpread = TraitSpread::from_median(0.2, 0.4),
        /// Probability that the participant takes a part of the last dish instead of one of the present dish, by habit.
        follows_habit: TraitSpread = TraitSpread::from_median(0.15, 0.4),
        /// Probability that the participant forgets parts at parking places.
        forgets_parked: TraitSpread = TraitSpread::from_median(0.2, 0.4),
        /// Probability that the participant first does what is within reach for another order.
        takes_along: TraitSpread = TraitSpread::from_median(0.4, 0.4),
        /// Probability that the participant notices a signal; at most 0.85.
        notices_signal: TraitSpread = TraitSpread::from_median(0.82, 0.15),
        /// Shortest and longest time from the appearance of a signal to its reading, in seconds.
        signal_after_s: [f64; 2] = [0.5, 1.5],
        /// Shortest and longest time that reading a signal takes, in seconds. The participant sees nothing else meanwhile.
        reads_signal_s: [f64; 2] = [0.5, 1.5],
        /// Probability that the participant, by reading a signal, forgets which press was intended next.
        loses_intention: TraitSpread = TraitSpread::from_median(0.05, 0.4),
        /// Time from reading a signal to the next press if the intended press was forgotten, in seconds.
        resumes_after_s: f64 = 1.0,
        /// Share by which the attention to signals moves towards the usefulness of each signal that is read.
        tires_of_signals: TraitSpread = TraitSpread::from_median(0.1, 0.4),
        /// Probability of misreading a recipe that a signal shows.
        misreads_signal: f64 = 0.03,
        /// Probability that the participant keeps the own version of a recipe when a signal shows another version.
        keeps_own_recipe: TraitSpread = NEVER,
        /// Probability, for each recipe, that the participant is sure of a wrong version after the instruction.
        misremembers: TraitSpread = NEVER,
        /// Probability that the participant guesses rightly what the robot did by a press that the participant did not see.
        guesses_robot: TraitSpread = NEVER,
        /// Probability that the participant, after an own press, does not know how to go on: the participant waits until
        /// something changes in what the participant believes, or a signal is read.
        gets_stuck: TraitSpread = NEVER,
        /// Factor, per earlier trial, on the odds of knowing a recipe (1: no learning between trials).
        recipes_gained: f64 = 1.0,
        /// Share of the presses in earlier trials that count as practice (0: earlier trials give no practice).
        practice_kept: f64 = 0.0,
        /// Size of the eye tracker's systematic offset, in metres on the display (1 deg at 2 m is 0.035 m).
        tracker_offset_m: f64 = 0.02,
        /// Whether all participants know the state and all recipes, and so make only planning errors and slips.
        all_knowing: bool = false,
        /// Probability of a wrong answer to a question of a freeze probe, whatever the participant believes: small, since
        /// otherwise wrong answers would hide the few false beliefs.
        answers_wrong: TraitSpread = TraitSpread::from_median(0.01, 0.4),
        /// Least probability of a belief's most probable value from which the value is given as the answer to a probe;
        /// below it, the answer is "I don't know". As `measures::sequences::FALSE_BELOW`.
        answers_from: f64 = 0.5,
        /// Time that a participant takes to answer a question of a freeze probe, in seconds.
        answer_s: TraitSpread = TraitSpread::from_median(3.0, 0.3),
        /// Probability that the participant, having read a proposal, makes the proposed presses at the next decision,
        /// whatever the participant believes. The default is an assumption: proposals were never shown to people.
        follows_proposal: TraitSpread = TraitSpread::from_median(0.9, 0.4),
    }
}

/// A participant's experience (practice) from earlier trials.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Experience {
    pub trials: u32,
    pub presses: f64,
}

/// Least and largest number of own presses that a participant thinks through (study, "Simulated participants").
const DEPTHS: [f64; 2] = [2.0, 5.0];
/// Upper bound of the probability of noticing a signal (study, "Simulated participants").
const MOST_SIGNALS_NOTICED: f64 = 0.85;

/// Declares the traits of one participant in the order in which they are drawn, each with the function that draws it.
macro_rules! traits {
    ($($name:ident: $draw:ident,)*) => {
        /// Traits of one simulated participant, drawn from the population, with meanings and units as in [`Population`].
        #[derive(Clone, Debug, PartialEq)]
        pub struct ParticipantTraits {
            $(pub $name: f64,)*
        }

        impl Population {
            pub fn draw(&self, random: &mut Stream) -> ParticipantTraits {
                let drawn = ParticipantTraits { $($name: self.$name.$draw(random),)* };
                let notices_signal = drawn.notices_signal.min(MOST_SIGNALS_NOTICED);
                let depth = drawn.depth.round().clamp(DEPTHS[0], DEPTHS[1]);
                ParticipantTraits { notices_signal, depth, ..drawn }
            }
        }
    };
}

traits! {
    press_s: draw,
    slip: draw_chance,
    look_alike_slip: draw_chance,
    thoughtless: draw_chance,
    checks: draw_chance,
    makes_sure: draw_chance,
    capture: draw_chance,
    order_capture: draw_chance,
    wanders: draw_chance,
    watches_robot: draw,
    fixation_s: draw,
    misreads: draw_chance,
    doubts_robot_hand: draw_chance,
    doubts_places: draw_chance,
    learned: draw_chance,
    half_forgotten: draw_chance,
    half_life_s: draw,
    loses_thread_per_min: draw,
    takes_hints: draw_chance,
    patience_s: draw,
    commitment_s: draw,
    notices_signal: draw_chance,
    depth: draw,
    skips_check: draw_chance,
    follows_habit: draw_chance,
    forgets_parked: draw_chance,
    takes_along: draw_chance,
    loses_intention: draw_chance,
    tires_of_signals: draw_chance,
    keeps_own_recipe: draw_chance,
    misremembers: draw_chance,
    guesses_robot: draw_chance,
    answers_wrong: draw_chance,
    answer_s: draw,
    follows_proposal: draw_chance,
    gets_stuck: draw_chance,
}

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
