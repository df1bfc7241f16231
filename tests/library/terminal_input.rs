//! The terminal's bytes as keys, mouse reports and pasted text; and that the space bar is a key whatever came before it.

use std::io::Write;
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use tomcom::console::ConsoleMessage::{self, Click, Focus, Key, Paste, Pointer, Wheel};
use tomcom::run::terminal_bytes::TerminalParser;
use tomcom::run::terminal_input::TerminalInput;
use tomcom_core::base::rng::Stream;

use crate::support::*;

const SILENCE: Duration = Duration::from_millis(50);
/// Seed of the random bytes, printed by a failure through the case's number.
const SEED: u64 = 17;

/// What these bytes mean, and then `silence` without a byte.
fn meaning(bytes: &[u8], silence: Duration) -> Vec<ConsoleMessage> {
    let (mut parser, began) = (TerminalParser::default(), Instant::now());
    let mut messages = parser.read(bytes, began);
    messages.extend(parser.expire(began + silence));
    messages
}

fn key(code: KeyCode, modifiers: KeyModifiers) -> ConsoleMessage {
    Key(KeyEvent::new(code, modifiers))
}

fn plain(code: KeyCode) -> ConsoleMessage {
    key(code, KeyModifiers::NONE)
}

fn space() -> ConsoleMessage {
    plain(KeyCode::Char(' '))
}

/// Whether the message is the space bar, with alt or without.
fn is_space(message: &ConsoleMessage) -> bool {
    matches!(message, Key(key) if key.code == KeyCode::Char(' '))
}

#[test]
fn keys_are_read_in_every_form_that_terminals_send() {
    use KeyCode::{BackTab, Backspace, Char, Delete, Down, End, Enter, Esc, F, Home, Insert, Left, PageDown, PageUp};
    use KeyCode::{Right, Tab, Up};
    use KeyModifiers as With;
    let cases: &[(&str, KeyCode, KeyModifiers)] = &[
        ("a", Char('a'), With::NONE),
        ("A", Char('A'), With::SHIFT),
        ("ä", Char('ä'), With::NONE),
        ("日", Char('日'), With::NONE),
        ("🍣", Char('🍣'), With::NONE),
        ("\x03", Char('c'), With::CONTROL),
        ("\x1f", Char('7'), With::CONTROL),
        ("\0", Char(' '), With::CONTROL),
        ("\r", Enter, With::NONE),
        ("\t", Tab, With::NONE),
        ("\x7f", Backspace, With::NONE),
        ("\x1b", Esc, With::NONE),
        ("\x1bq", Char('q'), With::ALT),
        ("\x1bé", Char('é'), With::ALT),
        ("\x1b ", Char(' '), With::ALT),
        ("\x1b\x03", Char('c'), With::ALT.union(With::CONTROL)),
        // Alt and a letter that also begins longer sequences.
        ("\x1b[", Char('['), With::ALT),
        ("\x1bO", Char('O'), With::ALT.union(With::SHIFT)),
        ("\x1b]", Char(']'), With::ALT),
        ("\x1bP", Char('P'), With::ALT.union(With::SHIFT)),
        ("\x1b[A", Up, With::NONE),
        ("\x1bOB", Down, With::NONE),
        ("\x1b[1;5C", Right, With::CONTROL),
        ("\x1b[D", Left, With::NONE),
        ("\x1b[H", Home, With::NONE),
        ("\x1b[4~", End, With::NONE),
        ("\x1b[Z", BackTab, With::SHIFT),
        ("\x1b[2~", Insert, With::NONE),
        ("\x1b[3;2~", Delete, With::SHIFT),
        ("\x1b[5~", PageUp, With::NONE),
        ("\x1b[6~", PageDown, With::NONE),
        ("\x1bOP", F(1), With::NONE),
        ("\x1b[[C", F(3), With::NONE),
        ("\x1b[1;3S", F(4), With::ALT),
        ("\x1b[15~", F(5), With::NONE),
        ("\x1b[24~", F(12), With::NONE),
        // Kitty's protocol: number, shifted number, modifiers.
        ("\x1b[32u", Char(' '), With::NONE),
        ("\x1b[97;5u", Char('a'), With::CONTROL),
        ("\x1b[97:65;2u", Char('A'), With::NONE),
        ("\x1b[57358;1u\x1b[57441;2u\x1b[27;1:1u", Esc, With::NONE),
        ("\x1b[9;2u", BackTab, With::SHIFT),
        ("\x1b[57406;129u", Char('7'), With::NONE),
        ("\x1b[57414u", Enter, With::NONE),
    ];
    for (bytes, code, modifiers) in cases {
        assert_eq!(meaning(bytes.as_bytes(), SILENCE), [key(*code, *modifiers)], "{bytes:?}");
    }
    for (bytes, kind) in [("\x1b[97;1:2u", KeyEventKind::Repeat), ("\x1b[97;1:3u", KeyEventKind::Release)] {
        let event = KeyEvent::new_with_kind(Char('a'), With::NONE, kind);
        assert_eq!(meaning(bytes.as_bytes(), SILENCE), [Key(event)], "{bytes:?}");
    }
}

