//! The study: statistics, what concepts would have prevented, tables and report.

use std::fs;
use std::path::Path;

use csv::Writer;
use serde::Serialize;
use tomcom::base::time::SessionTime;
use tomcom::communication::Sender;
use tomcom::communication::concept::ConceptName;
use tomcom::edge::log::codes;
use tomcom::kitchen::AspectId;
use tomcom::measures::coding::{Code, Codes};
use tomcom::robot::AbortReason;
use tomcom::robot::safety::SafetyMode;
use tomcom::run::codes::CodedRecording;
use tomcom::run::study::reading::{self, AnalysisScope};
use tomcom::session::Event;
use tomcom::session::event::EndReason;
use tomcom::session::settings::{ArmKind, Condition, ParticipantKind};
use tomcom::study::effect::{StudyMeasure, effect, pairs};
use tomcom::study::facts::Facts;
use tomcom::study::figures::StudySummary;
use tomcom::study::prevention::{
    ConceptSignal, FalseBeliefTruth, PressTruth, PreventionCounts, SequenceTruth, TrialTruth,
};
use tomcom::study::report;
use tomcom::study::robot::{ArmSummary, RobotSummary, RobotTally};
use tomcom::study::roc::{SweptTrial, compare};
use tomcom::study::statistics::{hodges_lehmann, mixed_anova, permutation_p};
use tomcom::study::tables::{
    ActionRow, AnswerRow, BeliefRow, CommunicationRow, ConceptRow, DictionaryRow, GazeRow, ParticipantRow, Table,
};
use tomcom::study::trial::{BeliefBasis, BeliefErrors, QuestionnaireAnswer, Trial, arrange};
use tomcom::study::trial_row::{self, TrialRow};

fn near(found: f64, wanted: f64) {
    assert!((found - wanted).abs() < 1e-9 * wanted.abs().max(1.0), "{found} instead of {wanted}");
}

fn at(seconds: f64) -> SessionTime {
    SessionTime::from_secs_f64(seconds)
}

/// A trial of 200 presses of the human with this many errors, three of four of them belief related.
fn trial(participant: &str, period: u32, condition: Condition, errors: u64) -> Trial {
    let related = errors * 3 / 4;
    let lengths = if related > 0 { vec![related as u32] } else { Vec::new() };
    Trial {
        recording: format!("{participant}-{period}"),
        participant: participant.to_string(),
        seed: 1,
        kind: ParticipantKind::Simulated,
        started: None,
        group: Some("AB".to_string()),
        period: Some(period),
        is_planned: true,
        condition,
        left_out: None,
        ended: Some(EndReason::Presses),
        arm: ArmKind::Timed,
        robot: RobotSummary::default(),
        human_presses: 200,
        robot_presses: 100,
        errors,
        races: 0,
        beliefs: Some(BeliefErrors {
            basis: BeliefBasis::Recorded,
            errors: related,
            of_two: 0,
            lengths_by_aspect: lengths.clone(),
            lengths,
            recovery_s: vec![6.0],
            episodes: Some(1),
        }),
        orders: 12,
        order_s: Some(20.0),
        presses_per_order: Some(19.0),
        press_s: Some(1.8),
        signals: 0,
        seconds: 400.0,
        answers: Vec::new(),
        wizard: None,
        lanes: None,
        swept: Vec::new(),
        raters: None,
    }
}

/// Participants with errors in the first and in the second trial; those of the first list are assisted in the second one.
fn trials(assisted_second: &[[u64; 2]], assisted_first: &[[u64; 2]]) -> Vec<Trial> {
    let mut trials = Vec::new();
    for (group, errors) in [assisted_second, assisted_first].into_iter().enumerate() {
        for (index, errors) in errors.iter().enumerate() {
            for period in [1, 2] {
                let assisted = (group == 0) == (period == 2);
                let condition = if assisted { Condition::Wizard } else { Condition::None };
                let code = format!("{}{index}", ["A", "B"][group]);
                trials.push(trial(&code, period, condition, errors[period as usize - 1]));
            }
        }
    }
    arrange(&mut trials);
    trials
}

