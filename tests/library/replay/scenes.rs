//! The scene that Rerun shows of a session.

use std::cell::RefCell;

use tomcom::run::open_viewer::{RerunReviewRequest, review};
use tomcom::run::seekable_replay::SeekableReplay;
use tomcom_core::measures::sequences::{FALSE_BELOW, THINKS};
use tomcom_core::measures::wizard_performance::SignalVerdict;
use tomcom_devices::scene::{EntityData, EntityUpdate, SceneInputs, SceneUpdate, SessionScene, WIDE};
use tomcom_session::history::error_reasons::ExplainedError;
use tomcom_session::history::{event_words, signal_words, wording};
use tomcom_session::replay::ReplayLandmark;
use tomcom_session::settings::Condition;
use tomcom_session::wizard_log::signal_verdicts;
use tomcom_study::analysis::annotations::AnnotationCollector;

use super::{SESSIONS, folder, session, simulated};
use crate::support::*;

/// Everything that a recording shows, and its events.
fn shown(recording: &Path) -> (Vec<SceneUpdate>, Vec<TimestampedEvent>) {
    let mut replay = RecordingReplay::open(recording).expect("a recording");
    let mut scene = SessionScene::new(replay.session(), 0);
    let mut moments = vec![scene.opening()];
    let mut events = Vec::new();
    while let Some(line) = replay.step().expect("events of a session") {
        let (follower, belief) = (&replay.follower, Some(replay.follower.filter.belief()));
        moments.extend(scene.see(&line.stamped, SceneInputs { follower, belief }));
        events.push(line.stamped);
    }
    (moments, events)
}

#[test]
fn a_scene_shows_every_press_signal_and_sample_once_at_its_time() {
    for name in ["format-3-hand.jsonl", "format-3-simulated.jsonl"] {
        let (moments, events) = shown(&Path::new("tests/golden").join(name));
        // Only curves that begin have rows of earlier times.
        let is_of_curves = |moment: &SceneUpdate| moment.rows.iter().all(|row| row.entity.starts_with("human/belief/"));
        let in_order = || moments.iter().filter(|&moment| !is_of_curves(moment));
        assert!(in_order().map(|moment| moment.time).is_sorted(), "{name}: moments come in the order of their times");
        let steps_of = |entity: &str| -> Vec<(u64, SessionTime)> {
            let rows = |moment: &SceneUpdate| moment.rows.iter().filter(|row| row.entity == entity).count();
            moments.iter().flat_map(|moment| vec![(moment.step, moment.time); rows(moment)]).collect()
        };
        let mut is_running = false;
        let mut presses = [Vec::new(), Vec::new()];
        // The line of the cost of signals begins with the trial.
        let (mut gaze, mut signals, mut cost) = (Vec::new(), Vec::new(), Vec::new());
        for stamped in &events {
            let place = (stamped.seq, stamped.time);
            match &stamped.event {
                Event::TrialStarted => {
                    is_running = true;
                    cost.push(place);
                }
                Event::TrialResumed => is_running = true,
                Event::TrialPaused | Event::TrialEnded { .. } | Event::TrialAborted { .. } => is_running = false,
                Event::Press { agent, .. } if is_running => presses[agent.index()].push(place),
                Event::Gaze(_) => gaze.push(place),
                Event::SignalShown { by: Sender::Wizard, .. } => signals.push(place),
                Event::Advised(_) => cost.push(place),
                _ => {}
            }
        }
        assert!(presses.iter().all(|presses| !presses.is_empty()), "{name} has presses of both");
        assert_eq!(steps_of("human/presses"), presses[Agent::Human.index()], "{name}");
        assert_eq!(steps_of("robot/presses"), presses[Agent::Robot.index()], "{name}");
        assert_eq!(steps_of("human/gaze"), gaze, "{name}");
        assert_eq!(steps_of("assistant/benefit/cost_line"), cost, "{name}");
        // Where a signal is marked as sent, its curve has that value.
        for moment in &moments {
            let value = |row: &EntityUpdate| match &row.shown {
                EntityData::Value(value) => Some((row.entity.clone(), *value)),
                _ => None,
            };
            let (sent, others): (Vec<_>, Vec<_>) =
                moment.rows.iter().filter_map(value).partition(|(entity, _)| entity == "assistant/benefit/sent");
            let has_curve = |net: f64| {
                others.iter().any(|(entity, value)| entity.starts_with("assistant/benefit/") && *value == net)
            };
            assert!(sent.iter().all(|(_, net)| has_curve(*net)), "{name}: a signal at {}", moment.trial);
        }
        let sent = moments.iter().flat_map(|moment| &moment.rows).filter(|row| {
            row.entity == "wizard/signals"
                && matches!(&row.shown, EntityData::Words { text, .. } if !text.starts_with("wizard: took"))
        });
        assert_eq!(sent.count(), signals.len(), "{name}");
        assert!(in_order().map(|moment| moment.trial).is_sorted(), "{name}: the trial's clock never goes back");
        let started = events.iter().find(|stamped| stamped.event == Event::TrialStarted).expect("a trial").time;
        for moment in moments.iter().filter(|moment| moment.time <= started) {
            assert_eq!(moment.trial, SessionTime::ZERO, "{name}: before the trial its clock stands");
        }
        let lines = |entity: &str| -> Vec<String> {
            let text = |row: &EntityUpdate| match &row.shown {
                EntityData::Words { text, .. } if row.entity.starts_with(entity) => Some(text.clone()),
                _ => None,
            };
            moments.iter().flat_map(|moment| &moment.rows).filter_map(text).collect()
        };
        let happened = lines("happened");
        assert!(happened.len() > presses[0].len() + presses[1].len(), "{name}: more than presses happened");
        // Every line stands in the list of what happened once more, broken to the width of the view.
        let mut whole: Vec<String> = lines("").into_iter().collect();
        for line in &happened {
            let is_narrow = |line: &str| line.chars().count() <= 77;
            assert!(line.lines().all(is_narrow), "{name}: the viewer would cut {line}");
            let told = line.replace('\n', " ");
            let is_it = |text: &String| *text == told;
            // The line itself is among the lines, too.
            let of = whole.iter().position(|text| *text == *line).expect("the line");
            whole.remove(of);
            let of = whole.iter().position(is_it).unwrap_or_else(|| panic!("{name}: {line} is nobody's"));
            whole.remove(of);
        }
        assert!(whole.is_empty(), "{name}: not in the list: {whole:?}");
    }
}

