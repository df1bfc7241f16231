//! The command `tomcom simulate`.

use super::args::SimulateArgs;
use super::failure::{Failure, every_trial_failed, wrong_argument};
use super::lab::tell_carried;
use super::output::{print, progress, put_aside};
use super::rerun_messages::save_all;
use crate::run::files;
use crate::run::simulate;
use tomcom_core::base::text::count;
use tomcom_core::communication::settings::ShadowMode;
use tomcom_people::wizard::WizardKind;
use tomcom_session::SessionSpec;
use tomcom_session::features::Feature;
use tomcom_session::headless;
use tomcom_session::settings::{Condition, GazeSource, ParticipantKind};
use tomcom_session::study_arm::StudyArm;

pub(super) fn simulate(args: &SimulateArgs) -> Result<(), Failure> {
    if args.rerun {
        Feature::Rerun.require()?;
    }
    let mut files = files::read_session(&args.session)?;
    tell_carried(&args.session, Some(&args.out));
    let participant = &files.spec.participant;
    let is_simulated = matches!(participant.kind, ParticipantKind::Simulated | ParticipantKind::External)
        && matches!(participant.gaze, GazeSource::Simulated | GazeSource::None);
    if files.spec.plan.is_none() && !is_simulated {
        let found = "a session whose participant or gaze is not simulated".to_string();
        let remedy = "kind = \"simulated\" or \"external\", and gaze = \"simulated\" or \"none\"";
        return Err(wrong_argument(&args.session, found, remedy));
    }
    files.spec.seed = args.seed.unwrap_or(files.spec.seed);
    let trials = match (args.trials, files.study()) {
        (trials, None) => trials.unwrap_or(1),
        (trials, Some(study)) => {
            let most = study.plan.codes().len() as u64 * study.plan.conditions.len() as u64;
            if let Some(trials) = trials.filter(|&trials| trials > most) {
                let found = format!("--trials {trials}, with a plan of {}", count(most, "trial", "trials"));
                return Err(wrong_argument(&args.session, found, "no more trials than the plan has"));
            }
            trials.unwrap_or(most)
        }
    };
    if args.shard.of > trials {
        let found = format!("--shard of {} parts, with {}", args.shard.of, count(trials, "trial", "trials"));
        return Err(wrong_argument(&args.session, found, "at most as many parts as trials, so that no part is empty"));
    }
    check_condition(args, files.spec.plan.is_some())?;
    tell_unused(args, &files.spec);
    tell_differences(args, &files.spec);
    // If there is a plan, the plan defines the conditions.
    files.spec.trial.condition = args.condition.unwrap_or(Condition::None);
    if files.spec.unattended(files.spec.trial.condition) != files.spec.trial.condition {
        let found = "--condition wizard, with a session file whose wizard is a person".to_string();
        return Err(wrong_argument(&args.session, found, "[wizard] with kind = \"scripted\" in the session file"));
    }
    if let Some(concept) = &args.concept {
        files.spec.assistant.concept = concept.clone();
    }
    files.spec.robot.arm = args.arm.unwrap_or(files.spec.robot.arm);
    headless::require(&files.spec, &args.session)?;
    files.spec.assistant.shadow = if args.shadow { ShadowMode::On } else { ShadowMode::Off };
    let simulation = simulate::SimulationRequest { files, trials, shard: args.shard, out: args.out.clone() };
    let bar = progress(simulation.own_trials().count() as u64, "trials");
    let figures = simulate::simulate(&simulation, || bar.inc(1))?;
    bar.finish_and_clear();
    if args.rerun {
        save_all(&figures.recordings)?;
    }
    print(args.format, &figures, || simulate::describe(&figures))?;
    match &figures.failed[..] {
        [first, ..] if figures.failed.len() == figures.recordings.len() => Err(every_trial_failed(first)),
        _ => Ok(()),
    }
}

/// Reports assistant settings of the session file that only apply at the console: simulated trials ignore these
/// settings unless options ask for the assistant.
fn tell_unused(args: &SimulateArgs, spec: &SessionSpec) {
    if spec.plan.is_some() {
        return;
    }
    let acts = args.condition.is_none() && spec.trial.condition == Condition::Assistant;
    // An assistant that acts computes recommendations anyway.
    let is_asked = args.shadow || args.condition == Some(Condition::Assistant);
    let advises = !is_asked && spec.assistant.shadow == ShadowMode::On;
    let unused = [
        (acts, "the assistant does not act", "--condition assistant"),
        (advises, "the assistant's advice is not computed", "--shadow"),
    ];
    for (_, found, option) in unused.iter().filter(|(is_unused, ..)| *is_unused) {
        put_aside(&format!("{}: {found}; {option} does that\n", args.session.display()));
    }
}

/// Reports in what the simulated trials of a plan differ from those of people: the gaze, and conditions in which a person
/// would send signals.
fn tell_differences(args: &SimulateArgs, spec: &SessionSpec) {
    let Some(plan) = &spec.plan else { return };
    if spec.participant.gaze == GazeSource::None && spec.participant.kind != ParticipantKind::Simulated {
        let session = args.session.display();
        put_aside(&format!("{session}: simulated participants have gaze, which the plan has not (gaze = \"none\")\n"));
    }
    if spec.wizard.kind != WizardKind::Person {
        return;
    }
    let is_wizards = |arm: &&StudyArm| arm.condition() == Condition::Wizard;
    let silent: Vec<String> =
        plan.conditions.iter().filter(is_wizards).map(|arm| format!("\"{}\"", arm.name())).collect();
    if !silent.is_empty() {
        put_aside(&format!(
            "{}: trials of {} are simulated without signals, since the wizard is a person; [wizard] with kind = \
             \"scripted\" simulates one\n",
            args.session.display(),
            silent.join(" and ")
        ));
    }
}

/// Refuses options that have no effect in the given condition of the simulated trials.
fn check_condition(args: &SimulateArgs, is_planned: bool) -> Result<(), Failure> {
    let is_silent = matches!(args.condition, None | Some(Condition::None));
    let (found, remedy) = match () {
        () if is_planned && args.condition.is_some() => {
            ("--condition, of a session with a plan", "no --condition: the plan says who sends signals")
        }
        () if args.concept.is_some() && !is_planned && is_silent && !args.shadow => {
            ("--concept, where no assistant is asked", "--concept together with --condition assistant or --shadow")
        }
        () => return Ok(()),
    };
    Err(wrong_argument(&args.session, found.to_string(), remedy))
}
