//! Allowed ranges of the parameters of the human model.

use tomcom_core::base::number_range::NumberRange;

/// Range of rates of looks (how often people look at a location), per second.
const LOOKS: [f64; 2] = [0.0, 100.0];
const FEW_LOOKS: &str = "eyes look at a few places in a second";
const CHANCE: &str = "the setting is a probability";
/// Reason for the bounds of probabilities that must be neither 0 nor 1.
const UNSURE: &str = "a certain belief could not be corrected by any observation";
const PRECISION: &str = "with a lower precision there is no belief, with a higher one the belief is certain";
const DRAWS: &str = "larger samples take seconds to minutes for each press";

pub(super) const RANGES: [NumberRange; 37] = [
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
