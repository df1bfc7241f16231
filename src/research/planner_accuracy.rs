//! Command `tomcom-research planner`: accuracy of the planner with its limited budget of rollouts, and its speed compared with the plain reference
//! planner.
//!
//! The planner answers requests for advice after every press, as in a session. At steps spread evenly over the
//! recordings, the planner answers once more with 64 times the rollouts and no early end: the converged answer. The
//! plain reference planner answers at a few of these steps, at default fidelity.

use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;
use tomcom_core::base::text::{count, decimal};
use tomcom_core::communication::Signal;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::kitchen::Kitchen;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_session::Session;
use tomcom_session::advisor::{AdviceRequest, Advisor};
use tomcom_session::files::file_error::FileResult;
use tomcom_session::replay::{RecordingReplay, SameKitchenCheck};
use tomcom_study::gathered::GatheredRecordings;
use tomcom_study::parallel;

use crate::reference::planner::{ReferenceBenefit, ReferencePlanner};

/// Factor by which the converged answer uses more rollouts than the planner in a session.
const CONVERGED: usize = 64;
/// Largest number of rollouts that settings allow.
const MOST_ROLLOUTS: usize = 65_536;
/// The best option counts as clear if its net benefit exceeds the second best by more than this, in presses.
const LEAD: f64 = 0.2;
/// The planner's error is computed only over benefits larger than this, in presses.
const MATTERS: f64 = 0.3;

/// Accuracy of the planner: the output of `tomcom-research planner`. A value is null where no step contributes to it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PlannerAccuracySummary {
    pub steps: u64,
    /// Number of steps at which the best option (a signal or silence) leads by more than 0.2 presses.
    pub clear_steps: u64,
    /// Share of the clear steps at which the planner and its converged answer make the same decision.
    pub same_decision: Option<f64>,
    /// Root mean square error of the planner's benefit, in presses, over pairs of a step and a signal whose converged
    /// benefit exceeds 0.3 presses.
    pub benefit_rmse: Option<f64>,
    /// Number of pairs of a step and a signal from which `benefit_rmse` is computed.
    pub benefit_pairs: u64,
    /// Computing time of the plain reference planner divided by that of the planner, for the same steps.
    pub reference_ratio: Option<f64>,
    pub reference_steps: u64,
    /// Root mean square difference between the benefits of the plain reference and of the converged planner, in
    /// presses, over the signals of the steps that the reference answered.
    pub reference_rmse: Option<f64>,
    /// Part of `reference_rmse` that the reference planner's own standard errors explain, in presses.
    pub reference_error: Option<f64>,
    pub reference_pairs: u64,
    /// Number of the reference planner's steps at which the best option of the converged planner leads by more than 0.2
    /// presses.
    pub reference_clear_steps: u64,
    /// Share of the reference planner's clear steps at which it made the same decision as the converged planner.
    pub reference_same_decision: Option<f64>,
    pub plan_ms: Option<f64>,
    pub reference_ms: Option<f64>,
}

#[derive(Debug)]
struct RecordedAdviceRequests {
    pub session: Session,
    pub questions: Vec<AdviceRequest>,
}

/// A step of a recording: one request for advice, with the benefits of signals that each planner computed for it.
#[derive(Clone, Debug, Default)]
struct ComparedAdviceRequest {
    recording: usize,
    question: usize,
    took_s: f64,
    ours: Vec<(Signal, f64)>,
    converged: Vec<(Signal, f64)>,
    plain: Option<(f64, Vec<ReferenceBenefit>)>,
}

/// Compares planners on the requests for advice in recordings of one kitchen.
#[derive(Debug)]
struct PlannerComparison {
    kitchen: Arc<Kitchen>,
    asked: Vec<RecordedAdviceRequests>,
}

impl PlannerComparison {
    /// At most `most` steps that no planner has answered yet, spread evenly over all requests for advice.
    pub fn spread(&self, most: usize) -> Vec<ComparedAdviceRequest> {
        let all = self.asked.iter().enumerate().flat_map(|(recording, asked)| {
            let step =
                move |question| ComparedAdviceRequest { recording, question, ..ComparedAdviceRequest::default() };
            (0..asked.questions.len()).map(step)
        });
        let all: Vec<ComparedAdviceRequest> = all.collect();
        let chosen = most.min(all.len());
        (0..chosen).map(|index| all[index * all.len() / chosen].clone()).collect()
    }