/// The texts of an entity with a page or states, with the moments.
fn texts<'a>(moments: &'a [SceneUpdate], entity: &str) -> Vec<(&'a SceneUpdate, &'a str)> {
    let rows = moments.iter().flat_map(|moment| moment.rows.iter().map(move |row| (moment, row)));
    let text = |(moment, row): (&'a SceneUpdate, &'a EntityUpdate)| match &row.shown {
        EntityData::Page(text) | EntityData::State(text, _) if row.entity == entity => Some((moment, text.as_str())),
        _ => None,
    };
    rows.filter_map(text).collect()
}

#[test]
fn a_page_says_what_the_error_was_why_and_what_was_believed_before_it() {
    let recording = Path::new("tests/golden/format-3-offers.jsonl");
    let (moments, events) = shown(recording);
    let mut replay = RecordingReplay::open(recording).expect("a recording");
    replay.run().expect("events of a session");
    let errors: Vec<u64> =
        replay.follower.judged.iter().filter(|press| press.verdict.error).map(|press| press.seq).collect();
    assert!(errors.len() > 2, "{} errors", errors.len());
    let pages = texts(&moments, "human/now");
    let states = texts(&moments, "error");
    // By aspect, the last own false belief that began before an error: another wrong value or truth begins later.
    let mut began: BTreeMap<String, (String, String, Option<SessionTime>)> = BTreeMap::new();
    for (number, seq) in (1..).zip(&errors) {
        let heading = format!("## Error {number} at ");
        let (moment, page) = pages.iter().find(|(_, page)| page.starts_with(&heading)).expect("a page of the error");
        assert_eq!(moment.step, *seq, "{heading}");
        // The reason as replays have it, with what it costs.
        let judged = replay.follower.judged.iter().find(|press| press.seq == *seq).expect("a judged press");
        let why = ExplainedError::among(replay.session(), std::slice::from_ref(judged)).remove(0).why;
        let sentence = page.split_once("**Why an error**: ").expect("a reason").1.lines().next().expect("a line");
        assert!(sentence.contains(&why) && sentence.contains("costs "), "{why}: {sentence}");
        let (_, then) = pages.iter().rfind(|(_, page)| page.starts_with(&heading)).expect("a page of the error");
        // A table would be as wide as its longest line, and cut.
        assert!(!then.contains('|'), "{then}");
        // A press without effect says why once.
        assert!(page.lines().next().is_some_and(|heading| !heading.contains(&why)), "{why}: {page}");
        let is_bar = |text: &str| text.starts_with(&format!("{number}: ")) && text.matches(&why).count() == 1;
        assert!(states.iter().any(|(moment, text)| moment.step == *seq && is_bar(text)), "{why}");
        // All that the log has as believed wrong before the press, in the words of replays.
        let believed = replay.follower.believed_wrong(judged.time).expect("of each error");
        let own = events.iter().rev().find_map(|stamped| match &stamped.event {
            Event::ParticipantBelieves(witness) if stamped.seq < *seq => Some(witness),
            _ => None,
        });
        let estimated = events.iter().find_map(|stamped| match &stamped.event {
            Event::BeliefEstimated(witness) if witness.press == *seq => Some(witness),
            _ => None,
        });
        let own = own.expect("a belief").aspects.iter().filter(|one| one.p_truth < FALSE_BELOW).count();
        let estimated = estimated.expect("an estimate").aspects.iter().filter(|one| one.p_truth < FALSE_BELOW).count();
        assert_eq!((believed.participant.len(), believed.estimate.len()), (own, estimated), "{believed:?}");
        let told = believed.told().unwrap_or_default();
        for one in believed.participant.iter().chain(&believed.estimate) {
            assert!(page.contains(&format!("- **{}**: {}; P(truth) ", one.about, one.told)), "{one:?}: {page}");
            assert!(told.contains(&format!("{}: {}", one.about, one.told)), "{one:?}: {told}");
            assert_eq!(one.told.starts_with("unsure, "), one.p_believes < THINKS, "{one:?}");
            assert!(one.since().is_none_or(|since| since < replay.session().trial_clock_at(judged.time)), "{one:?}");
        }
        for own in &believed.participant {
            let now = (own.believes.clone(), own.truth.clone(), own.since());
            let before = began.insert(own.aspect.clone(), now.clone());
            if let Some((believes, truth, since)) = before.filter(|before| (&before.0, &before.1) != (&now.0, &now.1)) {
                assert!(now.2.is_none_or(|now| since.is_none_or(|since| now > since)), "{believes}, {truth}: {own:?}");
            }
        }
    }
    let believed =
        |by: &str| pages.iter().any(|(_, page)| page.contains(&format!("Believed wrong before it, by the {by}:")));
    assert!(believed("estimate") && believed("simulated participant"));
    // What is not probable is not stated.
    for stamped in &events {
        let Event::BeliefEstimated(witness) = &stamped.event else { continue };
        let wrong = witness.aspects.iter().filter(|one| one.p_truth < FALSE_BELOW);
        let unsure = wrong.filter(|one| one.values[&one.believes] < THINKS).count();
        let line = event_words::words(stamped, &replay.follower).unwrap_or_default();
        assert_eq!(line.matches(" = unsure").count(), unsure, "{line}");
    }
}

