//! Tells a pressed key from a held one, also where the terminal reports neither repeats nor releases.

use crossterm::event::{KeyEvent, KeyEventKind};

use super::console_model::{ConsoleModel, PressedKey};
use super::key_action::{KeyAction, ManualAction};

/// A key that the terminal reports again within this time is held down, not pressed again: terminals repeat a held key
/// about every 0.03 s, and no finger is that fast. Only where the terminal does not report repeats as such.
const REPEAT_S: f64 = 0.15;
/// A question is not answered by its own key within this time: longer than the usual delay before key repeat sets in
/// (0.25 to 0.7 s), when a key that stays down can not be told from a second press.
pub(super) const ANSWER_S: f64 = 0.7;

/// What a report of the terminal says of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Touch {
    /// It went down just now.
    Press,
    /// It was pressed a second time, or is held down since the first and begins to repeat.
    Again,
    /// It is held down.
    Held,
    Release,
}

/// What this report says of its key; remembers the key.
pub(super) fn touch(model: &mut ConsoleModel, key: &KeyEvent) -> Touch {
    match key.kind {
        KeyEventKind::Press if model.exact_keys => return Touch::Press,
        KeyEventKind::Press => {}
        kind => {
            model.exact_keys = true;
            return if kind == KeyEventKind::Release { Touch::Release } else { Touch::Held };
        }
    }
    // Only the key that went down last repeats. The wait runs from the press that counted, so that trying again is no way
    // to wait for ever.
    let now = model.clock;
    let last = model.pressed.filter(|last| last.code == key.code);
    let touch = match last.map(|last| (now.secs_since(last.reported), now.secs_since(last.counted))) {
        Some((gap_s, _)) if gap_s < REPEAT_S => Touch::Held,
        Some((_, since_s)) if since_s < ANSWER_S => Touch::Again,
        _ => Touch::Press,
    };
    let counted = last.filter(|_| touch != Touch::Press).map_or(now, |last| last.counted);
    model.pressed = Some(PressedKey { code: key.code, reported: now, counted });
    touch
}

/// Whether a second press within the delay of key repeat counts where the terminal does not tell it from a held key. What
/// does the opposite the second time does not, nor does what is written down each time.
pub(super) fn may_follow_at_once(action: &KeyAction) -> bool {
    let once = [ManualAction::HoldRobot, ManualAction::SkipPress].map(KeyAction::Hand);
    !matches!(action, KeyAction::Advance | KeyAction::SwitchLayer | KeyAction::Note(_)) && !once.contains(action)
}
