//! Allowed ranges of settings of simulated people: the population of participants, and the scripted wizard.

use tomcom_core::base::number_range::NumberRange;

const SECONDS: &str = "s";
const CHANCE: &str = "the setting is a probability";
const LATE: &str = "a wizard who takes longer cannot help";

/// Range of a probability that differs between people: its odds are drawn for each person, so 0 and 1 are not allowed.
const fn chance(path: &'static str) -> NumberRange {
    let reason = "the setting is a probability whose odds are drawn for each person, so neither 0 nor 1";
    NumberRange::real(path, [0.000_001, 0.999_999], "", reason)
}

/// Range of a probability that either differs between people, or is 0 for everybody.
const fn rare_chance(path: &'static str) -> NumberRange {
    NumberRange::real(
        path,
        [0.0, 0.999_999],
        "",
        "the setting is a probability whose odds are drawn for each person, so not 1; with 0 nobody does this",
    )
}

pub(super) const RANGES: [NumberRange; 61] = [
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
