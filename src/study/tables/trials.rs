//! Table of trials, and the measures among its columns that are compared between conditions.

use std::borrow::Cow;

use crate::analysis::offer_summary::OfferSummary;
use crate::column::{CsvCell, CsvColumn, CsvRow, CsvTable};
use crate::effect::StudyMeasure;
use crate::rater_episodes::RaterFalseBeliefAgreement;
use crate::robot_tally::ArmSafetySummary;
use crate::tables::probe_table::PROBES_WRONG;
use crate::tables::trials::TrialColumn::Compared;
use crate::trial_statistics::{FalseBeliefErrors, TrialStatistics, mean_length};
use tomcom_core::base::text::GUARDED;
use tomcom_core::measures::sequences::BeliefErrorCounts;
use tomcom_core::measures::wizard_performance::WizardMeasures;
use tomcom_core::robot::AbortReason;
use tomcom_session::event::TrialEndReason;
use tomcom_session::wall_display::RobotDepiction;

/// Main measure of the report, which is the first of the compared measures.
pub const HEADLINE: StudyMeasure = StudyMeasure {
    name: "error_rate_human",
    unit: "errors per press of the human",
    meaning: "",
    meaning_in: "in the {} trial",
    title: "errors per press of the human",
    digits: 3,
    value: TrialStatistics::error_rate_human,
};

/// Number of errors, which the paper compares. The report's main measure is the error rate, since trials differ in
/// length.
const NUMBER_OF_ERRORS: StudyMeasure = StudyMeasure {
    name: "errors",
    unit: "errors",
    meaning: "errors of the human, without races",
    meaning_in: "errors of the human in the {} trial, without races",
    title: "errors in a trial",
    digits: 1,
    value: |trial| Some(trial.errors as f64),
};

/// The compared measures in the order of their columns; the first is [`HEADLINE`], the last are the number of errors
/// and measures that were added later.
pub fn measures() -> Vec<StudyMeasure> {
    let measure = |column: TrialColumn| match column {
        Compared(measure) => Some(measure),
        TrialColumn::Plain(_) => None,
    };
    // Two measures are the same if their names are.
    let rank = |measure: &StudyMeasure| match measure {
        one if *one == HEADLINE => 0,
        one if *one == NUMBER_OF_ERRORS => 2,
        one if *one == PROBES_WRONG => 3,
        _ => 1,
    };
    let mut measures: Vec<StudyMeasure> = declared().filter_map(measure).collect();
    measures.sort_by_key(rank);
    measures
}

impl CsvRow for TrialStatistics {
    const TABLE: CsvTable = CsvTable::Trials;

    fn columns() -> Vec<CsvColumn<TrialStatistics>> {
        let column = |column: TrialColumn| match column {
            Compared(measure) => TrialStatistics::column(measure.name, measure.unit, measure.meaning, move |trial| {
                (measure.value)(trial).into()
            }),
            TrialColumn::Plain(column) => column,
        };
        declared().map(column).collect()
    }
}

/// All columns of the table of trials, in the order of the file; new columns are appended at the end.
fn declared() -> impl Iterator<Item = TrialColumn> {
    kind_of_trial()
        .into_iter()
        .chain(errors())
        .chain(pace())
        .chain(robot())
        .chain(presses_given_up())
        .chain(by_hand())
        .chain(work())
        .chain(offered())
        .chain(shown())
        .chain(false_beliefs())
        .chain(probed())
        .chain(arms())
        .chain(coded())
        .chain(model_and_initiative())
}