    /// Lets the planner answer all steps, and the plain reference planner some of them. `done` is called after each
    /// answer of a planner.
    ///
    /// The planner answers after every press on one thread, as in a session, where its cache helps the next answer. The
    /// plain reference planner answers directly after the planner, so that the machine is equally fast for both.
    pub fn answer(&self, steps: &mut [ComparedAdviceRequest], reference_steps: usize, done: impl Fn()) {
        let every = (reference_steps > 0).then(|| steps.len().div_ceil(reference_steps));
        let mut planner = ThreadPlanner::default();
        for (index, step) in steps.iter_mut().enumerate() {
            let (advisor, answered) = planner.advisor(self, step.recording, 1);
            for question in &self.asked[step.recording].questions[*answered..step.question] {
                benefits(advisor, question);
            }
            *answered = step.question + 1;
            let began = Instant::now();
            step.ours = benefits(advisor, self.question(step));
            step.took_s = began.elapsed().as_secs_f64();
            done();
            if every.is_some_and(|every| index % every == 0) {
                step.plain = Some(self.plain(step));
                done();
            }
        }
    }

    /// The step with the converged answer added. Several planners can converge steps in parallel, in any order.
    pub fn converge(&self, planner: &mut ThreadPlanner, step: &ComparedAdviceRequest) -> ComparedAdviceRequest {
        let (advisor, _) = planner.advisor(self, step.recording, CONVERGED);
        ComparedAdviceRequest { converged: benefits(advisor, self.question(step)), ..step.clone() }
    }

    /// The planner's accuracy over steps that were answered and converged. A step's decision is judged by the cost of
    /// communication of its own recording.
    pub fn summary(&self, steps: &[ComparedAdviceRequest]) -> PlannerAccuracySummary {
        let prices: Vec<f64> =
            self.asked.iter().map(|asked| asked.session.spec.assistant.cost_of_communication).collect();
        figures(steps, &prices)
    }

    fn question(&self, step: &ComparedAdviceRequest) -> &AdviceRequest {
        &self.asked[step.recording].questions[step.question]
    }

    /// Computing time of the plain reference planner for a step, in seconds, and the reference's answer.
    fn plain(&self, step: &ComparedAdviceRequest) -> (f64, Vec<ReferenceBenefit>) {
        let session = &self.asked[step.recording].session;
        let (human, assistant) = (session.spec.human.clone(), session.spec.assistant.clone());
        let plain = ReferencePlanner::new(self.kitchen.clone(), human, assistant, session.seed());
        let (question, mut cost) = (self.question(step), CostToGo::new(self.kitchen.clone()));
        let began = Instant::now();
        let worth = plain.advise(&mut cost, &question.moment());
        (began.elapsed().as_secs_f64(), worth)
    }
}

fn benefits(advisor: &mut Advisor, question: &AdviceRequest) -> Vec<(Signal, f64)> {
    let options = advisor.answer(question).options;
    options.into_iter().map(|option| (option.signal, option.benefit)).collect()
}

/// The planner of one thread, made for the recording of the step that it answers.
#[derive(Debug, Default)]
struct ThreadPlanner {
    /// Index of the recording, its planner, and the number of the recording's requests that the planner has answered.
    advisor: Option<(usize, Advisor, usize)>,
}

impl ThreadPlanner {
    /// The planner for a recording's session, with `times` as many rollouts, and the number of requests that this
    /// planner has answered.
    fn advisor(&mut self, bench: &PlannerComparison, recording: usize, times: usize) -> (&mut Advisor, &mut usize) {
        let made = || {
            let mut session = bench.asked[recording].session.clone();
            if times > 1 {
                let rollout = &mut session.spec.assistant.rollout;
                rollout.rollouts = (rollout.rollouts * times).min(MOST_ROLLOUTS);
                rollout.least_rollouts = rollout.rollouts;
            }
            let cost = CostToGo::new(bench.kitchen.clone());
            (recording, Advisor::by(ConceptName::TomCom, &session, cost), 0)
        };
        self.advisor = self.advisor.take().filter(|(other, ..)| *other == recording);
        let (_, advisor, answered) = self.advisor.get_or_insert_with(made);
        (advisor, answered)
    }
}

