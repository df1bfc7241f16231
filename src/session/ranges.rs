//! The allowed ranges of all numbers in session files, in files with parameters of the human model, and in
//! questionnaires. Those of layouts are in [`tomcom_core::kitchen::files`]; `docs/settings.md` shows both.
//! A file with a number outside of its allowed range is refused, and so is the header of a recording.

use serde::Serialize;

use crate::study_arm::StudyArm;
use tomcom_core::base::number_range::{self, NumberRange, OutOfRange, numbers};

/// The table of a session file with the parameters of the human model; a file with them alone has no such table.
pub const HUMAN: &str = "human";

pub fn of_sessions() -> Vec<NumberRange> {
    [OF_TRIALS, OF_PEOPLE, OF_HUMAN_MODEL].concat()
}

pub fn check_session(spec: &impl Serialize) -> Result<(), OutOfRange> {
    number_range::check_file(&of_sessions(), &numbers(spec, "")?)
}

/// The path in the error begins with [`HUMAN`].
pub fn check_human_model(model: &impl Serialize) -> Result<(), OutOfRange> {
    number_range::check_file(OF_HUMAN_MODEL, &numbers(model, HUMAN)?)
}

pub(crate) fn check_questionnaire(questionnaire: &impl Serialize) -> Result<(), OutOfRange> {
    number_range::check_file(OF_QUESTIONNAIRES, &numbers(questionnaire, "")?)
}

/// Ranges by the tables of their settings: kind of number, names, least and greatest value, unit, and reason.
macro_rules! ranges {
    ($($table:literal: $($kind:ident $($name:literal)+ [$least:expr, $most:expr] $unit:expr, $reason:expr;)+)+) => {
        &[$($($(NumberRange::$kind(concat!($table, $name), [$least, $most], $unit, $reason)),+),+),+]
    };
}

const SECONDS: &str = "s";
const CHANCE: &str = "the setting is a probability";
const PORT: &str = "ports of TCP and UDP have these numbers";
const PRESS: &str = "a shorter time is no movement, a longer time no cooperation";
const DAY_S: f64 = 86_400.0;
const LONGEST: &str = "no trial is longer than a day";
/// The largest number of 32 bits: practically no limit.
const COUNT: f64 = 4_294_967_295.0;
const FEW_LOOKS: &str = "eyes look at a few places in a second";

