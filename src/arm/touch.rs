//! Contacts between robot arm and human: each contact is reported once.

/// Number of controller cycles after which a contact is reported, and number of cycles without force after which the
/// contact has ended.
const CYCLES: u32 = 12;

/// The present contact between robot arm and human; `None` without a contact.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ContactTracker(Option<Contact>);

#[derive(Clone, Copy, Debug, Default)]
struct Contact {
    most_n: f64,
    cycles: u32,
    /// Number of controller cycles without force since the contact was last felt.
    quiet: u32,
}

impl ContactTracker {
    /// Adds the contact force of a controller cycle, in newtons. Returns the peak force of a contact that has to be
    /// reported now.
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

    /// Whether there is a contact that has not been reported yet.
    pub fn is_to_be_told(&self) -> bool {
        self.0.is_some_and(|contact| contact.cycles < CYCLES)
    }
}
