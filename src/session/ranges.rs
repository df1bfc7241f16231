//! The allowed ranges of all numbers in session files, in files with parameters of the human model, and in
//! questionnaires. Those of layouts are in [`tomcom_core::kitchen::files`]; `docs/settings.md` shows both.
//! A file with a number outside of its allowed range is refused, and so is the header of a recording.

use serde::Serialize;

use crate::study_arm::StudyArm;
use tomcom_core::base::number_range::{self, NumberRange, OutOfRange, numbers};

/// The table of a session file with the parameters of the human model; a file with them alone has no such table.
pub const HUMAN: &str = "human";

pub fn of_sessions() -> Vec<NumberRange> {
    [&OF_TRIALS[..], &OF_PEOPLE, &OF_HUMAN_MODEL].concat()
}

pub fn check_session(spec: &impl Serialize) -> Result<(), OutOfRange> {
    number_range::check_file(&of_sessions(), &numbers(spec, "")?)
}

/// The path in the error begins with [`HUMAN`].
pub fn check_human_model(model: &impl Serialize) -> Result<(), OutOfRange> {
    number_range::check_file(&OF_HUMAN_MODEL, &numbers(model, HUMAN)?)
}

pub(crate) fn check_questionnaire(questionnaire: &impl Serialize) -> Result<(), OutOfRange> {
    number_range::check_file(&OF_QUESTIONNAIRES, &numbers(questionnaire, "")?)
}

const SECONDS: &str = "s";
const CHANCE: &str = "the setting is a probability";
const PORT: &str = "ports of TCP and UDP have these numbers";
const PRESS: &str = "a shorter time is no movement, a longer time no cooperation";
const DAY_S: f64 = 86_400.0;
const LONGEST: &str = "no trial is longer than a day";
/// The largest number of 32 bits: practically no limit.
const COUNT: f64 = 4_294_967_295.0;

