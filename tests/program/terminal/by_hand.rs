//! A participant at the keyboard and the mouse, and gaze from another program.

use std::io::Write;
use std::time::{Duration, Instant};

use tomcom::console::kitchen_map::KitchenMap;
use tomcom::console::kitchen_map::KitchenMapElement;
use tomcom::console::view::regions::PanelAreas;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, ButtonAction, ButtonId};
use tomcom_session::replay::RecordingReplay;
use tomcom_session::settings::WizardVisibility;

use super::kitchen;
use crate::program::{PATIENCE, session_with_tracker};
use crate::pseudo_terminal::{SIZE, Terminal};

/// Makes and serves an order by hand: the person looks at the place and presses its button, the robot helps.
fn check_by_hand(session: &str) {
    let terminal = Terminal::open(&format!("by-hand-{session}"));
    let kitchen = kitchen(session);
    terminal.operate(session, &["--participant", "keyboard", "--gaze", "mouse"]);
    terminal.begin();
    terminal.key("Tab");
    terminal.see("KEYS: PARTICIPANT");
    let areas = PanelAreas::new(SIZE, &kitchen, WizardVisibility::Recommendation, None).kitchen_inside();
    let plan = KitchenMap::new(&kitchen, areas, true);
    let mut cost = CostToGo::new(kitchen.clone());
    let mut replay = RecordingReplay::open(&terminal.recording()).expect("it opens while it is written");
    let recipes = kitchen.true_recipes();
    let mut hands = 0;
    let began = Instant::now();
    while replay.session().served.is_empty() {
        assert!(began.elapsed() < 2 * PATIENCE, "no order was served:\n{}", terminal.screen());
        while replay.step().expect("it can be read while it is written").is_some() {}
        let state = replay.session().state;
        let here = cost.all_orders(state, &recipes);
        let buttons = (0..kitchen.buttons[Agent::Human.index()].len()).map(|index| ButtonId(index as u8));
        let helps = |button: &ButtonId| {
            let next = kitchen.press(state, &recipes, Agent::Human, *button);
            next.is_some_and(|next| cost.all_orders(next, &recipes) < here)
        };
        let Some(button) = buttons.filter(|_| here > 0).find(helps) else {
            std::thread::sleep(Duration::from_millis(20));
            continue;
        };
        let button = kitchen.button(Agent::Human, button);
        let place = |thing: &KitchenMapElement| match button.action {
            ButtonAction::Use(location) | ButtonAction::Serve(location) => {
                *thing == KitchenMapElement::Location(location)
            }
            ButtonAction::Take(item) => matches!(thing, KitchenMapElement::Storage(index)
                if kitchen.storages[*index].agent == Agent::Human && kitchen.storages[*index].item == item),
            ButtonAction::Process(_) | ButtonAction::Trash => {
                *thing == KitchenMapElement::Location(kitchen.hands[Agent::Human.index()])
            }
        };
        let spot = plan.spots.iter().find(|spot| place(&spot.thing)).expect("every button is about a place");
        let samples = terminal.count("\"kind\":\"gaze\"");
        terminal.point(spot.cells.x + spot.cells.width / 2, spot.cells.y + spot.cells.height / 2);
        // The pointer is seen before the press, also where the next one follows in a moment.
        terminal.gaze(samples + 2);
        let key = button.key.expect("every button of the human has a key").to_string();
        terminal.key_logs(&key, &format!("\"agent\":\"human\",\"button\":\"{}\"", button.name));
        hands += 1;
    }
    terminal.see("1 served");
    assert!(hands > 4, "the person did {hands} presses of it");
    assert!(replay.session().gaze.samples > 100, "the pointer is a steady stream of gaze");
    assert!(replay.session().gaze.looked_at.iter().flatten().count() > 1, "the person looked at several places");
    terminal.quit();
    terminal.verifies();
}

