//! The recommendation panel, and the key that accepts a recommendation.

use crossterm::event::KeyCode;
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::Cell;
use ratatui::style::{Color, Modifier};
use tomcom::console::panels::Panel;
use tomcom::console::view;
use tomcom::console::view::theme::{TerminalBackground, TextRole, Theme};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::recommendation::{Recommendation, SignalOption, SignalReason};
use tomcom_core::communication::settings::ShadowMode;
use tomcom_core::communication::{Sender, Signal};
use tomcom_session::event::{Event, SignalEndReason};
use tomcom_session::settings::{Condition, ParticipantKind, WizardVisibility};

use super::{SIZES, Stage, input, type_in};
use crate::check_snapshot;

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
    let for_ns = SessionTime::from_secs_f64(21.9);
    let advice = Recommendation { options, best, reason: Some(reason), ..Recommendation::silent(17, for_ns) };
    stage.at(21.9, Event::Advised(advice));
    stage.offer(22.4);
    stage.model.now = SessionTime::from_secs_f64(22.6);
    stage
}

#[test]
fn advice_is_ranked_with_its_errors_against_the_cost_of_a_signal() {
    check_snapshot("console", "advised_120x40", advised(true).screen((120, 40)));
    check_snapshot("console", "advised_200x60", advised(true).screen((200, 60)));
}

/// The texts that are inverse in the colour of signals.
fn inverse_signals(stage: &Stage, size: (u16, u16)) -> Vec<String> {
    let mut terminal = Terminal::new(TestBackend::new(size.0, size.1)).expect("a test terminal");
    terminal.draw(|frame| view(&stage.session, &stage.model, frame)).expect("drawn");
    let colour = Theme::colour(TerminalBackground::Dark, TextRole::Signal).map(Color::Indexed);
    let is_loud = |cell: &Cell| cell.modifier.contains(Modifier::REVERSED) && Some(cell.fg) == colour;
    let cells = &terminal.backend().buffer().content;
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
        let mut shown = advised(false);
        let signal = Signal::Highlight("cutting_board".to_string());
        shown.at(30.0, Event::SignalShown { by: Sender::Wizard, signal, offer: None });
        assert_eq!(inverse_signals(&shown, size), [""; 0], "{size:?}");
    }
}

#[test]
fn an_offer_says_what_is_believed_what_is_true_and_what_it_saves() {
    for size in SIZES {
        let screen = advised(true).screen(size);
        for words in
            ["thinks salmon nigiri, is tuna nigiri", "83 % for 0:0", "next error: take salmon", "saves ≈ 4 presses"]
        {
            assert!(screen.contains(words), "{words} is missing at {size:?}:\n{screen}");
        }
    }
}

#[test]
fn a_belief_has_one_certainty_on_the_screen() {
    for (held, p, words) in [
        ("shrimp nigiri", 0.44, "may think shrimp nigiri, is tuna nigiri · 44 % for 0:0"),
        ("shrimp nigiri", 0.71, "thinks shrimp nigiri, is tuna nigiri · 71 % for 0:0"),
    ] {
        let mut stage = advised(true);
        stage.estimate(&[("recipe of tuna nigiri", held, p)], false);
        for size in SIZES {
            let screen = stage.screen(size);
            assert!(screen.contains(words), "{words} at {size:?}:\n{screen}");
            assert!(!screen.contains("83 %"), "what the assistant thought then is no second certainty:\n{screen}");
        }
    }
}

/// That somebody may think the truth tells nothing: offer and list name the wrong value, and its probability.
#[test]
fn of_an_unsure_belief_the_likeliest_wrong_value_is_named() {
    let mut stage = advised(true);
    stage.estimate(&[("recipe of tuna nigiri", "tuna nigiri", 0.46)], false);
    let kitchen = stage.session.kitchen.clone();
    let aspect = kitchen.aspects.iter().find(|aspect| aspect.name == "recipe of tuna nigiri").expect("an aspect");
    let wrong = aspect.labels.iter().position(|label| label != "tuna nigiri").expect("another recipe");
    // The others are equally probable: the first is named.
    let (thinks, p) = (&aspect.wordings[wrong], format!("{:.0} %", 54.0 / (aspect.labels.len() - 1) as f64));
    stage.model.belief_focus = Some(kitchen.aspect_named("recipe of tuna nigiri").expect("an aspect"));
    for size in SIZES {
        for alone in [None, Some(Panel::Belief)] {
            stage.model.alone = alone;
            let screen = stage.screen(size);
            let offer = format!("may think {thinks}, is tuna nigiri · {p} for");
            assert!(screen.contains(&offer), "{offer} at {size:?}:\n{screen}");
            assert!(!screen.contains("may think tuna nigiri"), "{size:?}:\n{screen}");
            let list = match alone {
                None => format!("unsure, may think {thinks}"),
                Some(_) => format!("recipe of order 1: may think {thinks} {p}, is tuna nigiri"),
            };
            // On a small screen the title of the chart says only what is true.
            let is_named = screen.contains(&list) && screen.contains(&format!(" {p} "));
            assert!(is_named || (alone.is_some() && size.0 == 80), "{list} at {size:?}:\n{screen}");
        }
    }
}

