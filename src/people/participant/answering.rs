//! How a simulated participant answers the questions of a freeze probe: with the value that is most probable in the
//! participant's belief.

use rand::RngExt;

use super::draws::{chance, normal};
use super::simulated::SimulatedParticipant;
use super::witness;
use tomcom_core::base::rng::{Stream, stream};
use tomcom_core::kitchen::{AspectId, LocationId, State};
use tomcom_core::mind::RecordedBelief;

/// Standard deviation of the logarithm of one participant's answering times.
const ANSWER_JITTER: f64 = 0.35;
/// Least probabilities of the most probable value from which the confidence in an answer is 2 or 3 (of 3).
const SURE_FROM: [f64; 2] = [2.0 / 3.0, 0.9];

impl SimulatedParticipant {
    /// Record of the participant's present beliefs, from which the answers to a probe follow.
    pub fn believes(&self, state: State) -> RecordedBelief {
        witness::without_press(&self.kitchen, &self.beliefs, state)
    }

    /// Time from a probe's question to the participant's answer, in seconds.
    pub fn answers_after_s(&self, probe: u32, question: u32) -> f64 {
        self.person.answer_s * (ANSWER_JITTER * normal(&mut self.of_answer(probe, question))).exp()
    }

    /// The participant's answer to a question about a state aspect: one of the choices, or `None` for "I don't know".
    ///
    /// If the true value is as probable as any other value, the participant answers the true value: so the answer is
    /// right exactly where the belief is not false.
    pub fn answer(
        &self,
        state: State,
        aspect: AspectId,
        choices: &[String],
        (probe, question): (u32, u32),
    ) -> Option<String> {
        let mut random = self.of_answer(probe, question);
        let _time = normal(&mut random);
        let labels = &self.kitchen.aspects[aspect.index()].labels;
        let most_likely = witness::rounded(self.beliefs.certainty(aspect));
        let p_truth = witness::rounded(self.beliefs.p_truth(&self.kitchen, state, aspect));
        let believed = match p_truth >= most_likely {
            true => &labels[self.kitchen.true_value(state, aspect)],
            false => &labels[self.beliefs.most_likely(aspect)],
        };
        if chance(&mut random, self.person.answers_wrong) {
            let others: Vec<&String> = choices.iter().filter(|choice| *choice != believed).collect();
            return (!others.is_empty()).then(|| others[random.random_range(0..others.len())].clone());
        }
        (most_likely >= self.population.answers_from).then(|| believed.clone())
    }

    /// The participant's confidence in its answer about an aspect, from 1 to 3.
    pub fn confidence(&self, aspect: AspectId) -> u8 {
        match self.beliefs.certainty(aspect) {
            p if p < SURE_FROM[0] => 1,
            p if p < SURE_FROM[1] => 2,
            _ => 3,
        }
    }

    /// The order that the participant expects to be served next: the order on which the participant works.
    pub fn next_order(&self) -> Option<LocationId> {
        self.intent.order.map(|(order, _)| order)
    }

    /// The random stream of one answer, separate for each answer, so that no answer depends on which others were given.
    fn of_answer(&self, probe: u32, question: u32) -> Stream {
        stream(self.answer_seed, "participant's answers", u64::from(probe) << 8 | u64::from(question))
    }
}
