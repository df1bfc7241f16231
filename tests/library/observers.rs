//! The observers' page: how frames become text, who is let in, what becomes of remarks, and that nobody is waited for.

use std::net::{IpAddr, SocketAddr};
use std::time::{Duration, Instant};

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};
use tomcom::console::view::theme::TerminalBackground;
use tomcom::run::screen_frame::frame_of;
use tomcom_devices::observers::{CellColour, CellRun, MOST_OBSERVERS, ObserverServer, ScreenFrame};

use crate::display_server::{ALL, LOCAL, address_of, serve, status};
use crate::raw_page::RawObserver;
use crate::support::*;

/// Serves the observers' page; it is there until this is dropped.
fn observed(listen: IpAddr) -> (ObserverServer, SocketAddr) {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    let server = runtime.block_on(ObserverServer::open(SocketAddr::new(listen, 0))).expect("a free port");
    let address = address_of(&server.url());
    (server, address)
}

fn frame(lines: &[String]) -> ScreenFrame {
    let columns = lines.iter().map(String::len).max().unwrap_or_default() as u16;
    let run = |line: &String| vec![CellRun { text: line.clone(), columns, ..CellRun::default() }];
    ScreenFrame { columns, is_light: false, lines: lines.iter().map(run).collect() }
}

/// Waits until the page shows a screen that begins like this.
fn sees(observer: &mut RawObserver, text: &str) {
    let began = Instant::now();
    while !observer.screen().starts_with(text) {
        assert!(began.elapsed() < Duration::from_secs(300), "{text} did not appear: {}", observer.screen());
    }
}

/// Answers the next remark as a session does that takes all of them; the event that it becomes.
fn taken(server: &mut ObserverServer) -> Event {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    let remark = runtime.block_on(server.next()).expect("a remark");
    let event = remark.event();
    remark.answer(Ok(()));
    event
}

#[test]
fn a_frame_is_the_text_of_its_cells_with_their_looks() {
    let mut buffer = Buffer::empty(Rect::new(0, 0, 12, 2));
    let strong = Style::default().fg(Color::Indexed(203)).add_modifier(Modifier::BOLD | Modifier::REVERSED);
    buffer.set_string(0, 0, "pot", Style::default());
    buffer.set_string(3, 0, "\u{2717} 終る", strong);
    buffer.set_string(0, 1, "two", Style::default().bg(Color::Red));
    let frame = frame_of(&buffer, TerminalBackground::Light);
    assert!(frame.is_light && frame.columns == 12);
    let plain = |text: &str, columns| CellRun { text: text.to_string(), columns, ..CellRun::default() };
    let marked = CellRun {
        ink: Some(CellColour::Palette(203)),
        styles: "bold reversed".to_string(),
        ..plain("\u{2717} 終る", 6)
    };
    assert_eq!(frame.lines[0], [plain("pot", 3), marked, plain("   ", 3)]);
    let red = CellRun { ground: Some(CellColour::Palette(1)), ..plain("two", 3) };
    assert_eq!(frame.lines[1], [red, plain("         ", 9)]);
    for line in &frame.lines {
        assert_eq!(line.iter().map(|run| run.columns).sum::<u16>(), 12);
    }
}

#[test]
fn twenty_observers_see_every_change_and_the_next_one_is_refused_with_words() {
    let (server, address) = observed(LOCAL);
    server.show(frame(&["one".to_string(), "two".to_string()]));
    let mut observers: Vec<RawObserver> = (0..MOST_OBSERVERS).map(|_| RawObserver::open(address)).collect();
    for (number, observer) in observers.iter_mut().enumerate() {
        let joined = observer.joins(&format!("page {number}"), &format!("O{number}"), None);
        assert_eq!(joined.as_deref(), Some("welcome"), "{number}");
        sees(observer, "one\ntwo");
    }
    assert_eq!(server.count().watching(), 20);
    let mut late = RawObserver::open(address);
    late.hello("late", "O20", None);
    let refused = late.page.hear_one_of(&["welcome", "full"]).expect("an answer");
    assert_eq!((&refused["kind"], &refused["most"]), (&json!("full"), &json!(20)));
    server.show(frame(&["one".to_string(), "2".to_string()]));
    for observer in &mut observers {
        sees(observer, "one\n2");
    }
    // One goes, another one comes.
    observers.pop();
    let joins = |number: u32| {
        let mut next = RawObserver::open(address);
        next.joins(&format!("next {number}"), "O20", None).as_deref() == Some("welcome")
    };
    assert!((0..600).any(|number| joins(number) || {
        std::thread::sleep(Duration::from_millis(100));
        false
    }));
}

