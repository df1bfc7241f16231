//! What the wizard is told by the assistant: the recommendation and its key, beliefs, the comparison of wizard and assistants, the training.

use crossterm::event::KeyCode;
use ratatui::buffer::Cell;
use ratatui::style::{Color, Modifier};
use tomcom::console::beliefs::beliefs;
use tomcom::console::console_model::{
    Dialog, NoticeLevel, Playback, SenderComparisonView, TrainingFeedback, TrainingPanel,
};
use tomcom::console::panels::{Panel, screen};
use tomcom::console::view::theme::{TerminalBackground, TextRole, Theme};
use tomcom_core::communication::SignalKind;
use tomcom_core::communication::offer::OfferCloseReason;
use tomcom_core::communication::recommendation::{Recommendation, SignalOption, SignalReason};
use tomcom_core::measures::matching::CommunicationEvent;
use tomcom_session::history::belief_track;
use tomcom_session::history::belief_track::BeliefSnapshot;
use tomcom_session::history::comparison::{
    Communication, CommunicationContext, SenderCommunications, SenderComparison,
};

use super::{SIZES, Stage, input, panels, type_in};
use crate::support::*;

/// The sushi kitchen with an assistant that advises beside the wizard, and its advice.
fn advised(best: bool) -> Stage {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.assistant.shadow = ShadowMode::On;
    stage.at(21.85, Event::SignalEnded { reason: SignalEndReason::TakenBack });
    let option = |signal, benefit: f64, standard_error| SignalOption {
        signal,
        benefit,
        standard_error,
        net: benefit - 1.5,
        rollouts: 256,
    };
    let recipe = |order: &str| Signal::ShowRecipe(order.to_string());
    let highlight = |place: &str| Signal::Highlight(place.to_string());
    let options = vec![
        option(recipe("order_1"), if best { 4.2 } else { 1.2 }, 0.2),
        option(highlight("cooking_pot"), 1.1, 0.15),
        option(recipe("order_2"), 0.3, 0.1),
        option(highlight("robot_hand"), 0.0, 0.0),
    ];
    let reason = SignalReason {
        aspect: "recipe of tuna nigiri".to_string(),
        believes: "salmon nigiri".to_string(),
        truth: "tuna nigiri".to_string(),
        p_believes: 0.83,
        prevents: Some("take salmon".to_string()),
        instead: None,
    };
    let best = best.then(|| recipe("order_1"));
    let for_ns = at(21.9);
    let advice = Recommendation { options, best, reason: Some(reason), ..Recommendation::silent(17, for_ns) };
    stage.at(21.9, Event::Advised(advice));
    stage.offer(22.4);
    stage.model.now = at(22.6);
    stage
}

#[test]
fn advice_is_ranked_with_its_errors_against_the_cost_of_a_signal() {
    check_snapshot("console", "advised_120x40", advised(true).screen((120, 40)));
    check_snapshot("console", "advised_200x60", advised(true).screen((200, 60)));
}

/// The texts that are inverse in the colour of signals.
fn inverse_signals(stage: &Stage, size: (u16, u16)) -> Vec<String> {
    let drawn = stage.drawn(size);
    let colour = Theme::colour(TerminalBackground::Dark, TextRole::Signal).map(Color::Indexed);
    let is_loud = |cell: &Cell| cell.modifier.contains(Modifier::REVERSED) && Some(cell.fg) == colour;
    let cells = &drawn.buffer().content;
    let runs = cells.chunk_by(|a, b| is_loud(a) == is_loud(b)).filter(|run| is_loud(&run[0]));
    runs.map(|run| run.iter().map(Cell::symbol).collect::<String>().trim().to_string()).collect()
}

