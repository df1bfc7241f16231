//! Colours: their contrast, and that no meaning hangs on a colour alone.

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::Cell;
use ratatui::style::{Color, Modifier};
use tomcom::console::view;
use tomcom::console::view::theme::{TerminalBackground, TextRole, Theme};
use tomcom_session::settings::ParticipantKind;

use super::{SIZES, Stage};
use crate::check_snapshot;

/// What the cells look like, a line for each row, a letter for each style: without colour nothing may rest on colour.
#[test]
fn without_colour_every_meaning_has_a_sign_or_a_weight() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.model.theme = Theme { colour: false, unicode: true, ground: TerminalBackground::Dark };
    for (columns, rows) in SIZES {
        let mut terminal = Terminal::new(TestBackend::new(columns, rows)).expect("a test terminal");
        terminal.draw(|frame| view(&stage.session, &stage.model, frame)).expect("drawn");
        let buffer = terminal.backend().buffer();
        assert!(buffer.content.iter().all(|cell| cell.fg == Color::Reset && cell.bg == Color::Reset));
        let weights = |cell: &Cell| match cell.modifier {
            m if m.contains(Modifier::REVERSED) => '#',
            m if m.contains(Modifier::BOLD) => '*',
            m if m.contains(Modifier::DIM) => '-',
            _ if cell.symbol() == " " => ' ',
            _ => '.',
        };
        let lines: Vec<String> =
            buffer.content.chunks(usize::from(columns)).map(|row| row.iter().map(weights).collect()).collect();
        if (columns, rows) == SIZES[0] {
            check_snapshot("console", "no_color_80x24", lines.join("\n"));
        }
    }
}

/// The sign of the selected row means nothing else.
#[test]
fn the_cursor_of_lists_is_no_sign_of_a_panel() {
    for unicode in [true, false] {
        let signs = Theme { colour: true, unicode, ground: TerminalBackground::Dark }.signs();
        let others = [
            signs.gaze,
            signs.trail,
            signs.press,
            signs.no_effect,
            signs.error,
            signs.served,
            signs.taken_back,
            signs.stopped,
            signs.touched,
            signs.by_hand,
            signs.to,
            signs.changed,
            signs.recording,
            signs.pause,
            signs.ellipsis,
        ];
        assert!(!others.contains(&signs.cursor) && !signs.levels.contains(&signs.cursor), "{}", signs.cursor);
    }
}

/// The relative luminance of a colour (WCAG 2.1).
fn luminance(rgb: [u8; 3]) -> f64 {
    let linear = rgb.map(|value| match f64::from(value) / 255.0 {
        low if low <= 0.04045 => low / 12.92,
        high => ((high + 0.055) / 1.055).powf(2.4),
    });
    0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
}

/// The contrast ratio of two colours, 1 to 21 (WCAG 2.1).
fn contrast(a: [u8; 3], b: [u8; 3]) -> f64 {
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

/// A colour of the cube or the greys of xterm's 256, which are the same in every terminal.
fn xterm(index: u8) -> [u8; 3] {
    match index {
        0..=15 => panic!("{index} is one of the colours that everybody sets otherwise"),
        16..=231 => [36, 6, 1].map(|step| [0, 95, 135, 175, 215, 255][usize::from((index - 16) / step % 6)]),
        grey => [8 + 10 * (grey - 232); 3],
    }
}

#[test]
fn colours_keep_their_contrast_on_dark_and_light_terminals() {
    use TextRole::{Alarm, FalseBelief, Gaze, Human, Quiet, Robot, Signal};
    // Black, and the backgrounds of VS Code, One Dark and Solarized; white, and those of Solarized and GitHub's code.
    let dark = [[0, 0, 0], [0x1e, 0x1e, 0x1e], [0x28, 0x2c, 0x34], [0x00, 0x2b, 0x36]];
    let light = [[255, 255, 255], [0xfd, 0xf6, 0xe3], [0xf6, 0xf8, 0xfa]];
    for (ground, backgrounds) in [(TerminalBackground::Dark, &dark[..]), (TerminalBackground::Light, &light[..])] {
        let colour = |role| xterm(Theme::colour(ground, role).expect("a colour of its own"));
        for background in backgrounds {
            for role in [Quiet, Human, Robot, Signal, Gaze, Alarm, FalseBelief] {
                let ratio = contrast(colour(role), *background);
                assert!(ratio >= 4.5, "{role:?} on {background:02x?}: {ratio:.2}");
            }
            let ratio = contrast(colour(TextRole::Frame), *background);
            assert!(
                (1.5..4.5).contains(&ratio),
                "lines are there, and quieter than text, on {background:02x?}: {ratio:.2}"
            );
        }
        for other in [Quiet, Human, Robot, Signal, Gaze, Alarm] {
            assert_ne!(colour(other), colour(FalseBelief), "one colour is that of false beliefs alone");
        }
    }
}
