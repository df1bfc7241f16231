//! Section of the study report on robot events other than presses, and on the wizard's interventions in the robot.

use maud::{Markup, Render, html};

use super::elements::{Captions, arm, count, nothing, number, section};
use crate::arm_group::RobotArmTotals;
use crate::figures::StudySummary;
use crate::robot_tally::ArmSafetySummary;
use tomcom_core::base::text;
use tomcom_core::robot::AbortReason;

/// Table of robot statistics with one column per kind of robot arm.
pub(super) fn robot(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let groups = &figures.robot;
    if groups.is_empty() {
        return nothing();
    }
    let row = |what: &str, of: &dyn Fn(&RobotArmTotals) -> String| -> Vec<Markup> {
        std::iter::once(what.render()).chain(groups.iter().map(|group| of(group).render())).collect()
    };
    let felt =
        |what: &str, of: fn(&ArmSafetySummary) -> u64| row(what, &|group| count(group.robot.arm.as_ref().map(of)));
    let seconds = |what: &str, of: fn(&ArmSafetySummary) -> Option<f64>| {
        row(what, &|group| number(group.robot.arm.as_ref().and_then(of), 1))
    };
    let did = |what: &str, of: fn(&RobotArmTotals) -> u64| row(what, &|group| of(group).to_string());
    let mut rows = vec![
        felt("protective stops after a contact", |arm| arm.protective_stops),
        felt("stops because a joint did not follow", |arm| arm.faults),
        felt("contacts with a person", |arm| arm.contacts),
        seconds("largest contact force in N", |arm| arm.peak_force_n),
        seconds("seconds at reduced speed because of a hand nearby", |arm| Some(arm.reduced_s)),
        seconds("seconds of waiting for a hand (safeguard stop)", |arm| Some(arm.safeguard_s)),
        did("emergency stops by the wizard", |group| group.robot.emergency_stops),
    ];
    let occurs = |reason: &AbortReason| groups.iter().any(|group| group.robot.given_up.contains_key(reason));
    rows.extend(AbortReason::ALL.into_iter().filter(occurs).map(|reason| {
        let what = format!("aborted presses: {}", reason.words());
        row(&what, &|group| count(group.robot.given_up(reason)))
    }));
    rows.extend([
        did("times held by the wizard", |group| group.robot.held),
        did("presses skipped by the wizard", |group| group.robot.skipped),
        did("presses chosen by the wizard", |group| group.robot.driven),
        did("locations corrected by the wizard", |group| group.robot.corrected),
    ]);
    let head =
        |group: &RobotArmTotals| format!("{}, {}", arm(group.kind), words::count(group.trials, "trial", "trials"));
    let heads: Vec<String> = std::iter::once("arm".to_string()).chain(groups.iter().map(head)).collect();
    let caption = html! {
        "Sums over trials, pauses included, by arm. A timed arm has no contacts. Values of each trial are in "
        code { "trials.csv" } "."
    };
    section("The robot", captions.table(caption, &heads, &rows))
}