/// The best option (`None` for silence) given the benefits and the cost of a signal, and how far the best option leads
/// over the second best, in presses.
fn decision(benefits: &[(Signal, f64)], price: f64) -> (Option<&Signal>, f64) {
    let mut net: Vec<(Option<&Signal>, f64)> = benefits.iter().map(|(signal, of)| (Some(signal), of - price)).collect();
    net.push((None, 0.0));
    net.sort_by(|a, b| b.1.total_cmp(&a.1));
    (net[0].0, net[0].1 - net.get(1).map_or(f64::NEG_INFINITY, |second| second.1))
}

/// Sums from which accuracies are computed: differences of benefits, and agreement of decisions.
#[derive(Default)]
struct DecisionAgreement {
    clear: u64,
    same: u64,
    pairs: u64,
    squares: f64,
}

impl DecisionAgreement {
    fn add(&mut self, found: &[(Signal, f64)], converged: &[(Signal, f64)], price: f64) {
        let (best, lead) = decision(converged, price);
        if lead > LEAD {
            self.clear += 1;
            self.same += u64::from(decision(found, price).0 == best);
        }
        for (signal, benefit) in converged.iter().filter(|(_, benefit)| benefit.abs() > MATTERS) {
            if let Some((_, ours)) = found.iter().find(|(other, _)| other == signal) {
                self.pairs += 1;
                self.squares += (ours - benefit).powi(2);
            }
        }
    }

    fn same_decision(&self) -> Option<f64> {
        (self.clear > 0).then(|| self.same as f64 / self.clear as f64)
    }

    fn rmse(&self) -> Option<f64> {
        (self.pairs > 0).then(|| (self.squares / self.pairs as f64).sqrt())
    }
}

/// The planner's accuracy over steps of recordings with these costs of communication, in presses.
fn figures(steps: &[ComparedAdviceRequest], prices: &[f64]) -> PlannerAccuracySummary {
    let (mut ours, mut plain) = (DecisionAgreement::default(), DecisionAgreement::default());
    let (mut of_errors, mut plain_s, mut ours_s, mut reference_steps) = (0.0, 0.0, 0.0, 0u64);
    for step in steps {
        let price = prices[step.recording];
        ours.add(&step.ours, &step.converged, price);
        let Some((took_s, worth)) = &step.plain else { continue };
        let found: Vec<(Signal, f64)> = worth.iter().map(|one| (one.signal.clone(), one.benefit)).collect();
        plain.add(&found, &step.converged, price);
        for (signal, _) in step.converged.iter().filter(|(_, benefit)| benefit.abs() > MATTERS) {
            let error = worth.iter().find(|one| one.signal == *signal).map_or(0.0, |one| one.standard_error);
            of_errors += error * error;
        }
        (plain_s, ours_s, reference_steps) = (plain_s + took_s, ours_s + step.took_s, reference_steps + 1);
    }
    let each = |total_s: f64| (reference_steps > 0).then(|| 1e3 * total_s / reference_steps as f64);
    PlannerAccuracySummary {
        steps: steps.len() as u64,
        clear_steps: ours.clear,
        same_decision: ours.same_decision(),
        benefit_rmse: ours.rmse(),
        benefit_pairs: ours.pairs,
        reference_ratio: (ours_s > 0.0).then(|| plain_s / ours_s),
        reference_steps,
        reference_rmse: plain.rmse(),
        reference_error: (plain.pairs > 0).then(|| (of_errors / plain.pairs as f64).sqrt()),
        reference_pairs: plain.pairs,
        reference_clear_steps: plain.clear,
        reference_same_decision: plain.same_decision(),
        plan_ms: each(ours_s),
        reference_ms: each(plain_s),
    }
}

/// Numbers of steps at which the planner's accuracy is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AccuracyStepCounts {
    pub steps: usize,
    pub reference_steps: usize,
}

/// Compares the planner's answers with more precise ones. `done` is called after each step that a planner has answered.
///
/// # Errors
/// A recording cannot be read or replayed, or the recordings are of different kitchens.
pub fn measure(
    recordings: &GatheredRecordings,
    extent: AccuracyStepCounts,
    done: impl Fn() + Sync,
) -> FileResult<PlannerAccuracySummary> {
    let (mut one_kitchen, mut asked) = (SameKitchenCheck::default(), Vec::new());
    for recording in &recordings.paths {
        let mut replay = RecordingReplay::open(recording)?;
        one_kitchen.admit(recording, &replay.session().kitchen)?;
        asked.push(ask(&mut replay)?);
    }
    let bench = PlannerComparison { kitchen: one_kitchen.kitchen()?, asked };
    let mut steps = bench.spread(extent.steps);
    bench.answer(&mut steps, extent.reference_steps, &done);
    let converge = |planner: &mut ThreadPlanner, step: &ComparedAdviceRequest| bench.converge(planner, step);
    let steps = parallel::each_with(&steps, ThreadPlanner::default, converge, done);
    Ok(bench.summary(&steps))
}