#[test]
fn the_offer_alone_is_inverse_in_the_colour_of_signals() {
    for size in SIZES {
        assert_eq!(inverse_signals(&advised(true), size), ["enter  SHOW RECIPE OF ORDER 1 [q]"], "{size:?}");
        assert_eq!(inverse_signals(&advised(false), size), [""; 0], "{size:?}");
        let mut paused = advised(true);
        paused.at(22.6, Event::TrialPaused);
        assert_eq!(inverse_signals(&paused, size).len(), 1, "{size:?}");
        let mut replayed = advised(true);
        replayed.replays(Playback::new("S001".to_string()));
        replayed.shows(size, &["SHOW RECIPE OF ORDER 1"]);
        replayed.hides(size, &["[q]"]);
        let mut shown = advised(false);
        let signal = Signal::Highlight("cutting_board".to_string());
        shown.at(30.0, Event::SignalShown { by: Sender::Wizard, signal, offer: None });
        assert_eq!(inverse_signals(&shown, size), [""; 0], "{size:?}");
    }
}

#[test]
fn an_offer_says_what_is_believed_what_is_true_and_what_it_saves() {
    let words = ["thinks cut salmon, needs cut tuna", "83 % for 0:0", "next error: take salmon"];
    advised(true).shows_everywhere(&words);
    advised(true).shows_everywhere(&["saves ≈ 4.2 presses, net +2.7"]);
}

/// The offer's text is that of its opening, whatever the estimate says since.
#[test]
fn an_offer_holds_still_while_the_estimate_changes() {
    for size in SIZES {
        let mut stage = advised(true);
        let opened = offer_lines(&stage, size);
        assert!(opened.join(" ").contains("as of 0:19") || size.0 == 80, "{opened:?}");
        for (held, p) in [("shrimp nigiri", 0.71), ("tuna nigiri", 0.46), ("tuna nigiri", 0.99)] {
            stage.wait(2.0);
            stage.estimate(&[("recipe of tuna nigiri", held, p)], false);
            assert_eq!(offer_lines(&stage, size), opened, "{held} {p} at {size:?}");
        }
    }
}

/// That somebody may think the truth tells nothing: the list names the wrong value, and its probability.
#[test]
fn of_an_unsure_belief_the_likeliest_wrong_value_is_named() {
    let mut stage = advised(true);
    stage.estimate(&[("recipe of tuna nigiri", "tuna nigiri", 0.46)], false);
    let kitchen = stage.session.kitchen.clone();
    let aspect = kitchen.aspects.iter().find(|aspect| aspect.name == "recipe of tuna nigiri").expect("an aspect");
    let wrong = aspect.labels.iter().position(|label| label != "tuna nigiri").expect("another recipe");
    // The others are equally probable: the first is named, by the ingredient that differs.
    assert_eq!(aspect.labels[wrong], "salmon nigiri");
    let (thinks, p) = ("cut salmon", format!("{:.0} %", 54.0 / (aspect.labels.len() - 1) as f64));
    stage.model.belief_focus = Some(kitchen.aspect_named("recipe of tuna nigiri").expect("an aspect"));
    for size in SIZES {
        for alone in [None, Some(Panel::Belief)] {
            stage.model.alone = alone;
            let screen = stage.screen(size);
            assert!(!screen.contains("may think cut tuna"), "{size:?}:\n{screen}");
            let (list, certainty) = match alone {
                None => (format!("unsure, may think {thinks}"), format!(" {p} ")),
                Some(_) => (format!("recipe of order 1: may think {thinks} {p}, needs cut tuna"), String::new()),
            };
            // On a small screen the title of the chart says only what is true.
            let is_named = screen.contains(&list) && screen.contains(&certainty);
            assert!(is_named || (alone.is_some() && size.0 == 80), "{list} at {size:?}:\n{screen}");
        }
    }
}

/// The lines of the offer, as far as they say something.
fn offer_lines(stage: &Stage, size: (u16, u16)) -> Vec<String> {
    let screen = stage.screen(size);
    let rows = if size.0 < 200 { 2 } else { 1 };
    let lines = screen.lines().skip(1).take(rows).map(|line| line.trim_matches('"').trim().to_string());
    lines.filter(|line| !line.is_empty()).collect()
}

