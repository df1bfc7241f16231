//! Frames of the console as observers' pages show them.

use ratatui::buffer::{Buffer, Cell};
use ratatui::style::{Color, Modifier};

use crate::console::text_columns::width;
use crate::console::view::theme::TerminalBackground;
use tomcom_devices::observers::{CellColour, CellRun, ScreenFrame};

/// A frame of the console as lines of stretches of cells that look alike.
pub fn frame_of(buffer: &Buffer, ground: TerminalBackground) -> ScreenFrame {
    let columns = buffer.area.width;
    let lines = match columns {
        0 => Vec::new(),
        _ => buffer.content.chunks(usize::from(columns)).map(line_of).collect(),
    };
    ScreenFrame { columns, is_light: ground == TerminalBackground::Light, lines }
}

fn line_of(cells: &[Cell]) -> Vec<CellRun> {
    let mut runs: Vec<CellRun> = Vec::new();
    let mut look = None;
    let mut column = 0;
    while let Some(cell) = cells.get(column) {
        let text = if cell.symbol().is_empty() { " " } else { cell.symbol() };
        // A wide character covers the cells after it.
        let columns = width(text).max(1);
        column += usize::from(columns);
        let own = (cell.fg, cell.bg, cell.modifier);
        match runs.last_mut().filter(|_| look == Some(own)) {
            Some(run) => {
                run.text.push_str(text);
                run.columns += columns;
            }
            None => {
                let (ink, ground, styles) = (colour(cell.fg), colour(cell.bg), styles(cell.modifier));
                runs.push(CellRun { text: text.to_string(), columns, ink, ground, styles });
                look = Some(own);
            }
        }
    }
    runs
}

/// The colour of a cell; `None` for the terminal's own.
fn colour(colour: Color) -> Option<CellColour> {
    Some(CellColour::Palette(match colour {
        Color::Reset => return None,
        Color::Rgb(red, green, blue) => return Some(CellColour::Rgb([red, green, blue])),
        Color::Indexed(index) => index,
        Color::Black => 0,
        Color::Red => 1,
        Color::Green => 2,
        Color::Yellow => 3,
        Color::Blue => 4,
        Color::Magenta => 5,
        Color::Cyan => 6,
        Color::Gray => 7,
        Color::DarkGray => 8,
        Color::LightRed => 9,
        Color::LightGreen => 10,
        Color::LightYellow => 11,
        Color::LightBlue => 12,
        Color::LightMagenta => 13,
        Color::LightCyan => 14,
        Color::White => 15,
    }))
}

/// Names of the styles, as the page's style sheet has them.
fn styles(modifier: Modifier) -> String {
    modifier.iter_names().map(|(name, _)| name.to_lowercase()).collect::<Vec<_>>().join(" ")
}