/// In a terminal that reports no releases of keys.
#[test]
fn the_same_button_pressed_twice_is_in_the_log_twice_and_a_held_one_once() {
    let terminal = Terminal::open("twice");
    let kitchen = kitchen("default.toml");
    terminal.operate("default.toml", &["--participant", "keyboard", "--gaze", "mouse"]);
    terminal.send(".");
    terminal.see("start the trial anyway");
    terminal.send("o");
    terminal.see("RUNNING");
    terminal.send("\t");
    terminal.see("KEYS: PARTICIPANT");
    let button = kitchen.button_named(Agent::Human, "assembly_board").expect("a button of the sushi kitchen");
    let key = kitchen.button(Agent::Human, button).key.expect("a key").to_string();
    let presses = "\"agent\":\"human\",\"button\":\"assembly_board\"";
    // All reports at once, as of a key that is held down.
    terminal.send(&key.repeat(20));
    terminal.see("is held down: it counts as one press");
    // Longer than between two reports of a held key: nothing else tells them from a second press.
    std::thread::sleep(Duration::from_millis(360));
    terminal.send(&key);
    terminal.wait("a second press", || terminal.count(presses) > 1);
    assert_eq!(terminal.count(presses), 2);
    terminal.quit();
    terminal.verifies();
}

#[test]
fn an_order_is_made_and_served_by_hand_in_the_sushi_kitchen() {
    check_by_hand("default.toml");
}

#[test]
fn an_order_is_made_and_served_by_hand_in_the_burger_kitchen() {
    check_by_hand("burger.toml");
}

#[test]
fn the_bell_rings_where_gaze_is_lost_in_a_trial_if_the_session_asks_for_it() {
    let terminal = Terminal::open("bell");
    let (session, connect) = session_with_tracker(&terminal.folder);
    let text = std::fs::read_to_string(&session).expect("a session file");
    std::fs::write(&session, text.replace("bell = []", "bell = [\"gaze\"]")).expect("written");
    let out = terminal.recordings();
    terminal.run(&["operate", &session, "--out", &out, "--participant", "keyboard", "--gaze", "json"]);
    terminal.see("READY");
    let mut tracker = connect();
    let mut send = |samples: usize| {
        for _ in 0..samples {
            writeln!(tracker, "{{\"x\": 0.40, \"y\": 0.35, \"confidence\": 0.9}}").expect("sent");
            std::thread::sleep(Duration::from_millis(20));
        }
    };
    send(20);
    terminal.begin();
    assert_eq!(terminal.bells(), 0);
    // It is watched that gaze comes, and then it does not any more.
    send(30);
    terminal.wait("the bell", || terminal.bells() == 1);
    terminal.quit();
    assert_eq!(terminal.bells(), 1);
}

#[test]
fn gaze_comes_from_any_program_that_writes_lines() {
    let terminal = Terminal::open("json");
    let (session, connect) = session_with_tracker(&terminal.folder);
    let out = terminal.recordings();
    terminal.run(&["operate", &session, "--out", &out, "--participant", "keyboard", "--gaze", "json"]);
    terminal.see("READY");
    let mut tracker = connect();
    for step in 0..50 {
        let t = f64::from(step) / 50.0;
        writeln!(tracker, "{{\"t\": {t}, \"x\": 0.40, \"y\": 0.35, \"confidence\": 0.9}}").expect("sent");
        // As often as a tracker.
        std::thread::sleep(Duration::from_millis(20));
    }
    // Python's json writes NaN.
    writeln!(tracker, "{{\"t\": 1.0, \"x\": 0.40, \"y\": 0.35, \"confidence\": NaN}}").expect("sent");
    terminal.see("gaze without confidence is recorded and not read");
    writeln!(tracker, "nonsense").expect("sent");
    terminal.see("1 malformed");
    terminal.see("assembly board");
    terminal.wait("51 samples", || terminal.count("\"kind\":\"gaze\"") == 51);
    assert_eq!(terminal.count("\"confidence\":0.0,"), 1);
    terminal.quit();
    terminal.verifies();
}
