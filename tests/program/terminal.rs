//! The real program in a real terminal: every test runs the binary in tmux, presses keys and moves the mouse as a person
//! does, and reads the screen and the recording. Without tmux the tests say that they were skipped.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::{Duration, Instant};

use serial_test::serial;
use tomcom::console::arrange::{KitchenMap, MapElement};
use tomcom::console::view::regions::Regions;
use tomcom::edge::files::read_session;
use tomcom::edge::terminal::TerminalScreen;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, ButtonAction, ButtonId, Kitchen};
use tomcom::run::replay::Replay;
use tomcom::session::settings::Visibility;

use crate::tmux::{self, PATIENCE, SIZE, TOMCOM, Terminal};

fn kitchen(session: &str) -> Arc<Kitchen> {
    let files = read_session(&Path::new("sessions").join(session)).expect("a session of the project");
    Arc::new(files.kitchen.kitchen)
}

/// A wizard's whole session: every key that concerns participant, robot or analysis, and its line in the log.
fn check_wizard(session: &str) {
    let Some(terminal) = Terminal::open(&format!("wizard-{session}")) else { return };
    let kitchen = kitchen(session);
    terminal.operate(session, "");
    terminal.start();
    terminal.see("RUNNING");
    for location in &kitchen.locations {
        let Some(key) = location.signal_key.filter(|_| location.name != "human_hand") else { continue };
        // An order that was served has no recipe to show until the next one comes.
        let shown = format!("\":\"{}\"}}}}", location.name);
        terminal.wait(&shown, || {
            terminal.key(&key.to_string());
            std::thread::sleep(Duration::from_millis(800));
            terminal.count(&shown) > 0
        });
    }
    let shown = terminal.count("signal_shown");
    terminal.key_logs("BSpace", "taken_back");
    terminal.see("taken back");
    for _ in 0..20 {
        terminal.key("a");
    }
    terminal.wait("a held key", || terminal.count("signal_shown") > shown);
    terminal.key_logs("3", "\"marker\",\"note\":\"slip\"");
    terminal.key_logs("Space", "robot_stopped");
    terminal.see("STOPPED");
    assert_eq!(terminal.count("signal_shown"), shown + 1, "a held key sends once");
    terminal.key_logs("C-r", "robot_resumed");
    std::thread::sleep(Duration::from_millis(800));
    terminal.key_logs(".", "trial_paused");
    terminal.see("PAUSED");
    terminal.key("0");
    terminal.see("A note");
    terminal.tmux(&["send-keys", "-l", "Asks for help"]);
    terminal.see("Asks for help");
    terminal.key_logs("Enter", "\"note\":\"Asks for help\"");
    std::thread::sleep(Duration::from_millis(800));
    terminal.key_logs(".", "trial_resumed");
    terminal.key("?");
    terminal.see("any key closes");
    terminal.key("x");
    std::thread::sleep(Duration::from_millis(800));
    terminal.key("C-e");
    terminal.see("End the trial?");
    terminal.key_logs("y", "trial_ended");
    terminal.quit();
    assert_eq!(terminal.count("session_ended"), 1);
    assert_eq!(terminal.count("\"kind\":\"preflight\""), 1);
    for open in ["note", "help", "end_trial", "quit"] {
        let seen = "\"room\":\"medium\",\"panels\":[\"kitchen\",\"belief\",\"recommendation\"";
        let log = terminal.log();
        let mut lines = log.lines().filter(|line| line.contains(seen));
        assert!(lines.any(|line| line.contains(&format!("\"dialog\":\"{open}\""))), "{open}:\n{log}");
    }
    terminal.verifies();
}

#[test]
#[serial]
fn a_wizard_runs_a_session_in_the_sushi_kitchen() {
    check_wizard("default.toml");
}

#[test]
#[serial]
fn a_wizard_runs_a_session_in_the_burger_kitchen() {
    check_wizard("burger.toml");
}

