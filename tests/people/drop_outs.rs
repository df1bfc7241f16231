//! Drop-outs of a simulated participant's gaze.

use tomcom_core::base::rng::stream;
use tomcom_core::base::time::SessionTime;
use tomcom_people::participant::eyes::GazeDropoutSchedule;

#[test]
fn drop_outs_follow_their_seed() {
    let schedule = |seed| {
        let mut gaps = GazeDropoutSchedule::new(10.0, [1.0, 8.0], stream(seed, "drop-outs", 0));
        (0..60_000)
            .map(|step| gaps.swallows(SessionTime::from_secs_f64(f64::from(step) / 100.0)))
            .collect::<Vec<bool>>()
    };
    let lost = schedule(4);
    assert_eq!(lost, schedule(4));
    assert_ne!(lost, schedule(5));
    let runs: Vec<usize> = lost.chunk_by(|a, b| a == b).filter(|run| run[0]).map(<[bool]>::len).collect();
    assert!(runs.len() > 20, "{}", runs.len());
    // The last one may be cut by the end.
    assert!(runs[..runs.len() - 1].iter().all(|run| (99..=801).contains(run)), "{runs:?}");
}
