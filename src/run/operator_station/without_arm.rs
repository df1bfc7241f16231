//! Stand-in for the real arm in a build without the feature `ur`, in which no session with a real arm begins.

use crate::run::error::LiveError;
use tomcom_core::kitchen::Kitchen;
use tomcom_session::{Event, SessionSpec};

/// What a driver tells; this build has none.
pub(in crate::run) enum ArmNews {}

/// Orders to a driver; this build has none.
#[derive(Clone)]
pub(in crate::run) enum ArmOrders {}

impl ArmOrders {
    pub fn begin(&self) {
        match *self {}
    }

    pub fn order<Order>(&self, _: Order) {
        match *self {}
    }

    pub fn tell(&self, _: &Event) {
        match *self {}
    }
}

/// Stand-in for the real arm, which this build lacks.
#[derive(Default)]
pub(in crate::run) struct StationArm {}

impl StationArm {
    /// Starts no driver; sessions that need one were refused before.
    pub fn open(_: &SessionSpec, _: &Kitchen) -> Result<StationArm, LiveError> {
        Ok(StationArm {})
    }

    pub fn orders(&self) -> Option<ArmOrders> {
        None
    }

    pub async fn next(&mut self) -> Option<ArmNews> {
        std::future::pending().await
    }
}
