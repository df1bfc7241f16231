//! Colours and signs of the console, with ASCII fallback. Every meaning of a colour also has a sign or a letter. Colours come from
//! the 256 colours of xterm, one set for dark and one for light terminals, with a contrast of at least 4.5 to the usual
//! backgrounds (WCAG 2.1, success criterion 1.4.3).

use ratatui::style::{Color, Modifier, Style};

/// Role of a text on the screen, from which its style follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextRole {
    /// Ordinary text.
    Text,
    /// Labels and normal states.
    Quiet,
    /// Frames and separators.
    Frame,
    /// Titles and contents.
    Strong,
    /// The participant and its presses.
    Human,
    /// The robot and its presses.
    Robot,
    /// Keys of the wizard, and signals.
    Signal,
    /// The participant's gaze.
    Gaze,
    /// Alarms: stopped, lost, failed.
    Alarm,
    /// False beliefs only.
    FalseBelief,
}

/// The terminal's background.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TerminalBackground {
    /// Light text on a dark background.
    Dark,
    /// Dark text on a light background.
    Light,
}

/// Colours and signs of the console.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Theme {
    /// Whether colours are used; without, weight and signs tell the same.
    pub colour: bool,
    /// Whether signs beyond ASCII are used.
    pub unicode: bool,
    /// The terminal's background, which the colours must contrast with.
    pub ground: TerminalBackground,
}

/// The signs of the console.
#[derive(Debug, PartialEq, Eq)]
pub struct Glyphs {
    /// Corners top left, top right, bottom left, bottom right, then horizontal and vertical line.
    pub frame: [&'static str; 6],
    /// Rules of a card: normal, just changed, highlighted by a signal.
    pub rules: [&'static str; 3],
    /// A full cell of a bar.
    pub bar_full: &'static str,
    /// An empty cell of a bar.
    pub bar_empty: &'static str,
    /// Where the participant looks.
    pub gaze: &'static str,
    /// Where the participant looked before.
    pub trail: &'static str,
    /// A press.
    pub press: &'static str,
    /// An ineffective press.
    pub no_effect: &'static str,
    /// A press that was an error.
    pub error: &'static str,
    /// An order that was served.
    pub served: &'static str,
    /// A signal that was taken back.
    pub taken_back: &'static str,
    /// The robot is stopped.
    pub stopped: &'static str,
    /// Contact with the arm.
    pub touched: &'static str,
    /// Manual intervention of the experimenter.
    pub by_hand: &'static str,
    /// From one thing to another.
    pub to: &'static str,
    /// Changed just now.
    pub changed: &'static str,
    /// The session is recorded.
    pub recording: &'static str,
    /// The trial is paused.
    pub pause: &'static str,
    /// Text that was cut.
    pub ellipsis: &'static str,
    /// Bars from low to full, for curves.
    pub levels: [&'static str; 8],
    /// No value.
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
    changed: "<",
    recording: "*",
    pause: "=",
    ellipsis: "~",
    levels: ["_", ".", ",", "-", "~", "+", "*", "#"],
    dash: "-",
};

impl Theme {
    /// The signs of this theme.
    pub fn signs(&self) -> &'static Glyphs {
        if self.unicode { &UNICODE } else { &ASCII }
    }

    /// The colour of a role, as an index into the 256 colours of xterm; `None` is the terminal's own.
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

    /// The style of a role in this theme.
    pub fn style(&self, role: TextRole) -> Style {
        let modifier = match role {
            TextRole::Text | TextRole::Human | TextRole::Robot => Modifier::empty(),
            // Without colours, dim text replaces grey.
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

    /// Style of a filled badge.
    pub fn badge(&self, role: TextRole) -> Style {
        self.style(role).remove_modifier(Modifier::DIM).add_modifier(Modifier::REVERSED | Modifier::BOLD)
    }
}
