//! The first sentences of a study's results.

use tomcom_core::measures::raters::BeliefSource;
use tomcom_session::plan::QuestionnaireItemKind;
use tomcom_session::questionnaire::AnswerValue;
use tomcom_study::arm_comparison::ContrastVerdict;
use tomcom_study::headline::{doubts, mixed_sources, primary_outcome};
use tomcom_study::pass::describe;
use tomcom_study::trial_statistics::{QuestionnaireAnswer, TrialStatistics};

use super::{answer, in_arm, page, summary, trials};
use crate::support::*;

#[test]
fn the_first_sentence_is_the_primary_outcome_and_says_no_more_than_its_interval() {
    // The assisted trial of each is the better one by far; or the trials differ by chance.
    let clear = trials(&[[40, 20], [42, 18], [38, 22]], &[[20, 40], [22, 44], [18, 36]]);
    let open = trials(&[[20, 24], [22, 18], [18, 21]], &[[20, 21], [22, 18], [18, 22]]);
    for (trials, verdict) in [(&clear, ""), (&open, "no difference shown: ")] {
        let figures = summary(trials);
        let [sentence] = &primary_outcome(&figures)[..] else { panic!("one contrast") };
        let begins = format!("Primary outcome, errors per 100 presses of the human: {verdict}");
        assert!(sentence.starts_with(&begins), "{sentence}");
        assert_eq!(sentence.contains("no difference shown"), !verdict.is_empty(), "{sentence}");
        // The effect in percent with its interval, and the rates.
        let one = &figures.arms.as_ref().expect("a comparison").contrasts[0];
        let percent =
            |ratio: f64| format!("{:.0} % {}", 100.0 * (ratio - 1.0).abs(), if ratio < 1.0 { "fewer" } else { "more" });
        let [low, high] = one.interval.map(percent);
        let told = format!(
            "{} in wizard trials than in unassisted trials (95 % interval {low} to {high}); of all presses, from ",
            percent(one.ratio)
        );
        assert!(
            sentence.contains(&told) && sentence.contains(&format!("; ratio {:.2}, interval ", one.ratio)),
            "{sentence}"
        );
        // The same words in the terminal and in the report.
        assert!(describe(&figures).contains(sentence) && page(&figures, trials).contains(sentence.as_str()));
    }
    // No errors at all are no percentage, and neither is a ratio of 1.
    let mut none = trials(&[[0, 0]; 3], &[[0, 0]; 3]);
    none.iter_mut().zip(0..).for_each(|(trial, index)| trial.human_presses += index * index);
    let told = primary_outcome(&summary(&none));
    assert!(told.iter().all(|one| one.ends_with(": none in wizard and none in unassisted trials.")), "{told:?}");
    let told = primary_outcome(&summary(&trials(&[[20, 22], [22, 20], [18, 18]], &[[20, 22], [22, 20], [18, 18]])));
    assert!(told[0].contains("shown: about as many in wizard trials as in unassisted trials ("), "{told:?}");
    // With so few participants an interval would reach from almost nothing to a multiple.
    let few = trials(&[[20, 24], [22, 18]], &[[20, 21], [22, 18]]);
    let figures = summary(&few);
    let told = "(4 participants are too few for a test and an interval; at least 6 are needed)";
    let [sentence] = &primary_outcome(&figures)[..] else { panic!("one contrast") };
    assert!(sentence.contains(told) && !sentence.contains("interval "), "{sentence}");
    assert!(page(&figures, &few).contains("unassisted: 4 participants are too few for a test and an interval"));
    let mut one = clear;
    for trial in one.iter_mut().filter(|trial| trial.condition == Condition::Wizard) {
        trial.left_out = Some("excluded: asleep".to_string());
    }
    let told = primary_outcome(&summary(&one));
    let why = "unassisted 20.0; one condition, so nothing is compared: no trial of another one counts; left out: A0-2 (excluded: asleep)";
    assert!(told[0].contains(why) && told[0].ends_with(", and 3 more."), "{told:?}");
    one.retain(TrialStatistics::counts);
    let told = primary_outcome(&summary(&one));
    assert!(told[0].ends_with("nothing is compared: no trial of another one counts."), "{told:?}");
}