const OF_TRIALS: &[NumberRange] = ranges! {
    "":
        whole "seed" [0.0, 9_007_199_254_740_991.0] "",
            "every reader of JSON keeps whole numbers up to this one exactly";
    "trial.":
        whole "presses" [1.0, COUNT] "presses", "the largest numbers mean no limit in practice";
        real "seconds" [0.1, DAY_S] SECONDS, LONGEST;
        whole "orders" [1.0, COUNT] "orders", "the largest numbers mean no limit in practice";
        real "pace_s" [0.1, 60.0] SECONDS, PRESS;
    "robot.":
        real "press_s" [0.05, 60.0] SECONDS, PRESS;
        real "press_spread" [0.0, 2.0] "", "with a larger spread, presses take anything from no time to minutes";
        real "initiative_s" [0.0, DAY_S] SECONDS,
            "after the longest time the robot never takes the initiative, since no trial is longer";
        real "speed" [0.05, 1.0] "of the full speed", "a slower arm takes minutes for a press";
    "signals.":
        real "shown_s" [0.1, 3_600.0] SECONDS,
            "a signal shown for less time cannot be read, for more time it is a picture on the wall";
        real "cool_down_s" [0.0, 60.0] SECONDS, "a wizard who has to wait longer between signals cannot help";
    "assistant.":
        real "cost_of_communication" [0.0, 1_000.0] "presses", "no signal saves as many presses as the largest cost";
        real "concept.wait_s" [0.05, 3_600.0] SECONDS,
            "a program needs some time to answer, and nobody waits for hours";
        real "belief_threshold" [0.0, 0.99] "", "the threshold is a probability, and none exceeds 1";
        whole "proposed_presses" [1.0, 5.0] "presses", "more proposed presses are a recipe, not a hint";
    "assistant.rollout.":
        whole "horizon" [1.0, 64.0] "decisions", "an order takes some twenty presses, so a longer horizon sees no more";
        whole "rollouts" [1.0, 16_384.0] "rollouts", "more rollouts (64 times the default) take minutes for each press";
        whole "states" [1.0, 128.0] "states", "more states make the estimate no more exact";
        real "human_press_s" [0.05, 60.0] SECONDS, PRESS;
        real "looks_hz" "other_looks_hz" [0.0, 100.0] "per second", FEW_LOOKS;
        real "capture" [0.0, 1.0] "", CHANCE;
        real "enough_error" [0.0, 100.0] "presses",
            "with a larger error, the least number of rollouts is always enough";
        whole "least_rollouts" [1.0, 16_384.0] "rollouts",
            "the least number of rollouts cannot be above their largest number";
    "participant.":
        whole "gaze_port" [1.0, 65_535.0] "", PORT;
    "tracker.":
        whole "port" [1.0, 65_535.0] "", PORT;
        real "corners" [-10.0, 10.0] "fractions of the display", "a surface much larger than the display gets no gaze";
        real "file_start_s" [-DAY_S, DAY_S] SECONDS, LONGEST;
        real "gaps.every_s" "gaps.shortest_s" "gaps.longest_s" [0.01, DAY_S] SECONDS, LONGEST;
    "lsl.gaze.":
        real "size" [0.01, 100_000.0] "in the unit of the stream",
            "displays have these sizes, from a small one in metres to a wall of displays in pixels";
    "tracker.":
        real "distance_m" [0.2, 20.0] "m", "eyes see a display from these distances";
    "probes.":
        whole "per_trial" [0.0, 50.0] "probes", "more probes in a trial leave no time to work";
        real "apart_s" [1.0, 3_600.0] SECONDS, "the participant has to work between two probes";
        real "after_signal_s" [0.0, 600.0] SECONDS, "with a longer time after each signal, hardly any probe can begin";
        real "wait_s" [0.0, 600.0] SECONDS, "a probe that begins later is not at the time that was drawn";
        real "limit_s" [5.0, 600.0] SECONDS, "a shorter limit is too short for an answer; in a longer one beliefs fade";
        real "count_down_s" [0.0, 60.0] SECONDS, "beliefs fade in a longer count-down";
        whole "least_questions" "most_questions" [1.0, 8.0] "questions", "more questions in a probe take minutes";
        real "blind_share" [0.0, 1.0] "", "the setting is a share of the trial's probes";
        real "least_inclusion" [0.001, 1.0] "", "the setting is a probability, and analyses divide by this probability";
        real "teaches" [0.0, 1.0] "", CHANCE;
    "display.":
        whole "port" [1.0, 65_535.0] "", PORT;
    "plan.":
        whole "participants" [1.0, 9_999.0] "participants",
            "codes of counted participants have up to four digits; or give a list of codes";
        whole "block" [1.0, 9_999.0] "participants", "no block of participants is larger than the study";
    "plan.familiarisation.":
        whole "presses" [1.0, COUNT] "presses", "the largest numbers mean no limit in practice";
        real "seconds" [0.1, DAY_S] SECONDS, LONGEST;
        whole "orders" [1.0, COUNT] "orders", "a criterion of 0 orders would be no criterion";
        real "error_rate" [0.0, 1.0] "", "the setting is a share of presses";
    "plan.":
        whole "questionnaire.after" [1.0, StudyArm::ALL.len() as f64] "",
            "each participant has one trial in each condition, after which a questionnaire can follow";
        real "aims.margin" [1.01, 10.0] "",
            "the margin is a ratio of error rates above 1: up to it, worse counts as not worse";
};

pub const OF_QUESTIONNAIRES: &[NumberRange] = ranges! {
    "":
        whole "scale.points" "scales.*.points" [2.0, 9.0] "points", "each point of a scale has a key of its own";
        whole "item.min" "item.max" [-1_000_000.0, 1_000_000.0] "", "people have to type the number";
        whole "item.length" [1.0, 500.0] "characters", "page and console have to show the whole answer";
        whole "item.step" [1.0, 50.0] "", "with larger steps a slider has fewer than three positions";
};