#[test]
fn while_nothing_is_offered_the_line_changes_only_with_the_beliefs() {
    let check = |stage: &Stage, words: &str| {
        for size in SIZES {
            assert_eq!(offer_lines(stage, size), [words], "{size:?}");
            let drawn = stage.drawn(size);
            let grey = Theme::colour(TerminalBackground::Dark, TextRole::Quiet).map(Color::Indexed);
            let row = &drawn.buffer().content[usize::from(size.0)..2 * usize::from(size.0)];
            assert!(row.iter().filter(|cell| cell.symbol() != " ").all(|cell| Some(cell.fg) == grey), "quietly");
        }
    };
    let recipe = |order: &str| Signal::ShowRecipe(order.to_string());
    let sent = |order| Event::SignalShown { by: Sender::Wizard, signal: recipe(order), offer: None };
    let mut stage = advised(false);
    let wrong = "nothing worth saying: 3 false beliefs cost less than a signal";
    check(&stage, wrong);
    stage.at(23.0, sent("order_2"));
    check(&stage, wrong);
    stage.at(23.2, Event::SignalEnded { reason: SignalEndReason::TakenBack });
    check(&stage, wrong);
    let right = [("recipe of tuna nigiri", "tuna nigiri", 0.99), ("robot_hand", "tuna cut", 0.99)];
    stage.estimate(&right, false);
    check(&stage, "nothing worth saying: 1 false belief costs less than a signal");
    stage.estimate(&[("order_2", "crab maki", 0.99)], false);
    check(&stage, "nothing worth saying");
    // A replay says which signal was best.
    stage.replays(Playback::new("S001".to_string()));
    let best = "no signal; best would be recipe of order 1: saves 1.20 presses, -0.30 after the cost of a signal";
    stage.shows((120, 40), &[best]);
    stage.session.spec.trial.condition = Condition::Assistant;
    stage.shows((120, 40), &[best]);
}

#[test]
fn an_external_concept_says_why_in_its_own_words() {
    let mut stage = advised(false);
    let recipe = Signal::ShowRecipe("order_1".to_string());
    let words = Some("it is\tnew".to_string());
    let advice = Recommendation { best: Some(recipe.clone()), words, ..Recommendation::silent(18, at(23.0)) };
    stage.at(23.0, Event::Advised(advice));
    stage.shows_everywhere(&["it is\\tnew"]);
    stage.session.spec.trial.condition = Condition::Assistant;
    stage.at(23.1, Event::SignalShown { by: Sender::Assistant, signal: recipe, offer: None });
    stage.shows_everywhere(&["The assistant's recipe of order 1: it is\\tnew"]);
}

#[test]
fn an_offer_that_holds_still_keeps_its_row_among_the_signals() {
    let mut stage = advised(true);
    let advice = stage.session.advice.as_mut().expect("an advice");
    advice.options.iter_mut().for_each(|option| option.net = -0.2);
    stage.shows((200, 60), &["offered"]);
}

#[test]
fn a_closed_offer_fades_while_it_can_be_taken_and_is_told_in_the_timeline_then() {
    let mut stage = advised(true);
    let offer = stage.session.offers.open().map(|offer| offer.seq).expect("an offer");
    stage.at(26.0, Event::OfferClosed { offer, reason: OfferCloseReason::Fell });
    stage.wait(1.0);
    stage.shows_everywhere(&["recipe of order 1: no longer worth it; enter still sends it"]);
    stage.hides((200, 60), &["missed"]);
    stage.wait(0.5);
    stage.shows_everywhere(&["nothing worth saying: 3 false beliefs"]);
    stage.wait(5.0);
    for size in &SIZES[1..] {
        stage.shows(*size, &["─ missed"]);
    }
}

#[test]
fn an_offer_says_which_signal_on_the_display_it_would_replace() {
    let mut stage = advised(true);
    stage.hides((200, 60), &["replaces"]);
    let signal = Signal::Highlight("cutting_board".to_string());
    stage.at(22.6, Event::SignalShown { by: Sender::Wizard, signal, offer: None });
    stage.shows_everywhere(&["replaces highlight cutting board"]);
}

