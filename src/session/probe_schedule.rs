//! The times of a trial's freeze probes, drawn beforehand from a random stream of their own.
//!
//! Each probe comes between once and twice `apart_s` after the previous one (the first probe: after the trial's start),
//! so that nobody can foresee it. In a trial that is hardly long enough for all probes, intervals are closer to
//! `apart_s`.

use rand::RngExt;

use super::probe_settings::ProbeSpec;
use super::settings::SessionSpec;
use tomcom_core::base::rng::{Stream, shuffle, stream};
use tomcom_core::base::time::SessionTime;

/// A freeze probe of the trial's schedule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScheduledProbe {
    /// Time at which the freeze probe is due, on the trial's clock.
    pub at: SessionTime,
    /// Whether the belief estimate influences the choice of the probe's questions.
    pub uses_estimate: bool,
}

/// The settings of the freeze probes in this session's trial; none in a practice trial (familiarisation), in which
/// there are no probes because a practice trial does not count.
pub fn of_trial(spec: &SessionSpec) -> Option<&ProbeSpec> {
    let counts = spec.step.as_ref().is_none_or(|step| step.period.is_some());
    spec.probes.as_ref().filter(|_| counts)
}

/// Draws the schedule of the freeze probes in a trial.
pub fn draw(spec: &SessionSpec, trial: u64) -> Vec<ScheduledProbe> {
    let Some(probes) = of_trial(spec) else { return Vec::new() };
    let mut random = stream(spec.seed, "times of probes", trial);
    let number = probes.per_trial as usize;
    let slack_s = spec.trial.seconds - probes.wait_s - probes.apart_s * number as f64;
    let spread_s = (slack_s / number.max(1) as f64).clamp(0.0, probes.apart_s);
    let mut at_s = 0.0;
    let times: Vec<SessionTime> = (0..number)
        .map(|_| {
            at_s += probes.apart_s + spread_s * random.random::<f64>();
            SessionTime::from_secs_f64(at_s)
        })
        .collect();
    let blind = blind(number, probes.blind_share, &mut random);
    times.into_iter().zip(blind).map(|(at, is_blind)| ScheduledProbe { at, uses_estimate: !is_blind }).collect()
}

/// Draws for each probe whether it ignores the belief estimate (is blind): `share` of the probes are blind, in random
/// order. A fractional remainder of the number is the probability of one more blind probe.
fn blind(number: usize, share: f64, random: &mut Stream) -> Vec<bool> {
    let wanted = number as f64 * share;
    let count = wanted.floor() as usize + usize::from(random.random::<f64>() < wanted.fract());
    let mut blind: Vec<bool> = (0..number).map(|index| index < count).collect();
    shuffle(&mut blind, random);
    blind
}

/// Whether a freeze probe that the wizard requested uses the belief estimate: drawn at random, as for scheduled probes.
pub(super) fn requested_uses_estimate(spec: &SessionSpec, trial: u64, number: u32) -> bool {
    let share = spec.probes.as_ref().map_or(0.0, |probes| probes.blind_share);
    let name = format!("requested probes of trial {trial}");
    stream(spec.seed, &name, u64::from(number)).random::<f64>() >= share
}