const LATE: &str = "a wizard who takes longer cannot help";
/// Of probabilities that differ between people.
const DRAWN: &str = "the setting is a probability whose odds are drawn for each person, so neither 0 nor 1";
/// Of those that are 0 for everybody, or differ between people.
const DRAWN_OR_NEVER: &str =
    "the setting is a probability whose odds are drawn for each person, so not 1; with 0 nobody does this";

const OF_PEOPLE: &[NumberRange] = ranges! {
    "participant.population.":
        real "slip.median" "look_alike_slip.median" "thoughtless.median" "checks.median" "makes_sure.median"
            "capture.median" "order_capture.median" "wanders.median" "misreads.median" "doubts_robot_hand.median"
            "doubts_places.median" "learned.median" "half_forgotten.median" "takes_hints.median" "notices_signal.median"
            "skips_check.median" "follows_habit.median" "forgets_parked.median" "takes_along.median"
            "loses_intention.median" "tires_of_signals.median" [0.000_001, 0.999_999] "", DRAWN;
        real "keeps_own_recipe.median" "misremembers.median" "guesses_robot.median" "gets_stuck.median"
            "answers_wrong.median" "follows_proposal.median" [0.0, 0.999_999] "", DRAWN_OR_NEVER;
        real "answers_from" [0.0, 1.0] "", CHANCE;
        real "answer_s.median" [0.1, 60.0] SECONDS, "an answer to a probe takes less than a minute";
        real "depth.median" [1.0, 10.0] "presses", "drawn planning depths are rounded to 2 to 5 presses";
        real "press_s.median" [0.05, 60.0] SECONDS, "nobody presses more quickly, nobody cooperates more slowly";
        real "watches_robot.median" [0.001, 1_000.0] "times a place of the next press",
            "from a robot that is not watched at all to one that alone is watched";
        real "fixation_s.median" [0.02, 10.0] SECONDS, "fixations cannot be shorter, and eyes do not rest longer";
        real "half_life_s.median" [1.0, 1_000_000.0] SECONDS, "half-lives from forgotten at once to never forgotten";
        real "loses_thread_per_min.median" [0.0001, 60.0] "per minute", "from never to once a second";
        real "patience_s.median" "commitment_s.median" [0.1, 3_600.0] SECONDS, "from no time to endless";
        real "*.sigma" [0.0, 2.0] "", "with a larger spread, hardly anybody would be like anybody else";
        real "press_jitter" [0.0, 2.0] "", "with a larger jitter, presses take anything from no time to minutes";
        real "novice_slowdown" [0.0, 2.0] "", "with the largest slowdown, first presses take three times as long";
        real "practice_presses" [0.01, 100_000.0] "presses",
            "from people who are practised at once to people who never are";
        real "notices_slip" [0.0, 1.0] "", CHANCE;
        real "insists" [0.0, 0.99] "", "the setting is a probability, and with 1 nobody would ever stop";
        real "confuses_look_alikes" [0.001, 1_000.0] "times another topping", "confusions from never to always";
        real "signal_after_s" [0.0, 60.0] SECONDS, "a signal that is read later is no help";
        real "reads_signal_s" [0.0, 60.0] SECONDS, "nobody reads a signal for longer";
        real "resumes_after_s" [0.0, 60.0] SECONDS, "nobody thinks for longer before going on";
        real "misreads_signal" [0.0, 1.0] "", CHANCE;
        real "recipes_gained" [0.01, 100.0] "", "the odds of knowing a recipe grow by this factor with every trial";
        real "practice_kept" [0.0, 1.0] "", "the setting is a share from 0 to 1";
        real "tracker_offset_m" [0.0, 2.0] "m", "with a larger offset, gaze is not on the display";
    "wizard.":
        real "reaction_s" [0.0, 60.0] SECONDS, LATE;
        real "reaction_spread" [0.0, 2.0] "", "with a larger spread, a reaction takes anything from no time to minutes";
        real "sees_errors" "sees_overlooked" [0.0, 1.0] "", CHANCE;
        real "overlooked_after_s" "look_s" [0.0, 60.0] SECONDS, LATE;
        real "guesses_wrong" [0.0, 1.0] "", CHANCE;
        real "rest_s" [0.0, 60.0] SECONDS, LATE;
    "wizard.offers.":
        real "takes" [0.0, 1.0] "", CHANCE;
        real "reads_s" [0.0, 60.0] SECONDS, LATE;
};

