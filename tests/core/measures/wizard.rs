//! How well a wizard does.

use tomcom_core::kitchen::AspectId;
use tomcom_core::measures::wizard_performance::{
    FalseBeliefPeriod, SignalVerdict, TimeSummary, TrainingCriterion, WizardMeasures, WizardSignal, verdicts,
};

use super::at;

/// A signal about these aspects, so many seconds after the trial's beginning and after a press every two seconds.
fn sent(seconds: f64, aspects: &[u8]) -> WizardSignal {
    let aspects = aspects.iter().map(|&aspect| AspectId(aspect)).collect();
    WizardSignal { clock: at(seconds), press: (seconds / 2.0) as u32, aspects, to_display_ms: None, taken_back: false }
}

#[test]
fn a_wizards_signals_are_held_against_what_was_believed_wrong() {
    let period = |aspect: u8, from: f64, until: f64, errors: u32| FalseBeliefPeriod {
        aspect: AspectId(aspect),
        began: at(from),
        corrected: Some((at(until), (until / 2.0) as u32)),
        errors,
    };
    let mut periods = vec![period(1, 10.0, 30.0, 2), period(2, 20.0, 26.0, 0), period(3, 50.0, 60.0, 1)];
    periods.push(FalseBeliefPeriod { aspect: AspectId(4), began: at(80.0), corrected: None, errors: 1 });
    let signals = [
        (4.0, vec![1], SignalVerdict::Needless),
        (12.5, vec![1], SignalVerdict::Hit { latency_s: 2.5, period: 0 }),
        (14.0, vec![1], SignalVerdict::Again),
        (21.0, vec![2], SignalVerdict::Harmless),
        // An order with its recipe: the one that led to an error counts.
        (22.0, vec![2, 1], SignalVerdict::Again),
        (24.0, vec![5], SignalVerdict::WrongTarget),
        // Right again since two presses; and since too long.
        (34.0, vec![1], SignalVerdict::Late),
        (40.0, vec![1], SignalVerdict::Needless),
        (90.0, vec![4], SignalVerdict::Hit { latency_s: 10.0, period: 3 }),
    ];
    let all: Vec<WizardSignal> = signals.iter().map(|(seconds, aspects, _)| sent(*seconds, aspects)).collect();
    let wanted: Vec<SignalVerdict> = signals.iter().map(|(.., verdict)| *verdict).collect();
    assert_eq!(verdicts(&all, &periods), wanted);
    let found = WizardMeasures::from_signals(&all, Some(&periods));
    assert_eq!(
        (found.episodes, found.hits, found.omissions),
        (Some(3), Some(2), Some(1)),
        "the one of aspect 3 is missed"
    );
    assert_eq!(found.latency_s, TimeSummary::from_times(vec![2.5, 10.0]));
    let counts = [found.repeated, found.late, found.wrong_targets, found.needless, found.harmless];
    assert_eq!(counts, [2, 1, 1, 2, 1].map(Some));
    let named: u64 = counts.iter().flatten().sum::<u64>() + found.hits.unwrap_or(0);
    assert_eq!(named, found.signals, "every signal is one of these");
    // Of people nobody knows.
    let unknown = WizardMeasures::from_signals(&all, None);
    assert_eq!((unknown.signals, unknown.hits, unknown.omissions), (9, None, None));
    // Two of three hit; three of nine wrong.
    let met = |hits: f64, wrong: f64| TrainingCriterion { hits, wrong }.is_met(&found);
    assert!(met(0.66, 0.34) && !met(0.67, 0.34) && !met(0.66, 0.33));
    assert!(
        !TrainingCriterion { hits: 0.0, wrong: 1.0 }.is_met(&WizardMeasures::from_signals(&[], Some(&[]))),
        "nothing to hit"
    );
    let twice = WizardMeasures::sum([&found, &found]);
    assert_eq!((twice.hits, twice.signals), (Some(4), 18));
    assert_eq!(twice.latency_s, Some(TimeSummary { n: 4, median: 6.25, max: 10.0 }));
    assert_eq!(WizardMeasures::sum([&found, &unknown]).hits, None);
    // A signal more or less changes nothing about the others before it.
    for end in 0..all.len() {
        assert_eq!(verdicts(&all[..end], &periods), wanted[..end]);
    }
}