/// One participant's many errors weigh in the rates, not in the ratio.
#[test]
fn rates_and_ratio_that_point_two_ways_are_explained_beside_them() {
    let trials = trials(&[[40, 30], [10, 12], [11, 13]], &[[30, 40], [12, 10], [13, 11]]);
    let figures = summary(&trials);
    let [sentence] = &primary_outcome(&figures)[..] else { panic!("one contrast") };
    assert!(
        sentence.contains("2 % more in wizard trials")
            && sentence.contains("from 10.2 in unassisted to 9.2 in wizard trials; ratio 1.02"),
        "{sentence}"
    );
    assert!(
        sentence.contains(". Of wizard to unassisted rates and ratio point two ways: the rates pool"),
        "{sentence}"
    );
    assert!(describe(&figures).contains(sentence) && page(&figures, &trials).contains(sentence.as_str()));
}

/// Hardly an error: the model of logarithms sees half an error more in each trial, and the sentence says so.
#[test]
fn a_ratio_of_few_events_is_called_not_reliable_beside_it() {
    let few = trials(&[[0, 2], [0, 3], [0, 1], [0, 2]], &[[2, 0], [4, 0], [1, 0], [3, 1]]);
    let figures = summary(&few);
    let found = figures.arms.as_ref().expect("a comparison");
    let [one] = &found.contrasts[..] else { panic!("one contrast") };
    let doubt = one.doubt.expect("a doubt");
    assert!(doubt.few_events.is_some_and(|mean| mean < 1.0), "{doubt:?}");
    let [sentence] = &primary_outcome(&figures)[..] else { panic!("one contrast") };
    assert!(sentence.contains(&format!("ratio {:.2} (not reliable: errors are few", one.ratio)), "{sentence}");
    let why = &doubts(found)[0];
    assert!(why.contains("Bolker et al. 2009") && why.contains("the negative binomial model"), "{why}");
    assert!(describe(&figures).contains(why) && page(&figures, &few).contains("not reliable: errors are few"));
    let many = trials(&[[40, 20], [42, 18], [38, 22]], &[[20, 40], [22, 44], [18, 36]]);
    assert_eq!(summary(&many).arms.expect("a comparison").contrasts[0].doubt, None);
}

/// An effect against assistance: estimate and interval are told as "more".
#[test]
fn an_effect_and_its_interval_have_one_direction() {
    let worse =
        trials(&[[10, 20], [12, 18], [11, 22], [9, 12], [14, 19]], &[[20, 10], [15, 14], [18, 16], [21, 12], [13, 12]]);
    let figures = summary(&worse);
    let found = figures.effects[0].reduction.expect("an estimate");
    assert!(found.estimate < 0.0 && found.high.is_finite(), "{found:?}");
    let ends = format!("{:.1} to {:.1} more", -100.0 * found.high, -100.0 * found.low);
    let told = describe(&figures);
    assert!(told.contains(&format!("{:.1} more errors", -100.0 * found.estimate)) && told.contains(&ends), "{told}");
    let page = page(&figures, &worse);
    assert!(page.contains(&format!("%: {}", ends.replace('-', "\u{2212}"))), "{page}");
}