#[test]
fn a_scene_shows_contents_as_the_page_draws_them() {
    for name in SESSIONS {
        let files = session(name);
        let kitchen = &files.kitchen.kitchen;
        let items = || kitchen.contents.iter().filter_map(|content| content.look.as_ref());
        let looks = items().chain(kitchen.dishes.iter().filter_map(|dish| dish.look.as_ref()));
        let places = kitchen.locations.iter().filter_map(|place| place.look.as_ref());
        for look in looks.chain(places) {
            let picture = tomcom_devices::scene::picture(look).unwrap_or_else(|| panic!("no picture of {look:?}"));
            assert!(picture.starts_with(b"\x89PNG"), "{look:?}");
        }
    }
    // An item that is taken lies in the hand, as a picture.
    let (moments, _) = shown(Path::new("tests/golden/format-3-hand.jsonl"));
    let in_hand =
        moments.iter().flat_map(|moment| &moment.rows).filter(|row| row.entity == "kitchen/human_hand/items/0");
    let mut seen = Vec::new();
    for row in in_hand {
        let EntityData::Picture(picture) = &row.shown else { panic!("{row:?}") };
        seen.push(picture.png);
    }
    seen.sort();
    seen.dedup();
    assert!(seen.len() > 2, "{} pictures, of nothing and of items", seen.len());
}

