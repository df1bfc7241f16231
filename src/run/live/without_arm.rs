//! Stand-in for the news of a real arm, in a build without the feature `ur`.

use super::live_session::Live;
use crate::run::operator_station::ArmNews;

impl Live {
    pub(super) fn take_arm_news(&mut self, news: ArmNews) {
        match news {}
    }
}
