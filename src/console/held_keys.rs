//! Detection of held keys, also in terminals that report neither key repeats nor key releases.

use crossterm::event::{KeyEvent, KeyEventKind};

use super::console_model::{ConsoleModel, PressedKey};
use super::key_action::{KeyAction, ManualAction};

/// Largest time between two reports of one key, in seconds, for the key to count as held down: terminals repeat a held
/// key about every 0.03 s, and no finger is that fast. Used only where the terminal does not report repeats as such.
const REPEAT_S: f64 = 0.15;
/// Time in seconds for which a question ignores the key that opened it: longer than the usual delay before key repeat
/// sets in (0.25 to 0.7 s), during which a held key cannot be told from a second press.
pub(super) const ANSWER_S: f64 = 0.7;

/// Meaning of a terminal's key report: newly pressed, pressed again or held, held, or released.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum KeyPressKind {
    /// The key was newly pressed, according to the terminal's report.
    Press,
    /// The key was pressed a second time, or has been held since the first press and begins to repeat.
    Again,
    /// The key is held down, according to the terminal's report.
    Held,
    Release,
}

/// Classifies a key report of the terminal, and remembers the key for the next report.
pub(super) fn touch(model: &mut ConsoleModel, key: &KeyEvent) -> KeyPressKind {
    match key.kind {
        KeyEventKind::Press if model.exact_keys => return KeyPressKind::Press,
        KeyEventKind::Press => {}
        kind => {
            model.exact_keys = true;
            return if kind == KeyEventKind::Release { KeyPressKind::Release } else { KeyPressKind::Held };
        }
    }
    // Only the key that was pressed last repeats. The waiting time runs from the press that counted, so that repeated
    // attempts do not prolong it.
    let now = model.clock;
    let last = model.pressed.filter(|last| last.code == key.code);
    let touch = match last.map(|last| (now.secs_since(last.reported), now.secs_since(last.counted))) {
        Some((gap_s, _)) if gap_s < REPEAT_S => KeyPressKind::Held,
        Some((_, since_s)) if since_s < ANSWER_S => KeyPressKind::Again,
        _ => KeyPressKind::Press,
    };
    let counted = last.filter(|_| touch != KeyPressKind::Press).map_or(now, |last| last.counted);
    model.pressed = Some(PressedKey { code: key.code, reported: now, counted });
    touch
}

/// Whether a list has closed so recently that an enter key was probably meant for the list.
pub(super) fn is_right_after_list(model: &ConsoleModel) -> bool {
    model.answered.is_some_and(|answered| model.clock.secs_since(answered) < ANSWER_S)
}

/// Whether a second press shortly after the first counts although the terminal cannot tell it from a held key. It does
/// not count for actions that toggle, nor for actions that are recorded each time.
pub(super) fn may_follow_at_once(action: &KeyAction) -> bool {
    let once = [ManualAction::HoldRobot, ManualAction::SkipPress].map(KeyAction::Hand);
    !matches!(action, KeyAction::Advance | KeyAction::SwitchLayer | KeyAction::Note(_)) && !once.contains(action)
}