/// Unequal groups, with ties; the figures are those of pingouin 0.7.0 and SciPy 1.17.1.
#[test]
fn the_assistance_effect_is_that_of_other_programs() {
    let trials = trials(&[[24, 12], [30, 16], [18, 16], [40, 22], [22, 10]], &[[20, 18], [16, 16], [28, 20], [24, 24]]);
    let found = effect(StudyMeasure::ErrorRateHuman, &pairs(&trials, StudyMeasure::ErrorRateHuman), 1);
    assert_eq!(found.groups, [5, 4]);
    let test = found.assistance().expect("a test");
    near(test.f, 7.070008537626539);
    near((test.p * 1e6).round(), 32517.0);
    near((found.by_period.within.expect("a test").f * 1e6).round(), 19738993.0);
    let pearson = found.pearson.expect("a correlation");
    near(pearson.r, 0.7088637838665972);
    near(pearson.p, 0.03251668103330254);
    near(found.permutation_p.expect("a p"), 0.047619047619047616);
    near(found.hedges_g.expect("an effect"), 1.5854907169007093);
    // Half the shift.
    near(found.reduction.expect("an estimate").estimate, 0.0275);
    // Of groups of equal size the paper's coding tests the same.
    let equal: Vec<(usize, [f64; 2])> = pairs(&trials, StudyMeasure::ErrorRateHuman)[1..]
        .iter()
        .map(|p| (usize::from(p.assisted_second), p.values))
        .collect();
    let turned: Vec<(usize, [f64; 2])> =
        equal.iter().map(|&(group, [a, b])| (group, if group == 1 { [a, b] } else { [b, a] })).collect();
    near(mixed_anova(&turned).within.expect("a test").f, mixed_anova(&equal).interaction.expect("a test").f);
}

#[test]
fn what_is_missing_leaves_the_participant_out_of_the_pairs_and_nothing_is_invented() {
    let mut trials = trials(&[[24, 12], [30, 16]], &[[20, 18], [16, 16]]);
    trials[0].left_out = Some("excluded: the tracker slipped".to_string());
    assert_eq!(pairs(&trials, StudyMeasure::ErrorRateHuman).len(), 3);
    let figures = StudySummary::from_trials(&trials, &Facts::default(), 0);
    assert_eq!((figures.trials, figures.participants, figures.left_out.len()), (7, 4, 1));
    // A second trial that was done again counts as it was done the last time.
    let mut again = trial("A1", 2, Condition::Wizard, 2);
    again.recording = "A1-2-again".to_string();
    trials.push(again);
    arrange(&mut trials);
    let pair =
        pairs(&trials, StudyMeasure::ErrorRateHuman).into_iter().find(|pair| pair.participant == "A1").expect("a pair");
    near(pair.values[1], 0.01);
    let nobody = StudySummary::from_trials(&[], &Facts::default(), 0);
    assert!(nobody.anova.is_none() && nobody.pearson.is_none() && nobody.permutation_p.is_none());
    assert!(nobody.totals.error_rate.is_none() && nobody.totals.belief_related_share.is_none());
    assert_eq!((permutation_p(&[], &[1.0], 1), hodges_lehmann(&[], &[1.0], 0.95)), (None, None));
}

/// Errors at presses 3, 4, 5 of ten, a second apart, because of an aspect that is false from 2.5 to 7.5 s.
fn truth() -> TrialTruth {
    let (harmful, harmless) = (AspectId(0), AspectId(1));
    let error = |index: usize| (3..=5).contains(&index);
    TrialTruth {
        presses: (0..10)
            .map(|i| PressTruth { time: at(i as f64), error: error(i) || i == 9, related: error(i) })
            .collect(),
        spells: vec![
            FalseBeliefTruth { aspect: harmful, began: at(2.5), ended: Some(at(7.5)), harmful: true },
            FalseBeliefTruth { aspect: harmless, began: at(8.5), ended: None, harmful: false },
        ],
        sequences: vec![SequenceTruth { aspects: vec![harmful], errors: vec![at(3.0), at(4.0), at(5.0)] }],
    }
}