#[test]
fn a_bar_of_a_wrong_belief_says_what_is_true() {
    let recording = Path::new("tests/golden/format-3-offers.jsonl");
    let (moments, _) = shown(recording);
    let replay = RecordingReplay::open(recording).expect("a recording");
    let fixed = SessionScene::new(replay.session(), 0).fixed();
    let mut count = 0;
    for row in moments.iter().flat_map(|moment| &moment.rows) {
        if !row.entity.starts_with("wrong_belief/") {
            continue;
        }
        let EntityData::State(text, _) = &row.shown else { panic!("{row:?}") };
        assert!(text.is_empty() || text.starts_with("thinks "), "{text}");
        count += 1;
    }
    assert!(count > 2, "{count} wrong beliefs");
    // Whose recording it is.
    let about = fixed.iter().find(|row| row.entity == "about").expect("a page");
    let EntityData::Page(text) = &about.shown else { panic!("{about:?}") };
    let condition = replay.session().spec.trial.condition.name();
    assert!(text.contains(&format!("- condition: **{condition}**")) && text.contains("**Colours**"), "{text}");
}

#[test]
fn labels_keep_apart_and_bars_end_with_the_trial() {
    let recording = Path::new("tests/golden/format-3-simulated.jsonl");
    let (moments, _) = shown(recording);
    let replay = RecordingReplay::open(recording).expect("a recording");
    let fixed = SessionScene::new(replay.session(), 0).fixed();
    let labels = |rows: &[EntityUpdate], entity: &str| {
        let of = rows.iter().filter(|row| row.entity.starts_with(entity)).filter_map(|row| match &row.shown {
            EntityData::Labels(labels) => Some(labels.clone()),
            _ => None,
        });
        of.flatten().collect::<Vec<_>>()
    };
    // Storages have their names beside the display, where no hand is.
    let storages = labels(&fixed, "kitchen/storage");
    assert!(storages.len() > 5 && storages.iter().all(|label| !(0.0..WIDE).contains(&label.at[0])), "{storages:?}");
    let contents: Vec<_> = moments.iter().flat_map(|moment| labels(&moment.rows, "kitchen/")).collect();
    let is_narrow = |line: &str| line.split(" + ").count() < 2 || line.chars().count() <= 22;
    assert!(contents.iter().all(|label| label.words.lines().all(is_narrow)));
    assert!(contents.iter().any(|label| label.words.contains('\n')), "no stack is in lines");
    // What a place holds stands below its picture.
    let mut below = 0;
    for moment in &moments {
        for row in &moment.rows {
            let (Some(place), EntityData::Labels(labels)) = (row.entity.strip_suffix("/words"), &row.shown) else {
                continue;
            };
            let place = moment.rows.iter().find(|row| row.entity == place && place != "kitchen/shown");
            let Some(EntityData::Areas(areas)) = place.map(|place| &place.shown) else { continue };
            for area in areas {
                assert!(labels.iter().all(|label| label.at[1] >= area.top + area.height), "{row:?}");
                below += labels.len();
            }
        }
    }
    assert!(below > 5, "{below} labels");
    for lane in ["error", "look", "signal"] {
        assert!(texts(&moments, lane).last().is_none_or(|(_, text)| text.is_empty()), "{lane}");
    }
}

#[test]
fn each_false_belief_that_lasts_has_a_curve_and_each_aspect_its_own_colour() {
    let (mut files, out) = (session("default.toml"), folder("scene-curves"));
    (files.spec.trial.seconds, files.spec.seed, files.spec.robot.arm) = (300.0, 11, ArmKind::Timed);
    simulate_into(files, 1, &out);
    for recording in [only_recording(&out), PathBuf::from("tests/golden/format-3-offers.jsonl")] {
        let mut replay = RecordingReplay::open(&recording).expect("a recording");
        let fixed = SessionScene::new(replay.session(), 0).fixed();
        replay.run().expect("events of a session");
        let (moments, _) = shown(&recording);
        let aspects = &replay.session().kitchen.aspects;
        let mut colours = BTreeMap::<_, BTreeSet<&str>>::new();
        for row in &fixed {
            let (EntityData::Line(style) | EntityData::Marks(style, _)) = &row.shown else { continue };
            let Some((_, aspect)) = row.entity.strip_prefix("human/belief/").and_then(|rest| rest.split_once('/'))
            else {
                continue;
            };
            colours.entry(style.colour).or_default().insert(aspect);
        }
        assert_eq!(colours.len(), aspects.len());
        assert!(colours.values().all(|aspects| aspects.len() == 1), "{colours:?}");
        let lasting = replay.follower.false_beliefs.all().filter(|one| one.lasts(replay.session()));
        let mut count = 0;
        for held in lasting {
            let name = aspects[held.aspect.index()].name.replace(|letter: char| !letter.is_alphanumeric(), "_");
            let ended = held.ended.unwrap_or(replay.session().time);
            let within = moments.iter().filter(|moment| (held.began..=ended).contains(&moment.time));
            let mut rows = within.flat_map(|moment| &moment.rows);
            let is_its = |row: &EntityUpdate| {
                row.entity == format!("human/belief/estimated/{name}") && matches!(row.shown, EntityData::Value(_))
            };
            assert!(rows.any(is_its), "no curve of {held:?}");
            count += 1;
        }
        assert!(count > 5, "{count} false beliefs last");
    }
}

