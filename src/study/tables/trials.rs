//! Table of trials, and the measures among its columns that are compared between conditions.

use crate::column::{CsvRow, CsvTable, TableColumn, columns};
use crate::effect::StudyMeasure;
use crate::trial_statistics::{TrialStatistics, mean_length};
use crate::why;
use tomcom_core::base::text::GUARDED;
use tomcom_core::measures::sequences::BeliefErrorCounts;
use tomcom_core::robot::AbortReason;
use tomcom_session::event::TrialEndReason;
use tomcom_session::wall_display::RobotDepiction;

macro_rules! measures {
    ($($id:ident: $name:expr, $unit:expr, $title:expr, $digits:expr, $meaning:expr, $meaning_in:expr, $unknown:expr => $value:expr;)*) => {
        $(pub const $id: StudyMeasure = StudyMeasure {
            name: $name,
            unit: $unit,
            title: $title,
            digits: $digits,
            meaning: $meaning,
            meaning_in: $meaning_in,
            unknown: $unknown,
            value: $value,
        };)*

        /// In the order of their columns in the table of participants; those that were added later are last.
        pub const MEASURES: [StudyMeasure; [$($name),*].len()] = [$($id),*];
    };
}

// An entry each: name, unit, title, decimals; meaning; meaning in the table of participants; why it is unknown; value. The first is the
// report's main measure: trials differ in length, so it is a rate. The number of errors is what the paper compares.
measures! {
    HEADLINE: "error_rate_human", "errors per press of the human", "errors per press of the human", 3,
        "",
        "in the {} trial", why::NO_PRESS => TrialStatistics::error_rate_human;
    ERROR_RATE: "error_rate", "errors per press of both agents", "errors per press of both agents", 3,
        "",
        "in the {} trial", "no press" => TrialStatistics::error_rate;
    SEQUENCE_LENGTH: "sequence_length", "errors", "errors per sequence", 2,
        "mean errors per error sequence",
        "mean errors per error sequence of the {} trial",
        "no sequence of errors, or causes not known" => TrialStatistics::sequence_length;
    RECOVERY_S: "recovery_s", "s", "seconds to recover from a sequence", 2,
        "mean time from a sequence's first error to the first correct press after its last",
        "mean recovery time of the {} trial's error sequences",
        "no sequence was followed by a correct press, or causes not known" => TrialStatistics::recovery_s;
    ORDER_S: "order_s", "s", "seconds per order", 2,
        "median time from an order's appearance to its serving",
        "median time from an order's appearance to its serving in the {} trial", why::NO_ORDER => |t| t.order_s;
    PRESSES_PER_ORDER: "presses_per_order", "presses of both", "presses of both agents per order", 2,
        "median presses of both agents per order",
        "median presses of both agents per order in the {} trial", why::NO_ORDER => |t| t.presses_per_order;
    PRESS_S: "press_s", "s", "seconds between human presses", 2,
        "median time between successive human presses",
        "median time between successive human presses in the {} trial", why::ONE_PRESS => |t| t.press_s;
    ADDITIONAL_PRESSES: "additional_presses_per_order", "presses of both", "additional presses of both agents per order", 2,
        "summed regret of both agents' presses per served order",
        "summed regret of both agents' presses per served order in the {} trial", why::NO_ORDER => |t| t.additional_presses_per_order;
    ERRORS: "errors", "errors", "errors in a trial", 1,
        "errors of the human, without races",
        "errors of the human in the {} trial, without races", "" => |t| Some(t.errors as f64);
    PROBES_WRONG: "probes_wrong", "share of the questions", "share of wrong answers to probes", 3,
        "weighted share of wrong answers to probes, over the questions of the main results",
        "weighted share of wrong answers to probes in the {} trial", "no such question" => |t| t.probes.and_then(|probes| probes.share_wrong);
}

impl TrialStatistics {
    fn errors_about(&self, count: fn(&BeliefErrorCounts) -> u64) -> Option<u64> {
        self.beliefs.as_ref().map(|beliefs| count(&beliefs.causes))
    }
}

impl CsvRow for TrialStatistics {
    const TABLE: CsvTable = CsvTable::Trials;