fn sent(seconds: f64, aspect: u8) -> ConceptSignal {
    ConceptSignal { time: at(seconds), press: seconds as usize + 1, aspects: vec![AspectId(aspect)] }
}

#[test]
fn a_signal_prevents_the_rest_of_its_sequence() {
    let truth = truth();
    let silent = truth.count_signals(&[]);
    let outside = 5;
    assert_eq!(silent, PreventionCounts { presses: 10, related: 3, outside, ..PreventionCounts::default() });
    let counted = |sent: &[ConceptSignal]| truth.count_signals(sent);
    // Before the first error the whole sequence, after it the rest, after the last nothing.
    assert_eq!(counted(&[sent(2.6, 0)]).prevented, 3);
    assert_eq!(counted(&[sent(3.0, 0)]).prevented, 2);
    assert_eq!(counted(&[sent(3.0, 0), sent(4.0, 0)]).prevented, 2);
    assert_eq!(counted(&[sent(6.0, 0)]).prevented, 0);
    // Before the belief was false it is a false positive and prevents nothing.
    let early = counted(&[sent(0.5, 0)]);
    assert_eq!((early.prevented, early.false_presses, early.signals), (0, 1, 1));
    // About something else that is believed right, during an episode.
    let beside = counted(&[sent(4.0, 2)]);
    assert_eq!((beside.prevented, beside.false_presses, beside.false_inside), (0, 0, 1));
    // About what is wrong and does no harm.
    let harmless = counted(&[sent(8.6, 1)]);
    assert_eq!((harmless.harmless, harmless.false_presses), (1, 0));
    // Two false signals before the same press are one false press.
    assert_eq!(counted(&[sent(0.2, 0), sent(0.4, 1)]).false_presses, 1);
}

#[test]
fn a_proposal_spares_the_errors_of_the_next_presses() {
    let counts: Vec<[u64; 3]> = (1..=3)
        .map(|k| truth().count_proposals(k))
        .map(|count| [count.signals, count.prevented, count.false_presses])
        .collect();
    // Of one press: at 3 (sparing 4), at 5 (sparing 6), at 9. Press 8 is outside of episodes, but nothing is proposed for it.
    assert_eq!(counts, [[3, 1, 0], [4, 2, 0], [6, 2, 0]]);
}

#[test]
fn concepts_are_compared_where_they_say_equally_much() {
    let swept = |concept, parameter, signals, prevented, false_presses| SweptTrial {
        concept,
        parameter,
        count: PreventionCounts {
            presses: 100,
            signals,
            related: 10,
            prevented,
            outside: 50,
            false_presses,
            ..PreventionCounts::default()
        },
    };
    let participant = vec![
        swept(ConceptName::TomCom, 1.0, 4, 5, 1),
        swept(ConceptName::TomCom, 0.5, 8, 7, 5),
        swept(ConceptName::Tom, 0.9, 8, 4, 5),
        swept(ConceptName::Tom, 0.4, 16, 6, 10),
        swept(ConceptName::Dev, 1.0, 10, 2, 10),
    ];
    let found = compare(&[participant.clone(), participant], 2, 1);
    near(found.common_fpr.expect("a range"), 0.1);
    let at_equal = |concept: usize| -> Vec<f64> {
        found.concepts[concept].at_equal_signals.iter().map(|one| one.value.expect("a value")).collect()
    };
    // Straight lines from silence to the first point and from point to point.
    for (found, wanted) in at_equal(0).into_iter().zip([0.25, 0.5, 0.6, 0.7]) {
        near(found, wanted);
    }
    for (found, wanted) in at_equal(2).into_iter().zip([0.04, 0.08, 0.12, 0.16]) {
        near(found, wanted);
    }
    // From (0, 0) over (0.02, 0.5) to (0.1, 0.7).
    near(found.concepts[0].auc.expect("an area"), (0.5 * 0.02 * 0.5 + 0.08 * 0.6) / 0.1);
    // Two equal participants leave no doubt.
    let banded = found.concepts[0].behind_first[1];
    assert_eq!((banded.low, banded.high), (banded.value, banded.value));
}