#[test]
fn enter_is_named_only_where_it_sends() {
    let hints = |stage: &Stage| stage.screen((200, 60)).contains("enter send offer");
    let names = |stage: &Stage| stage.screen((200, 60)).contains("enter  SHOW RECIPE");
    let mut stage = advised(true);
    assert!(!hints(&stage), "the offer has just appeared");
    stage.wait(0.4);
    assert!(hints(&stage) && names(&stage));
    stage.control('k');
    type_in(&mut stage, "finish");
    stage.key(KeyCode::Enter);
    stage.model.dialog = None;
    assert!(!hints(&stage), "a list has just closed");
    stage.wait(0.3);
    assert_eq!(stage.key(KeyCode::Enter), None);
    assert!(stage.notice().contains("right after a list"), "{}", stage.notice());
    stage.wait(1.0);
    assert!(hints(&stage));
    assert!(input(stage.key(KeyCode::Enter)).is_some());
    stage.session.spec.trial.condition = Condition::None;
    stage.wait(1.0);
    assert!(!hints(&stage) && !names(&stage), "nobody may send:\n{}", stage.screen((200, 60)));
    // What is never so comes before what is not so now.
    for phase in [TrialPhase::Ready, TrialPhase::Running, TrialPhase::Over(TrialEndReason::Presses)] {
        let never = "nobody sends signals in the unassisted condition";
        for (condition, why) in [(Condition::None, never), (Condition::Wizard, "signals are sent while the trial runs")]
        {
            (stage.session.phase, stage.session.spec.trial.condition) = (phase, condition);
            stage.wait(1.0);
            stage.key(KeyCode::Enter);
            let is_told = stage.notice().contains(why);
            assert_eq!(is_told, why == never || phase != TrialPhase::Running, "{phase:?}: {}", stage.notice());
        }
    }
}

#[test]
fn enter_accepts_what_is_recommended_and_says_so() {
    let mut seen = advised(true);
    // Signals keep apart.
    seen.model.now = at(30.0);
    let accepted = input(seen.key(KeyCode::Enter));
    let offer = seen.session.offers.open().map(|offer| offer.seq);
    let Some(Event::SignalShown { by: Sender::Wizard, signal, offer: taken }) = accepted else {
        panic!("not accepted: {accepted:?}");
    };
    assert_eq!((signal, taken), (Signal::ShowRecipe("order_1".to_string()), offer));
    assert_eq!(input(advised(false).key(KeyCode::Enter)), None, "there is nothing to accept");
    let mut unseen = advised(true);
    unseen.session.spec.console.visibility = WizardVisibility::State;
    assert_eq!(input(unseen.key(KeyCode::Enter)), None, "what is not shown is not accepted");
}

#[test]
fn what_was_sent_is_not_offered_again_before_there_is_newer_advice() {
    let mut stage = advised(true);
    let advice = stage.session.advice.clone().expect("advice");
    let sent = advice.best.clone().expect("a recommendation");
    let offer = stage.session.offers.open().map(|offer| offer.seq);
    stage.at(22.6, Event::SignalShown { by: Sender::Wizard, signal: sent, offer });
    stage.offer(22.6);
    stage.model.now = at(23.2);
    assert_eq!(input(stage.key(KeyCode::Enter)), None);
    // The answer to what was asked before comes late, and does not know of it.
    let late = |seconds| Recommendation { for_ns: at(seconds), ..advice.clone() };
    stage.at(23.7, Event::Advised(late(22.5)));
    stage.offer(23.7);
    assert_eq!(input(stage.key(KeyCode::Enter)), None);
    stage.at(26.6, Event::SignalEnded { reason: SignalEndReason::TakenBack });
    stage.at(30.0, Event::Advised(late(30.0)));
    stage.offer(30.0);
    stage.wait(1.0);
    assert!(input(stage.key(KeyCode::Enter)).is_some(), "that is newer");
}