const OF_TRIALS: [NumberRange; 53] = [
    NumberRange::whole(
        "seed",
        [0.0, 9_007_199_254_740_991.0],
        "",
        "every reader of JSON keeps whole numbers up to this one exactly",
    ),
    NumberRange::whole("trial.presses", [1.0, COUNT], "presses", "the largest numbers mean no limit in practice"),
    NumberRange::real("trial.seconds", [0.1, DAY_S], SECONDS, LONGEST),
    NumberRange::whole("trial.orders", [1.0, COUNT], "orders", "the largest numbers mean no limit in practice"),
    NumberRange::real("trial.pace_s", [0.1, 60.0], SECONDS, PRESS),
    NumberRange::real("robot.press_s", [0.05, 60.0], SECONDS, PRESS),
    NumberRange::real(
        "robot.press_spread",
        [0.0, 2.0],
        "",
        "with a larger spread, presses take anything from no time to minutes",
    ),
    NumberRange::real(
        "robot.initiative_s",
        [0.0, DAY_S],
        SECONDS,
        "after the longest time the robot never takes the initiative, since no trial is longer",
    ),
    NumberRange::real("robot.speed", [0.05, 1.0], "of the full speed", "a slower arm takes minutes for a press"),
    NumberRange::real(
        "signals.shown_s",
        [0.1, 3_600.0],
        SECONDS,
        "a signal shown for less time cannot be read, for more time it is a picture on the wall",
    ),
    NumberRange::real(
        "signals.cool_down_s",
        [0.0, 60.0],
        SECONDS,
        "a wizard who has to wait longer between signals cannot help",
    ),
    NumberRange::real(
        "assistant.cost_of_communication",
        [0.0, 1_000.0],
        "presses",
        "no signal saves as many presses as the largest cost",
    ),
    NumberRange::real(
        "assistant.concept.wait_s",
        [0.05, 3_600.0],
        SECONDS,
        "a program needs some time to answer, and nobody waits for hours",
    ),
    NumberRange::real(
        "assistant.belief_threshold",
        [0.0, 0.99],
        "",
        "the threshold is a probability, and none exceeds 1",
    ),
    NumberRange::whole(
        "assistant.proposed_presses",
        [1.0, 5.0],
        "presses",
        "more proposed presses are a recipe, not a hint",
    ),
    NumberRange::whole(
        "assistant.rollout.horizon",
        [1.0, 64.0],
        "decisions",
        "an order takes some twenty presses, so a longer horizon sees no more",
    ),
    NumberRange::whole(
        "assistant.rollout.rollouts",
        [1.0, 16_384.0],
        "rollouts",
        "more rollouts (64 times the default) take minutes for each press",
    ),
    NumberRange::whole(
        "assistant.rollout.states",
        [1.0, 128.0],
        "states",
        "more states make the estimate no more exact",
    ),
    NumberRange::real("assistant.rollout.human_press_s", [0.05, 60.0], SECONDS, PRESS),
    NumberRange::real(
        "assistant.rollout.looks_hz",
        [0.0, 100.0],
        "per second",
        "eyes look at a few places in a second",
    ),
    NumberRange::real(
        "assistant.rollout.other_looks_hz",
        [0.0, 100.0],
        "per second",
        "eyes look at a few places in a second",
    ),
    NumberRange::real("assistant.rollout.capture", [0.0, 1.0], "", CHANCE),
    NumberRange::real(
        "assistant.rollout.enough_error",
        [0.0, 100.0],
        "presses",
        "with a larger error, the least number of rollouts is always enough",
    ),
    NumberRange::whole(
        "assistant.rollout.least_rollouts",
        [1.0, 16_384.0],
        "rollouts",
        "the least number of rollouts cannot be above their largest number",
    ),
    NumberRange::whole("participant.gaze_port", [1.0, 65_535.0], "", PORT),
    NumberRange::whole("tracker.port", [1.0, 65_535.0], "", PORT),
    NumberRange::real(
        "tracker.corners",
        [-10.0, 10.0],
        "fractions of the display",
        "a surface much larger than the display gets no gaze",
    ),
    NumberRange::real("tracker.file_start_s", [-DAY_S, DAY_S], SECONDS, LONGEST),
    NumberRange::real("tracker.gaps.every_s", [0.01, DAY_S], SECONDS, LONGEST),
    NumberRange::real("tracker.gaps.shortest_s", [0.01, DAY_S], SECONDS, LONGEST),
    NumberRange::real("tracker.gaps.longest_s", [0.01, DAY_S], SECONDS, LONGEST),
    NumberRange::real(
        "lsl.gaze.size",
        [0.01, 100_000.0],
        "in the unit of the stream",
        "displays have these sizes, from a small one in metres to a wall of displays in pixels",
    ),
    NumberRange::real("tracker.distance_m", [0.2, 20.0], "m", "eyes see a display from these distances"),
    NumberRange::whole("probes.per_trial", [0.0, 50.0], "probes", "more probes in a trial leave no time to work"),
    NumberRange::real("probes.apart_s", [1.0, 3_600.0], SECONDS, "the participant has to work between two probes"),
    NumberRange::real(
        "probes.after_signal_s",
        [0.0, 600.0],
        SECONDS,
        "with a longer time after each signal, hardly any probe can begin",
    ),
    NumberRange::real(
        "probes.wait_s",
        [0.0, 600.0],
        SECONDS,
        "a probe that begins later is not at the time that was drawn",
    ),
    NumberRange::real(
        "probes.limit_s",
        [5.0, 600.0],
        SECONDS,
        "a shorter limit is too short for an answer; in a longer one beliefs fade",
    ),
    NumberRange::real("probes.count_down_s", [0.0, 60.0], SECONDS, "beliefs fade in a longer count-down"),
    NumberRange::whole("probes.least_questions", [1.0, 8.0], "questions", "more questions in a probe take minutes"),
    NumberRange::whole("probes.most_questions", [1.0, 8.0], "questions", "more questions in a probe take minutes"),
    NumberRange::real("probes.blind_share", [0.0, 1.0], "", "the setting is a share of the trial's probes"),
    NumberRange::real(
        "probes.least_inclusion",
        [0.001, 1.0],
        "",
        "the setting is a probability, and analyses divide by this probability",
    ),
    NumberRange::real("probes.teaches", [0.0, 1.0], "", CHANCE),
    NumberRange::whole("display.port", [1.0, 65_535.0], "", PORT),
    NumberRange::whole(
        "plan.participants",
        [1.0, 9_999.0],
        "participants",
        "codes of counted participants have up to four digits; or give a list of codes",
    ),
    NumberRange::whole(
        "plan.block",
        [1.0, 9_999.0],
        "participants",
        "no block of participants is larger than the study",
    ),
    NumberRange::whole(
        "plan.familiarisation.presses",
        [1.0, COUNT],
        "presses",
        "the largest numbers mean no limit in practice",
    ),
    NumberRange::real("plan.familiarisation.seconds", [0.1, DAY_S], SECONDS, LONGEST),
    NumberRange::whole(
        "plan.familiarisation.orders",
        [1.0, COUNT],
        "orders",
        "a criterion of 0 orders would be no criterion",
    ),
    NumberRange::real("plan.familiarisation.error_rate", [0.0, 1.0], "", "the setting is a share of presses"),
    NumberRange::whole(
        "plan.questionnaire.after",
        [1.0, StudyArm::ALL.len() as f64],
        "",
        "each participant has one trial in each condition, after which a questionnaire can follow",
    ),
    NumberRange::real(
        "plan.aims.margin",
        [1.01, 10.0],
        "",
        "the margin is a ratio of error rates above 1: up to it, worse counts as not worse",
    ),
];