/// Where a belief's words need more than one line, they have a second one: nothing is cut on a large screen.
#[test]
fn a_belief_is_told_in_full_on_a_large_screen() {
    let screen = advised(true).screen((168, 60));
    let lines: Vec<&str> = screen.lines().collect();
    let at = lines.iter().position(|line| line.contains("  recipe of order 1  ")).expect("a belief in two lines");
    assert!(lines[at].contains("83 %"), "{screen}");
    assert!(lines[at + 1].contains("  thinks salmon nigiri, is tuna nigiri "), "{screen}");
    assert!(screen.contains(" order 2: thinks none, is crab maki"), "a short one needs one line:\n{screen}");
    let screen = advised(true).screen((200, 60));
    assert!(screen.contains(" recipe of order 1: thinks salmon nigiri, is tuna nigiri "), "{screen}");
}

/// The lines of the offer, as far as they say something.
fn offer_lines(stage: &Stage, size: (u16, u16)) -> Vec<String> {
    let screen = stage.screen(size);
    let rows = if size.0 < 200 { 2 } else { 1 };
    let lines = screen.lines().skip(1).take(rows).map(|line| line.trim_matches('"').trim().to_string());
    lines.filter(|line| !line.is_empty()).collect()
}

#[test]
fn where_no_signal_is_offered_the_line_says_what_was_sent_or_why() {
    let check = |stage: &Stage, first: &str, second: &str| {
        for size in SIZES {
            let (first, second) = (first.to_string(), second.to_string());
            let lines = match size.0 {
                200 if !second.is_empty() => vec![format!("{first}; {second}")],
                _ => [first, second].into_iter().filter(|line| !line.is_empty()).collect(),
            };
            assert_eq!(offer_lines(stage, size), lines, "{size:?}");
        }
    };
    let recipe = |order: &str| Signal::ShowRecipe(order.to_string());
    let sent = |order| Event::SignalShown { by: Sender::Wizard, signal: recipe(order), offer: None };
    let mut stage = advised(false);
    // No signal saves anything, and that about the false belief can be sent again.
    let advice = stage.session.advice.as_mut().expect("advice");
    advice.options.iter_mut().for_each(|option| option.benefit = 0.0);
    check(&stage, "3 false beliefs", "");
    let options = advice_without(&stage, &recipe("order_1"));
    stage.session.advice = Some(options);
    check(&stage, "3 false beliefs", "recipe of order 1 was sent and is not repeated yet");
    stage.at(23.0, sent("order_2"));
    check(&stage, "On the display: recipe of order 2", "3 false beliefs");
    stage.at(23.2, Event::SignalEnded { reason: SignalEndReason::TakenBack });
    check(&stage, "3 false beliefs", "signals need 0.5 s between them");
    stage.wait(1.0);
    check(&stage, "3 false beliefs", "recipe of order 2 was sent and is not repeated yet");
}

/// The latest recommendation, without a signal.
fn advice_without(stage: &Stage, signal: &Signal) -> Recommendation {
    let mut advice = stage.session.advice.clone().expect("advice");
    advice.options.retain(|option| option.signal != *signal);
    advice
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
}

#[test]
fn the_offers_line_says_that_no_signal_is_worth_its_cost() {
    let stage = advised(false);
    let (wrong, best) = ("3 false beliefs", "no signal is worth its cost");
    let both = format!("{wrong}; {best}");
    for (size, lines) in SIZES.into_iter().zip([vec![wrong, best], vec![wrong, best], vec![both.as_str()]]) {
        let screen = stage.screen(size);
        let offer = screen.lines().skip(1).take(lines.len()).map(|line| line.trim_matches('"').trim());
        assert_eq!(offer.collect::<Vec<_>>(), lines, "{size:?}");
        let mut terminal = Terminal::new(TestBackend::new(size.0, size.1)).expect("a test terminal");
        terminal.draw(|frame| view(&stage.session, &stage.model, frame)).expect("drawn");
        let grey = Theme::colour(TerminalBackground::Dark, TextRole::Quiet).map(Color::Indexed);
        let row = &terminal.backend().buffer().content[usize::from(size.0)..2 * usize::from(size.0)];
        assert!(row.iter().filter(|cell| cell.symbol() != " ").all(|cell| Some(cell.fg) == grey), "quietly");
    }
}

#[test]
fn enter_accepts_what_is_recommended_and_says_so() {
    let mut seen = advised(true);
    // Signals keep apart.
    seen.model.now = SessionTime::from_secs_f64(30.0);
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
    stage.model.now = SessionTime::from_secs_f64(23.2);
    assert_eq!(input(stage.key(KeyCode::Enter)), None);
    // The answer to what was asked before comes late, and does not know of it.
    let late = |at| Recommendation { for_ns: SessionTime::from_secs_f64(at), ..advice.clone() };
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
    assert!(!stage.screen((200, 60)).contains(" offers "));
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
        let (age, thought) = (row_of("◂0s"), row_of("thinks:"));
        assert!(age.is_some() && thought.is_some() && age < thought, "{below:?} in\n{screen}");
    }
}
