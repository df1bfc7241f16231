//! A participant at the keyboard and the mouse, and gaze from another program.

use std::fs;
use std::time::{Duration, Instant};

use serial_test::serial;
use tomcom::console::arrange::KitchenMap;
use tomcom::console::map_items::KitchenMapElement;
use tomcom::console::view::regions::PanelAreas;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, ButtonAction, ButtonId};
use tomcom::run::replay::RecordingReplay;
use tomcom::session::settings::WizardVisibility;

use super::kitchen;
use crate::tmux::{PATIENCE, SIZE, TOMCOM, Terminal};

/// Makes and serves an order by hand: the person looks at the place and presses its button, the robot helps.
fn check_by_hand(session: &str) {
    let Some(terminal) = Terminal::open(&format!("by-hand-{session}")) else { return };
    let kitchen = kitchen(session);
    terminal.operate(session, "--participant keyboard --gaze mouse");
    terminal.start();
    terminal.key("Tab");
    terminal.see("KEYS: PARTICIPANT");
    let panel = PanelAreas::new(SIZE, WizardVisibility::Recommendation, None).kitchen_inside();
    let plan = KitchenMap::new(&kitchen, panel, true);
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
            std::thread::sleep(Duration::from_millis(50));
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
        terminal.point(spot.cells.x + spot.cells.width / 2, spot.cells.y + spot.cells.height / 2);
        let key = button.key.expect("every button of the human has a key").to_string();
        terminal.key_logs(&key, &format!("\"agent\":\"human\",\"button\":\"{}\"", button.name));
        hands += 1;
        // The same key again at once would count as held down.
        std::thread::sleep(Duration::from_millis(200));
    }
    terminal.see("1 served");
    assert!(hands > 4, "the person did {hands} presses of it");
    assert!(replay.session().gaze.samples > 100, "the pointer is a steady stream of gaze");
    assert!(replay.session().gaze.looked_at.iter().flatten().count() > 1, "the person looked at several places");
    terminal.quit();
    terminal.verifies();
}

#[test]
#[serial]
fn the_same_button_pressed_twice_is_in_the_log_twice() {
    let Some(terminal) = Terminal::open("twice") else { return };
    let kitchen = kitchen("default.toml");
    terminal.operate("default.toml", "--participant keyboard --gaze mouse");
    terminal.start();
    terminal.key("Tab");
    terminal.see("KEYS: PARTICIPANT");
    let button = kitchen.button_named(Agent::Human, "assembly_board").expect("a button of the sushi kitchen");
    let key = kitchen.button(Agent::Human, button).key.expect("a key").to_string();
    let presses = "\"agent\":\"human\",\"button\":\"assembly_board\"";
    terminal.key_logs(&key, presses);
    // Longer than between two reports of a key that is held down.
    std::thread::sleep(Duration::from_millis(360));
    terminal.key_logs(&key, presses);
    assert_eq!(terminal.count(presses), 2);
    terminal.quit();
    terminal.verifies();
}

#[test]
#[serial]
fn an_order_is_made_and_served_by_hand_in_the_sushi_kitchen() {
    check_by_hand("default.toml");
}

#[test]
#[serial]
fn an_order_is_made_and_served_by_hand_in_the_burger_kitchen() {
    check_by_hand("burger.toml");
}

#[test]
#[serial]
fn gaze_comes_from_any_program_that_writes_lines() {
    use std::io::Write;
    let Some(terminal) = Terminal::open("json") else { return };
    let free = std::net::TcpListener::bind(("127.0.0.1", 0)).and_then(|listener| listener.local_addr());
    let port = free.expect("a free port").port();
    let text = fs::read_to_string("sessions/default.toml").expect("the default session");
    let root = env!("CARGO_MANIFEST_DIR");
    let text = text.replace("../layouts", &format!("{root}/layouts")).replace("50021", &port.to_string());
    let session = terminal.folder.join("session.toml");
    fs::write(&session, text).expect("written");
    let out = terminal.folder.display();
    let arguments = "--participant keyboard --gaze json";
    terminal.run(&format!("{TOMCOM} operate {} --out {out}/recordings {arguments}", session.display()));
    terminal.see("READY");
    let mut tracker = std::net::TcpStream::connect(("127.0.0.1", port)).expect("it listens");
    for step in 0..50 {
        let t = f64::from(step) / 50.0;
        writeln!(tracker, "{{\"t\": {t}, \"x\": 0.40, \"y\": 0.35, \"confidence\": 0.9}}").expect("sent");
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