#[test]
fn a_curve_begins_with_the_values_before_and_after_the_belief_turned_false() {
    let (moments, events) = shown(Path::new("tests/golden/format-3-offers.jsonl"));
    let mut curves = Vec::new();
    let mut open: BTreeMap<&str, Vec<(SessionTime, f64)>> = BTreeMap::new();
    for (moment, row) in moments.iter().flat_map(|moment| moment.rows.iter().map(move |row| (moment, row))) {
        let Some(aspect) = row.entity.strip_prefix("human/belief/estimated/") else { continue };
        match &row.shown {
            EntityData::NoValue => curves.extend(open.remove_entry(aspect)),
            EntityData::Value(p_truth) => open.entry(aspect).or_default().push((moment.time, *p_truth)),
            _ => {}
        }
    }
    // Of a press, those at its time.
    curves.extend(open);
    let time_of = |by: Agent| {
        let is_by = move |event: &Event| matches!(event, Event::Press { agent, .. } if *agent == by);
        let presses = events.iter().filter(move |stamped| is_by(&stamped.event));
        presses.map(|stamped| stamped.time).collect::<BTreeSet<SessionTime>>()
    };
    let (human, robot) = (time_of(Agent::Human), time_of(Agent::Robot));
    let mut falls = [0, 0];
    for (aspect, rows) in curves {
        assert!(rows.is_sorted_by_key(|(time, _)| *time), "{aspect}: {rows:?}");
        let is_fall = |nth: usize| rows[nth].1 >= FALSE_BELOW && rows[nth + 1].1 < FALSE_BELOW;
        let fall = (0..rows.len() - 1).rev().find(|&nth| rows[nth].0 == rows[0].0 && is_fall(nth));
        assert!(fall.is_some() || rows[0].1 < FALSE_BELOW, "{aspect}: {rows:?}");
        let Some(nth) = fall else { continue };
        let (before, turned, last) = (rows[nth].0, rows[nth + 1].0, rows[rows.len() - 1].0);
        assert!(last.secs_since(turned) >= 1.0, "{aspect}: {rows:?}");
        // What was forgotten since the row before is false before a press already.
        if human.contains(&turned) && before != turned || !human.contains(&turned) && !robot.contains(&turned) {
            continue;
        }
        falls[usize::from(robot.contains(&turned))] += 1;
        let bars = texts(&moments, &format!("wrong_belief/{aspect}"));
        let begins = bars.iter().any(|(moment, text)| moment.time == turned && !text.is_empty());
        assert!(begins, "{aspect}: no bar begins at {turned:?}");
    }
    assert!(falls.iter().all(|&count| count > 0), "{falls:?} curves that fall at presses of the human, of the robot");
}