#[test]
fn an_observer_has_a_code_and_another_pairing_code_than_the_participant() {
    let ((server, address), (display, page)) = (observed(ALL), serve(ALL));
    let (own, other) = (server.code().expect("a code").to_string(), display.code().expect("a code").to_string());
    assert_ne!(own, other);
    let mut observer = RawObserver::open(address);
    let mut asked = |name: &str, code: Option<&str>| {
        observer.hello("page", name, code);
        observer.page.hear_one_of(&["pairing", "welcome"]).expect("an answer")
    };
    assert_eq!(asked("", None)["why"], "code");
    for name in ["", "Anna Berg", "7", "n\u{e4}me"] {
        assert_eq!(asked(name, Some(&own))["why"], "observer", "{name}");
    }
    assert_eq!(asked("O1", Some(&other))["why"], "wrong", "the participant's code");
    let mut again = RawObserver::open(address);
    let mut joins = || again.joins("page", "O1", Some(&own)).as_deref() == Some("welcome");
    assert!((0..600).any(|_| joins() || {
        std::thread::sleep(Duration::from_millis(100));
        false
    }));
    // The participant's server has neither the page nor the messages of observers.
    let host = |address: SocketAddr| [format!("Host: {address}")];
    for path in ["/observers.js", "/observers.css"] {
        assert_eq!((status(page, path, &host(page)), status(address, path, &host(address))), (404, 200), "{path}");
    }
    assert_eq!((status(address, "/stage.js", &host(address)), status(page, "/stage.js", &host(page))), (404, 200));
}

#[test]
fn remarks_become_notes_of_their_observer_and_each_is_answered() {
    let (mut server, address) = observed(LOCAL);
    let mut observer = RawObserver::open(address);
    assert_eq!(observer.joins("page", "O1", None).as_deref(), Some("welcome"));
    let say = |observer: &mut RawObserver, number: u64| {
        let note = format!("  looks at pot {number}  ");
        observer.page.say(&json!({"kind": "remark", "number": number, "note": note}));
    };
    let answer = |observer: &mut RawObserver| {
        let answer = observer.page.hear("remark").expect("an answer");
        (answer["number"].as_u64(), answer["refused"].as_str().map(str::to_string))
    };
    // As long as one is not answered, another one is refused.
    say(&mut observer, 1);
    say(&mut observer, 2);
    let (number, refused) = answer(&mut observer);
    assert!(number == Some(2) && refused.is_some_and(|why| why.contains("one remark in a second")));
    let note = Event::Marker { note: "looks at pot 1".to_string(), observer: Some("O1".to_string()) };
    assert_eq!(taken(&mut server), note);
    assert_eq!(answer(&mut observer), (Some(1), None));
    // Where nothing is recorded, and when the program ends, the observer is told so.
    for number in [3, 4] {
        std::thread::sleep(Duration::from_millis(1100));
        say(&mut observer, number);
        observer.screen();
        server.refuse_waiting();
        let (answered, refused) = answer(&mut observer);
        assert!(answered == Some(number) && refused.is_some_and(|why| why.contains("nothing is recorded now")));
    }
    drop(server);
    assert!(observer.page.hear("ended").is_some());
}

#[test]
fn an_observer_who_reads_nothing_delays_neither_the_console_nor_others() {
    let (server, address) = observed(LOCAL);
    let mut stalled = RawObserver::open(address);
    assert_eq!(stalled.joins("stalled", "O1", None).as_deref(), Some("welcome"));
    let mut other = RawObserver::open(address);
    assert_eq!(other.joins("other", "O2", None).as_deref(), Some("welcome"));
    // More than the buffers of a connection hold.
    let line = |number: usize, row: usize| format!("{number} {row} {}", "x".repeat(60_000));
    for number in 0..200 {
        server.show(frame(&(0..4).map(|row| line(number, row)).collect::<Vec<_>>()));
        if number % 20 == 0 {
            other.screen();
        }
    }
    sees(&mut other, "199 0 ");
}

#[test]
fn an_observers_remark_is_a_note_with_words_and_leaves_open_marks_alone() {
    let mut engine = crate::display::engine(crate::display::files("sessions/default.toml"));
    let remark =
        |note: &str, observer: &str| Event::Marker { note: note.to_string(), observer: Some(observer.to_string()) };
    assert!(engine.input(at(0.0), remark(" ", "O1")).refused.is_some());
    assert!(engine.input(at(0.0), remark("pot", "Anna Berg")).refused.is_some());
    assert_eq!(engine.input(at(1.0), remark("looks at the pot", "O1")).refused, None);
    assert!(engine.session().open_marks.is_empty() && !engine.session().is_empty());
    crate::display::check(engine.session());
}
