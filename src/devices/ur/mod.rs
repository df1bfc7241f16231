//! The driver of a real UR5, and a simulated controller of one, to rehearse against: programs that talk to the manufacturer's
//! controllers talk to it as well.
//!
//! [`driver`] carries out the session's orders, without sockets and clocks: what the controller reports goes in, what it is
//! to read, what the session is told and what else is to be done come out. [`client`] is the codec of its RTDE connection,
//! and [`link`] joins it to the ports of a controller.
//!
//! [`controller`] is the controller without sockets and clocks: it goes on by one cycle of 8 ms at a time, over the arm in
//! the physics simulation, so that tests run it faster than real time. [`rtde`] (Real-Time Data Exchange, protocol version
//! 2, with the variables of [`variables`]) and [`dashboard`] answer bytes with bytes; [`script`] reads the supported part
//! of URScript and [`program`] runs it, with the functions of [`builtins`] and the motions of [`motion`]. [`server`] puts
//! them on the controller's ports in wall time, and [`faults`] are what goes wrong on command.
//!
//! Everything is written from the manufacturer's published descriptions of the interfaces, and compared from outside with
//! clients of other people. It was never compared with a real controller.

pub mod builtins;
pub mod client;
pub mod controller;
pub mod dashboard;
pub mod driver;
pub mod faults;
pub mod link;
pub mod motion;
pub mod program;
pub mod rtde;
pub mod script;
pub mod server;
pub mod variables;
