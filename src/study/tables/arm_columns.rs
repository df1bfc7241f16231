//! Columns of the table of trials about the arms of a study.

use super::trial_column::{TrialColumn, plain};

/// Columns for the arm as carried out, the planned arm, what the wizard could see, the contents of signals, and presses
/// whose judgement is not proven.
pub(super) fn arms() -> Vec<TrialColumn> {
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
