//! Colours with meaning and signs with a fallback. Every meaning has a sign or a letter too, so that nothing is lost
//! without colour; the terminal's own palette is used, so that dark and light terminals both work.

use ratatui::style::{Color, Modifier, Style};

/// What something on the screen is, not how it looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    Text,
    /// Labels, frames and what is as it should be.
    Quiet,
    /// Titles and what is there.
    Strong,
    Human,
    Robot,
    /// The wizard's keys, and what they show to the participant.
    Signal,
    Gaze,
    /// Stopped, lost, wrong: has to be seen at once.
    Alarm,
    /// False beliefs, and nothing else.
    FalseBelief,
}

/// How the console is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Theme {
    pub colour: bool,
    pub unicode: bool,
}

/// The signs of the console.
#[derive(Debug, PartialEq, Eq)]
pub struct Signs {
    /// Corners top left, top right, bottom left, bottom right, then horizontal and vertical line.
    pub frame: [&'static str; 6],
    /// The same of what is highlighted.
    pub heavy: [&'static str; 6],
    pub bar_full: &'static str,
    pub bar_empty: &'static str,
    pub gaze: &'static str,
    pub trail: &'static str,
    pub press: &'static str,
    pub no_effect: &'static str,
    pub error: &'static str,
    pub served: &'static str,
    pub taken_back: &'static str,
    pub stopped: &'static str,
    /// Done by the experimenter's hand.
    pub by_hand: &'static str,
    pub to: &'static str,
    pub changed: &'static str,
    pub recording: &'static str,
    pub pause: &'static str,
    pub ellipsis: &'static str,
    pub dash: &'static str,
}

const UNICODE: Signs = Signs {
    frame: ["╭", "╮", "╰", "╯", "─", "│"],
    heavy: ["┏", "┓", "┗", "┛", "━", "┃"],
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
    by_hand: "◆",
    to: "▸",
    changed: "◂",
    recording: "●",
    pause: "‖",
    ellipsis: "…",
    dash: "–",
};

const ASCII: Signs = Signs {
    frame: [".", ".", "'", "'", "-", "|"],
    heavy: ["#", "#", "#", "#", "#", "#"],
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
    by_hand: "%",
    to: ">",
    changed: "<",
    recording: "*",
    pause: "=",
    ellipsis: "~",
    dash: "-",
};

impl Theme {
    pub fn signs(&self) -> &'static Signs {
        if self.unicode { &UNICODE } else { &ASCII }
    }

    pub fn style(&self, role: Role) -> Style {
        let style = Style::new();
        let (colour, modifier) = match role {
            Role::Text => (None, Modifier::empty()),
            Role::Quiet => (None, Modifier::DIM),
            Role::Strong => (None, Modifier::BOLD),
            Role::Human => (Some(Color::Cyan), Modifier::empty()),
            Role::Robot => (Some(Color::LightBlue), Modifier::empty()),
            Role::Signal => (Some(Color::LightMagenta), Modifier::BOLD),
            Role::Gaze => (Some(Color::Green), Modifier::BOLD),
            Role::Alarm => (Some(Color::LightRed), Modifier::BOLD),
            Role::FalseBelief => (Some(Color::Yellow), Modifier::BOLD),
        };
        let style = style.add_modifier(modifier);
        match colour {
            Some(colour) if self.colour => style.fg(colour),
            _ => style,
        }
    }

    /// The same as a filled badge.
    pub fn badge(&self, role: Role) -> Style {
        self.style(role).remove_modifier(Modifier::DIM).add_modifier(Modifier::REVERSED | Modifier::BOLD)
    }
}