#[test]
fn what_is_offered_stands_first_among_the_beliefs_and_is_never_called_right() {
    let mut stage = advised(true);
    // The estimate has come to think that the recipe is known, and that the rolling mat is not.
    stage.estimate(&[("recipe of tuna nigiri", "tuna nigiri", 0.7), ("rolling_mat", "nori", 0.9)], false);
    for size in SIZES {
        let screen = stage.screen(size);
        let lines: Vec<&str> = screen.lines().collect();
        let list = lines.iter().position(|line| line.contains("Beliefs ─")).map(|title| title + 1);
        let first = list.or(lines.iter().position(|line| line.contains(" beliefs  "))).map(|first| lines[first]);
        assert!(
            first.is_some_and(|first| first.contains("recipe of order 1") && screen.contains("unsure")),
            "{size:?}:\n{screen}"
        );
    }
}

#[test]
fn the_timeline_shows_offers_from_their_opening_to_their_close() {
    let row = |stage: &Stage| {
        let screen = stage.screen((200, 60));
        let row = screen.lines().find(|line| line.contains(" offers ")).map(str::to_string);
        row.unwrap_or_else(|| panic!("no row of offers:\n{screen}"))
    };
    let mut stage = advised(true);
    stage.wait(4.0);
    assert!(row(&stage).contains("q────────"), "open for more than 4 s: {}", row(&stage));
    assert!(!row(&stage).contains('✓'));
    let offer = stage.session.offers.open().map(|offer| offer.seq);
    let signal = Signal::ShowRecipe("order_1".to_string());
    stage.at(27.0, Event::SignalShown { by: Sender::Wizard, signal, offer });
    stage.offer(27.0);
    assert!(row(&stage).contains("──────✓"), "taken: {}", row(&stage));
    stage.session.spec.console.visibility = WizardVisibility::Belief;
    stage.hides((200, 60), &[" offers "]);
}

#[test]
fn the_age_of_a_change_stands_above_what_is_thought_of_the_place() {
    let mut stage = advised(true);
    let hand = stage.session.kitchen.location_named("robot_hand").expect("the robot's hand");
    stage.session.changed_at[hand.index()] = stage.model.now;
    for size in [(120, 40), (200, 60)] {
        let screen = stage.screen(size);
        let rows: Vec<Vec<char>> = screen.lines().map(|line| line.chars().collect()).collect();
        let key: Vec<char> = "[r]".chars().collect();
        let found = rows.iter().enumerate().find_map(|(y, row)| {
            let x = row.windows(key.len()).position(|cells| cells == key)?;
            Some((y, x))
        });
        let (top, x) = found.unwrap_or_else(|| panic!("no key of the robot's hand in\n{screen}"));
        let below: Vec<String> = rows[top + 1..top + 5].iter().map(|row| row[x..x + 14].iter().collect()).collect();
        let row_of = |words: &str| below.iter().position(|line| line.contains(words));
        // Where the believed value does not fit, it says only that there is a false belief.
        let (age, thought) = (row_of("◂0s"), row_of("thinks:").or(row_of("false belief")));
        assert!(age.is_some() && thought.is_some() && age < thought, "{below:?} in\n{screen}");
    }
}

#[test]
fn one_belief_is_looked_at_over_time_and_then_the_next() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let all = panels(&stage);
    // Recipes of dishes that nobody ordered are not among them.
    let shown = beliefs(&stage.session, &stage.model).len();
    let mut seen = Vec::new();
    for _ in 0..3 {
        stage.control('b');
        let focus = stage.model.belief_focus.expect("a belief is shown");
        seen.push(stage.session.kitchen.aspects[focus.index()].name.clone());
        assert_eq!(panels(&stage), ["belief", "recommendation"], "the belief alone, with the offer's line");
        stage.wait(1.0);
    }
    assert_eq!(seen, ["order_2", "recipe of tuna nigiri", "robot_hand"], "the longest first");
    stage.key(KeyCode::Esc);
    assert_eq!((panels(&stage), stage.model.belief_focus), (all, None), "esc leaves it");
    for _ in 0..3 {
        stage.wait(1.0);
        stage.control('b');
    }
    stage.shows_everywhere(&["robot hand: thinks raw tuna 52 %, is cut tuna", "probability of the truth"]);
    check_snapshot("console", "belief_over_time_120x40", stage.screen((120, 40)));
    for _ in 0..shown - 2 {
        stage.wait(1.0);
        stage.control('b');
    }
    assert_eq!(stage.model.belief_focus, None, "after the last one none");
}