fn kind_of_trial() -> Vec<TrialColumn> {
    vec![
        plain("recording", "", "folder of the recording; key of all tables by recording", |t| (&t.recording).into()),
        plain("participant", "", "as in participants", |t| (&t.participant).into()),
        plain("kind", "", "as in participants", |t| t.kind_name().into()),
        plain("seed", "", "seed of all random streams", |t| t.seed.into()),
        plain("group", "", "as in participants", |t| t.group.as_ref().into()),
        plain("period", "", "1: the participant's first trial, 2: the second", |t| t.period.into()),
        plain("condition", "", "who sends signals: none, wizard or assistant", |t| t.condition.name().into()),
        plain("assisted", "", "whether the planned arm has signals, of the wizard or the assistant", |t| {
            t.is_assisted().into()
        }),
        plain("counts", "", "whether the trial counts; false: left out of all statistics", |t| t.counts().into()),
        plain("left_out", "", format!("reason for leaving the trial out; {GUARDED}"), |t| t.left_out.as_ref().into()),
        plain(
            "ended",
            "",
            "reason of the trial's end: set number of presses, time or orders; early: wizard or aborted; empty: incomplete recording",
            |t| t.ended.map(TrialEndReason::name).into(),
        ),
        plain("arm", "", "robot arm: timed (random press durations) or physics (simulated with contact forces)", |t| {
            t.arm.name().into()
        }),
    ]
}

fn errors() -> Vec<TrialColumn> {
    fn of_beliefs(trial: &TrialStatistics, count: fn(&FalseBeliefErrors) -> usize) -> CsvCell<'_> {
        trial.beliefs.as_ref().map(|beliefs| count(beliefs) as u64).into()
    }
    vec![
        plain("human_presses", "presses", "human presses while the trial ran", |t| t.human_presses.into()),
        plain("robot_presses", "presses", "robot presses while the trial ran", |t| t.robot_presses.into()),
        Compared(NUMBER_OF_ERRORS),
        plain("races", "presses", "human presses within 300 ms of a robot change at the same place", |t| {
            t.races.into()
        }),
        Compared(HEADLINE),
        Compared(StudyMeasure {
            name: "error_rate",
            unit: "errors per press of both agents",
            meaning: "",
            meaning_in: "in the {} trial",
            title: "errors per press of both agents",
            digits: 3,
            value: TrialStatistics::error_rate,
        }),
        plain(
            "beliefs_from",
            "",
            "source of the errors' causes: recorded (beliefs of simulated participants), consensus (of two raters), raters, or estimate",
            |t| t.beliefs.as_ref().map(|beliefs| beliefs.basis.name()).into(),
        ),
        plain("belief_related_errors", "errors", "", |t| t.beliefs.as_ref().map(|beliefs| beliefs.errors).into()),
        plain(
            "sequences",
            "sequences",
            "error sequences: errors of the same false belief at most 3 correct presses apart",
            |t| of_beliefs(t, |beliefs| beliefs.lengths.len()),
        ),
        Compared(StudyMeasure {
            name: "sequence_length",
            unit: "errors",
            meaning: "mean errors per error sequence",
            meaning_in: "mean errors per error sequence of the {} trial",
            title: "errors per sequence",
            digits: 2,
            value: TrialStatistics::sequence_length,
        }),
        plain("sequences_by_aspect", "sequences", "as sequences, which are by aspect", |t| {
            of_beliefs(t, |beliefs| beliefs.lengths.len())
        }),
        plain("sequence_length_by_aspect", "errors", "as sequence_length", |t| t.sequence_length().into()),
        Compared(StudyMeasure {
            name: "recovery_s",
            unit: "s",
            meaning: "mean time from a sequence's first error to the first correct press after its last",
            meaning_in: "mean recovery time of the {} trial's error sequences",
            title: "seconds to recover from a sequence",
            digits: 2,
            value: TrialStatistics::recovery_s,
        }),
    ]
}

fn pace() -> Vec<TrialColumn> {
    vec![
        plain("orders", "orders", "served orders", |t| t.orders.into()),
        Compared(StudyMeasure {
            name: "order_s",
            unit: "s",
            meaning: "median time from an order's appearance to its serving",
            meaning_in: "median time from an order's appearance to its serving in the {} trial",
            title: "seconds per order",
            digits: 2,
            value: |t| t.order_s,
        }),
        Compared(StudyMeasure {
            name: "presses_per_order",
            unit: "presses of both",
            meaning: "median presses of both agents per order",
            meaning_in: "median presses of both agents per order in the {} trial",
            title: "presses of both agents per order",
            digits: 2,
            value: |t| t.presses_per_order,
        }),
        Compared(StudyMeasure {
            name: "press_s",
            unit: "s",
            meaning: "median time between successive human presses",
            meaning_in: "median time between successive human presses in the {} trial",
            title: "seconds between human presses",
            digits: 2,
            value: |t| t.press_s,
        }),
        plain("signals", "signals", "signals shown to the participant", |t| t.signals.into()),
        plain("duration_s", "s", "duration of the trial, without pauses", |t| t.seconds.into()),
    ]
}

