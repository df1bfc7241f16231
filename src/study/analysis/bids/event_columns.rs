//! The columns of the BIDS table of events.

use super::event_levels::LEVELS;
use super::tsv::{BidsColumn, YES_NO};

/// Values of the column that says who did something (wizard, participant, robot), with their meanings.
const AGENTS: &[(&str, &str)] = &[
    ("human", "The participant"),
    ("participant", "The participant, in the tutorial"),
    ("robot", "The robot that cooks with the participant"),
    ("wizard", "The person at the console, or the script in its place"),
    ("assistant", "The communication concept that acts by itself"),
];
const SIGNALS: &[(&str, &str)] = &[
    ("show_recipe", "The recipe of the dish that the order at the place wants"),
    ("highlight", "Directs attention to the place and what lies there"),
    ("propose", "Proposes the next presses of the participant"),
];

/// The columns of the BIDS table of events, in their order.
pub(super) const EVENTS: [BidsColumn; 21] = [
    BidsColumn::of_unit("onset", "s", "Session time: since the beginning of the recording, by a monotonic clock"),
    BidsColumn::of_unit(
        "duration",
        "s",
        "Until what the event began is over; 0 for what happens at a moment; n/a where the recording ends before",
    ),
    BidsColumn::of_levels("trial_type", LEVELS, "Kind of the event, as in the log"),
    BidsColumn::new("seq", "Number of the event in the log, from 0"),
    BidsColumn::of_unit(
        "trial_time",
        "s",
        "The trial's clock, which stands still in pauses; n/a before and after the trial",
    ),
    BidsColumn::new("what", "What exactly happened, for kinds that have several"),
    BidsColumn::of_levels("agent", AGENTS, "Who did it"),
    BidsColumn::new(
        "button",
        "Name of the button; several are separated by commas: proposed ones, or those of the participant for which the robot waits",
    ),
    BidsColumn::of_levels("effective", YES_NO, "Presses: whether the button did anything"),
    BidsColumn::of_levels(
        "error",
        YES_NO,
        "Presses of the participant in the trial: whether the press was an error, by the number of presses that it loses",
    ),
    BidsColumn::new("location", "The place that it is about, by its name in the layout"),
    BidsColumn::new("dish", "The wanted dish, or the one whose recipe a probe asks for"),
    BidsColumn::new("content", "What lies at the place"),
    BidsColumn::of_levels("signal", SIGNALS, "Kind of the signal that is shown, offered or recommended"),
    BidsColumn::new("refers_to", "Number (seq) of the event that this one is about, answers or follows from"),
    BidsColumn::of_unit(
        "at",
        "s",
        "Session time that the event tells: when the button went down at the display, when the robot will touch the button, when \
         the display drew it, when a fixation began",
    ),
    BidsColumn::of_unit("force", "N", "Contact force"),
    BidsColumn::new(
        "item",
        "Item of a questionnaire, step of the tutorial, phase, aspect of a belief, size of the display, probe and question as in 2.1",
    ),
    BidsColumn::new(
        "answer",
        "Answer to the item: a number, or the ids of the chosen options; of a probe the value, or unsure",
    ),
    BidsColumn::new(
        "value",
        "The number that the event tells: of robot_safety the faulty joint, clock_jumped milliseconds, tracker seconds or dropped \
         samples (fixations: milliseconds), calibration targets or accuracy in degrees, belief_estimated the log probability of the \
         press, advised and offer_opened the net benefit in presses, probe the number of questions, or how sure an answer is from 1 to 3",
    ),
    BidsColumn::new("reason", "Why, as the log names it"),
];

/// Column with text that somebody typed, for exports that include such text.
pub(super) const WORDS: BidsColumn = BidsColumn::new(
    "words",
    "Words that somebody typed, or that a device calls itself by; a ' stands before words that begin with = + - or @, so that no spreadsheet computes them",
);
