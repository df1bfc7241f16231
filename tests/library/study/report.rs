//! The report: participants, robot, methods, raters.

use tomcom_core::communication::offer::{Offer, OfferCloseReason, OfferKeyKind, OfferUse, OfferedAdvice};
use tomcom_core::measures::raters::{BeliefSource, ErrorCauseCode, RaterCodes, RaterConsensus};
use tomcom_core::robot::{AbortReason, SafetyMode};
use tomcom_session::log::{consensus_file, rater_codes};
use tomcom_session::plan::QuestionnaireItemKind;
use tomcom_session::questionnaire::AnswerValue;
use tomcom_study::analysis::offer_summary::TimedOffer;
use tomcom_study::codes::CodedRecording;
use tomcom_study::column::{CsvTable, TableCell};
use tomcom_study::facts::RecordingFacts;
use tomcom_study::figures::StudySummary;
use tomcom_study::pass::describe;
use tomcom_study::prevention::PreventionCounts;
use tomcom_study::report;
use tomcom_study::robot_tally::{ArmSafetySummary, RobotEventTally};
use tomcom_study::roc::ConceptPreventionCounts;
use tomcom_study::trial_statistics::{AskedItem, DetailTotals, QuestionnaireAnswer, TrialDetails, TrialStatistics};

use super::{at, cell, near, read, record_person, summary, trial, trials, with_details};
use crate::support::*;