fn robot() -> Vec<TrialColumn> {
    fn of_arm<T: Into<CsvCell<'static>>>(
        trial: &TrialStatistics,
        value: fn(&ArmSafetySummary) -> T,
    ) -> CsvCell<'static> {
        trial.robot.arm.as_ref().map(value).into()
    }
    vec![
        plain(
            "protective_stops",
            "stops",
            "protective stops after a contact; this and the next five columns are empty for a timed arm",
            |t| of_arm(t, |arm| arm.protective_stops),
        ),
        plain("faults", "stops", "stops because a joint did not follow", |t| of_arm(t, |arm| arm.faults)),
        plain("contacts", "contacts", "contacts of a person with the arm, with or without a protective stop", |t| {
            of_arm(t, |arm| arm.contacts)
        }),
        plain("peak_force_n", "N", "largest contact force; empty without contact", |t| {
            of_arm(t, |arm| arm.peak_force_n)
        }),
        plain("reduced_s", "s", "time at reduced speed because of a hand near the arm, on the trial's clock", |t| {
            of_arm(t, |arm| arm.reduced_s)
        }),
        plain("safeguard_s", "s", "time of waiting for a hand in the arm's way, on the trial's clock", |t| {
            of_arm(t, |arm| arm.safeguard_s)
        }),
        plain("emergency_stops", "stops", "emergency stops of the robot by the wizard", |t| {
            t.robot.emergency_stops.into()
        }),
    ]
}

fn presses_given_up() -> Vec<TrialColumn> {
    let why = |reason: AbortReason| match reason {
        AbortReason::NoLongerUseful => ("no_longer_useful", "the press was no longer useful when the arm arrived"),
        AbortReason::Stopped => ("stopped", "the wizard stopped it"),
        AbortReason::Skipped => ("skipped", "the wizard skipped the press"),
        AbortReason::Driven => ("driven", "the wizard chose another press"),
        AbortReason::OutOfReach => ("out_of_reach", "the button was out of reach"),
        AbortReason::Singular => ("singular", "the arm would come close to a singularity"),
        AbortReason::Obstructed => ("obstructed", "every path to the button was obstructed"),
        AbortReason::HandInTheWay => ("hand_in_the_way", "a hand was in the way for too long"),
        AbortReason::NoClick => ("no_click", "the button did not click"),
        AbortReason::Contact => ("contact", "the arm stopped after a contact"),
        AbortReason::Fault => ("fault", "a joint did not follow"),
    };
    let column = |reason: AbortReason| {
        let (name, why) = why(reason);
        let unknown = if reason.is_of_physics() { "; empty for a timed arm" } else { "" };
        TrialColumn::Plain(TrialStatistics::column(
            format!("given_up_{name}"),
            "presses",
            format!("aborted robot presses: {why}{unknown}"),
            move |trial| trial.robot.given_up(reason).into(),
        ))
    };
    AbortReason::ALL.into_iter().map(column).collect()
}

fn by_hand() -> Vec<TrialColumn> {
    vec![
        plain("wizard_held", "times", "number of times the wizard held the robot before its next press", |t| {
            t.robot.held.into()
        }),
        plain("wizard_skipped", "times", "number of robot presses that the wizard skipped", |t| t.robot.skipped.into()),
        plain("wizard_driven", "times", "number of robot presses that the wizard chose", |t| t.robot.driven.into()),
        plain("wizard_corrected", "times", "number of locations that the wizard corrected", |t| {
            t.robot.corrected.into()
        }),
    ]
}