#[test]
fn the_belief_has_the_room_of_the_recommendation_where_there_is_none() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.console.visibility = WizardVisibility::Belief;
    let screen = stage.shows((120, 40), &["9 others are probably right", "order 2: probability of crab maki"]);
    assert!(!screen.contains("Signals by benefit"), "{screen}");
}

/// The chart is on the trial's clock: in a pause and after the trial nothing moves, and a long pause removes nothing.
#[test]
fn the_chart_of_a_belief_stands_while_the_trial_does() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.control('b');
    // As a running session does: gaze goes on in a pause and after the trial, and old estimates are forgotten.
    let wait = |stage: &mut Stage, seconds: u32| {
        for _ in 0..5 * seconds {
            let now = stage.model.now.as_secs_f64() + 0.2;
            stage.look(now, 0.4, 0.35);
            stage.estimate(&[], true);
            stage.model.belief.forget(&stage.session, stage.model.now, belief_track::SHOWN_S);
        }
    };
    let charts = |stage: &Stage| {
        SIZES.map(|size| {
            let screen = stage.screen(size);
            let lines: Vec<&str> = screen.lines().skip_while(|line| !line.contains("Beliefs")).collect();
            lines[..lines.len() - 2].join("\n")
        })
    };
    stage.at(23.0, Event::TrialPaused);
    let paused = charts(&stage);
    wait(&mut stage, 300);
    assert_eq!(charts(&stage), paused, "in a pause");
    let moments = stage.model.belief.until(stage.model.now).len();
    assert!(moments < 20, "estimates that are the same are kept once: {moments}");
    stage.at(324.0, Event::TrialResumed);
    assert_eq!(charts(&stage), paused, "it goes on where it stood");
    wait(&mut stage, 10);
    assert_ne!(charts(&stage), paused, "in the running trial it moves");
    stage.at(335.0, Event::TrialEnded { reason: TrialEndReason::Time });
    let over = charts(&stage);
    wait(&mut stage, 120);
    assert_eq!(charts(&stage), over, "after the trial");
}

/// A long session needs no more memory than a short one, and still knows since when what is believed wrong.
#[test]
fn the_belief_forgets_what_no_panel_shows() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    stage.at(1.0, Event::TrialStarted);
    stage.estimate(&[("cooking_pot", "rice raw", 0.9)], false);
    let aspect = stage.session.kitchen.location_named("cooking_pot").expect("a pot").index();
    for second in 2..3600 {
        stage.model.now = at(f64::from(second));
        let p = if second % 2 == 0 { 0.8 } else { 0.9 };
        stage.estimate(&[("cooking_pot", "rice raw", p)], false);
        stage.model.belief.forget(&stage.session, stage.model.now, belief_track::SHOWN_S);
        let moments = stage.model.belief.until(stage.model.now);
        assert!(moments.len() <= 200, "{} moments", moments.len());
        assert!(second < 70 || moments[0].time.as_secs_f64() <= f64::from(second) - belief_track::SHOWN_S);
        assert_eq!(belief_track::wrong_since(moments, aspect), Some(at(1.0)));
    }
    stage.model.now = at(3700.0);
    stage.estimate(&[("cooking_pot", "empty", 0.9)], true);
    assert_eq!(belief_track::wrong_since(stage.model.belief.until(stage.model.now), aspect), None);
}