pub const OF_QUESTIONNAIRES: [NumberRange; 6] = [
    NumberRange::whole("scale.points", [2.0, 9.0], "points", "each point of a scale has a key of its own"),
    NumberRange::whole("scales.*.points", [2.0, 9.0], "points", "each point of a scale has a key of its own"),
    NumberRange::whole("item.min", [-1_000_000.0, 1_000_000.0], "", "people have to type the number"),
    NumberRange::whole("item.max", [-1_000_000.0, 1_000_000.0], "", "people have to type the number"),
    NumberRange::whole("item.length", [1.0, 500.0], "characters", "page and console have to show the whole answer"),
    NumberRange::whole("item.step", [1.0, 50.0], "", "with larger steps a slider has fewer than three positions"),
];

const LATE: &str = "a wizard who takes longer cannot help";

/// A probability that differs between people: its odds are drawn for each person, so neither 0 nor 1.
const fn chance(path: &'static str) -> NumberRange {
    let reason = "the setting is a probability whose odds are drawn for each person, so neither 0 nor 1";
    NumberRange::real(path, [0.000_001, 0.999_999], "", reason)
}

/// A probability that either differs between people, or is 0 for everybody.
const fn rare_chance(path: &'static str) -> NumberRange {
    NumberRange::real(
        path,
        [0.0, 0.999_999],
        "",
        "the setting is a probability whose odds are drawn for each person, so not 1; with 0 nobody does this",
    )
}

