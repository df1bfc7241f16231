//! Errors that communications would have prevented, and concepts compared.

use tomcom::communication::concept::ConceptName;
use tomcom::kitchen::AspectId;
use tomcom::study::prevention::{
    ConceptSignal, FalseBeliefTruth, PressTruth, PreventionCounts, SequenceTruth, TrialTruth,
};
use tomcom::study::roc::{SweptTrial, compare};

use super::{at, near};

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
