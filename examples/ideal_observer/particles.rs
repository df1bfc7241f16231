//! The ideal observer: a particle filter over whole simulated participants. The particles follow a recording, and those
//! are kept that press as the recorded person did.

use rand::RngExt;
use tomcom::base::rng::{Stream, stream};
use tomcom::base::time::SessionTime;
use tomcom::kitchen::{AspectId, ButtonId, Kitchen};
use tomcom::measures::sequences::FALSE_BELOW;
use tomcom::participant::SimulatedParticipant;
use tomcom::participant::population::Experience;

use super::evidence::{Evidence, Interval, Shown};

/// Largest difference of a particle's press from the recorded press, in seconds.
const SAME_TIME_S: f64 = 0.3;
/// Rounds of proposals, one from each particle, before the filter is content with few that agree with a press.
const MOST_ROUNDS: u64 = 8;
/// Share of the particles that must agree with a press before the rounds end.
const ENOUGH: f64 = 0.5;
/// Share of the fixation targets that are drawn evenly from all, whatever the particle would look at: fixations are
/// found with errors.
const STRAY: f64 = 0.1;

/// How the observer works.
#[derive(Clone, Copy, Debug)]
pub struct ObserverSettings {
    /// Number of particles.
    pub particles: usize,
    /// Seed of all random numbers of the observer.
    pub seed: u64,
    /// Whether the choice of fixation targets counts as evidence.
    pub weighs_gaze: bool,
    /// Probability, per proposal, with which a lasting property of a particle is drawn again.
    pub varies: f64,
}

/// What the observer concludes about one press.
#[derive(Clone, Debug)]
pub struct Conclusion {
    /// For each aspect, the share of the particles whose belief in the truth lies below one half.
    pub p_false: Vec<f64>,
    /// For each aspect, the mean probability of wrong values.
    pub p_wrong: Vec<f64>,
    /// How the particles got past the press.
    pub passed: Passed,
}

/// By which rule particles were kept at a press.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Passed {
    /// Particles pressed the recorded button at the recorded time.
    Agreed,
    /// No particle did, but some pressed or were about to press the button at another time.
    OtherTime,
    /// No particle meant the button: all are made to press it.
    Forced,
}

/// What a particle did until the time of the recorded press.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Did {
    /// It pressed this button at this time, no more than [`SAME_TIME_S`] from the recorded time.
    Pressed(ButtonId, SessionTime),
    /// It pressed this button too early.
    Early(ButtonId, SessionTime),
    /// It has not pressed.
    Waited,
}

/// A particle that has been moved to the time of a recorded press, before the press.
struct Proposal {
    participant: SimulatedParticipant,
    did: Did,
    /// Log of the likelihood of the recorded fixation targets.
    log_weight: f64,
}

/// Follows a trial with particles; one conclusion per press.
pub fn observe(evidence: &Evidence, trial: u64, settings: &ObserverSettings) -> Vec<Conclusion> {
    let kitchen = &evidence.kitchen;
    let seed = stream(settings.seed, "ideal observer's participants", trial).random::<u64>();
    let draw = |number: u64| {
        let mut one = SimulatedParticipant::new(
            kitchen.clone(),
            &evidence.population,
            seed,
            number,
            number,
            Experience::default(),
        );
        one.on_trial_start(evidence.started.0, evidence.started.1);
        one
    };
    let particles: Vec<SimulatedParticipant> = (0..settings.particles as u64).map(draw).collect();
    let random = stream(seed, "ideal observer's choice", 0);
    let targets = (kitchen.locations.len() + 1) as f64;
    let mut filter = ParticleFilter { settings: *settings, seed, particles, proposed: 0, random, targets };
    evidence.intervals.iter().map(|interval| filter.pass(kitchen, interval)).collect()
}

struct ParticleFilter {
    settings: ObserverSettings,
    seed: u64,
    particles: Vec<SimulatedParticipant>,
    /// Number of proposals so far, which names their random streams.
    proposed: u64,
    random: Stream,
    /// Number of fixation targets that are told apart.
    targets: f64,
}

impl ParticleFilter {
    /// Moves the particles past the press at the end of an interval.
    fn pass(&mut self, kitchen: &Kitchen, interval: &Interval) -> Conclusion {
        let count = self.particles.len();
        let mut beliefs = Vec::new();
        let (mut agreed, mut other_time) = (Vec::new(), Vec::new());
        for _ in 0..MOST_ROUNDS {
            for index in 0..count {
                let proposal = self.propose(index, interval, true);
                if !matches!(proposal.did, Did::Early(..)) {
                    beliefs.push((proposal.log_weight, p_truths(kitchen, interval, &proposal)));
                }
                match proposal.did {
                    Did::Pressed(button, _) if button == interval.press.button => agreed.push(proposal),
                    Did::Early(button, _) if button == interval.press.button => other_time.push(proposal),
                    Did::Waited => {
                        let meant = proposal.participant.next_press().map(|(button, _)| button);
                        other_time.extend((meant == Some(interval.press.button)).then_some(proposal));
                    }
                    _ => {}
                }
            }
            other_time.truncate(count);
            if agreed.len() as f64 >= ENOUGH * count as f64 {
                break;
            }
        }
        let passed = match (agreed.is_empty(), other_time.is_empty()) {
            (false, _) => Passed::Agreed,
            (true, false) => Passed::OtherTime,
            (true, true) => Passed::Forced,
        };
        let kept = match passed {
            Passed::Agreed => agreed,
            Passed::OtherTime => other_time,
            Passed::Forced => (0..count).map(|index| self.propose(index, interval, false)).collect(),
        };
        if beliefs.is_empty() {
            beliefs.extend(kept.iter().map(|one| (one.log_weight, p_truths(kitchen, interval, one))));
        }
        let chosen = self.chosen(&kept);
        let next = chosen.into_iter().zip(&self.particles).map(|(index, before)| {
            let mut participant = after(&kept[index], interval);
            // The press tells nothing of recipes that nobody needs: choosing particles must not choose these.
            participant.take_unused_recipes(before);
            participant
        });
        self.particles = next.collect();
        conclude(&beliefs, passed)
    }