const OF_PEOPLE: [NumberRange; 61] = [
    chance("participant.population.slip.median"),
    chance("participant.population.look_alike_slip.median"),
    chance("participant.population.thoughtless.median"),
    chance("participant.population.checks.median"),
    chance("participant.population.makes_sure.median"),
    chance("participant.population.capture.median"),
    chance("participant.population.order_capture.median"),
    chance("participant.population.wanders.median"),
    chance("participant.population.misreads.median"),
    chance("participant.population.doubts_robot_hand.median"),
    chance("participant.population.doubts_places.median"),
    chance("participant.population.learned.median"),
    chance("participant.population.half_forgotten.median"),
    chance("participant.population.takes_hints.median"),
    chance("participant.population.notices_signal.median"),
    chance("participant.population.skips_check.median"),
    chance("participant.population.follows_habit.median"),
    chance("participant.population.forgets_parked.median"),
    chance("participant.population.takes_along.median"),
    chance("participant.population.loses_intention.median"),
    chance("participant.population.tires_of_signals.median"),
    rare_chance("participant.population.keeps_own_recipe.median"),
    rare_chance("participant.population.misremembers.median"),
    rare_chance("participant.population.guesses_robot.median"),
    rare_chance("participant.population.gets_stuck.median"),
    rare_chance("participant.population.answers_wrong.median"),
    rare_chance("participant.population.follows_proposal.median"),
    NumberRange::real("participant.population.answers_from", [0.0, 1.0], "", CHANCE),
    NumberRange::real(
        "participant.population.answer_s.median",
        [0.1, 60.0],
        SECONDS,
        "an answer to a probe takes less than a minute",
    ),
    NumberRange::real(
        "participant.population.depth.median",
        [1.0, 10.0],
        "presses",
        "drawn planning depths are rounded to 2 to 5 presses",
    ),
    NumberRange::real(
        "participant.population.press_s.median",
        [0.05, 60.0],
        SECONDS,
        "nobody presses more quickly, nobody cooperates more slowly",
    ),
    NumberRange::real(
        "participant.population.watches_robot.median",
        [0.001, 1_000.0],
        "times a place of the next press",
        "from a robot that is not watched at all to one that alone is watched",
    ),
    NumberRange::real(
        "participant.population.fixation_s.median",
        [0.02, 10.0],
        SECONDS,
        "fixations cannot be shorter, and eyes do not rest longer",
    ),
    NumberRange::real(
        "participant.population.half_life_s.median",
        [1.0, 1_000_000.0],
        SECONDS,
        "half-lives from forgotten at once to never forgotten",
    ),
    NumberRange::real(
        "participant.population.loses_thread_per_min.median",
        [0.0001, 60.0],
        "per minute",
        "from never to once a second",
    ),
    NumberRange::real("participant.population.patience_s.median", [0.1, 3_600.0], SECONDS, "from no time to endless"),
    NumberRange::real("participant.population.commitment_s.median", [0.1, 3_600.0], SECONDS, "from no time to endless"),
    NumberRange::real(
        "participant.population.*.sigma",
        [0.0, 2.0],
        "",
        "with a larger spread, hardly anybody would be like anybody else",
    ),
    NumberRange::real(
        "participant.population.press_jitter",
        [0.0, 2.0],
        "",
        "with a larger jitter, presses take anything from no time to minutes",
    ),
    NumberRange::real(
        "participant.population.novice_slowdown",
        [0.0, 2.0],
        "",
        "with the largest slowdown, first presses take three times as long",
    ),
    NumberRange::real(
        "participant.population.practice_presses",
        [0.01, 100_000.0],
        "presses",
        "from people who are practised at once to people who never are",
    ),
    NumberRange::real("participant.population.notices_slip", [0.0, 1.0], "", CHANCE),
    NumberRange::real(
        "participant.population.insists",
        [0.0, 0.99],
        "",
        "the setting is a probability, and with 1 nobody would ever stop",
    ),
    NumberRange::real(
        "participant.population.confuses_look_alikes",
        [0.001, 1_000.0],
        "times another topping",
        "confusions from never to always",
    ),
    NumberRange::real(
        "participant.population.signal_after_s",
        [0.0, 60.0],
        SECONDS,
        "a signal that is read later is no help",
    ),
    NumberRange::real(
        "participant.population.reads_signal_s",
        [0.0, 60.0],
        SECONDS,
        "nobody reads a signal for longer",
    ),
    NumberRange::real(
        "participant.population.resumes_after_s",
        [0.0, 60.0],
        SECONDS,
        "nobody thinks for longer before going on",
    ),
    NumberRange::real("participant.population.misreads_signal", [0.0, 1.0], "", CHANCE),
    NumberRange::real(
        "participant.population.recipes_gained",
        [0.01, 100.0],
        "",
        "the odds of knowing a recipe grow by this factor with every trial",
    ),
    NumberRange::real("participant.population.practice_kept", [0.0, 1.0], "", "the setting is a share from 0 to 1"),
    NumberRange::real(
        "participant.population.tracker_offset_m",
        [0.0, 2.0],
        "m",
        "with a larger offset, gaze is not on the display",
    ),
    NumberRange::real("wizard.reaction_s", [0.0, 60.0], SECONDS, LATE),
    NumberRange::real(
        "wizard.reaction_spread",
        [0.0, 2.0],
        "",
        "with a larger spread, a reaction takes anything from no time to minutes",
    ),
    NumberRange::real("wizard.sees_errors", [0.0, 1.0], "", CHANCE),
    NumberRange::real("wizard.sees_overlooked", [0.0, 1.0], "", CHANCE),
    NumberRange::real("wizard.overlooked_after_s", [0.0, 60.0], SECONDS, LATE),
    NumberRange::real("wizard.look_s", [0.0, 60.0], SECONDS, LATE),
    NumberRange::real("wizard.guesses_wrong", [0.0, 1.0], "", CHANCE),
    NumberRange::real("wizard.rest_s", [0.0, 60.0], SECONDS, LATE),
    NumberRange::real("wizard.offers.takes", [0.0, 1.0], "", CHANCE),
    NumberRange::real("wizard.offers.reads_s", [0.0, 60.0], SECONDS, LATE),
];

/// How often people look at a location, per second.
const LOOKS: [f64; 2] = [0.0, 100.0];
const FEW_LOOKS: &str = "eyes look at a few places in a second";
/// Of probabilities that must be neither 0 nor 1.
const UNSURE: &str = "a certain belief could not be corrected by any observation";
const PRECISION: &str = "with a lower precision there is no belief, with a higher one the belief is certain";
const DRAWS: &str = "larger samples take seconds to minutes for each press";

