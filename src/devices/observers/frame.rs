//! The wizard's screen as plain data: lines of stretches of cells with one look, and what changed between two frames.

use std::sync::Arc;

use serde::Serialize;

/// A frame of the wizard's screen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScreenFrame {
    pub columns: u16,
    /// Whether the colours are meant for a light background.
    pub is_light: bool,
    pub lines: Vec<Vec<CellRun>>,
}

/// Neighbouring cells of one line that look alike.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct CellRun {
    pub text: String,
    /// Number of columns that the text takes; wide characters take two.
    pub columns: u16,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ink: Option<CellColour>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground: Option<CellColour>,
    /// Names of the text's styles with spaces between them, such as "bold reversed".
    #[serde(skip_serializing_if = "String::is_empty")]
    pub styles: String,
}

/// A colour of a cell other than the terminal's own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum CellColour {
    /// Number in xterm's palette of 256 colours.
    Palette(u8),
    Rgb([u8; 3]),
}

/// What an observer's page has to draw.
#[derive(Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename = "frame")]
pub(super) struct FrameChange<'a> {
    pub columns: u16,
    pub rows: usize,
    #[serde(rename = "light")]
    pub is_light: bool,
    /// The lines that changed, each with its index from the top.
    pub lines: Vec<(usize, &'a [CellRun])>,
}

impl ScreenFrame {
    /// What changed since the frame that a page shows: all lines if it shows none, or one of another size; `None` if the
    /// page need draw nothing.
    pub(super) fn since(&self, shown: Option<&Arc<ScreenFrame>>) -> Option<FrameChange<'_>> {
        let size = |frame: &ScreenFrame| (frame.columns, frame.lines.len(), frame.is_light);
        let shown = shown.filter(|shown| size(shown) == size(self));
        let is_new = |(index, line): &(usize, &[CellRun])| shown.is_none_or(|shown| shown.lines[*index] != *line);
        let lines = self.lines.iter().map(Vec::as_slice).enumerate().filter(is_new).collect::<Vec<_>>();
        let (columns, rows, is_light) = size(self);
        (!lines.is_empty()).then_some(FrameChange { columns, rows, is_light, lines })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page_server::text;

    fn frame(lines: &[&str]) -> Arc<ScreenFrame> {
        let run = |line: &&str| {
            vec![CellRun { text: line.to_string(), columns: line.chars().count() as u16, ..CellRun::default() }]
        };
        Arc::new(ScreenFrame { columns: 5, is_light: false, lines: lines.iter().map(run).collect() })
    }

    fn changed(shown: Option<&Arc<ScreenFrame>>, now: &ScreenFrame) -> Vec<usize> {
        now.since(shown).map_or_else(Vec::new, |change| change.lines.iter().map(|(index, _)| *index).collect())
    }

    #[test]
    fn a_page_is_told_the_lines_that_changed_since_the_frame_that_it_shows() {
        let (first, second) = (frame(&["one  ", "two  ", "three"]), frame(&["one  ", "TWO  ", "three"]));
        assert_eq!(changed(None, &first), [0, 1, 2], "a new page");
        assert_eq!(changed(Some(&first), &first), [] as [usize; 0]);
        assert_eq!(changed(Some(&first), &second), [1]);
        // A slow page skips frames: what counts is the frame that it shows.
        let third = frame(&["ONE  ", "TWO  ", "three"]);
        assert_eq!(changed(Some(&first), &third), [0, 1]);
        assert_eq!(changed(Some(&first), &frame(&["one  ", "two  "])), [0, 1], "another size");
        let light = ScreenFrame { is_light: true, ..(*first).clone() };
        assert_eq!(changed(Some(&first), &light), [0, 1, 2], "another background");
    }

    #[test]
    fn a_change_of_the_look_alone_is_a_change() {
        let first = frame(&["one  ", "two  "]);
        let mut second = (*first).clone();
        second.lines[1][0].ink = Some(CellColour::Palette(203));
        assert_eq!(changed(Some(&first), &second), [1]);
        second = (*first).clone();
        second.lines[0][0].styles = "bold".to_string();
        assert_eq!(changed(Some(&first), &second), [0]);
    }

    #[test]
    fn a_frame_is_text_with_its_looks() {
        let look = CellRun {
            text: "✗ 終".to_string(),
            columns: 4,
            ink: Some(CellColour::Palette(203)),
            ground: Some(CellColour::Rgb([1, 2, 3])),
            styles: "bold reversed".to_string(),
        };
        let plain = CellRun { text: " ".to_string(), columns: 1, ..CellRun::default() };
        let frame = ScreenFrame { columns: 5, is_light: true, lines: vec![vec![look, plain]] };
        let told = frame.since(None).expect("a new page");
        let wanted = r#"{"kind":"frame","columns":5,"rows":1,"light":true,"lines":[[0,[{"text":"✗ 終","columns":4,"ink":203,"ground":[1,2,3],"styles":"bold reversed"},{"text":" ","columns":1}]]]}"#;
        assert_eq!(&*text(&told), wanted);
    }
}