#[test]
fn a_scene_tells_a_belief_before_the_press_as_the_log_does_and_then_the_one_after_it() {
    let out = simulated("default.toml", ArmKind::Physics, "scene", 1, 3);
    let recording = only_recording(&out);
    let (moments, _) = shown(&recording);
    let mut replay = RecordingReplay::open(&recording).expect("a recording");
    let (mut count, mut drawn, mut told_now) = (0, 0, 0);
    while let Some(line) = replay.step().expect("events of a session") {
        let stamped = &line.stamped;
        let Event::BeliefEstimated(witness) = &stamped.event else { continue };
        let (session, belief) = (replay.session(), replay.follower.filter.belief());
        count += 1;
        let mut of_step = moments.iter().filter(|moment| moment.step == stamped.seq && moment.time == stamped.time);
        // Where nothing is drawn, there is no moment.
        let Some(moment) = of_step.next() else { continue };
        let of_press = moments.iter().filter(|moment| [witness.press, stamped.seq].contains(&moment.step));
        let mut pages = of_press.flat_map(|moment| &moment.rows).filter_map(|row| match &row.shown {
            EntityData::Page(text) if row.entity == "human/now" => Some(text),
            _ => None,
        });
        let page = pages.next_back().and_then(|text| text.split_once("Believed wrong now"));
        for (index, told) in witness.aspects.iter().enumerate() {
            let entity = format!("human/belief/estimated/{}", told.aspect.replace(' ', "_"));
            let value = |row: &EntityUpdate| match row.shown {
                EntityData::Value(p_truth) if row.entity == entity => Some(p_truth),
                _ => None,
            };
            let values: Vec<f64> = moment.rows.iter().filter_map(value).collect();
            let aspect = tomcom_core::kitchen::AspectId(index as u8);
            let both = [told.p_truth, belief.p_truth(&session.kitchen, session.state, aspect)];
            // A curve ends where the belief is known, and begins where it is wrong.
            assert!(
                values == both || values == both[..1] || values == both[1..] || values.is_empty(),
                "{entity}: {values:?}"
            );
            drawn += usize::from(values == both);
            // What is believed now is what is believed after the press.
            if let Some((_, now)) = page.filter(|_| both[1] < FALSE_BELOW) {
                let p_truth = format!("; P(truth) {:.0} %", 100.0 * both[1]);
                assert!(now.contains(&p_truth), "{entity}: {p_truth} in {now}");
                told_now += 1;
            }
        }
    }
    assert!(count > 20 && drawn > 20 && told_now > 20, "{count} presses, {drawn} values, {told_now} in words");
}

#[test]
fn a_stream_tells_how_many_events_of_all_its_recordings_are_written() {
    let recordings = ["hand", "simulated"].map(|name| PathBuf::from(format!("tests/golden/format-3-{name}.jsonl")));
    let lines = |path: &PathBuf| fs::read_to_string(path).expect("a log").lines().count() as u64 - 1;
    let (first, all) = (lines(&recordings[0]), recordings.iter().map(lines).sum::<u64>());
    let (save, told) = (Some(Some(folder("scene-progress").join("both.rrd"))), RefCell::new(Vec::new()));
    let asked = RerunReviewRequest { recordings: recordings.to_vec(), save, web: false, at: None };
    review(&asked, &|done, of| told.borrow_mut().push((done, of))).expect("a stream");
    let told = told.into_inner();
    assert!(told.is_sorted() && told.contains(&(first, all)), "{first} of {all}");
    assert_eq!(told.last(), Some(&(all, all)));
}

#[test]
fn a_scene_shows_answers_of_probes_beside_the_estimate() {
    let (files, out) = (session("probes.toml"), folder("scene-probes"));
    simulate_into(files, 1, &out);
    let recording = only_recording(&out);
    let (moments, events) = shown(&recording);
    let state = |moment: &SceneUpdate, lane: &str| -> Option<String> {
        moment.rows.iter().find(|row| row.entity == lane).map(|row| match &row.shown {
            EntityData::State(text, _) => text.clone(),
            other => panic!("{other:?}"),
        })
    };
    let mut asked = Vec::new();
    let (mut answers, mut lanes) = (0, Vec::new());
    for stamped in &events {
        let Event::Probe(event) = &stamped.event else { continue };
        let moment = moments.iter().find(|moment| moment.step == stamped.seq && !moment.rows.is_empty());
        match event {
            ProbeEvent::Begun { questions, .. } => {
                // The answers of the probe before vanish.
                let cleared = |lane: &String| moment.and_then(|moment| state(moment, lane)).as_deref() == Some("");
                assert!(lanes.iter().all(cleared), "{lanes:?}");
                lanes.clear();
                asked.clone_from(questions);
            }
            ProbeEvent::Asked { question, .. } => {
                let about = wording::probe_subject(&asked[*question as usize - 1].about);
                assert_eq!(state(moment.expect("a moment"), "human/probes/asked"), Some(about));
            }
            ProbeEvent::Answered { question, answer, .. } => {
                answers += 1;
                let (moment, about) =
                    (moment.expect("a moment"), wording::probe_subject(&asked[*question as usize - 1].about));
                let lane = |kind: &str| {
                    format!("human/probes/{}_{kind}", about.replace(|letter: char| !letter.is_alphanumeric(), "_"))
                };
                let said = state(moment, &lane("answer")).expect("an answer");
                assert_eq!(answer.is_none(), said == "does not know", "{said}");
                let estimate = state(moment, &lane("estimate")).expect("an estimate");
                assert!(estimate.ends_with(" %"), "{estimate}");
                let line = format!("human answers, {about}: {said} (estimate: {estimate})");
                let is_line = |row: &EntityUpdate| {
                    row.entity == "human/answers"
                        && matches!(&row.shown, EntityData::Words { text, .. } if *text == line)
                };
                assert!(moment.rows.iter().any(is_line), "{line}");
                lanes.extend([lane("answer"), lane("estimate")]);
            }
            ProbeEvent::Closed { .. } => {
                assert_eq!(state(moment.expect("a moment"), "human/probes/asked").as_deref(), Some(""));
            }
            _ => {}
        }
    }
    assert!(answers > 3, "{answers} answers");
}

