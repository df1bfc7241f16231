//! The first sentences of a study's results.

use tomcom_core::measures::raters::BeliefSource;
use tomcom_session::plan::QuestionnaireItemKind;
use tomcom_session::questionnaire::AnswerValue;
use tomcom_study::headline::{mixed_sources, primary_outcome};
use tomcom_study::pass::describe;
use tomcom_study::trial_statistics::{AskedItem, QuestionnaireAnswer, TrialStatistics};

use super::{page, summary, trials};
use crate::support::*;

#[test]
fn the_first_sentence_is_the_primary_outcome_and_says_no_more_than_its_interval() {
    // The assisted trial of each is the better one by far; or the trials differ by chance.
    let clear = trials(&[[40, 20], [42, 18], [38, 22]], &[[20, 40], [22, 44], [18, 36]]);
    let open = trials(&[[20, 24], [22, 18], [18, 21]], &[[20, 21], [22, 18], [18, 22]]);
    for (trials, verdict) in
        [(&clear, "fewer in wizard trials than in unassisted trials"), (&open, "no difference shown")]
    {
        let figures = summary(trials);
        let [sentence] = &primary_outcome(&figures)[..] else { panic!("one contrast") };
        assert!(sentence.starts_with("Primary outcome, errors per 100 presses of the human: wizard "), "{sentence}");
        assert!(sentence.contains("95 % interval") && sentence.ends_with(&format!(": {verdict}.")), "{sentence}");
        // The same words in the terminal and in the report.
        assert!(describe(&figures).contains(sentence) && page(&figures, trials).contains(sentence.as_str()));
    }
    let mut one = clear;
    one.retain(|trial| trial.condition == Condition::None);
    let told = primary_outcome(&summary(&one));
    assert!(told[0].ends_with("unassisted 20.0; one condition, so nothing is compared."), "{told:?}");
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
    let asked = AskedItem {
        questionnaire: "demographics".to_string(),
        item: "age".to_string(),
        text: "How old are you?".to_string(),
        about: None,
        reversed: false,
        kind: QuestionnaireItemKind::Number,
    };
    let answer = |before| QuestionnaireAnswer {
        asked: asked.clone(),
        answer: Some(AnswerValue::Number(30)),
        points: None,
        options: Vec::new(),
        share: None,
        before,
        score: None,
    };
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
