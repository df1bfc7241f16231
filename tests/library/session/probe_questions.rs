//! The questions of freeze probes: each comes as often as its recorded probability says.

use std::collections::BTreeMap;
use std::path::Path;

use tomcom::edge::files::read_session;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::AspectId;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_session::engine::SessionEngine;
use tomcom_session::probe_sampling::{aspect, questions};
use tomcom_session::settings::{ParticipantKind, ProbeSpec};
use tomcom_session::{Event, Session};

use super::{at, kitchen};

/// A session in the middle of a trial.
fn midway() -> Session {
    let kitchen = kitchen();
    let mut spec = read_session(Path::new("sessions/probes.toml")).expect("a session").spec;
    spec.participant.kind = ParticipantKind::Simulated;
    let mut engine = SessionEngine::new(kitchen.clone(), spec, 0, CostToGo::new(kitchen));
    let _ = engine.input(SessionTime::ZERO, Event::TrialStarted);
    while engine.session().time < at(30.0) {
        engine.fire();
    }
    engine.session().clone()
}

#[test]
fn questions_come_as_often_as_their_recorded_probabilities_say() {
    const DRAWS: u32 = 20_000;
    let session = midway();
    let spec = ProbeSpec::default();
    let aspects = session.kitchen.aspects.len();
    let is_wrong: Vec<bool> = (0..aspects).map(|index| index % 7 == 3).collect();
    for is_wrong in [None, Some(&is_wrong[..])] {
        // By number of questions and aspect: how often it was drawn, and with which probability.
        let mut drawn: BTreeMap<(usize, AspectId), (u32, f64)> = BTreeMap::new();
        let mut probes = [0_u32; 5];
        let mut weights = 0.0;
        for probe in 1..=DRAWS {
            let asked = questions(&session, &spec, probe, is_wrong);
            probes[asked.len()] += 1;
            for question in &asked {
                let id = aspect(&session.kitchen, &question.about).expect("an aspect");
                let count = drawn.entry((asked.len(), id)).or_default();
                *count = (count.0 + 1, question.inclusion);
                weights += 1.0 / question.inclusion;
            }
        }
        assert_eq!(probes[..2], [0, 0]);
        let per_aspect = (2..=4).map(|number| drawn.keys().filter(|(of, _)| *of == number).count());
        assert!(per_aspect.into_iter().all(|count| count == aspects), "every aspect comes up");
        for ((number, id), (count, inclusion)) in drawn {
            let n = f64::from(probes[number]);
            let deviation = (inclusion * (1.0 - inclusion) / n).sqrt();
            let share = f64::from(count) / n;
            assert!((share - inclusion).abs() < 4.5 * deviation + 1e-6, "{number} {id:?}: {share} of {inclusion}");
            assert!(inclusion >= 0.05 - 1e-9, "{number} {id:?}: {inclusion}");
            if is_wrong.is_none() {
                assert!((inclusion - number as f64 / aspects as f64).abs() < 1e-6, "blind probes are uniform");
            }
        }
        // Weighted by their inverse, the drawn questions stand for all aspects.
        let stands_for = weights / f64::from(DRAWS);
        assert!((stands_for / aspects as f64 - 1.0).abs() < 0.02, "{stands_for} of {aspects}");
    }
}

#[test]
fn what_is_believed_wrong_is_asked_more_often_than_what_is_not() {
    let session = midway();
    let spec = ProbeSpec::default();
    let is_wrong: Vec<bool> = (0..session.kitchen.aspects.len()).map(|index| index == 3).collect();
    let asked = |is_wrong: Option<&[bool]>| {
        let of_3 = |probe: &u32| {
            let asked = questions(&session, &spec, *probe, is_wrong);
            asked.iter().any(|question| aspect(&session.kitchen, &question.about) == Some(AspectId(3)))
        };
        (1..=500).filter(of_3).count()
    };
    assert!(asked(Some(&is_wrong)) > 2 * asked(None));
}
