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

/// How the observer works.
#[derive(Clone, Copy, Debug)]
pub struct ObserverSettings {
    /// Number of particles.
    pub particles: usize,
    /// Seed of all random numbers of the observer.
    pub seed: u64,
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
    let mut filter = ParticleFilter { settings: *settings, seed, particles, proposed: 0, random };
    evidence.intervals.iter().map(|interval| filter.pass(kitchen, interval)).collect()
}

struct ParticleFilter {
    settings: ObserverSettings,
    seed: u64,
    particles: Vec<SimulatedParticipant>,
    /// Number of proposals so far, which names their random streams.
    proposed: u64,
    random: Stream,
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
                    beliefs.push(p_truths(kitchen, interval, &proposal));
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
            beliefs.extend(kept.iter().map(|one| p_truths(kitchen, interval, one)));
        }
        let chosen = self.chosen(kept.len());
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
        let mut proposal = Proposal { participant, did: Did::Waited };
        for clue in &interval.clues {
            if has_hand && !proposal.move_hand_until(clue.time, interval) {
                return proposal;
            }
            let participant = &mut proposal.participant;
            match clue.shown {
                Shown::Fixation(point, location) => participant.fixate(clue.time, point, location),
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

    /// Draws as many of `proposals` proposals as there are particles, each equally often (systematic resampling).
    fn chosen(&mut self, proposals: usize) -> Vec<usize> {
        let count = self.particles.len();
        let start = self.random.random::<f64>();
        let at = |number: usize| (number as f64 + start) / count as f64;
        (0..count).map(|number| ((at(number) * proposals as f64) as usize).min(proposals - 1)).collect()
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

/// The means over particles, each given by its P(truth) of each aspect.
fn conclude(beliefs: &[Vec<f64>], passed: Passed) -> Conclusion {
    let mut conclusion = Conclusion { p_false: vec![0.0; beliefs[0].len()], p_wrong: Vec::new(), passed };
    conclusion.p_wrong.clone_from(&conclusion.p_false);
    let share = 1.0 / beliefs.len() as f64;
    for p_truths in beliefs {
        for (index, p_truth) in p_truths.iter().enumerate() {
            conclusion.p_wrong[index] += share * (1.0 - p_truth);
            conclusion.p_false[index] += if *p_truth < FALSE_BELOW { share } else { 0.0 };
        }
    }
    conclusion
}
