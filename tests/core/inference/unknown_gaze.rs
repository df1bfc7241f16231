//! Unknown gaze: nothing is concluded from a look that nobody could have seen.

use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::Agent;
use tomcom_core::mind::dirichlet::Dirichlet;
use tomcom_core::mind::filter::unseen::UnknownGazeTimer;
use tomcom_core::mind::model::{HumanModel, LookingModel};
use tomcom_core::mind::observation::ObservedEvidence;

use super::{Bench, at};

/// A sample at the middle of the display's right edge, where no location is near.
fn sample(confidence: f64) -> GazeSample {
    GazeSample::new(0.999, 0.001, confidence)
}

/// Looks at one rate everywhere; changes by others neither draw the eye nor are thought through.
fn even(rate_hz: f64) -> HumanModel {
    let mut model = HumanModel::default();
    model.transition.foresight = 0.0;
    model.looking = LookingModel {
        looks_hz: rate_hz,
        other_looks_hz: rate_hz,
        capture: 0.0,
        display_lost_looks_hz: rate_hz / 10.0,
        ..LookingModel::default()
    };
    model
}

/// A trial in which the robot takes rice after a second.
fn trial(model: &HumanModel, before: impl FnOnce(&mut Bench)) -> Bench {
    let mut bench = Bench::new("sushi", model.clone());
    before(&mut bench);
    bench.press(1.0, Agent::Robot, "take rice");
    bench
}

impl Bench {
    fn advance(&mut self, seconds: f64) {
        self.filter.advance(at(seconds), &mut self.cost);
    }

    fn robots_hand(&self) -> &Dirichlet {
        self.filter.belief().aspect(self.aspect("robot_hand"))
    }

    /// The expected probability that the robot's hand holds rice.
    fn sees_rice(&self) -> f64 {
        self.p("robot_hand", "rice raw")
    }
}

#[test]
fn a_gap_is_a_hazard_with_exact_moments() {
    let model = even(0.7);
    let mut trial = trial(&model, |_| ());
    let before = trial.robots_hand().clone();
    let rice = trial.sees_rice();
    trial.advance(3.0);
    let looked = 1.0 - (-0.7_f64 * 2.0).exp();
    let right = 1.0 - model.perception.anything - model.perception.look_alike;
    let least = (1.0 - looked) * rice + looked * right;
    // Rice may have no look-alike.
    let most = (1.0 - looked) * rice + looked * (1.0 - model.perception.anything);
    let found = trial.sees_rice();
    assert!((least - 1e-6..=most + 1e-6).contains(&found), "{least} to {most}, and not {found}");
    let second = (1.0 - looked) * before.second() + looked;
    assert!((trial.robots_hand().second() - second).abs() < 1e-5, "{second}");
}

#[test]
fn dividing_a_gap_changes_nothing() {
    let model = HumanModel::default();
    let mut whole = trial(&model, |_| ());
    whole.advance(9.0);
    let mut divided = trial(&model, |_| ());
    divided.gaze(1.2, 2.8, sample(0.1), 60.0);
    divided.observe(5.0, ObservedEvidence::DisplayInView(true));
    divided.gaze(6.0, 0.5, GazeSample::new(f64::NAN, 0.5, 1.0), 60.0);
    divided.gaze(7.0, 1.0, sample(f64::NAN), 60.0);
    divided.advance(9.0);
    for (one, other) in whole.filter.belief().aspects.iter().zip(&divided.filter.belief().aspects) {
        for (a, b) in one.mean().iter().zip(other.mean()) {
            assert!((a - b).abs() < 1e-6, "{one:?} and {other:?}");
        }
        assert!((one.second() - other.second()).abs() < 1e-6, "{one:?} and {other:?}");
    }
}

#[test]
fn a_look_elsewhere_is_evidence_and_a_missing_sample_is_not() {
    let model = even(0.5);
    let rice_after = |what: &dyn Fn(&mut Bench)| {
        let mut trial = trial(&model, |trial| trial.gaze(0.0, 1.0, sample(1.0), 60.0));
        let before = trial.sees_rice();
        what(&mut trial);
        trial.advance(4.0);
        trial.sees_rice() - before
    };
    let beside = GazeSample::new(1.5, 0.5, 1.0);
    assert!(rice_after(&|trial| trial.gaze(1.0, 3.0, beside, 60.0)) < 1e-3, "off the display");
    assert!(rice_after(&|trial| trial.gaze(1.0, 3.0, sample(1.0), 60.0)) < 1e-3, "elsewhere on it");
    let unknown = rice_after(&|_| ());
    assert!(unknown > 0.5, "{unknown}");
    let low = rice_after(&|trial| trial.gaze(1.0, 3.0, sample(0.3), 60.0));
    assert!((low - unknown).abs() < 0.02, "samples of no confidence tell as little as none: {low} and {unknown}");
    let away = rice_after(&|trial| trial.observe(1.0, ObservedEvidence::DisplayInView(false)));
    assert!((0.02..unknown / 2.0).contains(&away), "a head that is turned away looks less: {away}");
}

/// Unknown time of a second of samples with this confidence after a second of good ones, and the time without a sample that
/// follows, in seconds.
fn unknown_s(confidence: f64, gap_s: f64) -> f64 {
    let model = HumanModel::default();
    let mut presence = UnknownGazeTimer::new(&model);
    presence.rest(at(0.0));
    let mut sum = 0.0;
    for step in 0..240 {
        let now = f64::from(step) / 120.0;
        let confidence = if step < 120 { 1.0 } else { confidence };
        let time = presence.sample(&sample(confidence), model.perception.known_share(confidence), at(now));
        sum += time.unknown_before_s + if time.known > 0.0 { (1.0 - time.known) * time.covers_s } else { 0.0 };
    }
    sum + presence.pass(at(239.0 / 120.0 + gap_s))
}

#[test]
fn confidence_joins_smoothly_and_a_blink_is_not_unknown() {
    assert!(unknown_s(0.9, 0.29) < 1e-6, "a blink");
    assert!((unknown_s(0.9, 1.3) - 1.0).abs() < 0.01, "{}", unknown_s(0.9, 1.3));
    assert!((unknown_s(0.6, 0.0) - 0.5).abs() < 0.01, "{}", unknown_s(0.6, 0.0));
    assert!((unknown_s(0.0, 0.0) - 0.7).abs() < 0.02, "{}", unknown_s(0.0, 0.0));
    let steps: Vec<f64> = (0..=100).map(|step| unknown_s(f64::from(step) / 100.0, 0.0)).collect();
    for pair in steps[41..].windows(2) {
        assert!(pair[0] >= pair[1] - 1e-9 && pair[0] - pair[1] < 0.05, "{pair:?}");
    }
}

#[test]
fn without_a_source_all_time_is_unknown() {
    let mut presence = UnknownGazeTimer::new(&HumanModel::default());
    presence.rest(at(2.0));
    assert!((presence.pass(at(7.0)) - 5.0).abs() < 1e-9);
    assert_eq!(presence.pass(at(7.0)), 0.0, "time counts once");
    presence.rest(at(20.0));
    assert!((presence.pass(at(21.0)) - 1.0).abs() < 1e-9, "a pause does not count");
}