    /// New columns are appended at the end.
    fn columns() -> Vec<TableColumn<Self>> {
        let mut columns = columns! { |t: Self|
            "recording", "", "folder of the recording; key of all tables by recording" => &t.recording;
            "participant", "", "as in participants" => &t.participant;
            "kind", "", "as in participants" => t.kind.name();
            "seed", "", "seed of the session, of which the random streams of each trial follow; BIDS has that of the trial" => t.seed;
            "group", "", "as in participants; empty: no plan" => t.group.as_ref();
            "period", "", "number of the trial in the participant's series; 1: the first; empty: no plan" => t.period;
            "condition", "", "who sends signals: none, wizard or assistant" => t.condition.name();
            "assisted", "", "whether the planned arm has signals, of the wizard or the assistant" => t.is_assisted();
            "counts", "", "whether the trial counts; false: left out of all statistics" => t.counts();
            "left_out", "", format!("reason for leaving the trial out; empty: it counts; {GUARDED}") => t.left_out.as_ref();
            "ended", "", "reason of the trial's end: set number of presses, time or orders; early: wizard or aborted; \
                empty: incomplete recording" => t.ended.map(TrialEndReason::name);
            "arm", "", "robot arm: timed (random press durations), physics (simulated with contact forces) or ur (a real UR5)"
                => t.arm.name();
            "human_presses", "presses", "human presses while the trial ran" => t.human_presses;
            "robot_presses", "presses", "robot presses while the trial ran" => t.robot_presses;
            ERRORS.name, ERRORS.unit, ERRORS.meaning_of_trial() => (ERRORS.value)(t);
            "races", "presses", "human presses within 300 ms of a robot change at the same place" => t.races;
            HEADLINE.name, HEADLINE.unit, HEADLINE.meaning_of_trial() => (HEADLINE.value)(t);
            ERROR_RATE.name, ERROR_RATE.unit, ERROR_RATE.meaning_of_trial() => (ERROR_RATE.value)(t);
            "beliefs_from", "", "source of the errors' causes: recorded (beliefs of simulated participants), \
                consensus (of two raters), raters, or estimate; empty: not known"
                => t.beliefs.as_ref().map(|beliefs| beliefs.basis.name());
            "belief_related_errors", "errors", "empty as beliefs_from" => t.beliefs.as_ref().map(|beliefs| beliefs.errors);
            "sequences", "sequences", "error sequences: errors of the same false belief at most 3 correct presses apart; empty as beliefs_from"
                => t.beliefs.as_ref().map(|beliefs| beliefs.lengths.len() as u64);
            SEQUENCE_LENGTH.name, SEQUENCE_LENGTH.unit, SEQUENCE_LENGTH.meaning_of_trial() => (SEQUENCE_LENGTH.value)(t);
            "sequences_by_aspect", "sequences", "as sequences, which are by aspect"
                => t.beliefs.as_ref().map(|beliefs| beliefs.lengths.len() as u64);
            "sequence_length_by_aspect", "errors", "as sequence_length, also where empty" => t.sequence_length();
            RECOVERY_S.name, RECOVERY_S.unit, RECOVERY_S.meaning_of_trial() => (RECOVERY_S.value)(t);
            "orders", "orders", "served orders" => t.orders;
            ORDER_S.name, ORDER_S.unit, ORDER_S.meaning_of_trial() => (ORDER_S.value)(t);
            PRESSES_PER_ORDER.name, PRESSES_PER_ORDER.unit, PRESSES_PER_ORDER.meaning_of_trial() => (PRESSES_PER_ORDER.value)(t);
            PRESS_S.name, PRESS_S.unit, PRESS_S.meaning_of_trial() => (PRESS_S.value)(t);
            "signals", "signals", "signals shown to the participant" => t.signals;
            "duration_s", "s", "duration of the trial, without pauses" => t.seconds;
            "protective_stops", "stops", "protective stops after a contact; empty: a timed arm" => t.robot.arm.as_ref().map(|arm| arm.protective_stops);
            "faults", "stops", "stops because a joint did not follow; empty: a timed arm" => t.robot.arm.as_ref().map(|arm| arm.faults);
            "contacts", "contacts", "contacts of a person with the arm, with or without a protective stop; empty: a timed or a real arm" => t.robot.arm.as_ref().filter(|_| !t.arm.is_real()).map(|arm| arm.contacts);
            "peak_force_n", "N", "largest contact force; empty: a timed arm, or no contact"
                => t.robot.arm.as_ref().and_then(|arm| arm.peak_force_n);
            "reduced_s", "s", "time at reduced speed because of a hand near the arm, on the trial's clock; empty: a timed arm"
                => t.robot.arm.as_ref().map(|arm| arm.reduced_s);
            "safeguard_s", "s", "time of waiting for a hand in the arm's way, on the trial's clock; empty: a timed arm"
                => t.robot.arm.as_ref().map(|arm| arm.safeguard_s);
            "emergency_stops", "stops", "emergency stops of the robot by the wizard" => t.robot.emergency_stops;
        };
        columns.extend(AbortReason::ALL.into_iter().map(given_up));
        columns.extend(columns! { |t: Self|
            "wizard_held", "times", "number of times the wizard held the robot before its next press" => t.robot.held;
            "wizard_skipped", "times", "number of robot presses that the wizard skipped" => t.robot.skipped;
            "wizard_driven", "times", "number of robot presses that the wizard chose" => t.robot.driven;
            "wizard_corrected", "times", "number of locations that the wizard corrected" => t.robot.corrected;
            "useful_signals", "signals", "signals without which a twin of the simulated trial makes more errors about \
                their target (of a proposal: in its next presses); empty: not judged" => t.useful_signals;
            "useless_signals", "signals", "all other signals; empty: not judged"
                => t.useful_signals.map(|useful| t.signals - useful);
            "sequences_any_aspect", "sequences", "error sequences whatever the aspect of their errors; empty as beliefs_from"
                => t.beliefs.as_ref().map(|beliefs| beliefs.lengths_any_aspect.len() as u64);
            "sequence_length_any_aspect", "errors", "mean errors per error sequence whatever the aspect; empty: none"
                => t.beliefs.as_ref().and_then(|beliefs| mean_length(&beliefs.lengths_any_aspect));
            ADDITIONAL_PRESSES.name, ADDITIONAL_PRESSES.unit, ADDITIONAL_PRESSES.meaning_of_trial() => (ADDITIONAL_PRESSES.value)(t);
            "errors_about_orders", "errors", "belief related errors about an order; empty as beliefs_from"
                => t.errors_about(|causes| causes.orders);
            "errors_about_recipes", "errors", "belief related errors about a recipe; empty as beliefs_from"
                => t.errors_about(|causes| causes.recipes);
            "errors_about_order_or_recipe", "errors", "belief related errors about an ordered dish: both order and \
                recipe believed wrong, or unknown which; empty as beliefs_from" => t.errors_about(|causes| causes.order_or_recipe);
            "errors_about_places", "errors", "belief related errors about another location's content; empty as beliefs_from"
                => t.errors_about(|causes| causes.places);
            "offers", "offers", "closed offers that a wizard could see; empty: a recording without offers"
                => t.offers.all.n;
            "offers_taken", "offers", "those whose signal the wizard sent with the key that takes the offer"
                => t.offers.taken;
            "offers_by_own_key", "offers", "those whose signal the wizard sent with the signal's own key"
                => t.offers.by_own_key;
            "offer_stood_s", "s", "median time for which these offers were open; empty: none was" => t.offers.all.median_s;
            "offer_reaction_s", "s", "median time from an offer's opening to either key; empty: neither was pressed" => t.offers.reaction_s;
            "display_arm", "", "how the participant's display showed the robot: none, hand or arm; empty: no display, \
                or none could be shown" => t.display_arm.map(RobotDepiction::name);
            "false_belief_episodes", "episodes", "periods of false belief with at least one error; source in \
                beliefs_from; empty: known by the estimate alone"
                => t.beliefs.as_ref().and_then(|beliefs| beliefs.episodes);
            "raters_same_belief", "errors", "errors that both raters put down to the same false belief; empty: \
                no two raters" => t.shared_beliefs.map(|shared| shared.same);
            "raters_other_belief", "errors", "errors that both put down to a false belief, each to another one; empty: no two raters"
                => t.shared_beliefs.map(|shared| shared.differing);
            "one_rater_belief", "errors", "errors that one of them alone puts down to a false belief; empty: no two raters"
                => t.shared_beliefs.map(|shared| shared.of_one);
            "wizard_hits", "episodes", "episodes with a signal of the wizard in time; empty: no wizard, or episodes not known"
                => t.wizard.as_ref().and_then(|wizard| wizard.hits);
            "wizard_omissions", "episodes", "episodes without one; empty as wizard_hits"
                => t.wizard.as_ref().and_then(|wizard| wizard.omissions);
            "probe_questions", "questions", "questions of probes in the main results: scheduled, about what is, \
                answered in time; empty: no probes" => t.probes.map(|probes| probes.counted);
            PROBES_WRONG.name, PROBES_WRONG.unit, PROBES_WRONG.meaning_of_trial() => (PROBES_WRONG.value)(t);
            "study_arm", "", "arm by what was done: none, wizard, wizard+advice (the wizard saw recommendations), \
                tom-com, tom or dev" => t.study_arm.name();
            "planned_arm", "", "arm under which the trial counts: that of the plan, without a plan that of the \
                settings; differs from study_arm where the trial was carried out otherwise" => t.planned_arm.name();
            "wizard_sees", "", "what the console may show: state (kitchen and gaze), belief (also the estimate) or \
                recommendation (also advice)" => t.wizard_sees.name();
            "signal_contents", "contents", "contents of the signals: a proposal of k presses has k, any other signal \
                one" => t.signal_contents;
            "unproven", "presses", "human presses whose judgement rests on a cost to go that is not proven to be the \
                least" => t.unproven;
            "raters", "", "the two raters, as R1+R2, whose codes or consensus determine the causes of errors; empty: \
                nobody's" => t.raters.as_ref().map(|pair| pair.name());
            "human_model", "", "the assistant's model of the human: its name, and parameters that differ from the \
                named model" => t.human_model.as_str();
            "initiative_presses", "presses", "of robot_presses: those that the robot set out for by its own \
                initiative, since the participant did not press" => t.initiative_presses;
            "display_lost", "times", "times that the participant's display was lost while the trial ran; empty: no \
                display" => t.display_losses.map(|losses| losses.times);
            "display_lost_s", "s", "time for which it was lost, on the trial's clock; empty: no display"
                => t.display_losses.map(|losses| losses.seconds);
        });
        columns
    }
}

fn given_up(reason: AbortReason) -> TableColumn<TrialStatistics> {
    let (name, why) = match reason {
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
    let unknown = if reason.is_of_physics() { "; empty for a timed arm" } else { "" };
    let meaning = format!("aborted robot presses: {why}{unknown}");
    TableColumn::new(format!("given_up_{name}"), "presses", meaning, move |trial: &TrialStatistics| {
        trial.robot.given_up(reason).into()
    })
}
