//! Contacts between arm and human, each told once.

/// A contact is told so many cycles after it began, when its first blow is over, and is over after so many without a force.
const CYCLES: u32 = 12;

/// A contact that goes on, if there is one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ContactTracker(Option<Contact>);

#[derive(Clone, Copy, Debug, Default)]
struct Contact {
    most_n: f64,
    cycles: u32,
    /// Cycles without a force.
    quiet: u32,
}

impl ContactTracker {
    /// A cycle with this force in newtons; the greatest force of a contact that is to be told now.
    pub fn feel(&mut self, force_n: f64) -> Option<f64> {
        if force_n > 0.0 {
            self.0.get_or_insert_default();
        }
        let contact = self.0.as_mut()?;
        contact.most_n = contact.most_n.max(force_n);
        contact.cycles += 1;
        contact.quiet = if force_n > 0.0 { 0 } else { contact.quiet + 1 };
        let told = (contact.cycles == CYCLES).then_some(contact.most_n);
        if contact.cycles > CYCLES && contact.quiet >= CYCLES {
            self.0 = None;
        }
        told
    }

    /// Whether there is a contact that was not told yet.
    pub fn is_to_be_told(&self) -> bool {
        self.0.is_some_and(|contact| contact.cycles < CYCLES)
    }
}