const OF_HUMAN_MODEL: [NumberRange; 37] = [
    NumberRange::real("human.prior.location_truth", [0.001, 0.9999], "", UNSURE),
    NumberRange::real("human.prior.location_precision", [0.01, 10_000.0], "", PRECISION),
    NumberRange::real("human.prior.recipe_truth", [0.001, 0.9999], "", UNSURE),
    NumberRange::real("human.prior.recipe_look_alike", [0.0, 1.0], "", "the setting is a share from 0 to 1"),
    NumberRange::real("human.prior.recipe_precision", [0.01, 10_000.0], "", PRECISION),
    NumberRange::real(
        "human.perception.reading_rate_hz",
        [0.01, 1_000.0],
        "per second",
        "at a lower rate nothing is read, at a higher one everything at once",
    ),
    NumberRange::real(
        "human.perception.radius_deg",
        [0.1, 40.0],
        "degrees",
        "radii from the fovea to the whole field of view",
    ),
    NumberRange::real(
        "human.perception.viewing_distance_m",
        [0.2, 20.0],
        "m",
        "eyes see a display from these distances",
    ),
    NumberRange::real("human.perception.look_alike", [0.0, 1.0], "", CHANCE),
    NumberRange::real("human.perception.anything", [0.0, 1.0], "", CHANCE),
    NumberRange::real("human.perception.min_confidence", [0.0, 1.0], "", "gaze confidence is from 0 to 1"),
    NumberRange::real(
        "human.perception.history_s",
        [0.01, 60.0],
        "s",
        "gaze older than this tells nothing about the present",
    ),
    NumberRange::real(
        "human.perception.max_sample_s",
        [0.001, 10.0],
        "s",
        "eye trackers send 1 to 1000 samples a second",
    ),
    NumberRange::real(
        "human.perception.look_ends_s",
        [0.001, 60.0],
        "s",
        "a look takes a tenth of a second to some seconds",
    ),
    NumberRange::real("human.looking.looks_hz", LOOKS, "per second", FEW_LOOKS),
    NumberRange::real("human.looking.other_looks_hz", LOOKS, "per second", FEW_LOOKS),
    NumberRange::real("human.looking.capture", [0.0, 1.0], "", CHANCE),
    NumberRange::real("human.looking.display_lost_looks_hz", LOOKS, "per second", FEW_LOOKS),
    NumberRange::real("human.looking.blink_s", [0.0, 60.0], "s", "a blink takes some tenths of a second"),
    NumberRange::real(
        "human.transition.recipe_half_life_s",
        [1.0, 1e18],
        "s",
        "half-lives from forgotten at once to never forgotten",
    ),
    NumberRange::real("human.transition.foresight", [0.0, 1.0], "", "the setting is a share from 0 to 1"),
    NumberRange::real(
        "human.decision.tau",
        [0.01, 100.0],
        "per press",
        "with a lower tau every button is pressed alike, with a higher tau only the best one",
    ),
    NumberRange::real(
        "human.decision.lapse",
        [0.000_001, 0.99],
        "",
        "for a person who never slips, any slip would be impossible",
    ),
    NumberRange::real(
        "human.decision.lapse_anywhere",
        [0.001, 1.0],
        "",
        "the setting is a share of slips; with 0, some presses would be impossible",
    ),
    NumberRange::real(
        "human.decision.wait_cost",
        [0.0, 1_000.0],
        "presses",
        "with the largest cost of waiting, nobody ever waits",
    ),
    NumberRange::whole("human.decision.cases", [1.0, 4_096.0], "worlds", DRAWS),
    NumberRange::real("human.signal.noticed", [0.0, 1.0], "", CHANCE),
    NumberRange::real("human.signal.highlight_noticed", [0.0, 1.0], "", CHANCE),
    NumberRange::real(
        "human.signal.delay_s",
        [0.0, 60.0],
        "s",
        "a signal is read within seconds; with 0 the signal is believed at once",
    ),
    NumberRange::real(
        "human.signal.reading_rate_hz",
        [0.01, 1_000.0],
        "per second",
        "at a lower rate nothing is read, at a higher one everything at once",
    ),
    NumberRange::real("human.signal.misread", [0.0, 1.0], "", CHANCE),
    NumberRange::real(
        "human.signal.follows",
        [0.0, 0.999],
        "",
        "with 1, no press could have another reason than the proposal",
    ),
    NumberRange::whole("human.inference.beliefs", [1.0, 2_048.0], "samples", DRAWS),
    NumberRange::whole("human.inference.states", [1.0, 128.0], "states", DRAWS),
    NumberRange::real(
        "human.inference.min_effective",
        [0.01, 2_048.0],
        "samples",
        "the effective number of samples cannot be above the number of samples",
    ),
    NumberRange::whole("human.inference.max_beliefs", [1.0, 2_048.0], "samples", DRAWS),
    NumberRange::whole("human.inference.predictions", [1.0, 4_096.0], "states", DRAWS),
];