#[test]
fn false_beliefs_are_the_same_in_replay_review_and_annotations() {
    let recording = Path::new("tests/golden/format-3-offers.jsonl");
    let mut replay = RecordingReplay::open(recording).expect("a recording");
    let mut collector = AnnotationCollector::default();
    while let Some(event) = replay.step().expect("events of a session") {
        collector.take(&event.stamped);
    }
    let kitchen = replay.session().kitchen.clone();
    let name = |aspect: &str| wording::location(aspect);
    let mut held: Vec<(SessionTime, String, String)> = Vec::new();
    for one in replay.follower.false_beliefs.all() {
        assert!(one.thinks != one.truth && one.ended.is_none_or(|ended| ended > one.began), "{one:?}");
        held.push((one.began, name(&kitchen.aspects[one.aspect.index()].name), one.told(&kitchen)));
    }
    assert!(held.len() > 5, "{} false beliefs", held.len());
    // The replay stops at those that last.
    let film = SeekableReplay::open(recording).expect("it opens");
    let lasting = replay.follower.false_beliefs.all().filter(|one| one.lasts(replay.session()));
    let began: Vec<SessionTime> = lasting.map(|one| one.began).collect();
    assert!(!began.is_empty() && began.len() < held.len(), "{} of {}", began.len(), held.len());
    assert_eq!(film.landmarks(ReplayLandmark::FalseBelief), began);
    // The review has a bar for each: the last row of a time holds.
    let (moments, _) = shown(recording);
    let mut bars = BTreeMap::new();
    for moment in &moments {
        for row in &moment.rows {
            let (Some(place), EntityData::State(text, _)) = (row.entity.strip_prefix("wrong_belief/"), &row.shown)
            else {
                continue;
            };
            bars.insert((moment.time, name(place)), text.clone());
        }
    }
    let bars: BTreeSet<_> = bars
        .into_iter()
        .filter(|(_, text)| !text.is_empty())
        .map(|((time, place), text)| (time, place, text))
        .collect();
    assert_eq!(bars, held.iter().cloned().collect::<BTreeSet<_>>());
    // So have annotations.
    let about = ("a recording".to_string(), None);
    let annotations = collector.finish(&replay.follower, about, &BTreeMap::new(), &[], false);
    let mut exported = BTreeSet::new();
    for tier in &annotations.tiers {
        let Some(place) = tier.name.strip_prefix("false belief (estimate): ") else { continue };
        for one in &tier.annotations {
            exported.insert((one.begin, place.to_string(), one.words.clone()));
        }
    }
    let near = |time: SessionTime| SessionTime(time.0 / 1000);
    let rounded = |all: BTreeSet<(SessionTime, String, String)>| -> BTreeSet<_> {
        all.into_iter().map(|(time, place, words)| (near(time + SessionTime(500)), place, words)).collect()
    };
    assert_eq!(rounded(exported), rounded(held.into_iter().collect()));
}