/// The names of the fields of a row, as they are written.
fn columns(row: &impl Serialize) -> Vec<String> {
    let mut out = Writer::from_writer(Vec::new());
    out.serialize(row).expect("a flat row");
    let text = String::from_utf8(out.into_inner().expect("bytes")).expect("text");
    text.lines().next().unwrap_or_default().split(',').map(str::to_string).collect()
}

#[test]
fn the_dictionary_says_what_every_column_means() {
    let of_table = |table: Table| match table {
        Table::Participants => columns(&ParticipantRow::default()),
        Table::Trials => columns(&TrialRow::default()),
        Table::Questionnaires => columns(&AnswerRow::default()),
        Table::Concepts => columns(&ConceptRow::default()),
        Table::Actions => columns(&ActionRow::default()),
        Table::Communications => columns(&CommunicationRow::default()),
        Table::Beliefs => columns(&BeliefRow::default()),
        Table::Gaze => columns(&GazeRow::default()),
        Table::Dictionary => columns(&DictionaryRow { table: "", column: "", unit: "", meaning: "" }),
    };
    for table in Table::ALL {
        assert_eq!(of_table(table), table.columns().collect::<Vec<_>>(), "{}", table.name());
    }
}

#[test]
fn the_report_says_who_took_part_and_needs_nothing_beside_it() {
    let mut trials = trials(&[[24, 12], [30, 16], [18, 16]], &[[20, 18], [16, 16], [28, 20]]);
    trials[3].left_out = Some("excluded: <b> & \"quoted\"".to_string());
    for (index, answer) in [Some(1), Some(3), None].into_iter().enumerate() {
        let assisted = trials.iter_mut().filter(|trial| trial.is_assisted() && trial.counts()).nth(index);
        assisted.expect("a trial").answers.push(QuestionnaireAnswer {
            questionnaire: "acceptance".to_string(),
            item: "annoyed".to_string(),
            text: "The signals annoyed me.".to_string(),
            about: Some("acceptance".to_string()),
            reversed: true,
            answer,
            points: 7,
        });
    }
    let figures = StudySummary::from_trials(&trials, &Facts::default(), 0);
    let accepted = figures.acceptance.clone().expect("answers");
    assert_eq!((accepted.high, accepted.medium, accepted.undecided, accepted.not_reported), (1, 1, 0, 1));
    let page = report::page(&figures, &trials, &Facts::default(), &Table::ALL);
    assert!(page.contains("<title>No kitchen: a study of simulated participants</title>"));
    assert!(page.contains("excluded: &lt;b&gt; &amp; &quot;quoted&quot;"), "reasons are told, and no markup");
    for outside in ["<script", "http:", "https:", "url(", "<link", "<img"] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(!page.contains("NaN") && !page.contains("inf "));
    let people: Vec<Trial> =
        trials.into_iter().map(|trial| Trial { kind: ParticipantKind::Display, ..trial }).collect();
    let page = report::page(
        &StudySummary::from_trials(&people, &Facts::default(), 0),
        &people,
        &Facts::default(),
        &Table::ALL,
    );
    assert!(!page.contains("simulated participants</title>"));
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
        (11.0, Event::TrialEnded { reason: EndReason::Wizard }, true),
        (11.0, Event::RobotStopped, false),
    ];
    let figures_of = |arm| {
        let mut tally = RobotTally::new(arm);
        events.iter().for_each(|(clock, event, was_on)| tally.note(event, at(*clock), *was_on));
        assert_eq!(tally.ended, Some(EndReason::Wizard));
        tally.into_figures()
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
    let row = trial_row::row(&Trial { robot: figures_of(ArmKind::Timed), ..trial("A0", 1, Condition::None, 4) });
    assert_eq!((row.contacts, row.peak_force_n, row.reduced_s, row.given_up_no_click), (None, None, None, None));
    assert_eq!((row.ended, row.arm, row.given_up_skipped), (Some("presses"), "timed", Some(1)));
}

