//! Allowed ranges of settings of trial, robot, signals, assistant, devices and plan.

use crate::base::number_range::{ABOVE_0, ANY, INSIDE_0_AND_1, NOT_NEGATIVE, NumberRange};

/// Range of numbers of rollouts that earlier versions of the program accepted.
const TO_65536: [f64; 2] = [1.0, 65_536.0];
/// Range of a probability that must be below 1.
const BELOW_1: [f64; 2] = [0.0, INSIDE_0_AND_1[1]];
const SECONDS: &str = "s";
const CHANCE: &str = "it is a probability";
const PORT: &str = "ports of TCP and UDP have these numbers";
/// Reason for the bounds of durations of presses and of intervals between presses, shown with an error.
const PRESS: &str = "less is no movement, more no cooperation";
/// Longest allowed trial, in seconds: a day.
const DAY_S: f64 = 86_400.0;
const LONGEST: &str = "no trial is longer than a day";
/// Largest number that 32 bits hold, which is practically no limit for a count.
const COUNT: f64 = 4_294_967_295.0;

pub(super) const RANGES: [NumberRange; 50] = [
    NumberRange::whole("seed", [0.0, 9_007_199_254_740_991.0], "", "every reader of JSON has these numbers exactly")
        .recorded(ANY),
    NumberRange::whole("trial.presses", [1.0, COUNT], "presses", "the largest numbers are as good as no limit"),
    NumberRange::real("trial.seconds", [0.1, DAY_S], SECONDS, LONGEST).recorded(ABOVE_0),
    NumberRange::whole("trial.orders", [1.0, COUNT], "orders", "the largest numbers are as good as no limit"),
    NumberRange::real("trial.pace_s", [0.1, 60.0], SECONDS, PRESS),
    NumberRange::real("robot.press_s", [0.05, 60.0], SECONDS, PRESS).recorded(ABOVE_0),
    NumberRange::real("robot.press_spread", [0.0, 2.0], "", "with more, presses take anything from no time to minutes"),
    NumberRange::real("signals.shown_s", [0.1, 3_600.0], SECONDS, "less cannot be read, more is a picture on the wall")
        .recorded(ABOVE_0),
    NumberRange::real("signals.cool_down_s", [0.0, 60.0], SECONDS, "a wizard who has to wait longer cannot help"),
    NumberRange::real(
        "assistant.cost_of_communication",
        [0.0, 1_000.0],
        "presses",
        "no signal saves as many as the most",
    )
    .recorded(NOT_NEGATIVE),
    NumberRange::real("assistant.belief_threshold", [0.0, 0.99], "", "it is a probability, and 1 is never exceeded")
        .recorded(BELOW_1),
    NumberRange::whole("assistant.proposed_presses", [1.0, 5.0], "presses", "more are a recipe, not a hint"),
    NumberRange::whole("assistant.rollout.horizon", [1.0, 64.0], "decisions", "an order takes some twenty presses"),
    NumberRange::whole(
        "assistant.rollout.rollouts",
        [1.0, 16_384.0],
        "rollouts",
        "64 times the default: more take minutes a press",
    )
    .recorded(TO_65536),
    NumberRange::whole("assistant.rollout.states", [1.0, 128.0], "states", "beyond, nothing becomes more exact")
        .recorded([1.0, 256.0]),
    NumberRange::real("assistant.rollout.human_press_s", [0.05, 60.0], SECONDS, PRESS).recorded(ABOVE_0),
    NumberRange::real("assistant.rollout.looks_hz", [0.0, 100.0], "per second", "eyes look at a few places a second")
        .recorded(NOT_NEGATIVE),
    NumberRange::real(
        "assistant.rollout.other_looks_hz",
        [0.0, 100.0],
        "per second",
        "eyes look at a few places a second",
    )
    .recorded(NOT_NEGATIVE),
    NumberRange::real("assistant.rollout.capture", [0.0, 1.0], "", CHANCE),
    NumberRange::real(
        "assistant.rollout.enough_error",
        [0.0, 100.0],
        "presses",
        "with more, the least number of rollouts is always enough",
    )
    .recorded(NOT_NEGATIVE),
    NumberRange::whole("assistant.rollout.least_rollouts", [1.0, 16_384.0], "rollouts", "no more than rollouts can be")
        .recorded(TO_65536),
    NumberRange::whole("participant.gaze_port", [1.0, 65_535.0], "", PORT).recorded(ANY),
    NumberRange::whole("tracker.port", [1.0, 65_535.0], "", PORT).recorded(ANY),
    NumberRange::real(
        "tracker.corners",
        [-10.0, 10.0],
        "fractions of the display",
        "a surface much larger than the display has no gaze on it",
    )
    .recorded(ANY),
    NumberRange::real("tracker.file_start_s", [-DAY_S, DAY_S], SECONDS, LONGEST),
    NumberRange::real("tracker.gaps.every_s", [0.01, DAY_S], SECONDS, LONGEST),
    NumberRange::real("tracker.gaps.shortest_s", [0.01, DAY_S], SECONDS, LONGEST),
    NumberRange::real("tracker.gaps.longest_s", [0.01, DAY_S], SECONDS, LONGEST),
    NumberRange::real(
        "lsl.gaze.size",
        [0.01, 100_000.0],
        "in the unit of the stream",
        "from a small display in metres to a wall of displays in pixels",
    ),
    NumberRange::real("tracker.distance_m", [0.2, 20.0], "m", "eyes see a display from these distances"),
    NumberRange::whole("probes.per_trial", [0.0, 50.0], "probes", "more leave no time to work"),
    NumberRange::real("probes.apart_s", [1.0, 3_600.0], SECONDS, "the participant works on between two probes"),
    NumberRange::real("probes.after_signal_s", [0.0, 600.0], SECONDS, "with more, hardly any probe is held"),
    NumberRange::real("probes.wait_s", [0.0, 600.0], SECONDS, "a later probe is not the one that was drawn"),
    NumberRange::real("probes.limit_s", [5.0, 600.0], SECONDS, "less is too short for an answer; beliefs fade"),
    NumberRange::real("probes.count_down_s", [0.0, 60.0], SECONDS, "beliefs fade in a longer one"),
    NumberRange::whole("probes.least_questions", [1.0, 8.0], "questions", "more take minutes"),
    NumberRange::whole("probes.most_questions", [1.0, 8.0], "questions", "more take minutes"),
    NumberRange::real("probes.blind_share", [0.0, 1.0], "", "it is a share of probes"),
    NumberRange::real("probes.least_inclusion", [0.001, 1.0], "", "it is a probability, and analyses divide by it"),
    NumberRange::real("probes.teaches", [0.0, 1.0], "", CHANCE),
    NumberRange::whole("display.port", [1.0, 65_535.0], "", PORT).recorded(ANY),
    NumberRange::whole(
        "plan.participants",
        [1.0, 9_999.0],
        "participants",
        "their codes have up to four digits; or a list of their codes",
    ),
    NumberRange::whole("plan.block", [1.0, 9_999.0], "participants", "no block is larger than the study"),
    NumberRange::whole(
        "plan.familiarisation.presses",
        [1.0, COUNT],
        "presses",
        "the largest numbers are as good as no limit",
    ),
    NumberRange::real("plan.familiarisation.seconds", [0.1, DAY_S], SECONDS, LONGEST).recorded(ABOVE_0),
    NumberRange::whole("plan.familiarisation.orders", [1.0, COUNT], "orders", "0 would be no criterion"),
    NumberRange::real("plan.familiarisation.error_rate", [0.0, 1.0], "", "it is a share of presses"),
    NumberRange::whole("plan.questionnaire.after", [1.0, 6.0], "", "participants have one to six trials"),
    NumberRange::real(
        "plan.aims.margin",
        [1.01, 10.0],
        "",
        "it is a ratio of rates above 1: how much worse is not worse",
    ),
];

pub(super) const OF_ITEMS: [NumberRange; 6] = [
    NumberRange::whole("scale.points", [2.0, 9.0], "points", "each point is a key"),
    NumberRange::whole("scales.*.points", [2.0, 9.0], "points", "each point is a key"),
    NumberRange::whole("item.min", [-1_000_000.0, 1_000_000.0], "", "people type it"),
    NumberRange::whole("item.max", [-1_000_000.0, 1_000_000.0], "", "people type it"),
    NumberRange::whole("item.length", [1.0, 500.0], "characters", "the page and the console show it whole"),
    NumberRange::whole("item.step", [1.0, 50.0], "", "a slider has at least three positions"),
];