fn ask(replay: &mut RecordingReplay) -> FileResult<RecordedAdviceRequests> {
    let session = replay.log().session();
    let mut questions = Vec::new();
    while let Some(question) = replay.next_question()? {
        questions.push(question);
    }
    Ok(RecordedAdviceRequests { session, questions })
}

pub fn describe(figures: &PlannerAccuracySummary) -> String {
    if figures.benefit_pairs == 0 {
        return format!(
            "{}: at none a signal was worth more than {MATTERS} presses, so nothing can be held against the answer with \
             {CONVERGED} times the rollouts; take more steps (--steps) or recordings\n",
            count(figures.steps, "step", "steps")
        );
    }
    let of_reference = match figures.reference_pairs {
        0 => "no signal was worth enough at them to compare benefits; take more (--reference-steps)".to_string(),
        pairs => format!(
            "benefits off by {} presses over {}, of which its own standard errors explain {}",
            decimal(figures.reference_rmse, 3),
            count(pairs, "pair", "pairs"),
            decimal(figures.reference_error, 3),
        ),
    };
    let mut text = format!(
        "{}: the same decision as with {CONVERGED} times the rollouts at {} of the {} clear ones, benefits off by {} presses \
         (root mean square over {} of step and signal, worth more than {MATTERS})\n",
        count(figures.steps, "step", "steps"),
        decimal(figures.same_decision, 3),
        figures.clear_steps,
        decimal(figures.benefit_rmse, 3),
        count(figures.benefit_pairs, "pair", "pairs"),
    );
    if figures.reference_steps > 0 {
        text += &format!(
            "plain reference on {}: {} times the time ({} ms a step, planner {} ms); the same decision at {} of the {} \
             clear ones, {of_reference}\n",
            count(figures.reference_steps, "step", "steps"),
            decimal(figures.reference_ratio, 0),
            decimal(figures.reference_ms, 1),
            decimal(figures.plan_ms, 2),
            decimal(figures.reference_same_decision, 3),
            figures.reference_clear_steps,
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step of a recording at which the planner and the reference computed the same benefit of one signal.
    fn step(recording: usize, benefit: f64, is_compared: bool) -> ComparedAdviceRequest {
        let signal = Signal::Highlight("counter".to_string());
        let benefits = vec![(signal.clone(), benefit)];
        let plain = is_compared.then(|| (1.0, vec![ReferenceBenefit { signal, benefit, standard_error: 0.0 }]));
        ComparedAdviceRequest { recording, ours: benefits.clone(), converged: benefits, plain, ..Default::default() }
    }

    #[test]
    fn a_step_is_judged_by_the_cost_of_its_own_recording() {
        // A benefit of 1.1 presses leads clearly at a cost of 0.5, not at a cost of 1.
        let steps = [step(0, 1.1, false), step(1, 1.1, false), step(1, 1.1, false)];
        for (prices, clear) in [([0.5, 1.0], 1), ([1.0, 0.5], 2), ([0.5, 0.5], 3)] {
            assert_eq!(figures(&steps, &prices).clear_steps, clear, "at costs of {prices:?}");
        }
    }

    #[test]
    fn the_reference_is_judged_at_clear_steps_only_and_their_number_is_told() {
        let mut other = step(0, 2.0, true);
        other.plain.iter_mut().for_each(|(_, worth)| worth[0].benefit = 0.0);
        let steps = [step(0, 2.0, true), other, step(0, 0.6, true), step(0, 2.0, false)];
        let found = figures(&steps, &[0.5]);
        assert_eq!((found.steps, found.clear_steps, found.same_decision), (4, 3, Some(1.0)));
        assert_eq!((found.reference_steps, found.reference_clear_steps), (3, 2));
        assert_eq!(found.reference_same_decision, Some(0.5));
        let text = describe(&found);
        assert!(text.contains("the same decision at 0.500 of the 2 clear ones"), "{text}");
    }
}