#[test]
fn the_report_says_who_took_part_and_needs_nothing_beside_it() {
    let mut trials = trials(&[[24, 12], [30, 16], [18, 16]], &[[20, 18], [16, 16], [28, 20]]);
    trials[3].left_out = Some("excluded: <b> & \"quoted\"".to_string());
    for (index, answer) in [Some(1), Some(3), None].into_iter().enumerate() {
        let assisted = trials.iter_mut().filter(|trial| trial.is_assisted() && trial.counts()).nth(index);
        let given = super::answer(QuestionnaireItemKind::Scale, AnswerValue::Number(0));
        assisted.expect("a trial").answers.push(QuestionnaireAnswer {
            asked: AskedItem { about: Some("acceptance".to_string()), reversed: true, ..given.asked.clone() },
            answer: answer.map(AnswerValue::from),
            points: Some(7),
            share: answer.map(|answer: u8| 1.0 - f64::from(answer - 1) / 6.0),
            ..given
        });
    }
    let figures = summary(&trials);
    let accepted = figures.acceptance.clone().expect("answers");
    assert_eq!((accepted.high, accepted.medium, accepted.undecided, accepted.not_reported), (1, 1, 0, 1));
    let page = super::page(&figures, &trials);
    assert!(page.contains("<title>A study of simulated participants</title>"));
    let mut names: Vec<&str> = trials.iter().map(|trial| trial.participant.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(report::participants_of_page(&page), Some(names), "the head says whom it is about");
    assert_eq!(report::participants_of_page("<html><head></head></html>"), None);
    assert!(page.contains("excluded: &lt;b&gt; &amp; &quot;quoted&quot;"), "reasons are told, and no markup");
    for outside in ["<script", "http:", "https:", "url(", "<link", "<img"] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(!page.contains("NaN") && !page.contains("inf "));
    let people: Vec<TrialStatistics> =
        trials.into_iter().map(|trial| TrialStatistics { kind: ParticipantKind::Display, ..trial }).collect();
    let page = super::page(&summary(&people), &people);
    assert!(!page.contains("simulated participants</title>"));
}

/// With fewer than eight participants r and p stand in the tables only, and the card says why.
#[test]
fn few_participants_have_no_r_among_the_main_results() {
    let card = |participants: usize| {
        let errors: Vec<[u64; 2]> =
            (0..participants as u64 / 2).map(|index| [24 + index, 12 + index * index]).collect();
        let trials = trials(&errors, &errors);
        let summary = summary(&trials);
        let page = super::page(&summary, &trials);
        assert!(!page.contains("&lt; 0.001"), "p < 0.001 is not broken over two lines");
        page.split("class=\"card\"").nth(4).expect("four cards").split("</div>").next().expect("a card").to_string()
    };
    let few = card(6);
    assert!(
        few.contains("secondary")
            && few.contains("6 participants with both trials are fewer than 8")
            && !few.contains("r\u{a0}="),
        "{few}"
    );
    let enough = card(8);
    assert!(
        enough.contains("r\u{a0}=") && enough.contains("secondary, the paper") && !enough.contains("fewer than"),
        "{enough}"
    );
}

/// Of an arm in the physics: slowed from 2 to 5 s, touched twice, stopped by the second contact, resumed, stopped by hand.
#[test]
fn what_the_robot_did_is_counted_while_the_trial_is_on() {
    let safety = |mode, force_n| Event::RobotSafety { mode, force_n, joint: None };
    let aborts = |reason| Event::RobotAborts { button: "rice".to_string(), reason };
    let (wizard, assistant) = (Sender::Wizard, Sender::Assistant);
    let events = [
        (0.0, Event::RobotStopped, false),
        (0.0, Event::RobotTouched { force_n: 90.0 }, false),
        (2.0, safety(SafetyMode::Reduced, None), true),
        (4.0, Event::RobotTouched { force_n: 12.0 }, true),
        (5.0, safety(SafetyMode::Safeguard, None), true),
        (6.5, safety(SafetyMode::ProtectiveStop, Some(31.0)), true),
        (6.5, Event::RobotTouched { force_n: 31.0 }, true),
        (6.5, aborts(AbortReason::Contact), true),
        (9.0, safety(SafetyMode::Normal, None), true),
        (9.0, Event::RobotHeld { by: wizard }, true),
        (9.5, Event::RobotSkipped { by: wizard }, true),
        (9.5, Event::RobotSkipped { by: assistant }, true),
        (9.5, aborts(AbortReason::Skipped), true),
        (10.0, Event::RobotStopped, true),
        (11.0, Event::TrialEnded { reason: TrialEndReason::Wizard }, true),
        (11.0, Event::RobotStopped, false),
    ];
    let figures_of = |arm| {
        let mut tally = RobotEventTally::new(arm);
        events.iter().for_each(|(clock, event, was_on)| tally.note(event, at(*clock), *was_on));
        assert_eq!(tally.ended, Some(TrialEndReason::Wizard));
        tally.figures
    };
    let found = figures_of(ArmKind::Physics);
    let arm = found.arm.clone().expect("an arm that feels");
    assert_eq!((arm.protective_stops, arm.faults, arm.contacts, arm.peak_force_n), (1, 0, 2, Some(31.0)));
    near(arm.reduced_s, 3.0);
    near(arm.safeguard_s, 1.5);
    assert_eq!((found.emergency_stops, found.held, found.skipped, found.driven, found.corrected), (1, 1, 1, 0, 0));
    let given_up = [AbortReason::Contact, AbortReason::Skipped, AbortReason::NoClick].map(|why| found.given_up(why));
    assert_eq!(given_up, [Some(1), Some(1), Some(0)]);
    // A timed arm feels nothing: that is unknown, and not nought.
    let trial = TrialStatistics { robot: figures_of(ArmKind::Timed), ..trial("A0", 1, Condition::None, 4) };
    let cell = |name: &str| cell(&trial, name);
    for unknown in ["contacts", "peak_force_n", "reduced_s", "given_up_no_click"] {
        assert_eq!(cell(unknown), TableCell::Unknown, "{unknown}");
    }
    assert_eq!(["ended", "arm", "given_up_skipped"].map(cell), ["presses".into(), "timed".into(), 1u64.into()]);
}

#[test]
fn methods_tell_how_trials_ended_with_which_arm_and_what_was_computed() {
    let mut trials = trials(&[[24, 12], [30, 16]], &[[20, 18]]);
    let report = |trials: &[TrialStatistics], details: DetailTotals, tables: &[CsvTable]| {
        report::page(&with_details(trials, details), trials, &RecordingFacts::default(), tables)
    };
    let page = report(&trials, DetailTotals::default(), &[CsvTable::Trials]);
    assert!(page.contains("6 after the set number of presses.") && page.contains("arm was timed."));
    assert!(
        !page.contains("hypothetical signals of each concept")
            && page.contains("Beside this page: <code>trials.csv</code>.")
    );
    trials[1].ended = Some(TrialEndReason::Wizard);
    trials[2].ended = Some(TrialEndReason::Time);
    trials[2].arm = ArmKind::Physics;
    trials[2].robot.arm =
        Some(ArmSafetySummary { contacts: 3, peak_force_n: Some(17.25), ..ArmSafetySummary::default() });
    let count = PreventionCounts {
        presses: 100,
        signals: 4,
        related: 10,
        prevented: 5,
        outside: 50,
        ..PreventionCounts::default()
    };
    let mut details = DetailTotals::default();
    let swept = vec![ConceptPreventionCounts { concept: ConceptName::TomCom, parameter: 1.0, count }];
    details.add(&trials[0], TrialDetails { swept, ..TrialDetails::default() });
    let page = report(&trials, details, CsvTable::ALL);
    assert!(page.contains("4 after the set number of presses, 1 after the set time, 1 early by the wizard."));
    assert!(page.contains("timed in 5 trials and simulated with contact forces in 1 trial; the statistics pool them."));
    assert!(page.contains("the hypothetical signals of each concept were recomputed"));
    let unknown = "<span class=\"unknown\" title=\"a timed arm feels nothing\">\u{2013}</span>";
    assert!(page.contains(&format!("<td>contacts with a person</td><td>{unknown}</td><td>3</td>")), "{page}");
    assert!(page.contains(" \u{2013}:\u{a0}a timed arm feels nothing.") && page.contains("<td>17.2</td>"), "{page}");
}

/// Of people it is estimated what they believed, until two raters have coded every error.
#[test]
fn two_raters_say_why_people_erred() {
    let folder = empty_folder("study-raters");
    record_person(&folder);
    let read = || read(&folder, "hand");
    let basis = |trial: &TrialStatistics| trial.beliefs.as_ref().map(|beliefs| beliefs.basis);
    let estimated = read();
    assert_eq!(basis(&estimated.trial), Some(BeliefSource::Estimate));
    let errors = CodedRecording::open(&folder).expect("a recording").codable.errors;
    assert!(errors.len() as u64 == estimated.trial.errors && errors.len() >= 2, "{errors:?}");
    let belief = |place: &str| ErrorCauseCode::Belief(place.to_string());
    let say = |rater: &str, of: &dyn Fn(usize) -> ErrorCauseCode, count: usize| {
        let said = errors.iter().take(count).enumerate().map(|(index, &press)| (press, of(index)));
        rater_codes::write(&folder, rater, &RaterCodes(said.collect())).expect("a file");
    };
    // One of them is not done yet.
    say("anna", &|_| belief("assembly_board"), errors.len());
    say("ben", &|_| belief("plate"), errors.len() - 1);
    assert_eq!(basis(&read().trial), Some(BeliefSource::Estimate));
    // They agree that all but the first come of false beliefs, though not about which.
    say("ben", &|index| if index == 0 { ErrorCauseCode::Slip } else { belief("plate") }, errors.len());
    let coded = read();
    assert_eq!(basis(&coded.trial), Some(BeliefSource::Raters));
    let related = errors.len() as u64 - 1;
    assert_eq!(coded.trial.beliefs.as_ref().map(|beliefs| beliefs.errors), Some(related));
    let figures = StudySummary::from_trials(&[coded.trial], DetailTotals::default(), &coded.facts, 0);
    let agreement = figures.raters.expect("an agreement");
    assert_eq!((agreement.errors, agreement.same_cause, agreement.same_aspect), (related + 1, related, 0));
    let actions = String::from_utf8(coded.rows[0].clone()).expect("text");
    assert_eq!(
        actions.lines().filter(|line| line.contains("belief assembly_board,belief plate")).count() as u64,
        related
    );
}

#[test]
fn what_was_offered_stands_beside_what_the_wizard_did() {
    let offer = |seq: u64, stood_s: f64, how: Option<OfferKeyKind>, reason| {
        let opened = at(10.0 * seq as f64);
        let sent = how.map(|_| opened + at(stood_s));
        let what = Signal::ShowRecipe("order_1".to_string());
        let advice = OfferedAdvice { what, for_seq: 1, worth: None, reason: None, words: None, visible: true };
        TimedOffer {
            offer: Offer { seq, opened, used: how.zip(sent).map(|(how, at)| OfferUse { how, at }), advice },
            opened_s: opened.as_secs_f64(),
            stood_s: Some(stood_s),
            reason: Some(reason),
            sent,
            reaction_s: how.map(|_| stood_s),
        }
    };
    let trials = trials(&[[12, 5]], &[[9, 15]]);
    let offers = vec![
        offer(1, 3.0, Some(OfferKeyKind::Taken), OfferCloseReason::Taken),
        offer(2, 2.0, Some(OfferKeyKind::OwnKey), OfferCloseReason::OwnKey),
        offer(3, 8.0, None, OfferCloseReason::Fell),
    ];
    let wizards = trials.iter().find(|trial| trial.condition == Condition::Wizard).expect("a wizard's trial");
    let mut details = DetailTotals::default();
    details.add(wizards, TrialDetails { offers, ..TrialDetails::default() });
    let figures = with_details(&trials, details);
    let page = super::page(&figures, &trials);
    for words in [
        "The wizard saw 3 offers, which stood 3.0 s in the median, 2.0 s at least",
        "1 taken, 1 sent by its own key, 1 no longer worth it",
        "The signal of 2 was sent, 2.5 s after its opening in the median: of 1 by the key of the offer, of 1 by",
    ] {
        assert!(page.contains(words), "{words} is missing:\n{page}");
    }
}

/// What two raters settled says why people erred, and their agreement stays that of their own codes.
#[test]
fn the_consensus_of_two_raters_says_why_people_erred_until_one_changes_a_code() {
    let folder = empty_folder("study-consensus");
    record_person(&folder);
    let read = || read(&folder, "hand");
    let errors = CodedRecording::open(&folder).expect("a recording").codable.errors;
    let all = |code: ErrorCauseCode| RaterCodes(errors.iter().map(|press| (*press, code.clone())).collect());
    let (slips, beliefs) = (all(ErrorCauseCode::Slip), all(ErrorCauseCode::Belief("assembly_board".to_string())));
    rater_codes::write(&folder, "anna", &slips).expect("a file");
    rater_codes::write(&folder, "ben", &beliefs).expect("a file");
    let decided = RaterCodes(beliefs.0.clone().into_iter().skip(1).collect());
    let settle = |decided: &RaterCodes| {
        let settled = RaterConsensus::new("anna", "ben").with_decided(decided, [&slips, &beliefs]);
        consensus_file::write(&folder, &settled).expect("a file");
    };
    settle(&decided);
    let basis = |trial: &TrialStatistics| trial.beliefs.as_ref().map(|beliefs| (beliefs.basis, beliefs.errors));
    assert_eq!(basis(&read().trial), Some((BeliefSource::Raters, 0)), "one error is not settled");
    settle(&beliefs);
    let settled = read();
    assert_eq!(basis(&settled.trial), Some((BeliefSource::Consensus, errors.len() as u64)));
    let rows = String::from_utf8(settled.rows[0].clone()).expect("text");
    assert!(
        rows.lines().any(|row| row.contains("slip,belief assembly_board,") && row.contains(",belief assembly_board,"))
    );
    let figures = StudySummary::from_trials(&[settled.trial], DetailTotals::default(), &settled.facts, 0);
    assert_eq!(figures.consensus, [("anna+ben".to_string(), 1)].into());
    let agreement = figures.raters.as_ref().expect("the raters' own agreement");
    assert_eq!((agreement.errors, agreement.same_cause), (errors.len() as u64, 0));
    assert!(describe(&figures).contains("codes of errors: consensus of anna and ben in 1 trial"));

    rater_codes::write(&folder, "ben", &all(ErrorCauseCode::Race)).expect("a file");
    let stale = read();
    assert_eq!(basis(&stale.trial), Some((BeliefSource::Raters, 0)));
    let figures = StudySummary::from_trials(&[stale.trial], DetailTotals::default(), &stale.facts, 0);
    assert!(figures.stale_consensus[0].reason.starts_with("ben changed the code of error 1"));
    assert!(describe(&figures).contains("stale consensus of raters, not used: hand: ben changed"));
}