/// Columns with error sequences, lost presses (regret), and errors by kind of state aspect.
fn work() -> Vec<TrialColumn> {
    fn cause(name: &'static str, meaning: &'static str, count: fn(&BeliefErrorCounts) -> u64) -> TrialColumn {
        TrialColumn::Plain(TrialStatistics::column(name, "errors", meaning, move |trial| {
            trial.beliefs.as_ref().map(|beliefs| count(&beliefs.causes)).into()
        }))
    }
    vec![
        plain(
            "useful_signals",
            "signals",
            "signals without which a twin of the simulated trial makes more errors about their target (of a proposal: in its next presses); \
             empty: not judged",
            |t| t.useful_signals.into(),
        ),
        plain("useless_signals", "signals", "all other signals; empty: not judged", |t| {
            t.useful_signals.map(|useful| t.signals - useful).into()
        }),
        plain("sequences_any_aspect", "sequences", "error sequences whatever the aspect of their errors", |t| {
            t.beliefs.as_ref().map(|beliefs| beliefs.lengths_any_aspect.len() as u64).into()
        }),
        plain("sequence_length_any_aspect", "errors", "mean errors per error sequence whatever the aspect", |t| {
            t.beliefs.as_ref().and_then(|beliefs| mean_length(&beliefs.lengths_any_aspect)).into()
        }),
        Compared(StudyMeasure {
            name: "additional_presses_per_order",
            unit: "presses of both",
            meaning: "summed regret of both agents' presses per served order",
            meaning_in: "summed regret of both agents' presses per served order in the {} trial",
            title: "additional presses of both agents per order",
            digits: 2,
            value: |trial| trial.additional_presses_per_order,
        }),
        cause("errors_about_orders", "belief related errors about an order", |causes| causes.orders),
        cause("errors_about_recipes", "belief related errors about a recipe", |causes| causes.recipes),
        cause(
            "errors_about_order_or_recipe",
            "belief related errors about an ordered dish: both order and recipe believed wrong, or unknown which",
            |causes| causes.order_or_recipe,
        ),
        cause("errors_about_places", "belief related errors about another location's content", |causes| causes.places),
    ]
}

fn offered() -> Vec<TrialColumn> {
    fn offers(
        name: &'static str,
        unit: &'static str,
        meaning: &'static str,
        value: fn(&OfferSummary) -> CsvCell<'static>,
    ) -> TrialColumn {
        TrialColumn::Plain(TrialStatistics::column(name, unit, meaning, move |trial| value(&trial.offers)))
    }
    vec![
        offers("offers", "offers", "closed offers that a wizard could see; empty: a recording without offers", |of| {
            of.all.n.into()
        }),
        offers(
            "offers_taken",
            "offers",
            "those whose signal the wizard sent with the key that takes the offer",
            |of| of.taken.into(),
        ),
        offers("offers_by_own_key", "offers", "those whose signal the wizard sent with the signal's own key", |of| {
            of.by_own_key.into()
        }),
        offers("offer_stood_s", "s", "median time for which these offers were open", |of| of.all.median_s.into()),
        offers("offer_reaction_s", "s", "median time from an offer's opening to either key", |of| of.reaction_s.into()),
    ]
}

fn shown() -> Vec<TrialColumn> {
    let arm =
        "how the participant's display showed the robot: none, hand or arm; empty: no display, or none could be shown";
    vec![plain("display_arm", "", arm, |t| t.display_arm.map(RobotDepiction::name).into())]
}