#[test]
fn methods_tell_how_trials_ended_with_which_arm_and_what_was_computed() {
    let mut trials = trials(&[[24, 12], [30, 16]], &[[20, 18]]);
    let report = |trials: &[Trial], tables: &[Table]| {
        report::page(&StudySummary::from_trials(trials, &Facts::default(), 0), trials, &Facts::default(), tables)
    };
    let page = report(&trials, &[Table::Trials]);
    assert!(page.contains("6 with the presses.") && page.contains("arm was timed."));
    assert!(
        !page.contains("what each concept would have") && page.contains("Beside this page: <code>trials.csv</code>.")
    );
    trials[1].ended = Some(EndReason::Wizard);
    trials[2].ended = Some(EndReason::Time);
    trials[2].arm = ArmKind::Physics;
    trials[2].robot.arm = Some(ArmSummary { contacts: 3, peak_force_n: Some(17.25), ..ArmSummary::default() });
    let count = PreventionCounts {
        presses: 100,
        signals: 4,
        related: 10,
        prevented: 5,
        outside: 50,
        ..PreventionCounts::default()
    };
    trials[0].swept = vec![SweptTrial { concept: ConceptName::TomCom, parameter: 1.0, count }];
    let page = report(&trials, &Table::ALL);
    assert!(page.contains("4 with the presses, 1 as the time was over, 1 as the wizard ended it before."));
    assert!(page.contains("timed in 5 trials and simulated in the physics in 1 trial; the figures pool them."));
    assert!(page.contains("what each concept would have said were computed anew"));
    assert!(
        page.contains("<td>contacts with somebody</td><td>\u{2013}</td><td>3</td>") && page.contains("<td>17.2</td>")
    );
}

/// Of people it is estimated what they believed, until two raters have coded every error.
#[test]
fn two_raters_say_why_people_erred() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("study-raters");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    fs::copy("tests/golden/format-1-hand.jsonl", folder.join("events.jsonl")).expect("a recording");
    let extent = AnalysisScope { concepts: false, events: true };
    let read = || match reading::read(&folder, "hand", extent) {
        Ok(Some((_, reading))) => reading,
        Ok(None) => panic!("it is no practice"),
        Err(error) => panic!("{error}"),
    };
    let basis = |trial: &Trial| trial.beliefs.as_ref().map(|beliefs| beliefs.basis);
    let estimated = read();
    assert_eq!(basis(&estimated.trial), Some(BeliefBasis::Estimate));
    let errors = CodedRecording::open(&folder).expect("a recording").codable.errors;
    assert!(errors.len() as u64 == estimated.trial.errors && errors.len() >= 2, "{errors:?}");
    let belief = |place: &str| Code::Belief(place.to_string());
    let say = |rater: &str, of: &dyn Fn(usize) -> Code, count: usize| {
        let said = errors.iter().take(count).enumerate().map(|(index, &press)| (press, of(index)));
        codes::write(&folder, rater, &Codes(said.collect())).expect("a file");
    };
    // One of them is not done yet.
    say("anna", &|_| belief("assembly_board"), errors.len());
    say("ben", &|_| belief("plate"), errors.len() - 1);
    assert_eq!(basis(&read().trial), Some(BeliefBasis::Estimate));
    // They agree that all but the first come of false beliefs, though not about which.
    say("ben", &|index| if index == 0 { Code::Slip } else { belief("plate") }, errors.len());
    let coded = read();
    assert_eq!(basis(&coded.trial), Some(BeliefBasis::Raters));
    let related = errors.len() as u64 - 1;
    assert_eq!(coded.trial.beliefs.as_ref().map(|beliefs| beliefs.errors), Some(related));
    let figures = StudySummary::from_trials(&[coded.trial], &coded.facts, 0);
    let agreement = figures.raters.expect("an agreement");
    assert_eq!((agreement.errors, agreement.same_cause, agreement.same_aspect), (related + 1, related, 0));
    let actions = String::from_utf8(coded.rows[0].clone()).expect("text");
    assert_eq!(
        actions.lines().filter(|line| line.contains("belief assembly_board,belief plate")).count() as u64,
        related
    );
}