#[test]
#[serial]
fn a_signal_to_the_program_closes_the_recording_and_gives_the_terminal_back() {
    for signal in ["TERM", "INT", "HUP"] {
        let Some(terminal) = Terminal::open(&format!("signal-{signal}")) else { return };
        terminal.operate("default.toml", "--participant keyboard --gaze mouse");
        terminal.start();
        let pid = terminal.read("pid");
        let killed = Command::new("kill").args([&format!("-{signal}"), pid.trim()]).status().expect("kill runs");
        assert!(killed.success());
        terminal.is_whole("0");
        assert_eq!(terminal.count("session_ended"), 1);
        terminal.verifies();
    }
}

/// Not a test by itself: what the next one runs in a terminal.
#[test]
#[serial]
#[ignore = "panics on purpose, inside of the terminal of another test"]
fn a_program_that_panics() {
    let _screen = TerminalScreen::take().expect("a terminal");
    panic!("on purpose");
}

#[test]
#[serial]
fn a_panic_gives_the_terminal_back_and_its_message_can_be_read() {
    let Some(terminal) = Terminal::open("panic") else { return };
    let this = std::env::current_exe().expect("a path");
    terminal.run(&format!("{} --ignored --exact terminal::a_program_that_panics --nocapture", this.display()));
    terminal.is_whole("101");
    terminal.see("on purpose");
}