#[test]
fn a_signal_has_its_reason_as_long_as_it_is_shown_and_then_what_became_of_it() {
    let (mut files, out) = (session("default.toml"), folder("scene-signals"));
    (files.spec.trial.condition, files.spec.trial.seconds, files.spec.seed) = (Condition::Assistant, 240.0, 7);
    files.spec.robot.arm = ArmKind::Timed;
    simulate_into(files, 1, &out);
    let recording = only_recording(&out);
    let (moments, _) = shown(&recording);
    let mut replay = RecordingReplay::open(&recording).expect("a recording");
    replay.run().expect("events of a session");
    let signals = &replay.follower.signals.shown;
    let verdicts = signal_verdicts(&replay.follower).expect("a simulated participant's beliefs are known");
    assert!(signals.len() > 2 && verdicts.len() == signals.len(), "{} signals", signals.len());
    let bars = texts(&moments, "signal");
    let pages = texts(&moments, "human/now");
    for (number, signal) in (1..).zip(signals) {
        let (_, bar) = bars.iter().find(|(moment, _)| moment.time == signal.time).expect("a bar");
        assert!(
            bar.starts_with(&format!("signal {number}: "))
                && bar.contains("(probability ")
                && bar.contains(" after the cost of a signal"),
            "{bar}"
        );
        let ended = signal.ended.expect("the trial is over");
        let while_shown = pages.iter().filter(|(moment, _)| moment.time > signal.time && moment.time < ended);
        for (moment, page) in while_shown {
            assert!(page.contains(bar), "at {}: {page}", moment.time);
        }
    }
    let mut whole = moments.iter().flat_map(|moment| &moment.rows).filter_map(|row| match &row.shown {
        EntityData::WholePage(text) => Some(text),
        _ => None,
    });
    let page = whole.next_back().expect("a page of the signals");
    for verdict in verdicts {
        let told = match verdict {
            SignalVerdict::Hit { .. } => "- hit: yes, about a false belief that led to errors\n".to_string(),
            other => format!("- hit: no, {}\n", other.name()),
        };
        assert!(page.contains(&told), "{verdict:?}: {page}");
    }
    let looked: Vec<String> = signals
        .iter()
        .filter_map(|signal| {
            Some(format!("looked at after {}", wording::seconds(signal.seen?.secs_since(signal.time))))
        })
        .collect();
    assert!(!looked.is_empty() && looked.iter().all(|looked| page.contains(looked)), "{looked:?}: {page}");
    // What a signal corrected was false when it came, also if the press before it at the same time made it so.
    let track = &replay.follower.false_beliefs;
    for (nth, signal) in signals.iter().enumerate() {
        let is_false = signal.aspects().iter().any(|&aspect| track.at(aspect, signal.time).is_some());
        let outcome = signal_words::outcome(&replay.follower, nth);
        assert!(!is_false || !outcome.contains("right already"), "{outcome}");
    }
    // The value of a signal that was sent is past.
    let ends = moments.iter().flat_map(|moment| &moment.rows).filter(|row| row.shown == EntityData::NoValue);
    assert!(ends.count() >= signals.len());
    // Looks are bars and words, the robot is told, and the timed arm, whose poses are nowhere, is not drawn.
    assert!(texts(&moments, "look").iter().any(|(_, text)| text.starts_with("storage: ")));
    assert!(pages.iter().any(|(_, page)| page.contains("; before: ")));
    assert!(pages.iter().any(|(_, page)| page.contains("**Robot**: on its way to ")));
    // What there is none of is told, too.
    let says = |words: &str| pages.iter().any(|(_, page)| page.contains(words));
    assert!(says("**On the display**: no signal\n") && says("**Assistant**: no advice\n"));
    assert!(says("**Assistant**: no signal; best would be recipe of order "), "why nothing is advised");
    assert!(pages.iter().all(|(_, page)| !page.contains("**: \n")));
    assert!(!moments.iter().flat_map(|moment| &moment.rows).any(|row| row.entity.starts_with("robot/arm")));
}

#[test]
fn the_page_of_signals_grows_no_longer_than_thirty_before_it_tells_all() {
    let (mut files, out) = (session("default.toml"), folder("scene-many-signals"));
    (files.spec.trial.condition, files.spec.trial.seconds, files.spec.seed) = (Condition::Assistant, 300.0, 7);
    (files.spec.robot.arm, files.spec.assistant.cost_of_communication) = (ArmKind::Timed, 0.0);
    simulate_into(files, 1, &out);
    let (moments, _) = shown(&only_recording(&out));
    let rows = moments.iter().flat_map(|moment| &moment.rows);
    let pages: Vec<usize> = rows
        .filter_map(|row| match &row.shown {
            EntityData::WholePage(text) => Some(text.matches("- hit: ").count()),
            _ => None,
        })
        .collect();
    let (all, before) = pages.split_last().expect("a page of the signals");
    assert!(*all > 30 && before.contains(&30) && before.iter().all(|signals| *signals <= 30), "{pages:?}");
}