#[test]
fn mouse_focus_and_answers_to_queries_are_no_keys() {
    let cases: &[(&str, &[ConsoleMessage])] = &[
        ("\x1b[<0;12;3M", &[Click(11, 2)]),
        ("\x1b[<0;12;3m", &[Pointer(11, 2)]),
        ("\x1b[<2;12;3M", &[Pointer(11, 2)]),
        ("\x1b[<35;300;100M", &[Pointer(299, 99)]),
        ("\x1b[<64;1;1M\x1b[<65;1;1M", &[Wheel(0, 0, 1), Wheel(0, 0, -1)]),
        ("\x1b[<0;0;3M\x1b[<0;99999;3M\x1b[<0;3M", &[]),
        ("\x1b[32;12;3M", &[Click(11, 2)]),
        // The oldest form, which is not asked for.
        ("\x1b[M!,#", &[]),
        ("\x1b[M  \x7f", &[space(), space()]),
        ("\x1b[I\x1b[O", &[Focus(true), Focus(false)]),
        ("\x1b[?62;22c\x1b[?15u\x1b[>0;276;0c", &[]),
        ("\x1b]11;rgb:0000/0000/0000\x1b\\\x1b]11;rgb:0/0/0\x07\x1bP1$r0m\x1b\\", &[]),
    ];
    for (bytes, messages) in cases {
        assert_eq!(meaning(bytes.as_bytes(), SILENCE), *messages, "{bytes:?}");
    }
}

#[test]
fn pasted_text_is_one_message_whatever_it_holds() {
    let pasted = |text: &str| meaning(format!("\x1b[200~{text}\x1b[201~").as_bytes(), SILENCE);
    for text in ["please call me", "", "two\r\nlines", "7,5", "\x1b[201", "\x1b\x1b[20\x1b[A", "日本", "\x1b[200~"] {
        assert_eq!(pasted(text), [Paste(Some(text.to_string()))], "{text:?}");
    }
    assert_eq!(meaning(b"\x1b[200~\xff\x1b[201~", SILENCE), [Paste(Some("\u{fffd}".to_string()))]);
    let [Paste(Some(long))] = &pasted(&"x ".repeat(1 << 20))[..] else { panic!("a paste") };
    assert!(long.len() < 1 << 20, "a paste is kept in bounded memory");
    assert_eq!(meaning(b"\x1b[201~a", SILENCE), [plain(KeyCode::Char('a'))], "an end without a paste");
}

#[test]
fn how_bytes_are_split_into_reads_changes_nothing() {
    let bytes = "a\x1b[A\x1b[<0;12;3Mß\x1b[200~please call\x1b[201~\x1b[97;5u\x1b]11;?\x1b\\\x1bOP z".as_bytes();
    let whole = meaning(bytes, SILENCE);
    assert_eq!(whole.len(), 9, "{whole:?}");
    let (mut parser, mut now) = (TerminalParser::default(), Instant::now());
    let mut single = Vec::new();
    for byte in bytes {
        // Just before the silence that would end a sequence.
        now += SILENCE - Duration::from_millis(1);
        single.extend(parser.expire(now));
        single.extend(parser.read(&[*byte], now));
    }
    assert_eq!(single, whole);
}

/// What a person or a broken connection can have sent before the space bar: bytes of sequences that were cut, in any
/// order, and any other bytes.
fn prefix(random: &mut Stream) -> Vec<u8> {
    const WHOLE: [&[u8]; 12] = [
        b"\x1b[A",
        b"\x1bOP",
        b"\x1b[<35;120;40M",
        b"\x1b[1;5C",
        b"\x1b[97:65;2:1u",
        b"\x1b[24~",
        b"\x1b[[A",
        b"\x1b]11;rgb:0000/0000/0000\x1b\\",
        b"\x1bP1$r0m\x1b\\",
        "ß日🍣".as_bytes(),
        b"\x1b[?62;22c",
        b"\x1b\x1b[3~",
    ];
    let mut bytes = Vec::new();
    for _ in 0..random.random_range(1..4) {
        if random.random_bool(0.3) {
            bytes.push(random.random());
        }
        let whole = WHOLE[random.random_range(0..WHOLE.len())];
        bytes.extend(&whole[..random.random_range(1..=whole.len())]);
    }
    bytes
}