/// The sushi kitchen, compared: the wizard with so many assistants.
fn compared(assistants: usize) -> Stage {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.model.keys = stage.model.keys.clone().with_comparison();
    let kitchen = stage.session.kitchen.clone();
    let recipe = |order: &str| Signal::ShowRecipe(order.to_string());
    let highlight = |place: &str| Signal::Highlight(place.to_string());
    let held = BeliefSnapshot::new(&kitchen, stage.session.state, &stage.belief, stage.model.now, false).held;
    let said = |press: u32, seconds: f64, what: Signal| {
        let best = Some(what.clone()).filter(|signal| signal.kind() != SignalKind::Proposal);
        let option = |signal: &Signal| SignalOption {
            signal: signal.clone(),
            benefit: 4.2,
            standard_error: 0.2,
            net: 2.7,
            rollouts: 256,
        };
        let options = best.iter().map(option).collect();
        let advice = Recommendation { options, best, ..Recommendation::silent(7, stage.model.now) };
        let (state, screen) = (stage.session.state, Some(screen(&stage.session, &stage.model)));
        let known = CommunicationContext { seq: 7, state, held: held.clone(), advice: vec![advice; 3], screen };
        let clock = at(seconds - 3.0);
        let said = CommunicationEvent { press, clock, content: what.compared(&kitchen) };
        Communication { said, time: at(seconds), what, known: Some(Arc::new(known)) }
    };
    let lane = |name: &str, concept, spoken| SenderCommunications { name: name.to_string(), concept, spoken };
    let sent = vec![said(5, 12.0, highlight("cutting_board")), said(9, 21.8, recipe("order_1"))];
    let planned = vec![
        said(2, 8.2, highlight("cooking_pot")),
        said(5, 10.6, highlight("cutting_board")),
        said(9, 21.1, recipe("order_1")),
    ];
    let proposed = Signal::Propose(vec!["take_nori".to_string(), "assembly_board".to_string()]);
    let mut lanes = vec![
        lane("wizard", None, sent),
        lane("tom-com", Some(ConceptName::TomCom), planned),
        lane("tom", Some(ConceptName::Tom), vec![said(4, 9.3, recipe("order_1")), said(9, 22.1, recipe("order_1"))]),
        lane("dev", Some(ConceptName::Dev), vec![said(6, 15.0, proposed)]),
    ];
    lanes.truncate(assistants + 1);
    let mut comparison = SenderComparisonView::default();
    comparison.show(SenderComparison::new(lanes, 3, 10, false));
    stage.model.comparison = Some(comparison);
    stage
}

#[test]
fn wizard_and_assistant_stand_side_by_side_at_every_size() {
    let figures = ["recall 1.00", "precision 0.67, F1 0.80, kappa 0.77, lead +1.0 s"];
    let mut plain = compared(3);
    plain.model.theme = Theme { colour: false, unicode: false, ground: TerminalBackground::Dark };
    for size in SIZES {
        let one = compared(1);
        one.shows(size, &figures);
        // The lead of the assistant is a line between two signals.
        one.shows(size, &["1/1  0:05  only tom-com: highlight cooking pot", "p c", "╭─╯"]);
        compared(3).shows(size, &figures);
        compared(3).shows(size, &["5/5  0:12  dev, not wizard: press take nori, then assembly board", "◆"]);
        compared(3).shows(size, &["wizard", "tom-com", "tom ", "dev"]);
        assert!(plain.screen(size).is_ascii(), "{}", plain.screen(size));
    }
    check_snapshot("console", "compared_all_120x40", compared(3).screen((120, 40)));
    let mut alone = compared(3);
    alone.model.alone = Some(Panel::Comparison);
    alone.shows((80, 24), &["recall", "kappa", "lead", "1/"]);
}

