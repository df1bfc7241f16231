//! Allowed ranges of settings of trial, robot, signals, assistant, devices and plan.

use tomcom_core::base::number_range::NumberRange;

const SECONDS: &str = "s";
const CHANCE: &str = "the setting is a probability";
const PORT: &str = "ports of TCP and UDP have these numbers";
/// Reason for the bounds of durations of presses and of intervals between them.
const PRESS: &str = "a shorter time is no movement, a longer time no cooperation";
/// Longest allowed trial, in seconds: a day.
const DAY_S: f64 = 86_400.0;
const LONGEST: &str = "no trial is longer than a day";
/// Largest number that 32 bits hold, which is practically no limit for a count.
const COUNT: f64 = 4_294_967_295.0;

pub(super) const RANGES: [NumberRange; 51] = [
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
        [1.0, 6.0],
        "",
        "participants have one to six trials, after which a questionnaire can follow",
    ),
    NumberRange::real(
        "plan.aims.margin",
        [1.01, 10.0],
        "",
        "the margin is a ratio of error rates above 1: up to it, worse counts as not worse",
    ),
];

pub(super) const OF_ITEMS: [NumberRange; 6] = [
    NumberRange::whole("scale.points", [2.0, 9.0], "points", "each point of a scale has a key of its own"),
    NumberRange::whole("scales.*.points", [2.0, 9.0], "points", "each point of a scale has a key of its own"),
    NumberRange::whole("item.min", [-1_000_000.0, 1_000_000.0], "", "people have to type the number"),
    NumberRange::whole("item.max", [-1_000_000.0, 1_000_000.0], "", "people have to type the number"),
    NumberRange::whole("item.length", [1.0, 500.0], "characters", "page and console have to show the whole answer"),
    NumberRange::whole("item.step", [1.0, 50.0], "", "with larger steps a slider has fewer than three positions"),
];