#[test]
fn after_silence_a_space_is_the_space_bar_whatever_came_before() {
    for case in 0..20_000 {
        let mut random = stream(SEED, "terminal input", case);
        let mut bytes: Vec<u8> = match case % 3 {
            0 => (0..random.random_range(1..12)).map(|_| random.random()).collect(),
            _ => prefix(&mut random),
        };
        let pastes = case % 5 == 0;
        if pastes {
            bytes.splice(0..0, *b"\x1b[200~");
        }
        let (mut parser, began) = (TerminalParser::default(), Instant::now());
        parser.read(&bytes, began);
        parser.expire(began + if pastes { Duration::from_secs(1) } else { SILENCE });
        let found = parser.read(b" ", began + Duration::from_secs(1));
        assert_eq!(found, [space()], "case {case}: {bytes:x?}");
        assert_eq!(parser.deadline(), None, "case {case}: the space is complete");
    }
}

#[test]
fn without_silence_too_a_space_ends_an_incomplete_sequence() {
    for case in 0..20_000 {
        let mut bytes = prefix(&mut stream(SEED, "terminal input", case));
        bytes.push(b' ');
        let found = meaning(&bytes, SILENCE);
        assert!(found.last().is_some_and(is_space), "case {case}: {bytes:x?}: {found:?}");
    }
}

#[test]
fn a_paste_without_an_end_is_given_up_and_its_spaces_count() {
    let (mut parser, began) = (TerminalParser::default(), Instant::now());
    let at = |ms| began + Duration::from_millis(ms);
    assert_eq!(parser.read(b"\x1b[20", at(0)), []);
    assert_eq!(parser.read(b"0~please", at(40)), []);
    assert_eq!(parser.expire(at(1039)), []);
    assert_eq!(parser.expire(at(1040)), [Paste(None)]);
    assert_eq!(parser.read(b" ", at(1041)), [space()]);
    // Text keeps a paste open. The space bar and what else a held key sends do not.
    for held in [" ", "\x1b[32;1:2u", "\x1b[A"] {
        let (mut parser, mut found) = (TerminalParser::default(), Vec::new());
        parser.read(b"\x1b[200~please", at(0));
        parser.read(b"call", at(900));
        for ms in (930..2500).step_by(30) {
            found.extend(parser.expire(at(ms)));
            found.extend(parser.read(held.as_bytes(), at(ms)));
            assert_eq!(found.is_empty(), ms < 1900, "{held:?} at {ms} ms: {found:?}");
        }
        assert_eq!(found[0], Paste(None), "{held:?}");
        assert_eq!(found[1] == space(), held != "\x1b[A", "{held:?}: {found:?}");
    }
    let unended = |text: &[u8]| meaning(&[b"\x1b[200~", text].concat(), Duration::from_secs(1));
    assert_eq!(unended(b"call"), [Paste(None)]);
    assert_eq!(unended(b"call me"), [Paste(None), space()]);
    assert_eq!(unended(b"\x1b[200~call me"), [Paste(None), space()]);
}

/// The space bar is read after random beginnings of sequences, by the thread that reads the terminal.
#[tokio::test]
async fn the_reading_thread_gives_up_what_is_incomplete() {
    let (mut typist, terminal) = UnixStream::pair().expect("a connection");
    let mut input = TerminalInput::from_terminal(terminal.into()).expect("a thread");
    for case in 0..50 {
        let bytes = prefix(&mut stream(SEED, "reading thread", case));
        typist.write_all(&bytes).expect("written");
        typist.write_all(b" ").expect("written");
        for _ in bytes.iter().filter(|byte| **byte == b' ').chain([&b' ']) {
            while !is_space(&input.next().await.expect("the terminal is open")) {}
        }
    }
    typist.write_all(b"\x1b[200~please call me").expect("written");
    assert_eq!(input.next().await, Some(Paste(None)), "after a second");
    assert_eq!(input.next().await, Some(space()));
    typist.write_all(b"\x1b[").expect("written");
    assert_eq!(input.next().await, Some(key(KeyCode::Char('['), KeyModifiers::ALT)), "after 50 ms");
    drop(typist);
    assert_eq!(input.next().await, None, "the terminal is closed");
}

/// The thread that reads the terminal ends with its reader, so that it takes no input from whoever is next.
#[tokio::test]
async fn nobody_reads_the_terminal_after_the_console() {
    let (mut typist, terminal) = UnixStream::pair().expect("a connection");
    let input = TerminalInput::from_terminal(terminal.into()).expect("a thread");
    drop(input);
    // A write to a connection that nobody reads any more fails once the thread is over.
    while typist.write_all(b"a").is_ok() {
        tokio::task::yield_now().await;
    }
}