/// Three conditions: one sentence says what their contrasts show together, and no interval contradicts it.
#[test]
fn several_contrasts_are_told_together_and_agree_with_their_intervals() {
    let arms = [StudyArm::None, StudyArm::Wizard, StudyArm::TomCom];
    let study = |rates: [u64; 3]| -> Vec<TrialStatistics> {
        (0..12_u64)
            .flat_map(|person| {
                (0..3_usize).map(move |period| {
                    let which = (period + person as usize) % 3;
                    let errors = rates[which] + (person * 7 + period as u64 * 5) % 9;
                    let trial = in_arm(format!("P{person:02}"), period as u32 + 1, arms[which], errors);
                    TrialStatistics { recording: format!("P{person:02}-{period}"), ..trial }
                })
            })
            .collect()
    };
    let mut verdicts = BTreeSet::new();
    for rates in [[40, 15, 15], [12, 10, 9], [12, 12, 12], [20, 17, 16], [15, 13, 12]] {
        let trials = study(rates);
        let figures = summary(&trials);
        let found = figures.arms.as_ref().expect("a comparison");
        for one in &found.contrasts {
            let spans_one = one.interval[0] < 1.0 && one.interval[1] > 1.0;
            assert_eq!(one.verdict() == ContrastVerdict::Shown, !spans_one, "{one:?}");
            assert!(one.level >= 0.95 - 1e-9 && one.level < 0.984, "{one:?}");
            verdicts.insert(format!("{:?}", one.verdict()));
        }
        let told = primary_outcome(&figures);
        assert_eq!(told.len(), 4, "{told:?}");
        assert!(!told[0].contains("Primary outcome"), "{told:?}");
        // The report begins with the sentence, and shows each condition's rate and picture before all else.
        let page = page(&figures, &trials);
        let at = |words: &str| page.find(words).unwrap_or_else(|| panic!("{words}"));
        assert!(at(&told[0]) < at("class=\"cards\"") && at("class=\"cards\"") < at("Figure\u{a0}1."));
        assert!(at("Figure\u{a0}1.") < at("<nav>") && at("<nav>") < at("Comparison with the paper"));
    }
    let clear = primary_outcome(&summary(&study([40, 15, 15])));
    assert_eq!(
        clear[0],
        "Fewer errors in wizard and in ToM-Com trials than in unassisted trials; no difference shown between ToM-Com and \
         wizard trials."
    );
    assert!(verdicts.contains("Shown") && verdicts.contains("NoDifference"), "{verdicts:?}");
}

#[test]
fn conditions_whose_causes_are_known_from_different_sources_are_not_compared_in_silence() {
    let mut trials = trials(&[[20, 24], [22, 18]], &[[20, 21], [22, 18]]);
    assert_eq!(mixed_sources(&summary(&trials)), None);
    for trial in &mut trials {
        let is_coded = trial.condition == Condition::Wizard;
        trial.beliefs.as_mut().expect("beliefs").basis =
            if is_coded { BeliefSource::Consensus } else { BeliefSource::Estimate };
    }
    let figures = summary(&trials);
    let (words, differs) = mixed_sources(&figures).expect("two sources");
    assert!(differs && words.contains("unassisted: the assistant's estimate in 4 trials"), "{words}");
    assert!(words.contains("wizard: the consensus of two raters in 4 trials; so the conditions"), "{words}");
    let (told, page) = (describe(&figures), page(&figures, &trials));
    assert!(told.contains(&words) && !told.contains("estimate alone"), "{told}");
    assert!(!page.contains("known only as the assistant") && page.contains("Causes of errors are known by"));
    // Half of each: several sources, but alike.
    for (index, trial) in trials.iter_mut().enumerate() {
        trial.beliefs.as_mut().expect("beliefs").basis =
            if index % 4 < 2 { BeliefSource::Consensus } else { BeliefSource::Estimate };
    }
    assert!(mixed_sources(&summary(&trials)).is_some_and(|(_, differs)| !differs));
}

#[test]
fn what_is_asked_before_the_trials_is_the_participants_whatever_becomes_of_the_trial() {
    let mut trials = trials(&[[20, 24]], &[[20, 21]]);
    let age = || answer(QuestionnaireItemKind::Number, AnswerValue::Number(30));
    let answer = |before| QuestionnaireAnswer { before, ..age() };
    trials[0].answers = vec![answer(true), answer(false)];
    let answers = |trials: &[TrialStatistics]| -> Vec<(bool, u64)> {
        let items = summary(trials).questionnaires;
        items.iter().map(|item| (item.condition.is_none(), item.answers)).collect()
    };
    assert_eq!(answers(&trials), [(true, 1), (false, 1)]);
    trials[0].left_out = Some("excluded: the tracker slipped".to_string());
    assert_eq!(answers(&trials), [(true, 1)]);
    // Nobody of whom nothing counts is described.
    trials[1].left_out = Some("excluded: asked for it".to_string());
    assert_eq!(answers(&trials), []);
}