#[test]
fn a_difference_is_chosen_and_opened_by_keys_and_the_screen_says_what_was_seen() {
    let mut stage = compared(1);
    let panels = screen(&stage.session, &stage.model).panels;
    assert!(panels.iter().any(|panel| panel == "comparison"), "{panels:?}");
    assert_eq!(
        stage.model.comparison.as_ref().and_then(|one| one.seen.as_ref()).map(|one| one.differences.len()),
        Some(1)
    );
    let mut stage_of_all = compared(3);
    for (stage, words) in
        [(&mut stage, "0:05  only tom-com: highlight cooking pot"), (&mut stage_of_all, "dev, not wizard")]
    {
        assert!(stage.screen((120, 40)).contains(words), "{}", stage.screen((120, 40)));
        stage.control('o');
        assert_eq!(screen(&stage.session, &stage.model).dialog.as_deref(), Some("difference"));
        let seen = "panels on the wizard's screen: orders, kitchen";
        stage.shows((120, 40), &["What wizard and assistant knew", "true contents of the kitchen:", seen]);
    }
    check_snapshot("console", "compared_opened_120x40", stage.screen((120, 40)));
    // The one before, without closing; then any key closes.
    stage_of_all.control('t');
    assert!(matches!(stage_of_all.model.dialog, Some(Dialog::Details(..))));
    stage_of_all.hides((120, 40), &["dev, not wizard: press take nori, then assembly board\npress"]);
    stage_of_all.key(KeyCode::Char('x'));
    assert_eq!(stage_of_all.model.dialog, None);
    // Without a comparison the keys have no meaning.
    let mut alone = Stage::sushi(ParticipantKind::Simulated);
    alone.control('o');
    assert_eq!(alone.model.dialog, None);
}

#[test]
fn a_training_says_what_to_do_keeps_what_it_said_and_ends_when_that_is_read() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.console.visibility = WizardVisibility::State;
    stage.model.playback = Some(Playback::new("seed1-S001".to_string()));
    let task = ["A hit is the first signal about a false belief that leads to an error."];
    let lesson = TrainingPanel {
        task: task.map(str::to_string).to_vec(),
        score: "3 hit, 12 missed, 10 wrong or needless".to_string(),
        ..TrainingPanel::default()
    };
    stage.model.lesson = Some(lesson.clone());
    stage.shows((120, 40), &["Press . to start.", "A hit is the first signal"]);
    stage.model.lesson = Some(TrainingPanel { begun: true, ..lesson.clone() });
    assert!(!stage.screen((120, 40)).contains("to start"), "{}", stage.screen((120, 40)));
    let said = |seconds: f64, level: NoticeLevel, text: &str| {
        let clock = at(seconds);
        TrainingFeedback { clock, level, text: text.to_string() }
    };
    let long = "missed, with 2 errors: recipe of tuna nigiri: believed salmon nigiri, truly tuna nigiri; right would have been: recipe of order 1";
    let feedback = vec![
        said(4.0, NoticeLevel::Done, "highlight plate: repeated: a signal already told this"),
        said(9.0, NoticeLevel::Refused, long),
        said(12.0, NoticeLevel::Done, "recipe of order 1: hit: the belief has been false for 3.1 s"),
    ];
    stage.model.lesson = Some(TrainingPanel { feedback, begun: true, ..lesson });
    stage.shows_everywhere(&["0:12 recipe of order 1: hit:", "0:09 missed, with 2 errors"]);
    check_snapshot("console", "training_120x40", stage.screen((120, 40)));
    stage.control('b');
    assert!(stage.notice().contains("not shown in this session"), "{}", stage.notice());
    stage.model.dialog = Some(Dialog::Report(vec!["1 of 2 hit".to_string(), "    missed; ".to_string() + long]));
    let report = ["The training is over", "1 of 2 hit", "would have been: recipe of order 1", "this report is saved"];
    stage.shows((120, 40), &report);
    stage.wait(1.0);
    stage.key(KeyCode::Char('q'));
    assert!(stage.model.dialog.is_some(), "a signal that came too late closes nothing");
    stage.key(KeyCode::Enter);
    assert_eq!(stage.model.dialog, None);
}