/// Of probabilities that must be neither 0 nor 1.
const UNSURE: &str = "a certain belief could not be corrected by any observation";
const PRECISION: &str = "with a lower precision there is no belief, with a higher one the belief is certain";
const DRAWS: &str = "larger samples take seconds to minutes for each press";

const OF_HUMAN_MODEL: &[NumberRange] = ranges! {
    "human.prior.":
        real "location_truth" [0.001, 0.9999] "", UNSURE;
        real "location_precision" [0.01, 10_000.0] "", PRECISION;
        real "recipe_truth" [0.001, 0.9999] "", UNSURE;
        real "recipe_look_alike" [0.0, 1.0] "", "the setting is a share from 0 to 1";
        real "recipe_precision" [0.01, 10_000.0] "", PRECISION;
    "human.perception.":
        real "reading_rate_hz" [0.01, 1_000.0] "per second",
            "at a lower rate nothing is read, at a higher one everything at once";
        real "radius_deg" [0.1, 40.0] "degrees", "radii from the fovea to the whole field of view";
        real "viewing_distance_m" [0.2, 20.0] "m", "eyes see a display from these distances";
        real "look_alike" "anything" [0.0, 1.0] "", CHANCE;
        real "min_confidence" [0.0, 1.0] "", "gaze confidence is from 0 to 1";
        real "history_s" [0.01, 60.0] SECONDS, "gaze older than this tells nothing about the present";
        real "max_sample_s" [0.001, 10.0] SECONDS, "eye trackers send 1 to 1000 samples a second";
        real "look_ends_s" [0.001, 60.0] SECONDS, "a look takes a tenth of a second to some seconds";
    "human.looking.":
        real "looks_hz" "other_looks_hz" [0.0, 100.0] "per second", FEW_LOOKS;
        real "capture" [0.0, 1.0] "", CHANCE;
        real "display_lost_looks_hz" [0.0, 100.0] "per second", FEW_LOOKS;
        real "blink_s" [0.0, 60.0] SECONDS, "a blink takes some tenths of a second";
    "human.transition.":
        real "recipe_half_life_s" [1.0, 1e18] SECONDS, "half-lives from forgotten at once to never forgotten";
        real "foresight" [0.0, 1.0] "", "the setting is a share from 0 to 1";
    "human.decision.":
        real "tau" [0.01, 100.0] "per press",
            "with a lower tau every button is pressed alike, with a higher tau only the best one";
        real "lapse" [0.000_001, 0.99] "", "for a person who never slips, any slip would be impossible";
        real "lapse_anywhere" [0.001, 1.0] "",
            "the setting is a share of slips; with 0, some presses would be impossible";
        real "wait_cost" [0.0, 1_000.0] "presses", "with the largest cost of waiting, nobody ever waits";
        whole "cases" [1.0, 4_096.0] "worlds", DRAWS;
    "human.signal.":
        real "noticed" "highlight_noticed" [0.0, 1.0] "", CHANCE;
        real "delay_s" [0.0, 60.0] SECONDS, "a signal is read within seconds; with 0 the signal is believed at once";
        real "reading_rate_hz" [0.01, 1_000.0] "per second",
            "at a lower rate nothing is read, at a higher one everything at once";
        real "misread" [0.0, 1.0] "", CHANCE;
        real "follows" [0.0, 0.999] "", "with 1, no press could have another reason than the proposal";
    "human.inference.":
        whole "beliefs" [1.0, 2_048.0] "samples", DRAWS;
        whole "states" [1.0, 128.0] "states", DRAWS;
        real "min_effective" [0.01, 2_048.0] "samples",
            "the effective number of samples cannot be above the number of samples";
        whole "max_beliefs" [1.0, 2_048.0] "samples", DRAWS;
        whole "predictions" [1.0, 4_096.0] "states", DRAWS;
};
