//! The real arm at the operator's station: its driver, which stays connected from one recording to the next.

use crate::run::error::LiveError;
use crate::run::event_loop::or_never;
use tomcom_core::kitchen::Kitchen;
use tomcom_devices::ur::driver::UrDriver;
use tomcom_devices::ur::link::UrConnection;
pub(in crate::run) use tomcom_devices::ur::link::{ArmNews, ArmOrders};
use tomcom_devices::ur::server::PORTS;
use tomcom_session::SessionSpec;
use tomcom_session::settings::{ArmKind, ParticipantKind, RobotSpec};

/// The driver, if the session's arm is a real one.
#[derive(Default)]
pub(in crate::run) struct StationArm(Option<UrConnection>);

impl StationArm {
    /// Starts the driver, if the session's arm is a real one.
    ///
    /// # Errors
    /// The operating system has no thread for it.
    pub fn open(spec: &SessionSpec, kitchen: &Kitchen) -> Result<StationArm, LiveError> {
        let ArmKind::Ur(address) = spec.robot.arm else { return Ok(StationArm::default()) };
        let with_person = matches!(spec.participant.kind, ParticipantKind::Keyboard | ParticipantKind::Display);
        let driver = UrDriver::new(kitchen, spec.robot.speed.unwrap_or(RobotSpec::SPEED), with_person);
        UrConnection::start(address, PORTS, driver).map(|link| StationArm(Some(link))).map_err(LiveError::Arm)
    }

    pub fn orders(&self) -> Option<ArmOrders> {
        self.0.as_ref().map(|link| link.orders.clone())
    }

    /// Waits for the arm's next news; waits forever without a real arm.
    pub async fn next(&mut self) -> Option<ArmNews> {
        or_never(self.0.as_mut().map(UrConnection::next)).await
    }
}
