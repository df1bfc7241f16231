//! Colours and signs of the console, with a fallback in ASCII. Every meaning of a colour also has a sign or a letter.
//! Colours come from xterm's palette of 256, one set for dark and one for light terminals, with a contrast of at least
//! 4.5 to the usual backgrounds (WCAG 2.1, success criterion 1.4.3).

use ratatui::style::{Color, Modifier, Style};

/// Role of a text on the screen, such as a title or an alarm, from which its style follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextRole {
    Text,
    Quiet,
    Frame,
    Strong,
    Human,
    Robot,
    Signal,
    Gaze,
    Alarm,
    /// Style of false beliefs, and of nothing else.
    FalseBelief,
}

/// Brightness of the terminal's background.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TerminalBackground {
    #[default]
    Dark,
    Light,
}

/// Theme of the console: its colours and signs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Theme {
    /// Whether colours are used; without colours, weight and signs tell the same.
    pub colour: bool,
    pub unicode: bool,
    pub ground: TerminalBackground,
}

/// Signs (glyphs) of the console, in Unicode or in ASCII.
#[derive(Debug, PartialEq, Eq)]
pub struct Glyphs {
    /// Frame signs: corners top left, top right, bottom left, bottom right, then horizontal and vertical line.
    pub frame: [&'static str; 6],
    /// Vertical rules of a location's box: normal, just changed, highlighted by a signal.
    pub rules: [&'static str; 3],
    pub bar_full: &'static str,
    pub bar_empty: &'static str,
    pub gaze: &'static str,
    pub trail: &'static str,
    pub press: &'static str,
    pub no_effect: &'static str,
    pub error: &'static str,
    pub served: &'static str,
    /// Item of an order that is not there.
    pub missing: &'static str,
    /// An item of an order that is there, but not processed yet.
    pub in_work: &'static str,
    pub taken_back: &'static str,
    pub stopped: &'static str,
    pub touched: &'static str,
    pub by_hand: &'static str,
    pub to: &'static str,
    pub cursor: &'static str,
    pub changed: &'static str,
    /// Changed while no gaze tells whether it was seen.
    pub unknown: &'static str,
    pub recording: &'static str,
    pub pause: &'static str,
    pub ellipsis: &'static str,
    /// Signs for curves: vertical bars from low to full.
    pub levels: [&'static str; 8],
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
    missing: "□",
    in_work: "◐",
    taken_back: "↶",
    stopped: "■",
    touched: "×",
    by_hand: "◆",
    to: "▸",
    cursor: "»",
    changed: "◂",
    unknown: "◂?",
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
    missing: "_",
    in_work: "~",
    taken_back: "<",
    stopped: "#",
    touched: "x",
    by_hand: "%",
    to: ">",
    cursor: ")",
    changed: "<",
    unknown: "<?",
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

    pub fn badge(&self, role: TextRole) -> Style {
        self.style(role).remove_modifier(Modifier::DIM).add_modifier(Modifier::REVERSED | Modifier::BOLD)
    }
}