/// Columns about false belief episodes, raters' agreement on them, and a wizard's hits.
fn false_beliefs() -> Vec<TrialColumn> {
    fn shared(name: &'static str, meaning: &'static str, count: fn(RaterFalseBeliefAgreement) -> u64) -> TrialColumn {
        TrialColumn::Plain(TrialStatistics::column(name, "errors", meaning, move |trial| {
            trial.shared_beliefs.map(count).into()
        }))
    }
    fn wizard(name: &'static str, unit: &'static str, meaning: &'static str, count: Counted) -> TrialColumn {
        TrialColumn::Plain(TrialStatistics::column(name, unit, meaning, move |trial| {
            trial.wizard.as_ref().and_then(count).into()
        }))
    }
    type Counted = fn(&WizardMeasures) -> Option<u64>;
    vec![
        plain(
            "false_belief_episodes",
            "episodes",
            "periods of false belief with at least one error; source in beliefs_from; empty: known by the estimate alone",
            |t| t.beliefs.as_ref().and_then(|beliefs| beliefs.episodes).into(),
        ),
        shared(
            "raters_same_belief",
            "errors that both raters put down to the same false belief; this and the next two columns are empty without two raters",
            |shared| shared.same,
        ),
        shared("raters_other_belief", "errors that both put down to a false belief, each to another one", |shared| {
            shared.differing
        }),
        shared("one_rater_belief", "errors that one of them alone puts down to a false belief", |shared| shared.of_one),
        wizard("wizard_hits", "episodes", "episodes with a signal of the wizard in time", |wizard| wizard.hits),
        wizard("wizard_omissions", "episodes", "episodes without one", |wizard| wizard.omissions),
    ]
}

fn coded() -> Vec<TrialColumn> {
    vec![plain(
        "raters",
        "",
        "the two raters, as R1+R2, whose codes or consensus determine the causes of errors; empty: nobody's",
        |t| t.raters.as_ref().map(|pair| pair.name()).into(),
    )]
}

fn probed() -> Vec<TrialColumn> {
    vec![
        plain(
            "probe_questions",
            "questions",
            "questions of probes in the main results: scheduled, about what is, answered in time; empty: no probes",
            |t| t.probes.map(|probes| probes.counted).into(),
        ),
        Compared(PROBES_WRONG),
    ]
}

fn model_and_initiative() -> Vec<TrialColumn> {
    vec![
        plain(
            "human_model",
            "",
            "the assistant's model of the human: its name, and parameters that differ from the named model",
            |t| t.human_model.as_str().into(),
        ),
        plain(
            "initiative_presses",
            "presses",
            "of robot_presses: those that the robot set out for by its own initiative, since the participant did not press",
            |t| t.initiative_presses.into(),
        ),
        plain(
            "display_lost",
            "times",
            "times that the participant's display was lost while the trial ran; empty: no display",
            |t| t.display_losses.map(|losses| losses.times).into(),
        ),
        plain("display_lost_s", "s", "time for which it was lost, on the trial's clock; empty: no display", |t| {
            t.display_losses.map(|losses| losses.seconds).into()
        }),
    ]
}

enum TrialColumn {
    Plain(CsvColumn<TrialStatistics>),
    Compared(StudyMeasure),
}

/// Declares a column of the table of trials that the report does not compare.
fn plain(
    name: &'static str,
    unit: &'static str,
    meaning: impl Into<Cow<'static, str>>,
    value: fn(&TrialStatistics) -> CsvCell<'_>,
) -> TrialColumn {
    TrialColumn::Plain(TrialStatistics::column(name, unit, meaning, value))
}

/// Columns for the arm as carried out, the planned arm, what the wizard could see, the contents of signals, and presses
/// whose judgement is not proven.
fn arms() -> Vec<TrialColumn> {
    vec![
        plain(
            "study_arm",
            "",
            "arm by what was done: none, wizard, wizard+advice (the wizard saw recommendations), tom-com, tom or dev",
            |t| t.study_arm.name().into(),
        ),
        plain(
            "planned_arm",
            "",
            "arm under which the trial counts: that of the plan, without a plan that of the settings; differs from study_arm \
             where the trial was carried out otherwise",
            |t| t.planned_arm.name().into(),
        ),
        plain(
            "wizard_sees",
            "",
            "what the console may show: state (kitchen and gaze), belief (also the estimate) or recommendation (also advice)",
            |t| t.wizard_sees.name().into(),
        ),
        plain(
            "signal_contents",
            "contents",
            "contents of the signals: a proposal of k presses has k, any other signal one",
            |t| t.signal_contents.into(),
        ),
        plain(
            "unproven",
            "presses",
            "human presses whose judgement rests on a cost to go that is not proven to be the least",
            |t| t.unproven.into(),
        ),
    ]
}
