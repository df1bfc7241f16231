//! Signals that were sent to simulated participants, judged by twins of the trial without them.

use std::fs;
use std::path::Path;

use tomcom::edge::files::read_session;
use tomcom_core::communication::concept::ConceptName;
use tomcom_session::headless::SimulationShard;
use tomcom_session::log::LOG_NAME;
use tomcom_session::settings::{ArmKind, Condition};
use tomcom_study::kept_cost::KeptCost;
use tomcom_study::pass::reading::{self, AnalysisScope};
use tomcom_study::trial_statistics::TrialStatistics;

use super::{folder, run};

fn analysed(recording: &Path) -> TrialStatistics {
    let scope = AnalysisScope { concepts: true, events: false };
    let (_, analysis) =
        reading::read(recording, "one", scope, None, &mut KeptCost::default()).expect("readable").expect("no practice");
    analysis.trial
}

/// A proposal of DEV is useful if the twin errs in its next presses, by a slip, too.
#[test]
fn proposals_of_simulated_trials_are_judged_by_the_next_presses() {
    let mut files = read_session(Path::new("sessions/default.toml")).expect("the default session");
    files.spec.trial.condition = Condition::Assistant;
    (files.spec.trial.presses, files.spec.seed) = (200, 9702);
    (files.spec.assistant.concept, files.spec.assistant.proposed_presses) = (ConceptName::Dev, 2);
    files.spec.robot.arm = ArmKind::Timed;
    let figures = run(&files, 3, SimulationShard::WHOLE, &folder("twins-dev"));
    let trials: Vec<TrialStatistics> =
        figures.recordings.iter().map(|recording| analysed(Path::new(recording))).collect();
    let sum = |of: fn(&TrialStatistics) -> u64| trials.iter().map(of).sum::<u64>();
    let (signals, contents) = (sum(|trial| trial.signals), sum(|trial| trial.signal_contents));
    let useful = sum(|trial| trial.useful_signals.expect("it comes out the same again"));
    assert!(0 < useful && useful < signals, "{useful} of {signals} useful");
    assert!(signals < contents && contents <= 2 * signals, "{signals} proposals of {contents} presses");
    assert!(trials.iter().all(|trial| (trial.acting.concept, trial.acting.parameter) == ("dev", Some(2.0))));
}

/// ToM sends many signals: some of them prevent errors, others are about beliefs that do no harm.
#[test]
fn signals_of_simulated_trials_are_useful_or_useless_and_those_of_trials_that_come_out_otherwise_unknown() {
    let mut files = read_session(Path::new("sessions/default.toml")).expect("the default session");
    files.spec.trial.condition = Condition::Assistant;
    files.spec.trial.presses = 200;
    files.spec.assistant.concept = ConceptName::Tom;
    files.spec.robot.arm = ArmKind::Timed;
    files.spec.seed = 21;
    let figures = run(&files, 3, SimulationShard::WHOLE, &folder("twins"));
    let trials: Vec<TrialStatistics> =
        figures.recordings.iter().map(|recording| analysed(Path::new(recording))).collect();
    let useful: u64 = trials.iter().map(|trial| trial.useful_signals.expect("it comes out the same again")).sum();
    let signals: u64 = trials.iter().map(|trial| trial.signals).sum();
    assert_eq!(signals, figures.signals);
    assert!(0 < useful && useful < signals, "{useful} of {signals} useful");

    // Another participant presses otherwise, as after a change of the program.
    let recording = Path::new(&figures.recordings[0]);
    let log = recording.join(LOG_NAME);
    let text = fs::read_to_string(&log).expect("a log");
    fs::write(&log, text.replacen("\"seed\":21", "\"seed\":22", 1)).expect("written");
    assert_eq!(analysed(recording).useful_signals, None);
}