    /// Moves a copy of a particle, with random numbers of its own, to the end of an interval.
    fn propose(&mut self, index: usize, interval: &Interval, has_hand: bool) -> Proposal {
        let mut participant = self.particles[index].clone();
        self.proposed += 1;
        participant.reseed(self.seed, self.proposed);
        participant.vary(self.settings.varies, &mut self.random);
        let mut proposal = Proposal { participant, did: Did::Waited, log_weight: 0.0 };
        for clue in &interval.clues {
            if has_hand && !proposal.move_hand_until(clue.time, interval) {
                return proposal;
            }
            let participant = &mut proposal.participant;
            match clue.shown {
                Shown::Fixation(point, location) => {
                    let p = participant.fixate(clue.time, point, location);
                    if self.settings.weighs_gaze {
                        proposal.log_weight += ((1.0 - STRAY) * p + STRAY / self.targets).ln();
                    }
                }
                Shown::Reading => participant.read_fixated(clue.time, clue.state),
                Shown::Order => participant.see_change(clue.time, clue.state),
                Shown::RobotPress(press) => {
                    participant.on_press(clue.time, &press);
                    participant.see_change(clue.time, clue.state);
                }
            }
        }
        if has_hand && proposal.move_hand_until(interval.time, interval) {
            proposal.press_now(interval);
        }
        proposal
    }

    /// Draws as many proposals as there are particles, by their weights (systematic resampling).
    fn chosen(&mut self, proposals: &[Proposal]) -> Vec<usize> {
        let weights = weights(&proposals.iter().map(|proposal| proposal.log_weight).collect::<Vec<f64>>());
        let count = self.particles.len();
        let start = self.random.random::<f64>();
        let (mut index, mut below) = (0, weights[0]);
        let at = |number: usize| (number as f64 + start) / count as f64;
        (0..count)
            .map(|number| {
                while below < at(number) && index + 1 < weights.len() {
                    index += 1;
                    below += weights[index];
                }
                index
            })
            .collect()
    }
}

impl Proposal {
    /// Lets the hand move up to this time. False if the particle pressed another button than the recorded one too
    /// early, so that it need not be followed any further.
    fn move_hand_until(&mut self, time: SessionTime, interval: &Interval) -> bool {
        while self.did == Did::Waited && self.participant.hand_due() <= time {
            let now = self.participant.hand_due();
            let Some(button) = self.participant.try_hand(now, interval.press.before) else { continue };
            let is_early = interval.time.secs_since(now) > SAME_TIME_S;
            self.did = if is_early { Did::Early(button, now) } else { Did::Pressed(button, now) };
            if is_early && button != interval.press.button {
                return false;
            }
        }
        true
    }

    /// Lets a hand press at the time of the recorded press that would press soon after.
    fn press_now(&mut self, interval: &Interval) {
        let now = interval.time;
        if self.did == Did::Waited && self.participant.hand_due().secs_since(now) <= SAME_TIME_S {
            let pressed = self.participant.try_hand(now, interval.press.before);
            self.did = pressed.map_or(Did::Waited, |button| Did::Pressed(button, now));
        }
    }
}

/// The particle after the recorded press.
fn after(proposal: &Proposal, interval: &Interval) -> SimulatedParticipant {
    let mut participant = proposal.participant.clone();
    match proposal.did {
        Did::Pressed(_, at) | Did::Early(_, at) => participant.postpone_hand(interval.time - at),
        Did::Waited => participant.press_unintended(interval.time),
    }
    participant.on_press(interval.time, &interval.press);
    participant
}

/// A particle's P(truth) of each aspect before a press.
fn p_truths(kitchen: &Kitchen, interval: &Interval, proposal: &Proposal) -> Vec<f64> {
    let beliefs = proposal.participant.beliefs();
    let aspects = (0..kitchen.aspects.len()).map(|index| AspectId(index as u8));
    aspects.map(|aspect| beliefs.p_truth(kitchen, interval.press.before, aspect)).collect()
}

/// Weights that sum to 1, from their logarithms.
fn weights(logs: &[f64]) -> Vec<f64> {
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let raw: Vec<f64> = logs.iter().map(|log| (log - most).exp()).collect();
    let total: f64 = raw.iter().sum();
    raw.into_iter().map(|weight| weight / total).collect()
}

/// The weighted means over particles, each given by its log weight and its P(truth) of each aspect.
fn conclude(beliefs: &[(f64, Vec<f64>)], passed: Passed) -> Conclusion {
    let weights = weights(&beliefs.iter().map(|(log, _)| *log).collect::<Vec<f64>>());
    let mut conclusion = Conclusion { p_false: vec![0.0; beliefs[0].1.len()], p_wrong: Vec::new(), passed };
    conclusion.p_wrong.clone_from(&conclusion.p_false);
    for (weight, (_, p_truths)) in weights.iter().zip(beliefs) {
        for (index, p_truth) in p_truths.iter().enumerate() {
            conclusion.p_wrong[index] += weight * (1.0 - p_truth);
            conclusion.p_false[index] += if *p_truth < FALSE_BELOW { *weight } else { 0.0 };
        }
    }
    conclusion
}
