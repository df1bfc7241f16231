//! Colours and signs of the console, with a fallback in ASCII. Every meaning of a colour also has a sign or a letter.
//! Colours come from xterm's palette of 256, one set for dark and one for light terminals, with a contrast of at least
//! 4.5 to the usual backgrounds (WCAG 2.1, success criterion 1.4.3).

use ratatui::style::{Color, Modifier, Style};

/// Role of a text on the screen, such as a title or an alarm, from which its style follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextRole {
    /// Style of ordinary text.
    Text,
    /// Style of labels and normal states.
    Quiet,
    /// Style of frames and separators.
    Frame,
    /// Style of titles and contents.
    Strong,
    /// Style of the participant and of the participant's presses.
    Human,
    /// Style of the robot and of its presses.
    Robot,
    /// Style of the wizard's keys, and of signals.
    Signal,
    /// Style of the participant's gaze.
    Gaze,
    /// Style of alarms: stopped, lost, failed.
    Alarm,
    /// Style of false beliefs, and of nothing else.
    FalseBelief,
}

/// Brightness of the terminal's background.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TerminalBackground {
    /// A terminal with light text on a dark background.
    Dark,
    /// A terminal with dark text on a light background.
    Light,
}

/// Theme of the console: its colours and signs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Theme {
    /// Whether colours are used; without colours, weight and signs tell the same.
    pub colour: bool,
    /// Whether the signs may be Unicode characters outside ASCII.
    pub unicode: bool,
    /// Terminal background that the colours must contrast with.
    pub ground: TerminalBackground,
}

/// Signs (glyphs) of the console, in Unicode or in ASCII.
#[derive(Debug, PartialEq, Eq)]
pub struct Glyphs {
    /// Frame signs: corners top left, top right, bottom left, bottom right, then horizontal and vertical line.
    pub frame: [&'static str; 6],
    /// Vertical rules of a location's box: normal, just changed, highlighted by a signal.
    pub rules: [&'static str; 3],
    /// Sign for a full cell of a bar.
    pub bar_full: &'static str,
    /// Sign for an empty cell of a bar.
    pub bar_empty: &'static str,
    /// Sign for where the participant looks.
    pub gaze: &'static str,
    /// Sign for where the participant looked before.
    pub trail: &'static str,
    /// Sign for a press.
    pub press: &'static str,
    /// Sign for a press without an effect.
    pub no_effect: &'static str,
    /// Sign for a press that was an error.
    pub error: &'static str,
    /// Sign for an order that was served.
    pub served: &'static str,
    /// Sign for a signal that was taken back.
    pub taken_back: &'static str,
    /// Sign for a stopped robot.
    pub stopped: &'static str,
    /// Sign for a contact with the robot arm.
    pub touched: &'static str,
    /// Sign for a manual intervention of the experimenter.
    pub by_hand: &'static str,
    /// Sign for a direction: an arrow from one thing to another.
    pub to: &'static str,
    /// Sign for the selected row of a list.
    pub cursor: &'static str,
    /// Sign for a content that has just changed.
    pub changed: &'static str,
    /// Sign for a session that is recorded.
    pub recording: &'static str,
    /// Sign for a paused trial.
    pub pause: &'static str,
    /// Sign for text that was cut off: an ellipsis.
    pub ellipsis: &'static str,
    /// Signs for curves: vertical bars from low to full.
    pub levels: [&'static str; 8],
    /// Sign for a missing value.
    pub dash: &'static str,
}

const UNICODE: Glyphs = Glyphs {
    frame: ["╭", "╮", "╰", "╯", "─", "│"],
    rules: ["▏", "▌", "█"],
    bar_full: "▰",
    bar_empty: "▱",
    gaze: "◉",
    trail: "∘",
    press: "•",
    no_effect: "○",
    error: "✗",
    served: "✓",
    taken_back: "↶",
    stopped: "■",
    touched: "×",
    by_hand: "◆",
    to: "▸",
    cursor: "»",
    changed: "◂",
    recording: "●",
    pause: "‖",
    ellipsis: "…",
    levels: ["▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"],
    dash: "–",
};

const ASCII: Glyphs = Glyphs {
    frame: [".", ".", "'", "'", "-", "|"],
    rules: ["|", "!", "#"],
    bar_full: "=",
    bar_empty: "-",
    gaze: "@",
    trail: ".",
    press: ".",
    no_effect: "o",
    error: "X",
    served: "v",
    taken_back: "<",
    stopped: "#",
    touched: "x",
    by_hand: "%",
    to: ">",
    cursor: ")",
    changed: "<",
    recording: "*",
    pause: "=",
    ellipsis: "~",
    levels: ["_", ".", ",", "-", "~", "+", "*", "#"],
    dash: "-",
};

impl Theme {
    /// The signs of this theme: those in Unicode or those in ASCII.
    pub fn signs(&self) -> &'static Glyphs {
        if self.unicode { &UNICODE } else { &ASCII }
    }

    /// Colour of a text role, as an index into xterm's 256 colours; `None` is the terminal's own colour.
    pub fn colour(ground: TerminalBackground, role: TextRole) -> Option<u8> {
        let (dark, light) = match role {
            TextRole::Text | TextRole::Strong => return None,
            TextRole::Quiet => (247, 241),
            TextRole::Frame => (240, 248),
            TextRole::Human => (80, 23),
            TextRole::Robot => (111, 25),
            TextRole::Signal => (177, 127),
            TextRole::Gaze => (114, 22),
            TextRole::Alarm => (203, 160),
            TextRole::FalseBelief => (221, 94),
        };
        Some(if ground == TerminalBackground::Dark { dark } else { light })
    }

    /// The style (colour, weight) of a text role in this theme.
    pub fn style(&self, role: TextRole) -> Style {
        let modifier = match role {
            TextRole::Text | TextRole::Human | TextRole::Robot => Modifier::empty(),
            // Without colours, quiet text is drawn dim instead of grey.
            TextRole::Quiet | TextRole::Frame if self.colour => Modifier::empty(),
            TextRole::Quiet | TextRole::Frame => Modifier::DIM,
            TextRole::Strong | TextRole::Signal | TextRole::Gaze | TextRole::Alarm | TextRole::FalseBelief => {
                Modifier::BOLD
            }
        };
        let style = Style::new().add_modifier(modifier);
        match Theme::colour(self.ground, role).filter(|_| self.colour) {
            Some(index) => style.fg(Color::Indexed(index)),
            None => style,
        }
    }

    /// Style of a badge, an inverse label in the colour of a text role.
    pub fn badge(&self, role: TextRole) -> Style {
        self.style(role).remove_modifier(Modifier::DIM).add_modifier(Modifier::REVERSED | Modifier::BOLD)
    }
}