/// Makes and serves an order by hand: the person looks at the place and presses its button, the robot helps.
fn check_by_hand(session: &str) {
    let Some(terminal) = Terminal::open(&format!("by-hand-{session}")) else { return };
    let kitchen = kitchen(session);
    terminal.operate(session, "--participant keyboard --gaze mouse");
    terminal.start();
    terminal.key("Tab");
    terminal.see("KEYS: PARTICIPANT");
    let panel = Regions::new(SIZE, Visibility::Recommendation, None).kitchen_inside();
    let plan = KitchenMap::new(&kitchen, panel, true);
    let mut cost = CostToGo::new(kitchen.clone());
    let mut replay = Replay::open(&terminal.recording()).expect("it opens while it is written");
    let recipes = kitchen.true_recipes();
    let mut hands = 0;
    let began = Instant::now();
    while replay.session().served.is_empty() {
        assert!(began.elapsed() < 6 * PATIENCE, "no order was served:\n{}", terminal.screen());
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
        let place = |thing: &MapElement| match button.action {
            ButtonAction::Use(location) | ButtonAction::Serve(location) => *thing == MapElement::Location(location),
            ButtonAction::Take(item) => matches!(thing, MapElement::Storage(index)
                if kitchen.storages[*index].agent == Agent::Human && kitchen.storages[*index].item == item),
            ButtonAction::Process(_) | ButtonAction::Trash => {
                *thing == MapElement::Location(kitchen.hands[Agent::Human.index()])
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
    terminal.key(&key);
    std::thread::sleep(Duration::from_millis(360));
    terminal.key(&key);
    let presses = "\"agent\":\"human\",\"button\":\"assembly_board\"";
    terminal.wait("two presses", || terminal.count(presses) == 2);
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
fn a_running_session_is_watched_from_another_terminal_and_looked_at_again() {
    let Some(terminal) = Terminal::open("watched") else { return };
    let Some(other) = Terminal::open("watching") else { return };
    terminal.operate("default.toml", "");
    terminal.start();
    let recording = terminal.recording();
    other.run(&format!("{TOMCOM} replay {} --follow", recording.display()));
    other.see("RUNNING");
    other.see("live");
    terminal.key_logs("a", "signal_shown");
    other.see("highlight assembly board");
    terminal.quit();
    other.see("CLOSED");
    other.key("q");
    other.is_whole("0");
    other.run(&format!("{TOMCOM} replay {}", recording.display()));
    other.see("play 1x");
    for (key, seen) in [("+", "play 2x"), (".", "paused 2x"), ("End", "CLOSED"), ("Home", "event 0/")] {
        other.key(key);
        other.see(seen);
    }
    other.key("Right");
    other.see("event 1/");
    other.key("q");
    other.is_whole("0");
}

#[test]
#[serial]
fn a_rater_codes_errors_by_keys_and_sees_no_estimate() {
    let Some(terminal) = Terminal::open("rater") else { return };
    let out = terminal.folder.join("recordings");
    let simulated =
        tmux::tomcom(&["simulate", "sessions/default.toml", "--seed", "7", "--out", &out.display().to_string()]);
    assert!(simulated.status.success(), "{simulated:?}");
    let recording = terminal.recording();
    let log = terminal.log();
    let codes = recording.join("codes-R1.csv");
    let rows =
        || fs::read_to_string(&codes).unwrap_or_default().lines().skip(1).map(str::to_string).collect::<Vec<_>>();
    terminal.run(&format!("{TOMCOM} replay {} --rater R1", recording.display()));
    terminal.see("R1, before the first of");
    assert!(!terminal.screen().contains("Belief"), "{}", terminal.screen());
    let kitchen = kitchen("default.toml");
    let place = kitchen.locations.iter().find(|location| location.name == "cooking_pot").expect("a pot");
    let letter = place.signal_key.expect("a key").to_string();
    for (key, seen) in [
        ("9", "\"9\" has no meaning"),
        ("1", "no error yet"),
        ("Enter", "R1, error 1 of"),
        ("1", "slip (1 coded)"),
        ("Enter", "R1, error 2 of"),
        (&letter, "wrong about cooking pot (2 coded)"),
        ("Enter", "R1, error 3 of"),
        ("3", "other (3 coded)"),
        ("DC", " effect: not coded (2 coded)"),
        ("BSpace", "R1, error 2 of"),
    ] {
        terminal.key(key);
        terminal.see(seen);
        std::thread::sleep(Duration::from_millis(800));
    }
    terminal.key("C-c");
    terminal.is_whole("0");
    let kept = rows();
    assert!(matches!(&kept[..], [a, b] if a.ends_with(",slip,") && b.ends_with(",belief,cooking_pot")), "{kept:?}");
    assert_eq!(terminal.log(), log, "the log stays as it is");
    terminal.run(&format!("{TOMCOM} replay {} --rater R1", recording.display()));
    terminal.see("(2 coded)");
    terminal.key("C-c");
    terminal.is_whole("0");
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
    writeln!(tracker, "nonsense").expect("sent");
    terminal.see("1 malformed");
    terminal.see("assembly board");
    assert_eq!(terminal.count("\"kind\":\"gaze\""), 50);
    terminal.quit();
    terminal.verifies();
}

#[test]
#[serial]
fn an_aborted_trial_is_done_again_in_a_recording_of_its_own() {
    let Some(terminal) = Terminal::open("again") else { return };
    terminal.operate("default.toml", "");
    let first = terminal.recording();
    terminal.start();
    terminal.key_logs("C-p", "robot_held");
    terminal.see("HELD");
    // What a terminal reports when its window loses and regains the keyboard.
    for (report, event) in [("\x1b[O", "focus_lost"), ("\x1b[I", "focus_regained")] {
        terminal.tmux(&["send-keys", "-l", report]);
        terminal.wait(event, || terminal.count(event) == 1);
    }
    terminal.key("C-k");
    terminal.see("Correct the kitchen");
    terminal.key("Enter");
    terminal.see("What is at human hand?");
    terminal.key("Escape");
    terminal.see("Correct the kitchen");
    terminal.key_logs("Space", "robot_stopped");
    terminal.key("Escape");
    std::thread::sleep(Duration::from_millis(800));
    terminal.key("C-x");
    terminal.see("Abort the trial: why?");
    terminal.key_logs("Enter", "\"trial_aborted\",\"reason\":\"participant stopped\"");
    terminal.see("^n do it again");
    terminal.key("C-n");
    terminal.see("READY");
    let name = first.file_name().expect("a name").to_string_lossy().into_owned();
    let second = first.with_file_name(format!("{}-2", name.trim_end_matches("-1")));
    let log = |folder: &Path| fs::read_to_string(folder.join("events.jsonl")).expect("a log");
    assert!(log(&second).contains(&format!("\"redoes\":\"{name}\"")));
    assert!(log(&first).ends_with("\"session_ended\"}\n"), "the aborted recording is closed");
    terminal.start();
    terminal.see("RUNNING");
    terminal.quit();
    let orders = |log: &str| -> Vec<String> {
        let shown = log.lines().filter(|line| line.contains("order_shown")).take(2);
        shown.filter_map(|line| Some(line.split_once("\"kind\"")?.1.to_string())).collect()
    };
    assert_eq!(orders(&log(&first)), orders(&log(&second)), "it is the same trial");
    for recording in [&first, &second] {
        let output = tmux::tomcom(&["replay", &recording.display().to_string(), "--verify"]);
        assert!(output.status.success(), "{output:?}");
    }
}

#[test]
#[serial]
fn wizard_and_assistant_are_compared_live_and_from_another_terminal() {
    let Some(terminal) = Terminal::open("compare") else { return };
    let Some(beside) = Terminal::open("compare-follow") else { return };
    let (root, out) = (env!("CARGO_MANIFEST_DIR"), terminal.folder.display());
    terminal.run(&format!("{TOMCOM} compare {root}/sessions/default.toml --with tom --out {out}/recordings"));
    terminal.see("READY");
    terminal.see("Wizard and assistant");
    terminal.start();
    // The other sees the same lanes, and writes nothing.
    beside.run(&format!("{TOMCOM} compare {} --with tom --follow", terminal.recording().display()));
    beside.see("Wizard and assistant");
    terminal.key_logs("q", "show_recipe");
    for one in [&terminal, &beside] {
        one.see("recall");
        one.see("wizard");
        one.see("tom-com");
    }
    // What may still be matched is no difference.
    terminal.see("opens it");
    terminal.key("C-o");
    terminal.see("What each knew");
    terminal.key("x");
    terminal.wait("a closed dialog", || !terminal.screen().contains("What each knew"));
    beside.key("q");
    beside.is_whole("0");
    terminal.quit();
    assert_eq!(terminal.count("\"kind\":\"unblinded\",\"concepts\":[\"tom-com\",\"tom\"]"), 1);
    assert!(terminal.count("signal_drawn") > 0, "when a signal was seen");
    assert!(terminal.count("\"comparison\"") > 0, "the panel is among those that were seen");
    terminal.verifies();
}

#[test]
#[serial]
fn a_wizard_is_trained_with_feedback_and_a_score_and_held_against_oneself() {
    let Some(terminal) = Terminal::open("train") else { return };
    let out = terminal.folder.join("training");
    let mut met = Vec::new();
    for time in 1..=2 {
        terminal.run(&format!(
            "{TOMCOM} train --wizard W7 --speed 4 --seconds 30 --hits 0 --wrong 1 --out {}",
            out.display()
        ));
        terminal.see("0 hit, 0 missed, 0 wrong");
        terminal.see("A hit is the first signal");
        terminal.key(".");
        terminal.see("it runs");
        // The orders come with the trial's first moment.
        terminal.see("0:01");
        for key in ["q", "c", "p"] {
            terminal.key(key);
            terminal.wait("feedback", || {
                let screen = terminal.screen();
                ["hit:", "already", "wrong,", "late:", "wrong:"].iter().any(|word| screen.contains(word))
            });
            std::thread::sleep(Duration::from_millis(900));
        }
        terminal.see("The training is over");
        terminal.key("Enter");
        terminal.is_whole("0");
        terminal.see("recorded in");
        let record = fs::read_to_string(out.join(format!("W7-{time}.json"))).expect("a record");
        let record: serde_json::Value = serde_json::from_str(&record).expect("a JSON object");
        let one = &record["recordings"][0];
        assert_eq!(one["complete"], true, "{record}");
        assert_eq!(one["signals"].as_array().map(Vec::len), Some(3));
        assert!(one["signals"][0]["worth"].is_string());
        assert_eq!(one["beliefs"].as_array().map(|all| all.len() as u64), one["measures"]["episodes"].as_u64());
        assert_eq!(record["speed"], 4.0, "{record}");
        assert_eq!(one["kappa_with_oneself"].is_number(), time == 2, "{record}");
        met.push(record["met"].clone());
    }
    assert_eq!(met[0], met[1], "the criterion holds for the same signals");
    // The training belongs to the wizard's figures.
    let recording =
        fs::read_dir(out.join("recordings/30s")).expect("a folder").next().expect("a recording").expect("readable");
    let arguments = ["compare", "--wizard", "W7", "--format", "json", "--training"].map(str::to_string);
    let folders = [&out, &recording.path()].map(|path| path.display().to_string());
    let output = Command::new(TOMCOM).args(arguments).args(folders).output().expect("tomcom runs");
    let figures: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a JSON object");
    assert_eq!(figures["training"]["times"], 2, "{figures}");
}
